// Histograms, coverage and limits of a scene's dose over HTTP.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, realData, startDaemon, until } from './daemon.mjs';

const brain = realData && join(realData, 'eclipse-ent-dose');
const skip = brain && existsSync(brain) ? false : 'no real plans on this machine';
const smaller = realData && join(realData, 'cases', 'dose-grid-smaller.zip');
const phantom = realData && join(realData, 'dicomrt-oncentra-phantom');
const isoeffective = JSON.parse(readFileSync('proto/dose_presets.json', 'utf8')).isoeffective[0].name;
const fields0 = 'goorley'; // the demo plan's dose
let daemon, room, folder;
const api = (rest) => call(`${daemon.url}/api/v1/plans/${rest}`);
const near = (value, expected, share) => assert.ok(Math.abs(value - expected) <= share * Math.abs(expected), `${value}, not ${expected}`);

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-dvh-'));
  if (!skip) cpSync(phantom, join(folder, 'stated'), { recursive: true });
  // the demo plan with a second field: the same components, per 30 seconds
  cpSync(join(demo, 'phantom'), join(folder, 'fields'), { recursive: true });
  const fields = JSON.parse(readFileSync(join(folder, 'fields', 'plan.json'), 'utf8'));
  fields.doses.push({ ...fields.doses[0], id: 'second', per: '30 seconds at 1e10 n/cm2/s' });
  fields.doses.push({ ...fields.doses[0], id: 'unsaid', per: '' });
  fields.doses.push({ ...fields.doses[0], id: 'fractions', per: 'fraction' });
  fields.doses.push({ ...fields.doses[0], id: 'reactor', per: 'MW-min' });
  writeFileSync(join(folder, 'fields', 'plan.json'), JSON.stringify(fields));
  daemon = await startDaemon(skip ? { plans: [demo, folder] } : { plans: [demo, brain, folder] });
  await openPlan(daemon.url, 'phantom');
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
});
after(async () => {
  await daemon?.stop();
  if (folder) rmSync(folder, { recursive: true });
});

/** A question about the room's scene with other values. */
const ask = (question, override, more = '') =>
  api(`phantom/${question}?room=${room}&view=${encodeURIComponent(JSON.stringify({ override }))}${more}`);

test('histograms hold every univel of every region that is shown, and their figures agree with their counts', async () => {
  const plan = (await api('phantom')).json;
  const { status, json } = await ask('dvh', {}, '&bins=4096');
  assert.equal(status, 200);
  assert.equal(json.curves.length, plan.regions.length);
  assert.match(json.method, /100 % is the whole region/);
  for (const curve of json.curves) {
    const region = plan.regions.find(({ id }) => id === curve.region);
    assert.equal(curve.n_univels, region.voxels);
    const sum = curve.counts_cm3.reduce((all, cm3) => all + cm3, 0);
    near(sum, curve.volume_cm3 - curve.missing_cm3, 1e-9);
    const mean = curve.counts_cm3.reduce((all, cm3, bin) => all + cm3 * (curve.bin_from + (bin + 0.5) * curve.bin_width), 0) / sum;
    near((mean * sum) / curve.volume_cm3, curve.least.mean, 1e-3); // with no dose where there is none
    let above = 0,
      bin = curve.counts_cm3.length;
    while (above < 0.95 * curve.volume_cm3 && bin > 0) above += curve.counts_cm3[--bin];
    assert.ok(
      above < 0.95 * curve.volume_cm3 ||
        Math.abs(curve.bin_from + bin * curve.bin_width - curve.least.metrics['D95%']) <= curve.bin_width * 1.01,
    );
    near(curve.bin_from + 4096 * curve.bin_width, curve.least.max, 1e-6);
    assert.equal(curve.is_partial, curve.missing_cm3 >= 1e-3 * curve.volume_cm3);
    assert.equal(curve.mean === null, curve.is_partial);
    if (!curve.is_partial) near(curve.metrics.HI, (curve.metrics['D2%'] - curve.metrics['D98%']) / curve.metrics['D50%'], 1e-9);
  }
  const target = json.curves.find((curve) => curve.conformity);
  for (const level of target.conformity) {
    near(level.rtog, level.isodose_cm3 / target.volume_cm3, 1e-9);
    if (level.isodose_cm3 > 0) near(level.paddick, level.covered_cm3 ** 2 / target.volume_cm3 / level.isodose_cm3, 1e-9);
    assert.ok(level.covered_cm3 <= level.isodose_cm3 * (1 + 1e-9));
  }
});

