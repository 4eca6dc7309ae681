// Numbers of histograms, profiles, limits and files of dose, against closed forms.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { axisEnd, boundsWords, densityAt, dvhCsv, dvhJson, plotPoints, readAt, shareWords, volumeFrom, withSums } =
  await load('features/dose/dose_dvh.js');
const { readDvh } = await load('features/dose/dose_answers.js');
const { aligned, depthOf, linesOf, pointAt, referenceGroups, valueAt } = await load('features/dose/dose_profile.js');
const { byState, constraintsCsv, constraintsFromCsv, freeConstraintId, limitAt, metricWords, mostConstraints, readMetric, verdictOf } =
  await load('features/dose/dose_constraints.js');
const { csvRows, csvText } = await load('parts/csv.js');

const near = (value, expected, tolerance = 1e-9) => assert.ok(Math.abs(value - expected) <= tolerance, `${value} is not ${expected}`);
const known = (figures) => Object.fromEntries(Object.entries(figures).map(([name, value]) => [name, [value, value]]));
/** A region in which the dose is spread evenly from low to high. */
const even = (region, low, high, cm3, more = {}) =>
  withSums({
    region,
    dose: 'd',
    of: 0,
    volume: cm3,
    cm3,
    univels: 1000,
    missing: 0,
    isPartial: false,
    population: 'own',
    basis: "each region's own weights",
    conformity: [],
    high,
    figures: known({ min: low, mean: (low + high) / 2, max: high, 'D98%': low, 'D50%': low, 'D2%': high, 'D0.03cc': high, HI: 1 }),
    from: low,
    width: (high - low) / 10,
    counts: Array(10).fill(cm3 / 10),
    ...more,
  });

test('of a dose that is spread evenly the volume above a value falls in a straight line', () => {
  const curve = even('a', 10, 30, 50);
  for (const [dose, cm3] of [
    [-1, 50],
    [0, 50],
    [10, 50],
    [15, 37.5],
    [20.5, 23.75],
    [30, 0],
    [31, 0],
  ])
    near(volumeFrom(curve, dose), cm3);
  near(densityAt(curve, 12), 2.5); // 50 cm3 over 20 Gy
  assert.equal(densityAt(curve, 9), 0);
  assert.equal(densityAt(curve, 30.1), 0);
});

test('a constant dose is a step', () => {
  const curve = withSums({ region: 'a', of: 0, volume: 8, cm3: 8, low: 2, high: 2, from: 2, width: 1e-6, counts: [8] });
  near(volumeFrom(curve, 2), 8);
  near(volumeFrom(curve, 2.1), 0);
});

test('the points of a plot: percent of each volume, cm3, and a differential curve whose area is the volume', () => {
  const curves = [even('a', 0, 40, 20), even('b', 10, 30, 5)];
  const { doses, values, end } = plotPoints(curves, { isDifferential: false, unit: 'percent', nPoints: 100 });
  assert.ok(end >= 40 && end <= 50);
  assert.equal(doses.at(-1), end);
  near(values[0][0], 100);
  near(values[1][doses.findIndex((dose) => dose >= 20)], (100 * (30 - doses.find((dose) => dose >= 20))) / 20, 1e-9);
  const { doses: steps, values: per } = plotPoints(curves, { isDifferential: true, unit: 'cm3', nPoints: 500 });
  for (const [at, cm3] of [
    [0, 20],
    [1, 5],
  ])
    near(per[at].reduce((sum, value) => sum + value, 0) * (steps[1] - steps[0]), cm3, 1e-9);
  assert.equal(axisEnd([]), 1);
});

test('under a dose each region has its share and its volume', () => {
  const [{ percent, cm3 }] = readAt([even('a', 0, 40, 20)], 10);
  near(percent, 75);
  near(cm3, 15);
});

const words = (value) => value.toFixed(1);

test('a figure that a part without a dose could change is said as bounds', () => {
  assert.equal(boundsWords([6.73, 6.73], words), '6.7');
  assert.equal(boundsWords([6.73, Infinity], words), '≥ 6.7');
  assert.equal(boundsWords([0, Infinity], words), 'not known');
  assert.equal(boundsWords([0, 1.2], words), '≤ 1.2');
  assert.equal(boundsWords([18, 99.9], words), '18.0 to 99.9');
  assert.equal(boundsWords([NaN, NaN], words), '–');
});

