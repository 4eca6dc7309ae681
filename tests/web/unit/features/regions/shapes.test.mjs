// How the page asks for the figures of shapes, and what it makes of them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { csvText } = await load('parts/csv.js');
const { figureRows, methods, representations } = await load('features/regions/representations.js');
const { isExportable, shapeQuery, volumeDifference } = await load('features/regions/shapes.js');
const { Comparison } = await load('features/regions/comparison.js');
const { Refusals, inQuestion } = await load('features/regions/refusals.js');
const { nameSome } = await load('parts/format.js');
const { signal } = await load('../lib/signals-core.js');

const scene = {
  surface: { algorithm: 'eight-cell' },
  outline: { method: 'marching-squares' },
  points: { inner_boundary: true },
  nurbs: { order: 3, sampling: 'degree-bins', bins: 24 },
};

test('a shape is asked for with what decides it in this scene, and nothing else', () => {
  assert.deepEqual(shapeQuery(scene, 'surface'), { representation: 'surface', algorithm: 'eight-cell' });
  assert.deepEqual(shapeQuery(scene, 'outline'), { representation: 'outline', outline: 'marching-squares' });
  assert.deepEqual(shapeQuery(scene, 'solid'), { representation: 'solid', inner_boundary: 'true' });
  assert.deepEqual(shapeQuery(scene, 'nurbs'), { representation: 'nurbs', order: '3', sampling: 'degree-bins', bins: '24' });
  assert.deepEqual(shapeQuery(scene, 'univels'), { representation: 'univels' });
});

test('every way of showing a region is compared, under a name of its own', () => {
  const all = methods(scene);
  assert.equal(new Set(all.map(({ name }) => name)).size, all.length);
  assert.deepEqual(new Set(all.map(({ query }) => query.representation)), new Set(representations.map(([word]) => word)));
  assert.deepEqual(representations.map(([word]) => word).filter(isExportable), ['surface', 'univels', 'nurbs', 'fan']);
});

test('the difference to the univels is in per cent of theirs', () => {
  assert.equal(volumeDifference({ volume_mm3: 990, univel_volume_mm3: 1000 }), -1);
  assert.ok(Number.isNaN(volumeDifference({ volume_mm3: null, univel_volume_mm3: 1000 })));
});

test('the table for a spreadsheet keeps a name with a comma in one cell, and a refusal as its reason', () => {
  const [head, one, two] = csvText(
    figureRows([
      { region: 'brain', name: 'Surface, smooth', result: { triangles: 12, ms: 3.5, area_mm2: null } },
      { region: 'brain', name: 'Fan', error: 'too "many" points' },
    ]),
  ).split('\r\n');
  assert.equal(head.split(',').length, 15);
  assert.match(one, /^brain,"Surface, smooth",12,,,,3\.5,/);
  assert.match(two, /^brain,Fan,,{11},"too ""many"" points"$/);
});

test('a comparison fills row by row; a newer one drops what the older still waits for', async () => {
  const waiting = [];
  const api = {
    surface: (plan, region, query, aborted) =>
      new Promise((done, fail) => {
        waiting.push({ region, query, done, fail });
        aborted.addEventListener('abort', () => fail(new Error('aborted')));
      }),
  };
  const comparison = new Comparison(api, signal([]));
  const old = comparison.start('plan', { id: 'brain' }, scene);
  assert.equal(waiting.length, 1, 'one question at a time');
  assert.equal(waiting[0].query.frames, '5');
  waiting[0].done({ triangles: 7 });
  await new Promise((done) => {
    setTimeout(done);
  });
  assert.deepEqual(comparison.rows.value[0].result, { triangles: 7 });
  const next = comparison.start('plan', { id: 'tumor' }, scene);
  await old;
  assert.ok(comparison.rows.value.every((row) => row.region === 'tumor' && !row.result));
  comparison.stop();
  await next;
  assert.ok(comparison.rows.value.every((row) => !row.result));
});

test('a dose says its unit, what it is per and what it holds; a beam says where it comes from', async () => {
  const { beamWords, doseWords, frameWords } = await load('room/plan.js');
  assert.equal(
    doseWords({ unit: 'Gy', per: 'per fraction', components: [{ quantity: 'boron', per_ppm: true }, { quantity: 'gamma' }] }),
    'Gy per fraction, boron per ppm, gamma',
  );
  assert.equal(doseWords({ unit: '', per: '', components: [] }), 'no unit');
  assert.equal(
    doseWords({
      unit: 'cGy',
      per: '',
      components: [
        { quantity: 'total', per_ppm: false, boron_ppm: 1 },
        { quantity: 'total', per_ppm: false, boron_ppm: null },
      ],
    }),
    'cGy, total with boron at 1 ppm, total',
  );
  assert.match(frameWords({ frame_of_reference: 'differs' }), /another frame of reference/);
  assert.match(frameWords({ frame_of_reference: 'unknown' }), /Nothing says/);
  assert.deepEqual([frameWords({ frame_of_reference: 'same' }), frameWords({ frame_of_reference: null })], ['', '']);
  assert.equal(beamWords({ aperture_mm: 120, delivery: null }), 'aperture 120 mm');
  assert.equal(
    beamWords({ aperture_mm: null, delivery: { radiation: 'NEUTRON', gantry_deg: 90, gantry_stop_deg: 150 } }),
    'neutron, gantry 90° to 150°',
  );
});

// ---- what is missing from the picture ---------------------------------------------------------------------------------------

const style = (representation, change = {}) => ({ visible: true, opacity: 1, representation, ...change });

test('only visible regions shown as splines are in question', () => {
  const plan = { regions: ['a', 'b', 'c', 'd', 'e'].map((id) => ({ id, voxels: id === 'e' ? 0 : 9 })) };
  const regions = {
    a: style('nurbs'),
    b: style('surface'),
    c: style('nurbs', { visible: false }),
    d: style('nurbs', { opacity: 0 }),
    e: style('nurbs'),
  };
  assert.deepEqual(
    inQuestion(plan, { ...scene, regions }).map(({ id }) => id),
    ['a'],
  );
  assert.deepEqual(inQuestion(null, null), []);
});

test('a refused region is known with its reason, each is asked for once, and who is busy has refused nothing', async () => {
  const asked = [];
  const api = {
    surface: async (plan, region) => {
      asked.push(region);
      if (region === 'hollow') throw Object.assign(new Error('hollow'), { status: 422 });
      if (region === 'late') throw Object.assign(new Error('busy'), { status: 503 });
      return {};
    },
  };
  const refusals = new Refusals(api, signal({}));
  const questions = ['round', 'hollow', 'late'].map((id) => ({ id, query: { bins: '36' } }));
  await refusals.ask('p', questions);
  assert.deepEqual(refusals.reasons.value, { hollow: 'hollow' });
  await refusals.ask('p', questions);
  assert.deepEqual(asked, ['round', 'hollow', 'late', 'late']);
  await refusals.ask('p', questions.slice(0, 1));
  assert.deepEqual(refusals.reasons.value, {}, 'only of what is shown');
});

test('a few names are named, many counted', () => {
  assert.equal(nameSome(['liver']), 'liver');
  assert.equal(nameSome(['liver', 'colon', 'aorta']), 'liver, colon and aorta');
  assert.equal(nameSome(['liver', 'colon', 'aorta', 'rib']), 'liver, colon and 2 more');
});
