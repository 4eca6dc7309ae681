// A page whose daemon is stopped and started again: it says so, comes back by itself to the same room, or says that it is gone.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, it } from 'node:test';
import { call, startDaemon, until } from '../api/daemon.mjs';
import { onDisk } from '../api/on_disk.mjs';
import { full, missing, startWorld } from './browser.mjs';

const skip = missing && `${missing} is not there`;
let world, data;

before(async () => {
  if (skip) return;
  data = mkdtempSync(join(tmpdir(), 'beamroom-again-'));
  world = await startWorld({ data, args: ['--stub'] });
});
after(async () => {
  await world?.stop();
  if (data) rmSync(data, { recursive: true, force: true });
});

/** The daemon is killed and started again on the same port; with another folder nothing is kept. */
async function restart(folder) {
  const host = new URL(world.daemon.url).host, ended = new Promise((done) => world.daemon.child.on('exit', done));
  world.daemon.child.kill('SIGKILL');
  await ended;
  world.daemon = await startDaemon({ data: folder, args: ['--stub', '--listen', host] });
}

it('a page comes back by itself to the same scene after the daemon was killed, as the same member', { skip }, async () => {
  const room = await world.newRoom();
  const page = await world.newPage(`#/rooms/${room}`);
  await full(page);
  const scene = () => call(`${world.daemon.url}/api/v1/rooms/${room}/scene`);
  const patched = await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { image: { window: { center: 77 } } }, { 'If-Match': '*' });
  assert.equal(patched.status, 200, patched.text);
  const before = (await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json;
  await page.waitForFunction((revision) => globalThis.beamroom.stats().headers[1].scene_revision === revision, before.revision);
  await until(() => onDisk(room, data), (row) => row?.revision === before.revision && row.members.length === 1);
  const asked = page.waitForEvent('websocket'); // the next one
  await restart(data);
  await asked;
  await page.waitForFunction(() => globalThis.beamroom.stats().badges[1] !== 'disconnected');
  await full(page);
  assert.equal(await page.locator('.ended').count(), 0);
  const after = (await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json;
  assert.deepEqual(after.members.map(({ id, name, connected }) => ({ id, name, connected })), before.members.map(({ id, name }) => ({ id, name, connected: true })));
  const { json, headers } = await scene();
  assert.equal(json.image.window.center, 77);
  assert.equal(headers.get('etag'), `"${before.revision}"`);
});

it('a page comes back by itself after a restart of a daemon that lost its rooms, and says that its room has ended', { skip }, async () => {
  const page = await world.newPage(`#/rooms/${await world.newRoom()}`);
  await full(page);
  const asked = page.waitForEvent('websocket');
  await restart();
  await asked;
  const card = page.locator('.ended');
  await card.waitFor();
  assert.match(await card.textContent(), /The room is no longer there/);
  await card.getByRole('link', { name: 'All plans' }).waitFor();
  await card.getByRole('button', { name: /^Open Phantom.* in a new room$/ }).click(); // the server has its list of plans again
  await page.waitForFunction(() => globalThis.beamroom.stats().badges[1] !== 'disconnected' && !document.querySelector('.ended'));
  assert.match(page.url(), /#\/rooms\/[a-z0-9-]+\/phantom$/);
  assert.deepEqual(world.errors, []);
});