test('the band of a region of which a part has no dose holds its curve with that part at 0 and at twice the maximum', () => {
  // 20 of 80 cm3 have a dose, spread evenly from 0 to 40
  const partial = even('a', 0, 40, 20, { volume: 80, missing: 60, isPartial: true });
  const atZero = (dose) => (dose <= 0 ? 100 : (100 * 20 * Math.max(0, 40 - dose)) / 40 / 80);
  const atTwice = (dose) => (100 * (60 * (dose <= 80) + 20 * Math.min(1, Math.max(0, (40 - dose) / 40)))) / 80;
  const {
    doses,
    values: [low],
    tops: [high],
  } = plotPoints([partial], { isDifferential: false, unit: 'percent', nPoints: 100 });
  doses.forEach((dose, at) => {
    for (const filled of [atZero(dose), atTwice(dose)])
      assert.ok(dose === 0 || (low[at] <= filled + 1e-9 && filled <= high[at] + 1e-9), `${dose}: ${low[at]} ${filled} ${high[at]}`);
  });
  near(low[0], 25);
  near(high[0], 100);
  assert.deepEqual(plotPoints([partial], { isDifferential: true, unit: 'percent' }).tops, [null]);
  assert.deepEqual(plotPoints([even('a', 0, 40, 20)], { isDifferential: false, unit: 'percent' }).tops, [null]);
  assert.equal(shareWords(partial, 10, words), '12.5 to 87.5 %');
  assert.equal(shareWords(even('a', 0, 40, 20), 10, words), '50.0 %');
});

test('an answer with bounds is read with them, in the plot and in both files', () => {
  const answer = {
    id: 'd',
    unit: 'Gy',
    without_curves: [
      { dose: 'd', region: 'mucosa', reason: 'no weights for mucosa' },
      { dose: 'e', reason: 'no such quantity' },
    ],
    curves: [
      {
        region: 'a',
        dose: 'd',
        unit: 'Gy',
        quantity: 'total',
        basis: 'weights of brain',
        population: 'whole',
        n_univels: 10,
        volume_cm3: 80,
        missing_cm3: 60,
        is_partial: true,
        min: null,
        mean: null,
        max: null,
        metrics: { 'D98%': null, 'D50%': null, 'D2%': null, 'D0.03cc': null, HI: null },
        least: { min: 0, mean: 5, max: 40, metrics: { 'D98%': 0, 'D50%': 0, 'D2%': 30, 'D0.03cc': 39, HI: 0 } },
        most: { min: 1, mean: null, max: null, metrics: { 'D98%': 12, 'D50%': null, 'D2%': null, 'D0.03cc': null, HI: null } },
        bin_from: 0,
        bin_width: 10,
        counts_cm3: [5, 5, 5, 5],
      },
    ],
  };
  const { curves, left, reason } = readDvh(answer);
  assert.deepEqual(left, [{ region: 'mucosa', reason: 'no weights for mucosa' }]);
  assert.equal(reason, 'e: no such quantity');
  assert.deepEqual(
    [curves[0].figures.mean, curves[0].figures.min, curves[0].figures['D98%'], curves[0].high],
    [[5, Infinity], [0, 1], [0, 12], 40],
  );
  const about = { words: [], regionName: (id) => id, unit: 'Gy' };
  const rows = csvRows(dvhCsv(curves, about)).map(({ cells }) => cells);
  assert.deepEqual(rows[0].slice(0, 7), ['region', 'cm3', 'univels', 'missing_cm3', 'min (Gy)', 'mean (Gy)', 'max (Gy)']);
  assert.deepEqual(rows[1].slice(0, 7), ['a', '80', '10', '60', '≤ 1', '≥ 5', '≥ 40']);
  assert.deepEqual(rows[1].slice(-2), ['whole region', 'weights of brain']);
  assert.equal(rows[2].length, 3, 'dose, least, most');
  assert.deepEqual(rows[3].map(Number), [0, 25, 100]);
  const json = JSON.parse(dvhJson(curves, about)).histograms[0];
  assert.deepEqual([json.missing_cm3, json.is_partial, json.figures.mean], [60, true, { least: 5, most: null }]);
});

test('a file of histograms says what it depends on, and has the curves', () => {
  const rows = csvRows(
    dvhCsv([even('a', 0, 40, 20)], {
      words: [
        { id: 'plan', name: 'plan', values: ['A, "B"'] },
        { id: 'weights', name: 'weights', values: ['=1+1'] },
      ],
      regionName: () => 'tumour, left',
      unit: 'Gy(w)',
    }),
  );
  assert.deepEqual(rows[0].cells, ['plan', 'A, "B"']);
  assert.deepEqual(rows[1].cells, ['weights', "'=1+1"], 'no formula for a spreadsheet');
  assert.deepEqual(rows[3].cells.slice(0, 7), ['tumour, left', '20', '1000', '0', '0', '20', '40']);
  const curve = rows.slice(5).map(({ cells }) => cells.map(Number));
  assert.equal(curve.length, 201);
  for (const [dose, percent] of curve) near(percent, dose <= 40 ? 100 - 2.5 * dose : 0, 1e-4);
});

