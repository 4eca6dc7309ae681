// The dose that a scene shows: its numbers, its acceptance, and eight members who watch while the boron concentration changes.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, realData, startDaemon } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const head = realData && join(realData, 'sera-head');
const skip = head && existsSync(head) ? false : 'no real plans on this machine';
let daemon, api;

before(async () => {
  daemon = await startDaemon({ plans: skip ? [demo] : [demo, head] });
  api = `${daemon.url}/api/v1`;
  await openPlan(daemon.url, 'phantom');
});
after(() => daemon?.stop());

const makeRoom = async (plan, scene) => {
  const room = (await call(`${api}/rooms`, 'POST', { plan })).json.id;
  if (scene) await patch(room, scene);
  return room;
};
const patch = async (room, scene) => {
  const answer = await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' });
  assert.equal(answer.status, 200, answer.text);
  return answer.json;
};
const probe = async (plan, room, [x, y, z]) => (await call(`${api}/plans/${plan}/dose/probe?room=${room}&x=${x}&y=${y}&z=${z}`)).json;
const near = (value, expected, share, what) =>
  assert.ok(Math.abs(value - expected) <= share * Math.abs(expected), `${what}: ${value}, expected ${expected}`);

/** Sum of the components with the weights that the answer states. */
function summed({ components, weights }) {
  const of = (quantity) => components.find((component) => component.quantity === quantity)?.value ?? 0;
  return (
    weights.cbe * of('boron') +
    weights.nitrogen * of('nitrogen') +
    weights.fast * of('fast') +
    weights.gamma * of('gamma') +
    weights.other * of('other')
  );
}

test('a weighted total is the sum of its weighted components, and boron follows the concentration in blood', async () => {
  const room = await makeRoom('phantom');
  const plan = (await call(`${api}/plans/phantom`)).json;
  const point = plan.regions.find((region) => region.is_target)?.center_mm ?? plan.regions.at(-1).center_mm;
  const boron = [];
  for (const ppm of [0, 10, 25]) {
    await patch(room, { dose: { quantity: 'weighted', blood_ppm: ppm } });
    const answer = await probe('phantom', room, point);
    assert.equal(answer.value_reason, null);
    assert.ok(answer.unit.endsWith('(w)'));
    assert.equal(answer.blood_ppm, ppm);
    near(answer.value, summed(answer), 1e-6, `${ppm} ppm`);
    boron.push(answer.components.find(({ quantity }) => quantity === 'boron').value);
  }
  assert.equal(boron[0], 0);
  near(boron[2], 2.5 * boron[1], 1e-6, 'boron');
});

test('where there is no value the answer says why, and never zero', async () => {
  const room = await makeRoom('phantom', { dose: { quantity: 'weighted' } });
  const far = await probe('phantom', room, [5000, 0, 0]);
  assert.deepEqual([far.value, far.percent, far.value_reason], [null, null, 'outside the dose grid']);
  assert.ok(far.components.every(({ value, reason }) => value === null && reason === 'outside the dose grid'));
  await patch(room, { dose: { quantity: 'weighted-total' } });
  const answer = (await call(`${api}/plans/phantom/dose?room=${room}`)).json;
  assert.equal(answer.drawn, false);
  assert.match(answer.reason, /has no weighted-total/);
});

test('levels are parts of the reference that the scene names', async () => {
  const room = await makeRoom('phantom', {
    dose: {
      quantity: 'weighted',
      reference: { kind: 'value', value: 12.5 },
      levels: { 'level-1': { value: 90, unit: 'percent' }, 'level-2': { value: 5, unit: 'dose' } },
    },
  });
  const { reference, levels } = (await call(`${api}/plans/phantom/dose?room=${room}`)).json;
  assert.deepEqual([reference.kind, reference.value, reference.words], ['value', 12.5, 'prescription']);
  assert.deepEqual(
    levels.slice(0, 2).map(({ value, percent }) => [value, percent]),
    [
      [11.25, 90],
      [5, 40],
    ],
  );
});

test('ids that the plan does not have are refused in weights, sums and comparison', async () => {
  const room = await makeRoom('phantom');
  for (const dose of [
    { weights: { nobody: {} } },
    { sum: { nobody: {} } },
    { compare: { id: 'nobody' } },
    { tissue: 'nobody' },
    { reference: { region: 'nobody' } },
    { coverage: { region: 'nobody' } },
  ]) {
    const answer = await call(`${api}/rooms/${room}/scene`, 'PATCH', { dose }, { 'If-Match': '*' });
    assert.equal(answer.status, 422, JSON.stringify(dose));
    assert.match(answer.text, /unknown-id/);
  }
});

/* Each member's frames carry revisions that never fall; after the last change all have the same still, which is also what one who
   comes later sees. */