test('a mean follows blood ppm linearly, boron alone in proportion, and says with which weights', async () => {
  const at = async (ppm, quantity) => (await ask('dvh', { dose: { blood_ppm: ppm } }, `&regions=brain&bins=1&quantity=${quantity}`)).json;
  const [none, ten, twenty] = await Promise.all([0, 10, 20].map((ppm) => at(ppm, 'weighted')));
  near(twenty.curves[0].mean - none.curves[0].mean, 2 * (ten.curves[0].mean - none.curves[0].mean), 1e-5);
  assert.equal(twenty.blood_ppm, 20);
  assert.ok(twenty.weights.some(({ region, boron_ppm: ppm }) => region === 'brain' && ppm > 0));
  const boron = await Promise.all([10, 20].map((ppm) => at(ppm, 'boron')));
  near(boron[1].curves[0].mean, 2 * boron[0].curves[0].mean, 1e-6);
  assert.equal(boron[0].curves[0].quantity, 'boron');
  assert.notEqual(boron[0].unit, twenty.unit);
});

test('regions, figures, quantities and bins that do not exist are refused by name', async () => {
  for (const [more, status, word] of [
    ['&regions=brain,nowhere', 404, 'nowhere'],
    ['&metrics=D95', 422, 'D95'],
    ['&quantity=colour', 422, 'colour'],
    ['&bins=5000', 422, 'bins'],
    ['&border=6', 422, 'border'],
    ['&format=xml', 422, 'xml'],
  ]) {
    const { status: found, json } = await ask('dvh', {}, more);
    assert.equal(found, status, more);
    assert.ok(json.detail.includes(word), json.detail);
  }
});

test('as CSV a histogram is one line for each bin, from all of the volume on', async () => {
  const { status, type, text } = await ask('dvh', {}, '&regions=brain,tumour&bins=10&format=csv');
  assert.equal(status, 200);
  assert.match(type, /^text\/csv/);
  const rows = text
    .trimEnd()
    .split('\r\n')
    .map((line) => line.split(','));
  assert.equal(
    rows.length,
    1 + rows.slice(1).filter(([, region]) => region === 'brain').length * (rows.some(([, region]) => region === 'tumour') ? 2 : 1),
  );
  assert.equal(rows[1].length, rows[0].length);
  assert.equal(rows[1][rows[0].indexOf('volume_from_percent')], '100');
});

test('coverage is what the histogram has above a level, and constraints are held to it', async () => {
  const { json: histogram } = await ask('dvh', {}, '&regions=brain&metrics=V5,V5cc,D2cc&descendants=true');
  const curve = histogram.curves[0];
  const { json: coverage } = await ask('coverage', { dose: { population: 'whole' } }, '&region=brain&low=5&unit=dose');
  near(coverage.volume_cm3, curve.metrics.V5cc, 2e-3);
  near(100 * coverage.share, curve.metrics.V5, 2e-3);
  near(coverage.region_cm3, curve.volume_cm3, 1e-9);
  const own = (await ask('dvh', {}, '&regions=brain&metrics=D2cc')).json.curves[0];
  const limits = {
    a: ['max', 'at-most', own.max * 1.001],
    b: ['max', 'at-most', own.max * 0.999],
    c: ['D2cc', 'at-least', own.metrics.D2cc * 0.99],
    d: ['D99999cc', 'at-most', 1],
    e: ['D95', 'at-most', 1],
  };
  const constraints = Object.fromEntries(
    Object.entries(limits).map(([id, [metric, side, limit]]) => [id, { region: 'brain', quantity: 'weighted', metric, side, limit }]),
  );
  constraints.f = { region: 'brain', quantity: 'weighted-total', metric: 'max', side: 'at-most', limit: 1 };
  const { json } = await ask('constraints', { constraints });
  const met = Object.fromEntries(json.constraints.map((row) => [row.id, row.met]));
  assert.deepEqual(met, { a: true, b: false, c: true, d: null, e: null, f: null });
  for (const row of json.constraints) assert.equal(row.reason === null, row.met !== null, JSON.stringify(row));
  near(json.constraints.find(({ id }) => id === 'a').value, own.max, 1e-9);
  assert.equal(json.constraints.find(({ id }) => id === 'a').unit, histogram.unit);
});