test('comma-separated values come back as they were, and broken ones name their line', () => {
  const rows = [
    ['a,b', 'c"d', 'e\nf'],
    ['', 'g', ''],
  ];
  assert.deepEqual(
    csvRows(csvText(rows)).map(({ cells }) => cells),
    rows,
  );
  assert.deepEqual(
    csvRows('\uFEFFa , b\r\n\r\n,,\nc,d').map(({ line, cells }) => [line, cells]),
    [
      [1, ['a', 'b']],
      [4, ['c', 'd']],
    ],
  );
  assert.throws(() => csvRows('a\n"b'), /Line 2: a quotation mark is not closed/);
  assert.throws(() => csvRows('a\nb"c'), /Line 2: a quotation mark inside a field/);
  assert.throws(() => csvRows('"a"b'), /Line 1: text after a quotation mark/);
  assert.equal(csvText([['brain\u202enoitcennoc', 1]]), 'brain«RLO»noitcennoc,1\r\n'); // shown, not obeyed
});

test('a line through the patient: depth of a point, how far beside it is, and back', () => {
  const plan = {
    beams: [
      { id: 'b', name: '', entry_mm: [10, 0, 0], target_mm: [10, 30, 40] },
      { id: 'nowhere', entry_mm: [1, 1, 1], target_mm: [1, 1, 1] },
    ],
  };
  const scene = {
    measures: {
      m: { kind: 'distance', name: 'across', points: [{ at_mm: [0, 0, 0] }, { at_mm: [0, 0, 9] }] },
      angle: { kind: 'angle', points: [] },
    },
  };
  const lines = linesOf(plan, scene);
  assert.deepEqual(
    lines.map(({ key, name }) => [key, name]),
    [
      ['beam b', 'b'],
      ['measure m', 'across'],
    ],
  );
  assert.deepEqual(pointAt(lines[0], 25), [10, 15, 20]);
  const { depth, asideMm } = depthOf(lines[0], [17, 15, 20]);
  near(depth, 25);
  near(asideMm, 7);
});

test('between depths values are linear; outside, and beside a point without one, there is none', () => {
  const [depths, values] = [
    [0, 10, 20],
    [1, 3, null],
  ];
  near(valueAt(depths, values, 5), 2);
  near(valueAt(depths, values, 10), 3);
  for (const depth of [-1, 15, 20, 21]) assert.equal(valueAt(depths, values, depth), null);
  const both = aligned({ depths: [0, 10], curves: [{ values: [0, 10] }] }, [{ depths: [5, 15], values: [50, 150] }]);
  assert.deepEqual(
    both,
    {
      depths: [0, 5, 10],
      lists: [
        [0, 5, 10],
        [null, 50, 100],
      ],
    },
    'references end where the profile ends',
  );
  assert.deepEqual(
    referenceGroups([
      { name: 'a', unit: 'Gy' },
      { name: 'a', unit: '1/cm2' },
      { name: 'a', unit: 'Gy' },
      { name: 'b', unit: 'Gy' },
    ]).map(({ name, unit, curves }) => [name, unit, curves.length]),
    [
      ['a', 'Gy', 2],
      ['a', '1/cm2', 1],
      ['b', 'Gy', 1],
    ],
  );
});

test('a figure is read as people write it, and nothing else is one', () => {
  for (const [text, metric] of [
    ['D95%', 'D95%'],
    ['d95 %', 'D95%'],
    ['D0.03 cc', 'D0.03cc'],
    ['D2cm³', 'D2cc'],
    ['MEAN', 'mean'],
    ['V20', 'V20'],
    ['V20%', 'V20'],
    ['v2.5cc', 'V2.5cc'],
  ])
    assert.equal(readMetric(text), metric, text);
  for (const text of [
    '',
    'D95',
    'D101%',
    'D-2%',
    'Dmax',
    'V',
    'V20Sv',
    'V20Gy',
    'V20 Gy(w)',
    'V20Gycc',
    'median',
    'D95%;x',
    `D${'9'.repeat(30)}cc`,
  ])
    assert.equal(readMetric(text), '', text);
  assert.deepEqual(
    [metricWords('D95%', 'Gy'), metricWords('V20', 'Gy(w)'), metricWords('V20cc', 'Gy'), metricWords('mean', 'Gy')],
    ['D95 %', 'V20 Gy(w)', 'V20 Gy, cm³', 'mean'],
  );
  assert.deepEqual(
    [limitAt({ metric: 'D95%', limit: 20 }), limitAt({ metric: 'V20', limit: 30 }), limitAt({ metric: 'max', limit: 9 })],
    [{ dose: 20, percent: 95 }, { dose: 20, percent: 30 }, { dose: 9 }],
  );
});

