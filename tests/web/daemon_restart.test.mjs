// A page whose daemon is stopped and started again: it says so, comes back by itself, and says what it finds there.
import assert from 'node:assert/strict';
import { after, before, it } from 'node:test';
import { startDaemon } from '../api/daemon.mjs';
import { full, missing, startWorld } from './browser.mjs';

const skip = missing && `${missing} is not there`;
let world, again;

before(async () => { if (!skip) world = await startWorld({ args: ['--stub'] }); });
after(async () => {
  await world?.stop();
  await again?.stop();
});

it('a page comes back by itself after a restart of the daemon, and says that its room has ended', { skip }, async () => {
  const page = await world.newPage(`#/rooms/${await world.newRoom()}`);
  await full(page);
  const asked = page.waitForEvent('websocket'); // the next one
  await world.daemon.stop();
  await page.waitForFunction(() => globalThis.beamroom.stats().badges[1] === 'disconnected');
  assert.equal(await page.locator('.ended').count(), 0, 'it does not give up');
  again = await startDaemon({ args: ['--stub', '--listen', new URL(world.daemon.url).host] });
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
