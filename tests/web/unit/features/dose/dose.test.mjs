// The page's side of dose: what can be shown, units, what is missing, levels in both units, weights by name, pins and their file.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { basisWords, choosePatch, dependsOnBlood, missingOf, missingWords, quantitiesOf, toggledPatch, unitOf } = await load('room/dose.js');
const { addedLevel, convertedLevel, doseOf, levelsOf, percentOf } = await load('features/dose/level_list.js');
const { levelTables, tableOf, tablePatch } = await load('features/dose/dose_tables.js');
const { choosePresetPatch, editPatch, isEdited, presetOf, presetsFor, tissueFor, weightPresets, weightsOf } =
  await load('features/dose/weight_table.js');
const { referenceText } = await load('features/dose/dose_reference.js');
const { pinnedAt } = await load('features/dose/pins.js');
const { planPatch } = await load('features/patient/plan_choice.js');
const { mergePatch } = await load('wire/merge.js');

const part = (quantity, more = {}) => ({ quantity, unit: 'Gy', per_ppm: false, boron_ppm: null, ...more });
const full = {
  id: 'mc',
  name: '',
  unit: 'Gy',
  per: '250 kW-min',
  fit: 'same',
  components: [part('boron', { per_ppm: true }), part('nitrogen'), part('fast'), part('gamma'), part('thermal-fluence', { unit: '1/cm2' })],
};
const total = {
  id: 'plan',
  name: 'Plan',
  unit: 'cGy',
  per: 'fraction',
  fit: 'differs',
  fit_reason: 'Another frame.',
  components: [part('total', { unit: 'cGy' })],
};
const two = { id: 'two', name: '', unit: 'Gy', per: '', fit: 'apart', components: [part('boron', { per_ppm: true }), part('gamma')] };
const regions = [
  { id: 'scalp', name: 'scalp', parent: null, voxels: 9 },
  { id: 'brain', name: 'Brain_L', parent: 'scalp', voxels: 5 },
  { id: 'ptv', name: 'PTV56', parent: 'brain', voxels: 2, is_target: true },
  { id: 'bone', name: 'mandible', parent: null, voxels: 2 },
];
const plan = { doses: [full, total, two], regions };
const level = (value, unit = 'percent', color = '#ff0000') => ({
  value,
  unit,
  color,
  visible: true,
  line: true,
  wash: true,
  surface: false,
  opacity: 0.4,
});
const dose = (more = {}) => ({
  dose: {
    id: 'mc',
    quantity: 'weighted',
    factor: 1,
    sum: {},
    tissue: '',
    blood_ppm: 15,
    weights: {},
    weights_name: '',
    levels: {},
    lines: { visible: false },
    wash: { visible: false },
    surfaces: { visible: false },
    coverage: { visible: false },
    compare: { mode: 'none' },
    reference: { kind: 'body', region: '' },
    ...more,
  },
});

test('sums are offered only where there is something to sum, in Gy(w) only where weights are in', () => {
  assert.deepEqual(quantitiesOf(full), ['weighted', 'total', 'boron', 'nitrogen', 'fast', 'gamma', 'isoeffective', 'thermal-fluence']);
  assert.deepEqual(quantitiesOf(total), ['total']);
  assert.equal(unitOf(full, 'weighted'), 'Gy(w)');
  assert.equal(unitOf(full, 'thermal-fluence'), '1/cm²');
  assert.equal(unitOf(total, 'total'), 'cGy');
  assert.equal(dependsOnBlood(full, 'weighted'), true);
  assert.equal(dependsOnBlood(full, 'gamma'), false);
  assert.equal(dependsOnBlood(total, 'total'), false);
});

test('the value of what was 100 % before never stands beside what is 100 % now', () => {
  const scene = dose({ reference: { kind: 'region-max', region: 'brain' } });
  const words = (isOld, value) =>
    referenceText({
      room: { plan: { value: plan }, scene: { value: scene } },
      doses: { scale: { value: { isOld } }, reference: { value } },
    });
  assert.match(words(false, 16.2), / max, 16\.2 Gy\(w\)$/);
  assert.match(words(true, 16.2), / max$/);
  assert.match(words(false, null), / max$/);
});