test('one switch sets the population of histograms, limits and coverage, and each says which', async () => {
  const plan = (await api('phantom')).json;
  const voxels = Object.fromEntries(plan.regions.map(({ id, voxels: n }) => [id, n]));
  const isInside = ({ id, parent }) =>
    id !== 'brain' && (parent === 'brain' || (parent && isInside(plan.regions.find((region) => region.id === parent))));
  const whole = voxels.brain + plan.regions.filter(isInside).reduce((all, { voxels: n }) => all + n, 0);
  assert.ok(whole > voxels.brain, 'the phantom has a region inside the brain');
  const constraints = { a: { region: 'brain', quantity: 'weighted', metric: 'mean', side: 'at-most', limit: 1 } };
  for (const [population, n] of [
    ['own', voxels.brain],
    ['whole', whole],
    ['usual', voxels.brain],
  ]) {
    const override = { dose: { population }, constraints };
    const [curve] = (await ask('dvh', override, '&regions=brain&metrics=V5')).json.curves;
    const coverage = (await ask('coverage', override, '&region=brain&low=5&unit=dose')).json;
    const [limit] = (await ask('constraints', override)).json.constraints;
    assert.equal(curve.n_univels, n);
    near(coverage.region_cm3, curve.volume_cm3, 1e-9);
    near(limit.volume_cm3, curve.volume_cm3, 1e-9);
    near(limit.value, curve.mean, 1e-9);
    near(100 * coverage.share, curve.metrics.V5, 2e-3);
    const highlighted = (await ask('coverage', { dose: { population } }, '&region=brain&low=4&unit=dose')).json; // 4 is the edge of a bin
    const [at] = (await ask('dvh', { dose: { population } }, '&regions=brain&metrics=V4&bins=1')).json.curves;
    assert.ok(
      Math.abs(highlighted.share_least - at.metrics.V4 / 100) * at.n_univels < 0.5,
      'the highlighted univels are those of the histogram',
    );
    const said = population === 'whole' ? 'whole' : 'own';
    assert.deepEqual([curve.population, coverage.population, limit.population], [said, said, said]);
    assert.deepEqual([curve.basis, coverage.basis, limit.basis], Array(3).fill("each region's own weights"));
  }
  assert.equal((await ask('dvh', {}, '&population=all')).status, 422);
});

test('nothing of how the dose is drawn changes a limit, a figure or a coverage; a basis chosen in them does, and is named', async () => {
  const own = (await ask('dvh', {}, '&regions=brain')).json.curves[0];
  const limit = (more) => ({ region: 'brain', quantity: 'weighted', metric: 'max', side: 'at-most', limit: own.max * 1.01, ...more });
  const constraints = {
    a: limit({}),
    b: limit({ limit: own.max * 0.99 }),
    c: limit({ tissue: 'tumour' }),
    d: limit({ quantity: 'gamma', limit: 1e9 }),
  };
  const coverage = { region: 'brain', low: 50, unit: 'percent' };
  let before;
  for (const dose of [
    {},
    { tissue: 'brain' },
    { tissue: 'tumour' },
    { wash: { visible: true }, tissue: 'tumour' },
    { interpolation: 'slice', error: true },
    { quantity: 'gamma' },
  ]) {
    const { json } = await ask('constraints', { dose, constraints });
    const histogram = (await ask('dvh', { dose }, '&regions=brain&quantity=weighted&bins=4')).json;
    const said = (await ask('coverage', { dose: { ...dose, coverage: { ...coverage, quantity: 'weighted' } } })).json;
    const now = JSON.stringify([json.constraints, histogram.curves, [said.low, said.share, said.volume_cm3]]);
    before ??= now;
    assert.equal(now, before, JSON.stringify(dose));
  }
  const rows = Object.fromEntries((await ask('constraints', { constraints })).json.constraints.map((row) => [row.id, row]));
  assert.deepEqual(
    ['a', 'b', 'c', 'd'].map((id) => rows[id].met),
    [true, false, false, true],
  );
  assert.deepEqual(
    ['a', 'c', 'd'].map((id) => rows[id].basis),
    ["each region's own weights", 'weights of tumour', null],
  );
  const other = (await ask('dvh', {}, '&regions=brain&tissue=tumour')).json.curves[0];
  near(rows.c.value, other.max, 1e-9);
  assert.equal(other.basis, 'weights of tumour');
});

