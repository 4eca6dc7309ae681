// A page whose daemon is killed and started again without its rooms: it says that the room is gone. With its rooms: whole_meeting.test.mjs.
import assert from 'node:assert/strict';
import { after, before, it } from 'node:test';
import { startDaemon } from '../api/daemon.mjs';
import { full, missing, startWorld } from './browser.mjs';

const skip = missing && `${missing} is not there`;
let world;

before(async () => {
  if (skip) return;
  world = await startWorld({ args: ['--stub'] });
});
after(() => world?.stop());

/** The daemon is killed and started again on the same port, with another folder: nothing is kept. */
async function restart() {
  const host = new URL(world.daemon.url).host,
    ended = new Promise((done) => world.daemon.child.on('exit', done));
  world.daemon.child.kill('SIGKILL');
  await ended;
  world.daemon = await startDaemon({ args: ['--stub', '--listen', host] });
}

it('a page comes back by itself after a restart of a daemon that lost its rooms, and says that its room has ended', { skip }, async () => {
  const page = await world.newPage(`rooms/${await world.newRoom()}`);
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
  assert.match(page.url(), /\/rooms\/[a-z0-9-]+$/);
  assert.deepEqual(world.errors, []);
});
