// The surface of an isodose level: its figures, and as a file whose points have the level's dose.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, startDaemon } from './daemon.mjs';

let daemon, api, room, level;

before(async () => {
  daemon = await startDaemon({ plans: [demo] });
  api = `${daemon.url}/api/v1`;
  await openPlan(daemon.url, 'phantom');
  room = (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const scene = { dose: { quantity: 'gamma', levels: { half: { value: 50 }, high: { value: 90 } } } };
  const answer = await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' });
  assert.equal(answer.status, 200, answer.text);
  level = (id, more = '') => call(`${api}/plans/phantom/dose/levels/${id}/surface?room=${room}${more}`);
});
after(() => daemon?.stop());

/** The bytes of a file, which call() would read as text. */
const file = async (format) => {
  const answer = await fetch(`${api}/plans/phantom/dose/levels/half/surface?room=${room}&format=${format}`);
  assert.equal(answer.status, 200);
  return { headers: answer.headers, bytes: new DataView(await answer.arrayBuffer()) };
};

test('the figures of a level: its value, what it encloses, and how many triangles that takes', async () => {
  const half = (await level('half')).json,
    high = (await level('high')).json;
  assert.ok(Math.abs(half.value - half.reference.value / 2) < 1e-9 * half.value);
  assert.ok(Math.abs(high.value - 1.8 * half.value) < 1e-9 * half.value);
  assert.deepEqual([half.level, half.grid, half.level_reason], ['half', 'dose', null]);
  assert.ok(half.triangles > 100 && half.vertices > 50 && half.area_mm2 > 0);
  assert.ok(high.area_mm2 > 0 && high.area_mm2 < half.area_mm2);
  // of all bodies of one area the ball has the largest volume
  assert.ok(high.volume_mm3 > 0 && 36 * Math.PI * high.volume_mm3 ** 2 <= high.area_mm2 ** 3);
  assert.equal(half.volume_mm3, null); // cut by the end of the dose's grid
});

test('each point of the file has the dose of the level', async () => {
  const { value, triangles } = (await level('half')).json;
  const { bytes, headers } = await file('stl');
  assert.equal(headers.get('content-type'), 'model/stl');
  assert.equal(headers.get('content-disposition'), 'attachment; filename="phantom-half.stl"');
  assert.equal(bytes.getUint32(80, true), triangles);
  assert.equal(bytes.byteLength, 84 + 50 * triangles);
  for (let triangle = 0; triangle < triangles; triangle += Math.ceil(triangles / 40)) {
    const [x, y, z] = [0, 4, 8].map((at) => bytes.getFloat32(84 + 50 * triangle + 12 + at, true));
    const probe = (await call(`${api}/plans/phantom/dose/probe?room=${room}&x=${x}&y=${y}&z=${z}`)).json;
    // points lie on edges between voxels, where both interpolate alike; coordinates are floats
    assert.ok(Math.abs(probe.value - value) < 1e-4 * value, `${probe.value} at ${[x, y, z]}, expected ${value}`);
  }
  const glb = await file('glb');
  assert.equal(glb.headers.get('content-type'), 'model/gltf-binary');
  assert.equal(glb.bytes.getUint32(0, true), 0x46546c67); // "glTF"
  assert.equal((await file('ply')).headers.get('content-type'), 'application/octet-stream');
});

test('a level that is not there, a format that is not known, and a level beyond the dose', async () => {
  assert.equal((await level('none')).status, 404);
  const wrong = await level('half', '&format=obj');
  assert.deepEqual([wrong.status, wrong.json.errors?.[0]?.pointer ?? wrong.json.pointer], [422, '/format'], wrong.text);
  await call(`${api}/rooms/${room}/scene`, 'PATCH', { dose: { levels: { above: { value: 200 } } } }, { 'If-Match': '*' });
  const above = await level('above');
  assert.equal(above.status, 200, above.text);
  assert.deepEqual([above.json.triangles, above.json.area_mm2], [0, 0]);
});