test('a region without weights has no curve, coverage or limit, with the reason', async () => {
  const { json: scene } = await api(`phantom/dose?room=${room}`);
  const weights = Object.fromEntries(
    scene.weights.map(({ region }) => [region, { isoeffective: region === 'tumour' ? isoeffective : '' }]),
  );
  const override = {
    dose: { quantity: 'isoeffective', weights },
    constraints: { a: { region: 'brain', quantity: 'isoeffective', metric: 'max', side: 'at-most', limit: 1 } },
  };
  const { json } = await ask('dvh', override, '&regions=brain,tumour&bins=4');
  const reason = 'no parameters of the isoeffective dose for brain'; // "no weights for" of a weighted one: tests/unit/core/derive/test_dose_histogram.c
  assert.deepEqual(
    json.curves.map(({ region }) => region),
    ['tumour'],
  );
  assert.deepEqual(
    json.without_curves.map(({ region, reason: why }) => [region, why]),
    [['brain', reason]],
  );
  const [limit] = (await ask('constraints', override)).json.constraints;
  assert.deepEqual([limit.met, limit.value, limit.reason], [null, null, reason]);
  assert.equal((await ask('coverage', override, '&region=brain&low=1&unit=dose')).json.coverage_reason, reason);
});

/** The photon dose of the same effect, by the equation of Gonzalez and Santa Cruz with two repair times, solved by bisection. */
function photonDose(set, doses, minutes) {
  const lea = (tau, t) => (2 / (t / tau) ** 2) * (t / tau - 1 + Math.exp(-t / tau));
  const [fast, slow] = [set.repair_fast_min, set.repair_slow_min].map((tau) => lea(tau, minutes));
  const parts = [
    ['boron', doses.boron],
    ['nitrogen', doses.nitrogen],
    ['fast', doses.fast + doses.other],
    ['photon', doses.gamma],
  ].map(([name, gy]) => ({ ...set[name], gy, isLow: name === 'photon' }));
  let effect = parts.reduce((sum, { alpha, gy }) => sum + alpha * gy, 0);
  const [boron, , , photon] = parts;
  const high = parts[1].gy + parts[2].gy;
  for (const a of parts)
    for (const b of parts) {
      // of photons and a neutron component, the neutron components count together
      const of = (one) => (one === boron || one.isLow ? one.gy : high);
      const share = a.isLow === b.isLow ? (a.isLow ? 1 : 0) : photon.gy / (of(a) + of(b));
      const part = set.high_let_fast_part + (set.low_let_fast_part - set.high_let_fast_part) * share;
      effect += (slow - part * (slow - fast)) * Math.sqrt(a.beta * b.beta) * a.gy * b.gy;
    }
  const beta =
    set.photon.beta *
    (lea(set.repair_slow_min, set.photon_min) -
      set.low_let_fast_part * (lea(set.repair_slow_min, set.photon_min) - lea(set.repair_fast_min, set.photon_min)));
  let [low, top] = [0, 1e4];
  for (let step = 0; step < 200; step++) {
    const middle = (low + top) / 2;
    if (set.photon.alpha * middle + beta * middle ** 2 < effect) low = middle;
    else top = middle;
  }
  return low;
}

test('an isoeffective dose is that of the components beside it, wherever the point lies between voxels', async () => {
  const sets = JSON.parse(readFileSync('proto/dose_presets.json', 'utf8')).isoeffective;
  const set = sets[4];
  const { json: scene } = await api(`phantom/dose?room=${room}`);
  const weights = Object.fromEntries(scene.weights.map(({ region }) => [region, { isoeffective: set.name }]));
  const minutes = 40;
  const factor = 30; // the phantom's dose is per minute
  const view = encodeURIComponent(
    JSON.stringify({ override: { dose: { quantity: 'isoeffective', weights, irradiation_min: minutes, factor } } }),
  );
  let n = 0;
  for (let at = 0; at < 40; at++) {
    const [x, y, z] = [13, 7, 29].map((step, axis) => (((at * step + 0.37 * at * axis) % 80) - 40) * 1.013);
    const { json } = await api(`phantom/dose/probe?room=${room}&view=${view}&x=${x}&y=${y}&z=${z}`);
    if (json.value === null) continue;
    const of = (quantity) => json.components.find((part) => part.quantity === quantity)?.value ?? 0;
    const expected = photonDose(
      set,
      { boron: of('boron'), nitrogen: of('nitrogen'), fast: of('fast'), gamma: of('gamma'), other: of('other') },
      minutes,
    );
    near(json.value, expected, 2e-6);
    n++;
  }
  assert.ok(n > 10, `${n} points`);
});

