// The legend of a wash that is none of levels: which it is, its colours, its ends.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { gradientOf, hasLines, shownScale, washKind } = await load('features/dose/dose_scales.js');
const plan = {
  regions: [{}],
  doses: [
    { id: 'a', name: 'Run 1', unit: 'Gy', components: [] },
    { id: 'b', name: '', unit: 'Gy', components: [] },
  ],
};
const compare = {
  id: 'b',
  mode: 'none',
  span_percent: 5,
  dose_percent: 3,
  distance_mm: 2.5,
  threshold_percent: 10,
  normalization: 'global',
};
const sceneOf = (more = {}, dose = {}) => ({
  dose: {
    id: 'a',
    quantity: 'total',
    wash: { visible: true },
    lines: { visible: false },
    error: false,
    ...dose,
    compare: { ...compare, ...more },
  },
});
const digits = (value) => value.toFixed(2);

test('a comparison takes the place of the levels, and the error of theirs, as in the picture', () => {
  const kinds = [
    [{}, {}],
    [{}, { error: true }],
    [{ mode: 'difference' }, { error: true }],
    [{ mode: 'gamma' }, {}],
    [{ mode: 'gamma' }, { wash: { visible: false } }],
    [{ mode: 'lines' }, {}],
    [{}, { error: true, wash: { visible: false } }],
    [{ mode: 'gamma', id: 'gone' }, {}],
  ];
  assert.deepEqual(
    kinds.map(([more, dose]) => washKind(plan, sceneOf(more, dose))),
    ['levels', 'error', 'difference', 'gamma', 'gamma', 'levels', '', 'levels'],
  );
  assert.deepEqual(
    ['none', 'lines', 'difference', 'gamma'].map((mode) => hasLines(plan, sceneOf({ mode }))),
    [false, true, true, false],
  );
});

test('a legend has its ends in the unit, criteria and domain, and follows the mode', () => {
  assert.equal(shownScale(plan, sceneOf(), 40, digits), null);
  assert.deepEqual(shownScale(plan, sceneOf({ mode: 'difference' }), 40, digits), {
    kind: 'difference',
    title: 'b − Run 1, Gy',
    ends: ['≤ −2.00', '0', '≥ +2.00'],
    about: 'to ±5 %, in the body, from 10 %',
    more: 'b less Run 1, in the body where Run 1 has at least 10 % of the reference, where both have a dose; strongest colours from ±5 % of the reference on',
  });
  assert.deepEqual(shownScale(plan, sceneOf({ mode: 'difference' }), null, digits).ends, ['≤ −5 %', '0', '≥ +5 %']);
  const gamma = shownScale(plan, sceneOf({ mode: 'gamma', normalization: 'local' }), 40, digits);
  assert.deepEqual([gamma.ends, gamma.about], [['0', '1 passes up to here', '≥ 2'], '3 % of the point, 2.5 mm, in the body, from 10 %']);
  for (const [of, more] of [
    [{ ...plan, regions: [] }, {}],
    [plan, { domain: 'grid' }],
  ])
    assert.equal(shownScale(of, sceneOf({ mode: 'difference', ...more }), 40, digits).about, 'to ±5 %, from 10 %');
  assert.equal(shownScale(plan, sceneOf({}, { error: true }), 40, digits).kind, 'error');
});

test('its colours are those of the picture: from end to end, with a jump where an index of 1 passes', () => {
  assert.equal(gradientOf('difference'), 'linear-gradient(90deg, #2166acff 0%, #f7f7f71a 50%, #b35806ff 100%)');
  assert.equal(gradientOf('gamma'), 'linear-gradient(90deg, #2166ac59 0%, #92c5deff 50%, #fdb863ff 50%, #b35806ff 100%)');
});
