// Images with values far from Hounsfield units: their plan opens, and each is shown over its own range.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, startDaemon } from './daemon.mjs';

// PET in Bq/ml, neutrons per source particle, and the written limits of a window
const windows = { becquerel: [500000, 1000000], fluence: [5e-14, 1e-13], widest: [1e12, 2e12], narrowest: [-1e12, 1e-15] };
let folder, daemon;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-windows-'));
  for (const [name, [center, width]] of [...Object.entries(windows), ['beyond', [0, 3e12]]]) {
    cpSync(join(demo, 'phantom'), join(folder, name), { recursive: true });
    const file = join(folder, name, 'plan.json');
    const plan = JSON.parse(readFileSync(file, 'utf8'));
    plan.images[0].window = { center, width };
    writeFileSync(file, JSON.stringify(plan));
  }
  daemon = await startDaemon({ plans: [folder] });
});
after(async () => {
  await daemon?.stop();
  rmSync(folder, { recursive: true });
});

for (const [name, [center, width]] of Object.entries(windows))
  test(`a window of ${width} about ${center} is what a new room begins with`, async () => {
    await openPlan(daemon.url, name);
    const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: name })).json.id;
    const { status, json } = await call(`${daemon.url}/api/v1/rooms/${room}/scene`);
    assert.equal(status, 200);
    assert.deepEqual(json.image.window, { center, width, gamma: 1 });
  });

test('a window beyond the limits is refused with the place and what is expected', async () => {
  const { json } = await call(`${daemon.url}/api/v1/plans/beyond`);
  assert.match(JSON.stringify(json), /images\[0\]\.window: expected a center within 1e12 of 0, and a width from 1e-15 to 2e12/);
});