test('of a region mostly outside the grid of the dose figures are bounds, and limits that the rest could decide are not known', {
  skip: smaller && existsSync(smaller) ? false : 'no made cases on this machine',
}, async () => {
  const sent = await fetch(`${daemon.url}/api/v1/plans?name=smaller`, {
    method: 'POST',
    body: readFileSync(smaller),
    headers: { 'Content-Type': 'application/zip' },
  });
  const { id } = await sent.json();
  const { plan } = await until(
    async () => (await call(`${daemon.url}/api/v1/jobs/${id}`)).json,
    (job) => job.state !== 'running',
  );
  await openPlan(daemon.url, plan);
  const regions = (await api(plan)).json.regions;
  const { json } = await api(`${plan}/dvh?regions=${regions.map(({ id }) => id)}&metrics=mean,D95%25,D2%25,V5,D1cc&bins=64`);
  const curve = json.curves.find(({ missing_cm3: cm3 }) => cm3 > 1);
  near(curve.volume_cm3, 84.9, 0.01); // shared/data/cases/README.md
  near(curve.missing_cm3, 69.5, 0.01);
  assert.equal(curve.is_partial, true);
  const known = curve.counts_cm3.reduce((all, cm3) => all + cm3, 0);
  near(known, curve.volume_cm3 - curve.missing_cm3, 1e-9);
  const mean =
    curve.counts_cm3.reduce((all, cm3, bin) => all + cm3 * (curve.bin_from + (bin + 0.5) * curve.bin_width), 0) / curve.volume_cm3;
  near(curve.least.mean, mean, 0.02); // the rest without any dose
  assert.deepEqual(
    [curve.mean, curve.most.mean, curve.metrics['D95%'], curve.least.metrics['D95%'], curve.most.max],
    [null, null, null, 0, null],
  );
  assert.ok(curve.least.max > 0 && curve.most.min > 0 && curve.least.min === 0);
  assert.ok(
    curve.least.metrics.V5 <= (100 * known) / curve.volume_cm3 + 1e-9 &&
      curve.most.metrics.V5 >= (100 * curve.missing_cm3) / curve.volume_cm3,
  );
  const at = (metric, side, limit) => ({ region: curve.region, quantity: json.quantity, metric, side, limit });
  const constraints = {
    a: at('mean', 'at-most', 1e6),
    b: at('max', 'at-most', curve.least.max * 0.5),
    c: at('max', 'at-most', curve.least.max * 2),
    d: at('D95%', 'at-least', 1),
    e: at('mean', 'at-least', curve.least.mean * 0.99),
  };
  const limits = (await api(`${plan}/constraints?view=${encodeURIComponent(JSON.stringify({ override: { constraints } }))}`)).json
    .constraints;
  assert.deepEqual(
    limits.map(({ met }) => met),
    [null, false, null, null, true],
  );
  assert.ok(limits.every(({ value }) => value === null));
  near(limits[1].least, curve.least.max, 1e-9);
  const text = (await api(`${plan}/dvh?regions=${curve.region}&bins=8&format=csv`)).text.split('\r\n').map((line) => line.split(','));
  const row = (name) => Number(text[1][text[0].indexOf(name)]);
  near(row('volume_from_percent'), (100 * known) / curve.volume_cm3, 1e-6);
  near(row('volume_from_percent_most'), 100, 1e-6);
  near(row('missing_cm3'), curve.missing_cm3, 1e-6);
});

test('means of a real plan are those of the planning program', { skip }, async () => {
  await openPlan(daemon.url, 'eclipse-ent-dose');
  const { json } = await api('eclipse-ent-dose/dvh?regions=ptv1,brain&metrics=mean,D50%25');
  assert.equal(json.without_curves.length, 0);
  const [ptv, head] = json.curves;
  near(ptv.mean, 60.9598, 0.01); // the planning program's own table, as tests/oracle/dvh_values.py reads it
  near(head.mean, 20.7685, 0.01);
});