test('what a total lacks is said', () => {
  assert.equal(missingWords(missingOf(two, 'weighted')), 'without nitrogen, fast neutron');
  assert.equal(missingWords(missingOf(full, 'weighted')), '');
  assert.equal(missingWords(missingOf(total, 'total')), '');
});

test('the basis names unit, per what, blood, weights and tissue', () => {
  assert.equal(
    basisWords(plan, dose({ weights_name: 'BPA example', tissue: 'brain' })),
    'Gy(w) per 250 kW-min · blood 15 ppm · weights: BPA example · isodose as Brain_L',
  );
  assert.equal(basisWords(plan, dose({ id: 'plan', quantity: 'total', factor: 30 })), 'cGy for 30 × fraction · physical total');
  assert.match(basisWords(plan, dose({ id: 'two' })), /weights: edited · without nitrogen, fast neutron$/);
});

test('a dose of one beam says so, and so does the sum of those of all beams; one of them that is chosen stands alone', () => {
  const beamDose = (n) => ({
    id: `b${n}`,
    name: `B${n}`,
    unit: 'Gy',
    per: 'beam',
    beam: n,
    plan: 0,
    fit: 'same',
    components: [part('total')],
  });
  const doses = [beamDose(1), beamDose(2), beamDose(3)];
  const ofBeams = { doses, regions, treatmentPlans: [{ label: 'P', beams: 3, beam_doses: ['b1', 'b2', 'b3'] }] };
  const scene = (id, sum, more = {}) =>
    dose({ id, quantity: 'total', sum: Object.fromEntries(sum.map((other) => [other, { factor: 1 }])), ...more });
  const all = scene('b1', ['b2', 'b3']);
  assert.equal(basisWords(ofBeams, all), 'Gy · physical total · sum of the doses of 3 beams');
  assert.equal(basisWords(ofBeams, scene('b2', [])), 'Gy · physical total · dose of beam 2 of 3');
  assert.equal(basisWords(ofBeams, scene('b1', ['b2'])), 'Gy per beam · physical total · sum of 2 doses');
  assert.equal(basisWords(ofBeams, scene('b1', ['b2', 'b3'], { factor: 2 })), 'Gy for 2 × beam · physical total · sum of 3 doses');
  assert.deepEqual(choosePatch(ofBeams, all, doses[1]).dose, { id: 'b2', quantity: 'total', sum: { b2: null, b3: null } });
  assert.deepEqual(choosePatch(ofBeams, all, doses[0]).dose, { id: 'b1', quantity: 'total' });
  assert.deepEqual(choosePatch(ofBeams, scene('b1', ['b2']), doses[2]).dose, { id: 'b3', quantity: 'total' });
});

test('a treatment plan whose beams have doses is shown by their sum, each once, whatever the dose before was multiplied by', () => {
  const of = (id, n, more = {}) => ({ id, name: id, unit: 'Gy', per: 'beam', plan: n, fit: 'same', components: [part('total')], ...more });
  const doses = [of('whole', 0, { per: 'fraction' }), of('b1', 1), of('b2', 1), of('b3', 1)];
  const treatmentPlans = [
    { label: 'A', structs: null, beams: 1, beam_doses: [] },
    { label: 'B', structs: null, beams: 3, beam_doses: ['b1', 'b2', 'b3'] },
  ];
  const both = { doses, regions: [], beams: [], treatmentPlans };
  const [from, to] = treatmentPlans;
  const compare = { mode: 'none' };
  for (const factor of [1, 30]) {
    const before = dose({ id: 'whole', quantity: 'total', factor, reference: { kind: 'body', region: '', value: 0 }, compare });
    const after = mergePatch(before, planPatch(both, before, from, to));
    assert.deepEqual([after.dose.id, after.dose.factor, after.dose.sum], ['b1', 1, { b2: { factor: 1 }, b3: { factor: 1 } }]);
    assert.equal(basisWords(both, after), 'Gy · physical total · sum of the doses of 3 beams');
  }
});

