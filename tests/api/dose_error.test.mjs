// The statistical error of a dose, from the plan's files to the read-outs; and doses that are summed.
import assert from 'node:assert/strict';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, realData, startDaemon } from './daemon.mjs';

const oncentra = realData && join(realData, 'dicomrt-oncentra-phantom');
const skip = oncentra && existsSync(oncentra) ? false : 'no real plans on this machine';
const folder = mkdtempSync(join(tmpdir(), 'beamroom-error-'));
let daemon, api;

before(async () => {
  cpSync(join(demo, 'phantom'), join(folder, 'with-errors'), { recursive: true });
  const file = join(folder, 'with-errors/plan.json');
  const plan = JSON.parse(readFileSync(file, 'utf8'));
  // as large as the value for each, but of gamma as large as the nitrogen dose
  for (const component of plan.doses[0].components)
    component.error = component.quantity === 'gamma' ? 'dose/nitrogen.nii.gz' : component.path;
  writeFileSync(file, JSON.stringify(plan));
  daemon = await startDaemon({ plans: skip ? [folder] : [folder, oncentra] });
  api = `${daemon.url}/api/v1`;
});
after(async () => {
  await daemon?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const probeOf = async (plan, room, [x, y, z]) => (await call(`${api}/plans/${plan}/dose/probe?room=${room}&x=${x}&y=${y}&z=${z}`)).json;
const makeRoom = async (plan, scene) => {
  const room = (await call(`${api}/rooms`, 'POST', { plan })).json.id;
  assert.equal((await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' })).status, 200);
  return room;
};
const near = (value, expected, what) =>
  assert.ok(Math.abs(value - expected) <= 1e-5 * Math.abs(expected), `${what}: ${value}, expected ${expected}`);

test('a component has the error of its file, a weighted sum that of independent components', async () => {
  await openPlan(daemon.url, 'with-errors');
  const room = await makeRoom('with-errors', { dose: { quantity: 'weighted' } });
  const probe = await probeOf('with-errors', room, [1, 2, 3]);
  const of = Object.fromEntries(probe.components.map((component) => [component.quantity, component]));
  for (const quantity of ['boron', 'nitrogen', 'fast']) near(of[quantity].error_percent, 100, quantity);
  near(of.gamma.error_percent, (100 * of.nitrogen.value) / of.gamma.value, 'gamma');
  const squares = Object.values(of).reduce((sum, { weighted, error_percent: percent }) => sum + (weighted * percent) ** 2, 0);
  near(probe.error_percent, Math.sqrt(squares) / probe.value, 'weighted');
});

test('without such files there is no error', { skip }, async () => {
  await openPlan(daemon.url, 'dicomrt-oncentra-phantom');
  const room = await makeRoom('dicomrt-oncentra-phantom', {});
  const probe = await probeOf('dicomrt-oncentra-phantom', room, [0.29, 0.59, 0]);
  assert.ok(probe.value > 0);
  assert.equal(probe.error_percent, null);
});

test('beams are summed at a point, each with its factor, and the parts are said', { skip }, async () => {
  const plan = 'dicomrt-oncentra-phantom';
  const { doses } = (await call(`${api}/plans/${plan}`)).json;
  const ids = doses.filter(({ per }) => per === 'beam').map(({ id }) => id);
  assert.equal(ids.length, 3);
  const at = [
    [0.29, 0.59, 0],
    [12, -20, 4],
    [-31, 15, -6],
  ];
  const single = {};
  const none = Object.fromEntries(ids.map((id) => [id, null])); // a new room adds the doses of all beams
  for (const id of ids) {
    const room = await makeRoom(plan, { dose: { id, quantity: 'total', sum: none } });
    single[id] = await Promise.all(at.map(async (point) => (await probeOf(plan, room, point)).value));
  }
  const sum = { [ids[1]]: { factor: 2 }, [ids[2]]: { factor: 0.5 } };
  const room = await makeRoom(plan, { dose: { id: ids[0], quantity: 'total', sum } });
  for (const [i, point] of at.entries()) {
    const probe = await probeOf(plan, room, point);
    near(probe.value, single[ids[0]][i] + 2 * single[ids[1]][i] + 0.5 * single[ids[2]][i], `sum at ${point}`);
    assert.equal(probe.name, 'Sum of 3 doses');
    assert.deepEqual(
      probe.parts.map(({ id, factor, used }) => ({ id, factor, used })),
      [
        { id: ids[0], factor: 1, used: true },
        { id: ids[1], factor: 2, used: true },
        { id: ids[2], factor: 0.5, used: true },
      ],
    );
  }
});