test('histograms that an RTDOSE file carries stand beside ours, and ours agree with them', { skip }, async (context) => {
  const written = spawnSync(process.env.PYTHON ?? '/usr/bin/python3', [resolve('tests/oracle/rtdose_dvh.py'), join(folder, 'stated')], {
    encoding: 'utf8',
  });
  if (written.error || written.status === 77) {
    context.skip('no pydicom or numpy on this machine');
    return;
  }
  assert.equal(written.status, 0, written.stderr);
  const theirs = written.stdout
    .trim()
    .split('\n')
    .map((line) => Number(line.split(' ')[2]))
    .sort((a, b) => a - b);
  await openPlan(daemon.url, 'stated');
  const ours = [];
  const { doses } = (await api('stated')).json;
  const made = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'stated' })).json.id;
  const sum = Object.fromEntries(doses.map(({ id }) => [id, null])); // a new room adds the doses of all beams
  assert.equal((await call(`${daemon.url}/api/v1/rooms/${made}/scene`, 'PATCH', { dose: { sum } }, { 'If-Match': '*' })).status, 200);
  for (const { id } of doses) {
    const view = encodeURIComponent(JSON.stringify({ override: { dose: { id } } }));
    const { curves } = (await api(`stated/dvh?bins=1&room=${made}&view=${view}`)).json;
    for (const { mean, stated, volume_cm3: cm3 } of curves) {
      near(mean, stated.mean, 0.01);
      near(cm3, stated.volume_cm3, 1e-6);
      assert.ok(Math.abs(stated.mean_difference_percent) < 1);
      ours.push(mean);
    }
  }
  assert.equal(ours.length, theirs.length);
  ours.sort((a, b) => a - b).forEach((mean, index) => near(mean, theirs[index], 1e-5)); // numpy's own means
  assert.equal((await ask('dvh', {}, '&regions=brain')).json.curves[0].stated, null);
});

