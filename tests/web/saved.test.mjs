// The page while the server's disk is full: it says so until the disk is fine again, and says saved only then.
import assert from 'node:assert/strict';
import { after, before, it } from 'node:test';
import { call } from '../api/daemon.mjs';
import { FullDisk } from '../api/full_disk.mjs';
import { axe } from './axe.mjs';
import { full, missing, startWorld } from './browser.mjs';

const disk = new FullDisk();
const skip = missing ? `${missing} is not there` : disk.missing || false;
let world;
before(async () => {
  if (!skip) world = await startWorld({ data: disk.data, args: ['--stub'] });
});
after(async () => {
  await world?.stop();
  disk.remove();
});

it('a full disk is said in a line over the panes until it is fine again', { skip }, async () => {
  const room = await world.newRoom();
  const page = await world.newPage(`rooms/${room}`, { viewport: { width: 1100, height: 800 } });
  const patch = (center) =>
    call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { image: { window: { center } } }, { 'If-Match': '*' });
  const line = page.getByRole('alert').filter({ hasText: 'what is changed now is not kept' });
  await full(page);
  await page.locator('#saved', { hasText: /^Saved$/ }).waitFor();
  disk.fill(world.daemon.child);
  for (let n = 0; n < 300 && !(await line.count()); n++) await patch(n); // what is left of the last block is used up
  await line.waitFor();
  assert.match(await line.innerText(), disk.code === 'full' ? /The server's disk is full/ : /The server cannot write to its disk/);
  await page.locator('#saved', { hasText: 'Not saved' }).waitFor();
  assert.deepEqual(await axe(page), []);
  await page.screenshot({ path: 'build/test-artifacts/disk-full-1100.png' });
  await page.setViewportSize({ width: 1440, height: 900 });
  await full(page);
  await page.screenshot({ path: 'build/test-artifacts/disk-full-1440.png' });
  await page.reload();
  await line.waitFor();
  disk.free(world.daemon.child);
  await line.waitFor({ state: 'detached' });
  await page.locator('#saved', { hasText: /^Saved$/ }).waitFor();
  await patch(1234);
  await page.waitForFunction(() => document.querySelector('#saved').textContent === 'Saved');
  assert.deepEqual(world.errors, []);
});