const plan = {
  regions: [
    { id: 'brain', name: 'Brain, whole' },
    { id: 'tumour', name: 'Tumour' },
  ],
};
const good = 'region,quantity,metric,side,limit\nbrain,weighted,max,at-most,10\nTumour,boron,D95 %,at-least,2e1\n';

test('limits of a file: by id or name, and what we write we read', () => {
  const limits = constraintsFromCsv(good, plan);
  assert.deepEqual(limits, [
    { region: 'brain', quantity: 'weighted', metric: 'max', side: 'at-most', limit: 10 },
    { region: 'tumour', quantity: 'boron', metric: 'D95%', side: 'at-least', limit: 20 },
  ]);
  const rows = limits.map((constraint, at) => ({
    id: String(at),
    constraint,
    verdict: verdictOf(at ? undefined : { value: 8, unit: 'Gy(w)', met: true }),
  }));
  assert.deepEqual(constraintsFromCsv(constraintsCsv(rows, plan), plan), limits);
  const weighed = constraintsFromCsv('region,quantity,metric,side,limit,tissue\nbrain,weighted,max,at-most,10,Tumour\n', plan);
  assert.equal(weighed[0].tissue, 'tumour');
  assert.deepEqual(constraintsFromCsv(constraintsCsv([{ ...rows[0], constraint: weighed[0] }], plan), plan), weighed);
  assert.throws(
    () => constraintsFromCsv('region,quantity,metric,side,limit,tissue\nbrain,weighted,max,at-most,10,liver\n', plan),
    /no region “liver” whose weights/,
  );
});

test('a file of limits with anything wrong is refused whole, with its lines', () => {
  const bad = (line, words) => assert.throws(() => constraintsFromCsv(`${good}${line}`, plan), words);
  bad('liver,weighted,max,at-most,10', /^Error: Line 4: The plan has no region “liver”\.$/);
  bad('brain,heat,max,at-most,10', /Line 4: “heat” is no quantity/);
  bad('brain,weighted,D95,at-most,10', /Line 4: “D95” is no figure/);
  bad('brain,weighted,max,under,10', /Line 4: “under” is no side/);
  bad('brain,weighted,max,at-most,ten', /Line 4: The limit “ten” is not a number/);
  bad('brain,weighted,max,at-most,', /Line 4: The limit “” is not a number/);
  bad('brain,weighted,max,at-most,-1', /Line 4: The limit “-1” is not a number from 0 on/);
  bad('brain,weighted,V20,at-most,101', /Line 4: .*over 100 %/);
  bad('brain,weighted,max,at-most', /Line 4: 4 fields, not 5/);
  bad('liver,weighted,max,at-most,1\nbrain,heat,max,at-most,1', /Line 4: .*Line 5: /);
  assert.throws(() => constraintsFromCsv('region,metric,side,limit\n', plan), /quantity is not there/);
  assert.throws(() => constraintsFromCsv(`${good.replace('limit\n', 'limit,price\n')}`, plan), /The column “price” is not known/);
  assert.throws(
    () => constraintsFromCsv('region,region,quantity,metric,side,limit\nbrain,brain,weighted,max,at-most,1', plan),
    /“region” is there twice/,
  );
  assert.throws(() => constraintsFromCsv('', plan), /The first line has to name/);
  assert.throws(() => constraintsFromCsv(good.split('\n')[0], plan), /no limits/);
  assert.throws(() => constraintsFromCsv(good + 'brain,weighted,max,at-most,1\n'.repeat(mostConstraints), plan), /at most 64/);
});

test('what the server does not know is said with its reason, and is never met', () => {
  assert.deepEqual(verdictOf({ value: 8, unit: 'Gy', met: false }), {
    state: 'unmet',
    value: 8,
    bounds: [8, 8],
    unit: 'Gy',
    reason: '',
    basis: '',
    population: '',
  });
  const bound = verdictOf({ value: null, least: 13.1, most: null, unit: 'Gy', met: false, basis: 'weights of brain', population: 'own' });
  assert.deepEqual([bound.state, bound.value, bound.bounds, bound.basis], ['unmet', null, [13.1, Infinity], 'weights of brain']);
  assert.equal(verdictOf({ value: null, least: 6.73, most: null, met: null, reason: '18 % of the region have no dose' }).state, 'unknown');
  assert.deepEqual(
    byState(['met', 'unknown', 'unmet', 'met'].map((state, id) => ({ id, verdict: { state } }))).map(({ id }) => id),
    [2, 1, 0, 3],
  );
  assert.equal(verdictOf({ value: null, met: null, reason: 'There is no boron.' }).state, 'unknown');
  assert.equal(verdictOf({ value: 8 }).state, 'unknown');
  assert.equal(verdictOf(undefined, 'The server does not answer.').reason, 'The server does not answer.');
  assert.equal(freeConstraintId({ 'limit-1': {}, 'limit-3': {} }, ['limit-2']), 'limit-4');
});