test('the irradiation time is where each limit is reached, the first of them ends it, and targets have their dose then', async () => {
  await openPlan(daemon.url, 'fields');
  const made = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'fields' })).json.id;
  const asked = async (question, override, more = '') => {
    const view = encodeURIComponent(JSON.stringify({ override }));
    const { status, json } = await call(`${daemon.url}/api/v1/plans/fields/${question}?room=${made}&view=${view}${more}`);
    assert.equal(status, 200, JSON.stringify(json));
    return json;
  };
  const curve = async (dose, region) => (await asked('dvh', { dose }, `&regions=${region}&metrics=D95%,D2cc`)).curves[0];
  const limit = (region, metric, side, value) => ({ region, quantity: 'weighted', metric, side, limit: value });
  const constraints = {
    mean: limit('brain', 'mean', 'at-most', 7),
    max: limit('brain', 'max', 'at-most', 12.5),
    volume: limit('brain', 'V10', 'at-most', 100),
    target: limit('tumour', 'D95%', 'at-least', 20),
  };

  // one field: figures of the histogram, which are per minute, say how many minutes each limit lasts
  const brain15 = await curve({ blood_ppm: 15 }, 'brain');
  const one = await asked('irradiation', { constraints, dose: { blood_ppm: 15 } });
  const rowOf = ({ limits }, id) => limits.find((row) => row.id === id);
  assert.equal(one.output, 'min at 1e10 n/cm2/s');
  near(rowOf(one, 'mean').units, 7 / brain15.mean, 1e-6);
  near(rowOf(one, 'max').units, 12.5 / brain15.max, 1e-6);
  assert.deepEqual([rowOf(one, 'volume').is_never, rowOf(one, 'volume').units], [true, null]);
  const first = rowOf(one, 'mean').units < rowOf(one, 'max').units ? 'mean' : 'max';
  assert.deepEqual([one.first, one.is_certain], [first, true]);
  assert.deepEqual(
    one.limits.filter((row) => row.is_first).map(({ id }) => id),
    [first],
  );
  near(one.units, rowOf(one, first).units, 0);
  near(one.minutes, one.units, 0);
  near(rowOf(one, first).value, constraints[first].limit, 1e-9);
  const tumour15 = await curve({ blood_ppm: 15 }, 'tumour');
  assert.deepEqual(
    one.targets.map(({ region, unit }) => [region, unit]),
    [
      ['target', 'Gy(w)'],
      ['tumour', 'Gy(w)'],
    ],
  );
  const target = one.targets[1];
  near(target.d95, one.units * tumour15.metrics['D95%'], 1e-6);
  near(target.mean, one.units * tumour15.mean, 1e-6);
  near(target.min, one.units * tumour15.min, 1e-6);
  near(rowOf(one, 'target').units, 20 / tumour15.metrics['D95%'], 1e-6);

  // measured boron replaces the one that is shown, and neither factor nor sum changes anything
  const brain22 = await curve({ blood_ppm: 22 }, 'brain');
  const measured = await asked('irradiation', {
    constraints,
    dose: { blood_ppm: 15, factor: 30, sum: { second: { factor: 2 } } },
    irradiation: { blood_ppm: 22 },
  });
  near(rowOf(measured, 'mean').units, 7 / brain22.mean, 1e-6);
  assert.deepEqual([measured.fields.length, measured.fields[0].is_measured, measured.fields[0].blood_ppm], [1, true, 22]);

  // two fields, three quarters and a quarter of the output, each with its own boron: the second is per half a minute
  const both = await asked('irradiation', {
    constraints,
    irradiation: { blood_ppm: 22, fields: { [fields0]: { share: 3 }, second: { share: 1, blood_ppm: 15 } } },
  });
  assert.deepEqual(
    both.fields.map(({ dose, share, blood_ppm: ppm }) => [dose, share, ppm]),
    [
      [fields0, 0.75, 22],
      ['second', 0.25, 15],
    ],
  );
  near(rowOf(both, 'mean').units, 7 / (0.75 * brain22.mean + 0.25 * 2 * brain15.mean), 1e-6);
  near(both.fields[1].units, both.units / 4, 1e-12);

  // what a dose is per decides what can be said
  const unsaid = await asked('irradiation', { constraints, irradiation: { fields: { unsaid: {} } } });
  assert.deepEqual([unsaid.output, unsaid.first, unsaid.units, unsaid.targets[0].mean], [null, null, null, null]);
  assert.match(unsaid.reason, /does not say what it is per/);
  const mixed = await asked('irradiation', { constraints, irradiation: { fields: { [fields0]: {}, fractions: {} } } });
  assert.match(mixed.reason, /no output of the source in common/);
  const counted = await asked('irradiation', { constraints, irradiation: { rate: 5, fields: { fractions: {} } } });
  assert.deepEqual([counted.output, counted.minutes], ['fraction', null]);
  near(rowOf(counted, 'mean').units, 7 / brain15.mean, 1e-6);

  // an isoeffective dose is not in proportion: at the time that is found, the histogram has the figure of the limit
  const weights = Object.fromEntries((await api('fields/dose?room=' + made)).json.weights.map(({ region }) => [region, { isoeffective }]));
  const dose = { blood_ppm: 15, weights };
  const iso = { ...limit('brain', 'mean', 'at-most', 7), quantity: 'isoeffective' };
  const grown = await asked('irradiation', { constraints: { iso }, dose });
  assert.deepEqual([grown.first, grown.is_certain, rowOf(grown, 'iso').unit], ['iso', true, 'Gy(IsoE)']);
  const then = { ...dose, quantity: 'isoeffective', factor: grown.units, irradiation_min: grown.units };
  near((await curve(then, 'brain')).mean, 7, 1e-3); // rows of a histogram are off by up to 0.1 %
  near(grown.targets[1].d95, (await curve(then, 'tumour')).metrics['D95%'], 1e-3);
  // a source that is twice as strong: the same output in half the time has less repair, so less of it is needed
  const ofReactor = async (rate) =>
    rowOf(await asked('irradiation', { constraints: { iso }, dose, irradiation: { rate, fields: { reactor: {} } } }), 'iso');
  near((await ofReactor(1)).units, grown.units, 2e-4);
  const fast = await ofReactor(2);
  assert.ok(fast.units < grown.units * 0.9999 && fast.units > grown.units / 2, `${fast.units} of ${grown.units}`);
  near(fast.minutes, fast.units / 2, 1e-12);
  assert.match((await ofReactor(null)).reason, /the source's strength is needed, in a unit that fits MW-min/);
  const noTime = await asked('irradiation', { constraints: { iso }, dose, irradiation: { fields: { fractions: {} } } });
  assert.match(rowOf(noTime, 'iso').reason, /no time follows from a dose per fraction/);
});
