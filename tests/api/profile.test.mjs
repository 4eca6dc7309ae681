// Doses along a line, and two doses compared, over HTTP.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, realData, startDaemon } from './daemon.mjs';

const head = realData && join(realData, 'sera-head');
const skip = head && existsSync(head) ? false : 'no real plans on this machine';
let daemon, api;

before(async () => {
  daemon = await startDaemon({ plans: skip ? [demo] : [demo, head] });
  api = `${daemon.url}/api/v1`;
  await openPlan(daemon.url, 'phantom');
});
after(() => daemon?.stop());

const makeRoom = async (of, scene) => {
  const room = (await call(`${api}/rooms`, 'POST', { plan: of })).json.id;
  if (scene) assert.equal((await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' })).status, 200);
  return room;
};
const profileOf = async (of, room, query) => {
  const answer = await call(`${api}/plans/${of}/profile?room=${room}&${query}`);
  assert.equal(answer.status, 200, answer.text);
  return answer.json;
};
const near = (value, expected, share, what) =>
  assert.ok(Math.abs(value - expected) <= share * Math.abs(expected) + 1e-12, `${what}: ${value}, expected ${expected}`);

test('the curves of a beam are the read-outs at its points, and weighted components add up to the weighted dose', async () => {
  const room = await makeRoom('phantom', { dose: { quantity: 'weighted' } });
  const {
    json: { beams },
  } = await call(`${api}/plans/phantom`);
  const profile = await profileOf('phantom', room, `beam=${beams[0].id}&samples=41`);
  assert.equal(profile.depths_mm.length, 41);
  assert.equal(profile.curves[0].quantity, 'weighted');
  const parts = profile.curves.filter(({ physical }) => physical);
  assert.ok(parts.length >= 2);
  let n = 0;
  for (const at of [3, 12, 20, 27, 33]) {
    const [x, y, z] = profile.from_lps_mm.map((mm, axis) => mm + profile.depths_mm[at] * profile.direction[axis]);
    const { json: probe } = await call(`${api}/plans/phantom/dose/probe?room=${room}&x=${x}&y=${y}&z=${z}`);
    assert.equal(probe.value === null, profile.curves[0].values[at] === null);
    if (probe.value === null) continue;
    n++;
    near(profile.curves[0].values[at], probe.value, 1e-6, 'weighted');
    near(
      parts.reduce((sum, { values }) => sum + values[at], 0),
      probe.value,
      1e-6,
      'sum',
    );
    const band = profile.bands.find(({ from_mm: from, to_mm: to }) => profile.depths_mm[at] > from && profile.depths_mm[at] < to);
    assert.equal(band?.region, probe.regions[0]);
  }
  assert.ok(n >= 2, `${n} depths have a value`);
  const finite = profile.curves[0].values.filter((value) => value !== null);
  assert.equal(profile.peak.value, Math.max(...finite));
  assert.equal(profile.entry_mm, profile.bands[0].from_mm);
});

test('a line between two points begins at the first, and wrong lines are refused', async () => {
  const room = await makeRoom('phantom');
  const profile = await profileOf('phantom', room, 'from=-20,0,0&to=20,0,0&samples=5');
  assert.deepEqual(profile.depths_mm, [0, 10, 20, 30, 40]);
  assert.deepEqual(profile.direction, [1, 0, 0]);
  const status = async (query) => (await call(`${api}/plans/phantom/profile?room=${room}&${query}`)).status;
  assert.deepEqual(
    [
      await status('beam=none'),
      await status('from=1,2'),
      await status('from=1,2,3'),
      await status('from=1,2,3&to=1,2,3'),
      await status(''),
    ],
    [404, 422, 422, 422, 422],
  );
});

test("the head's advantage depth lies beyond the peak, as those of published epithermal beams do", { skip }, async () => {
  await openPlan(daemon.url, 'sera-head');
  const {
    json: { beams },
  } = await call(`${api}/plans/sera-head`);
  const room = await makeRoom('sera-head');
  const profile = await profileOf('sera-head', room, `beam=${beams[0].id}`);
  assert.ok(profile.bands.some(({ region }) => region === 'brain'));
  const { from_entry_mm: depth, normal_high: high, target } = profile.advantage;
  assert.equal(target, 'tumor');
  assert.ok(high > 0 && depth > profile.peak.from_entry_mm);
  assert.ok(depth > 60 && depth < 110, `${depth} mm; FiR 1: 81 to 90 mm at tumour boron 3.5 times that of blood`);
});

test('a dose agrees with itself, and what there is to compare is said', async () => {
  const room = await makeRoom('phantom');
  const gammaOf = async () => (await call(`${api}/plans/phantom/gamma?room=${room}`)).json;
  const none = await gammaOf();
  assert.equal(none.pass_percent, null);
  assert.match(none.comparison_reason, /no second dose/);
  const {
    json: { doses },
  } = await call(`${api}/plans/phantom`);
  const patch = { dose: { id: doses[0].id, compare: { id: doses[0].id, dose_percent: 3, distance_mm: 2, normalization: 'local' } } };
  assert.equal((await call(`${api}/rooms/${room}/scene`, 'PATCH', patch, { 'If-Match': '*' })).status, 200);
  const same = await gammaOf();
  assert.equal(same.comparison_reason, null);
  assert.equal(same.pass_percent, 100);
  assert.ok(same.voxels > 0 && same.max < 1e-6 && same.difference.root_mean_square < 1e-6);
  assert.equal(
    same.histogram.counts.reduce((sum, count) => sum + count, 0),
    same.voxels,
  );
  assert.match(same.method, /local: 3 % of the first dose at the voxel, 2 mm/);
});