test('another dose is shown with a quantity that it has, and is no longer added to itself', () => {
  assert.deepEqual(choosePatch(plan, dose({ id: 'two', sum: { mc: { factor: 2 } } }), full), {
    dose: { id: 'mc', quantity: 'weighted', sum: { mc: null } },
  });
  const on = toggledPatch(plan, dose(), full, true).dose;
  assert.deepEqual([on.lines.visible, on.wash.visible], [true, true]);
  const off = toggledPatch(plan, dose({ lines: { visible: true } }), full, true).dose;
  assert.deepEqual([off.lines.visible, off.wash.visible, off.surfaces.visible], [false, false, false]);
});

test('what stands in a unit of dose keeps its worth when a dose in another unit is shown', () => {
  const scene = {
    ...dose({
      levels: { a: level(30, 'dose'), b: level(90) },
      coverage: { unit: 'dose', low: 20, high: null },
      reference: { kind: 'value', value: 13.5 },
    }),
    constraints: {
      mean: { quantity: 'total', metric: 'mean', limit: 3 },
      v: { quantity: 'total', metric: 'V12.5cc', limit: 7 },
      fluence: { quantity: 'fast-fluence', metric: 'max', limit: 5 },
    },
  };
  const shown = mergePatch(scene, choosePatch(plan, scene, total));
  assert.deepEqual([shown.dose.id, shown.dose.levels.a.value, shown.dose.levels.b.value], ['plan', 3000, 90], '30 Gy are 3000 cGy');
  assert.deepEqual([shown.dose.coverage.low, shown.dose.coverage.high, shown.dose.reference.value], [2000, null, 1350]);
  assert.deepEqual(
    Object.values(shown.constraints).map(({ metric, limit }) => [metric, limit]),
    [
      ['mean', 300],
      ['V1250cc', 7],
      ['max', 5],
    ],
  );
  assert.deepEqual(mergePatch(shown, choosePatch(plan, shown, full)).dose.levels.a.value, 30, 'and back');
  assert.deepEqual(Object.keys(choosePatch(plan, scene, two)), ['dose'], 'nothing is written where the unit stays');
});

test('a level has a value in both units, and keeps its dose when its unit changes', () => {
  assert.equal(doseOf(level(90), 1.2), 1.08);
  assert.ok(Math.abs(percentOf(level(1.08, 'dose'), 1.2) - 90) < 1e-9);
  assert.equal(Number.isNaN(doseOf(level(90), null)), true);
  assert.deepEqual(convertedLevel(level(50), 'dose', 3), { unit: 'dose', value: 1.5 });
  assert.equal(convertedLevel(level(50), 'dose', null), null);
});

test('levels stand highest first, and one is added below the lowest', () => {
  const scene = dose({ levels: { a: level(50), b: level(2, 'dose'), 'level-1': level(90) } });
  assert.deepEqual(
    levelsOf(scene, 2.5).map(({ id }) => id),
    ['level-1', 'b', 'a'],
  ); // 2 of 2.5 is 80 %
  const { id, patch } = addedLevel(scene, 2.5);
  assert.equal(id, 'level-2');
  assert.equal(patch.dose.levels[id].value, 40);
});

test('a table replaces all levels, and keeps switches where the value stays', () => {
  const scene = dose({ levels: { 'level-1': { ...level(95), surface: true }, odd: level(33) } });
  const table = levelTables.find(({ name }) => name === 'Thesis');
  const after = mergePatch(scene, tablePatch(scene, table));
  assert.deepEqual(
    levelsOf(after).map(({ value, color }) => [value, color]),
    [
      [95, '#ff0000'],
      [90, '#00ff00'],
      [80, '#0000ff'],
      [70, '#ffff00'],
      [60, '#ff00ff'],
      [50, '#00ffff'],
    ],
  ); // thesis
  assert.equal(levelsOf(after)[0].surface, true);
  assert.equal(tableOf(after).name, 'Thesis');
  assert.equal(tableOf(scene), null);
});