test('eight members watch while the boron concentration changes: each picture is of its revision, the last one is the same for all', {
  timeout: 60000,
}, async (t) => {
  const room = await makeRoom('phantom', { dose: { quantity: 'weighted', wash: { visible: true, opacity: 0.6 } } });
  const members = [];
  const join_ = async () => {
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    client.send({ type: 'view.open', view: 1, document: { kind: 'axial', size_px: [512, 384] } });
    return client;
  };
  for (let i = 0; i < 8; i++) members.push(await join_());
  for (const member of members) await member.frame((frame) => frame.isStill, 0, 20000);
  let revision,
    first = [];
  for (let step = 0; step < 12; step++) {
    const since = performance.now();
    const { headers } = await call(`${api}/rooms/${room}/scene`, 'PATCH', { dose: { blood_ppm: 5 + 3 * step } }, { 'If-Match': '*' });
    revision = Number(headers.get('etag').replaceAll('"', ''));
    const frame = await members[0].frame((found) => found.revision >= revision, 0, 20000);
    first.push(frame.at - since);
  }
  t.diagnostic(`first new picture after a change, median ${first.sort((a, b) => a - b)[6].toFixed(1)} ms`);
  const late = await join_();
  const stills = [];
  for (const member of [...members, late])
    stills.push(await member.frame((frame) => frame.isStill && frame.revision === revision, 0, 20000));
  for (const member of members)
    assert.ok(
      member.frames.every((frame, i) => i === 0 || frame.revision >= member.frames[i - 1].revision),
      'revisions do not fall',
    );
  for (const still of stills) assert.ok(Buffer.from(still.picture).equals(Buffer.from(stills[0].picture)), 'one picture');
  for (const member of [...members, late]) member.cut();
});

test("SERA's head: weights of the plan, jumps at a border of tissues, and none where one tissue holds everywhere", { skip }, async () => {
  await openPlan(daemon.url, 'sera-head');
  const room = await makeRoom('sera-head');
  const plan = (await call(`${api}/plans/sera-head`)).json;
  const tumour = plan.regions.find((region) => region.id === 'tumor');
  const own = await probe('sera-head', room, tumour.center_mm);
  assert.deepEqual([own.weighted_by, own.weights.boron_ratio, own.weights.cbe], ['tumor', 3.5, 3.8]);
  near(own.value, summed(own), 1e-5, 'own tissue');
  await patch(room, { dose: { tissue: 'brain' } });
  const brain = await probe('sera-head', room, tumour.center_mm);
  assert.deepEqual([brain.weighted_by, brain.weights.boron_ratio, brain.weights.cbe], ['brain', 1, 1.3]);
  near(brain.value, summed(brain), 1e-5, 'as brain');
  assert.ok(own.value > 2 * brain.value);
});

/* The raw probe is held to independent readers elsewhere; the read-out of a scene's dose has to agree with it, weights aside. */
test("read-outs of a scene are the files' values at points between voxels, to float precision", { skip, timeout: 120000 }, async () => {
  for (const [id, folder] of [
    ['sera-head', head],
    ['eclipse-ent-dose', null],
    ['openkbp-pt99', null],
    ['dicomrt-oncentra-phantom', null],
  ]) {
    if (!folder && !existsSync(join(realData, id))) continue;
    const own = folder ? daemon : await startDaemon({ plans: [join(realData, id)] });
    try {
      await openPlan(own.url, id);
      const url = `${own.url}/api/v1/plans/${id}`,
        plan = (await call(url)).json;
      const [low, high] = ['low', 'high'].map((end) => plan.doses[0].components[0].grid.bounds_mm[end]);
      let n = 0;
      for (let i = 1; i <= 24; i++) {
        const at = low.map((value, axis) => value + (high[axis] - value) * ((i * [0.137, 0.311, 0.533][axis]) % 1));
        const query = `x=${at[0]}&y=${at[1]}&z=${at[2]}`;
        const raw = (await call(`${url}/probe?${query}`)).json.doses,
          shown = (await call(`${url}/dose/probe?${query}`)).json;
        for (const { quantity, value, weighted, boron_ppm: ppm } of shown.components) {
          const files = shown.parts.map((part) => raw.find((row) => row.id === part.id && row.quantity === quantity));
          if (value === null) continue;
          const expected = files.reduce((sum, file) => sum + (file.per_ppm ? file.value * ppm : file.value), 0);
          assert.ok(
            Math.abs(value - expected) <= 4e-7 * Math.abs(expected) + 1e-30,
            `${id} ${quantity} at ${at}: ${value}, expected ${expected}`,
          );
          assert.ok(weighted === null || shown.weights);
          n++;
        }
      }
      assert.ok(n >= 4, `${id}: ${n} values`);
    } finally {
      if (own !== daemon) await own.stop();
    }
  }
});