const bpa = weightPresets[0];

test('a region gets the row of a preset by the words of its name, a target that of tumour', () => {
  const tissue = (name, more) => tissueFor(bpa, { name, ...more }).tissue;
  assert.equal(tissue('Brain stem'), 'brain');
  assert.equal(tissue('LeftParotid'), 'other');
  assert.equal(tissue('skin_5mm'), 'skin');
  assert.equal(tissue('GTV1'), 'tumour');
  assert.equal(tissue('boost', { is_target: true }), 'tumour');
  assert.equal(tissue('ribbon'), 'other'); // "brain" begins no word of it
});

test('the first preset has the numbers of Barth et al. 2005, table 1', () => {
  const {
    dose: { weights, weights_name: name },
  } = choosePresetPatch(plan, dose(), bpa);
  const row = ({ boron_ratio: ratio, cbe, nitrogen, fast, gamma }) => [ratio, cbe, nitrogen, fast, gamma];
  assert.deepEqual(row(weights.ptv), [3.5, 3.8, 3.2, 3.2, 1]);
  assert.deepEqual(row(weights.brain), [1, 1.3, 3.2, 3.2, 1]);
  assert.deepEqual(row(weights.scalp), [1.5, 2.5, 3.2, 3.2, 1]);
  assert.equal(name, bpa.name);
});

test('an edited number is marked, can be reset, and leaves other regions alone', () => {
  const scene = mergePatch(dose(), choosePresetPatch(plan, dose(), bpa));
  const after = mergePatch(scene, editPatch(plan, scene, regions[2], { cbe: 4 }));
  assert.equal(after.dose.weights.ptv.cbe, 4);
  assert.equal(after.dose.weights.ptv.boron_ratio, 3.5);
  assert.deepEqual(after.dose.weights.brain, scene.dose.weights.brain);
  assert.deepEqual([isEdited(scene), isEdited(after)], [false, true]);
  assert.equal(presetOf(plan, after).name, bpa.name);
  assert.deepEqual(mergePatch(after, choosePresetPatch(plan, after, presetOf(plan, after))), scene);
});

test('a region without weights has those of the region around it', () => {
  const scene = dose({ weights: { scalp: { boron_ratio: 1.5, cbe: 2.5, nitrogen: 1, fast: 1, gamma: 1, other: 1, isoeffective: '' } } });
  assert.equal(weightsOf(plan, scene, regions[2]).from, 'scalp');
  assert.equal(weightsOf(plan, scene, regions[3]), null);
  const { weights } = editPatch(plan, scene, regions[2], { gamma: 2 }).dose;
  assert.deepEqual([weights.ptv.boron_ratio, weights.ptv.gamma], [1.5, 2]);
});

test("weights of the plan's files are a set of their own", () => {
  const own = {
    ...plan,
    regions: regions.map((region) =>
      region.id === 'brain'
        ? { ...region, tissue: { boron_ratio: 1, cbe_boron: 1.3, rbe_nitrogen: 3.2, rbe_fast: null, rbe_gamma: 1 } }
        : region,
    ),
  };
  const [files] = presetsFor(own);
  assert.equal(files.name, "from the plan's files");
  assert.deepEqual(choosePresetPatch(own, dose({ weights: { ptv: {} } }), files).dose.weights, {
    brain: { boron_ratio: 1, cbe: 1.3, nitrogen: 3.2, fast: 1, gamma: 1, other: 1, isoeffective: '' },
    ptv: null,
  });
  assert.equal(presetsFor(plan)[0], bpa);
});

test('a point is pinned once', () => {
  const scene = { probes: { 'pin-1': { at_mm: [1, 2, 3], name: '' } } };
  assert.equal(pinnedAt(scene, [1.01, 2, 3]), null);
  assert.deepEqual(pinnedAt(scene, [1, 2, 4]), { id: 'pin-2', patch: { probes: { 'pin-2': { at_mm: [1, 2, 4], name: '' } } } });
});
