// Parts that do not fit are not used: a part of another patient, frame of reference, treatment plan, unit, ... changes not one pixel and not one
// number on any path, whatever a scene asks of it. The expected side is the same folder without that part.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { bin, call, openPlan, startDaemon } from './daemon.mjs';
import { putDose, putImages, putPlan, putStructs, putWhole } from './made_dicom.mjs';

const anna = { id: 'A-1001', name: 'Alpha^Anna', birthDate: '19610412' },
  berta = { id: 'B-2002', name: 'Beta^Berta', birthDate: '19701231' };
const elsewhere = { ...anna, frame: '1.2.49', study: '1.2.39' };
const second = { uid: '1.2.82', file: 'dose-b.dcm', description: 'B', plan: '1.2.71' };

/** Parts beside the plan, by the folder's name: each puts its files. */
const beside = {
  alone: () => {},
  same: (folder) => putDose(folder, anna, second),
  frame: (folder) => putDose(folder, elsewhere, second),
  patient: (folder) => putDose(folder, berta, second),
  plan: (folder) => {
    putPlan(folder, anna, { uid: '1.2.75', label: 'OTHER', file: 'plan-b.dcm', beam: 'Other', date: '20200101' });
    putDose(folder, anna, { ...second, plan: '1.2.75' });
  },
  absent: (folder) => putDose(folder, anna, { ...second, plan: '1.2.999' }),
  unit: (folder) => putDose(folder, anna, { ...second, units: 'RELATIVE' }),
  per: (folder) => putDose(folder, anna, { ...second, summation: 'FRACTION' }),
  unstated: (folder) => putDose(folder, { ...anna, frame: '' }, second),
  apart: (folder) => putDose(folder, anna, { ...second, origin: '500\\500\\500' }),
  'regions-frame': (folder) => putStructs(folder, elsewhere, { uid: '1.2.65', file: 'structs-z.dcm', name: 'Zother' }),
  'regions-patient': (folder) => putStructs(folder, berta, { uid: '1.2.65', file: 'structs-z.dcm', name: 'Zother' }),
  'regions-set': (folder) => putStructs(folder, anna, { uid: '1.2.65', file: 'structs-z.dcm', name: 'Zother' }),
  'beam-frame': (folder) =>
    putPlan(folder, elsewhere, {
      uid: '1.2.75',
      label: 'OTHER',
      file: 'plan-b.dcm',
      beam: 'Other',
      isocenter: '20\\8\\6',
      date: '20200101',
    }),
  'beam-patient': (folder) =>
    putPlan(folder, berta, { uid: '1.2.75', label: 'OTHER', file: 'plan-b.dcm', beam: 'Other', isocenter: '20\\8\\6', date: '20200101' }),
  'image-frame': (folder) => putImages(folder, elsewhere, { series: '1.2.55', modality: 'MR', prefix: 'mr' }),
  'target-patient': (folder) => putStructs(folder, berta, { uid: '1.2.65', file: 'structs-z.dcm', name: 'GTV', left: 300 }),
  'image-patient-first': (folder) => putImages(folder, berta, { series: '1.2.11', modality: 'CT', prefix: 'aa', n: 4 }),
  'image-patient': (folder) => putImages(folder, berta, { series: '1.2.55', modality: 'MR', prefix: 'mr' }),
};
let daemon, api, root;
const plans = {};

before(async () => {
  root = mkdtempSync(join(tmpdir(), 'fits-'));
  for (const [name, put] of Object.entries(beside)) {
    const folder = join(root, `p-${name}`);
    mkdirSync(folder);
    putImages(folder, anna);
    putStructs(folder, anna);
    putPlan(folder, anna, { approval: 'APPROVED' });
    putDose(folder, anna, { plan: '1.2.71', description: 'A' });
    put(folder);
  }
  const folder = join(root, 'p-beams');
  putWhole(folder, anna, { beams: ['Front', 'Back'] });
  putDose(folder, anna, { plan: '1.2.71', summation: 'FRACTION', description: 'Whole' });
  for (const [beam, uid] of [
    [2, '1.2.82'],
    [1, '1.2.83'],
  ])
    putDose(folder, anna, { plan: '1.2.71', summation: 'BEAM', beam, uid, file: `beam-${beam}.dcm` });
  daemon = await startDaemon({ plans: [root] });
  api = `${daemon.url}/api/v1`;
  for (const name of Object.keys(beside)) {
    await openPlan(daemon.url, `p-${name}`);
    plans[name] = (await call(`${api}/plans/p-${name}`)).json;
  }
});
after(async () => {
  await daemon?.stop();
  rmSync(root, { recursive: true, force: true });
});

const idOf = (list, own) => list.find(({ id }) => id !== own)?.id;
const first = (name) => plans[name].doses.find((dose) => (plans[name].doses.length > 1 ? dose.name === 'A' : true)).id;

const ct = (name) =>
  plans[name].images.find(
    ({ modality, patient }) => modality === 'CT' && plans[name].patients[patient].masked === plans.alone.patients[0].masked,
  );

/** All that a scene can ask of a dose, regions, a beam and an image. */
function asking(name) {
  const plan = plans[name],
    dose = first(name),
    other = idOf(plan.doses, dose);
  const level = { value: 0.9, unit: 'dose', surface: true, line: true, wash: true };
  return {
    dose: {
      id: dose,
      quantity: 'total',
      levels: { x: level },
      lines: { visible: true },
      wash: { visible: true },
      surfaces: { visible: true },
      reference: { kind: 'value', value: 1 },
      coverage: { visible: true, region: 'box', low: 0.5, unit: 'dose' },
      ...(other ? { sum: { [other]: { factor: 1 } }, ...(name === 'plan' ? {} : { compare: { id: other, mode: 'lines' } }) } : {}),
    }, // doses of two plans may be compared
    constraints: { c: { region: 'box', quantity: 'total', metric: 'mean', limit: 1 } },
    regions: Object.fromEntries(plan.regions.map(({ id }) => [id, { visible: true, texture: 'dose', color: '#ff8800', opacity: 1 }])),
    beam: { looks: Object.fromEntries(plan.beams.map(({ id }) => [id, { visible: true }])) },
    image: { id: ct(name).id, ...(idOf(plan.images, ct(name).id) ? { blend: { id: idOf(plan.images, ct(name).id), opacity: 0.5 } } : {}) },
  };
}

async function picture(name, scene, kind, acceptances) {
  const answer = await fetch(`${api}/plans/p-${name}/render`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ scene, view: { kind, size_px: [160, 120] }, ...(acceptances ? { acceptances } : {}) }),
  });
  assert.equal(answer.status, 200, answer.ok ? '' : await answer.text());
  return Buffer.from(await answer.arrayBuffer());
}

const kinds = ['axial', '3d'];
const isUsed = ['same', 'unstated'];

test('what does not fit changes no pixel of a pane or of a view into space', async () => {
  const expected = Object.fromEntries(await Promise.all(kinds.map(async (kind) => [kind, await picture('alone', asking('alone'), kind)])));
  for (const name of Object.keys(beside).filter((each) => each !== 'alone'))
    for (const kind of kinds)
      assert.equal((await picture(name, asking(name), kind)).equals(expected[kind]), !isUsed.includes(name), `${name}, ${kind}`);
});

test('a new room begins as without it: image, window, crosshair, dose and how far a view into space reaches', async () => {
  const sceneOf = async (name) => {
    await openPlan(daemon.url, `p-${name}`);
    const room = (await call(`${api}/rooms`, 'POST', { plan: `p-${name}` })).json.id;
    const { image, dose, beam } = (await call(`${api}/rooms/${room}/scene`)).json;
    return { image: { ...image, id: image.id || plans[name].images[0].id }, dose, beam };
  };
  const expected = await sceneOf('alone');
  for (const name of Object.keys(beside).filter((each) => each !== 'alone')) {
    const found = await sceneOf(name);
    assert.equal(found.image.id, ct(name).id, name);
    assert.deepEqual({ ...found, image: { ...found.image, id: expected.image.id } }, expected, name);
    if (!['regions-frame', 'regions-set'].includes(name)) assert.deepEqual(plans[name].bounds_mm, plans.alone.bounds_mm, name);
    if (plans[name].regions.length > 1) continue; // their colours are given in turn
    for (const kind of kinds)
      assert.ok((await picture(name, undefined, kind)).equals(await picture('alone', undefined, kind)), `${name}, ${kind}`);
  }
});

test('no surface of a region and no values of an image of another patient are given out', async () => {
  const region = plans['target-patient'].regions.find(({ name }) => name === 'GTV').id,
    image = plans['image-patient-first'].images.find(({ id }) => id !== ct('image-patient-first').id).id;
  for (const path of [
    `p-target-patient/regions/${region}/surface`,
    `p-target-patient/regions/${region}/surface?format=stl`,
    `p-image-patient-first/images/${image}/histogram`,
  ]) {
    const answer = await call(`${api}/plans/${path}`);
    assert.equal(answer.status, 404, `${path}: ${answer.text}`);
    assert.match(answer.text, /another patient/);
  }
});

/** The numbers of every read-out of the first dose, its regions and its beam. */
async function numbers(name) {
  await openPlan(daemon.url, `p-${name}`);
  const room = (await call(`${api}/rooms`, 'POST', { plan: `p-${name}` })).json.id;
  const patched = await call(`${api}/rooms/${room}/scene`, 'PATCH', asking(name), { 'If-Match': '*' });
  assert.equal(patched.status, 200, patched.text);
  const ask = async (path) => (await call(`${api}/plans/p-${name}/${path}${path.includes('?') ? '&' : '?'}room=${room}`)).json;
  const at = 'x=14&y=14&z=9',
    dose = first(name);
  const answers = await Promise.all([
    ask('dvh'),
    ask(`dose/probe?${at}`),
    ask(`probe?${at}`),
    ask(`profile?beam=${plans.alone.beams[0].id}`),
    ask('coverage'),
    ask('constraints'),
    ask('gamma'),
    ask('dose/levels/x/surface'),
    ask(`beam?beam=${plans.alone.beams[0].id}`),
    ask('dose/isolines?view={"kind":"axial"}'),
  ]);
  for (const answer of answers) assert.equal(answer.type, undefined, JSON.stringify(answer));
  const [dvh, dosed, probe, profile, coverage, limits, gamma, isodose, beam, lines] = answers;
  return {
    dvh: dvh.curves
      .filter((curve) => curve.dose === dose)
      .map(({ region, min, mean, max, counts_cm3 }) => ({ region, min, mean, max, counts_cm3 })),
    second: dvh.curves.filter((curve) => curve.dose !== dose).length,
    body_cm3: dvh.body_cm3,
    value: dosed.value,
    percent: dosed.percent,
    regions: dosed.regions,
    images: probe.images,
    inside: probe.regions,
    doses: probe.doses.filter(({ id }) => id === dose).map(({ value }) => value),
    others: probe.doses.filter(({ id }) => id !== dose).length,
    curves: profile.curves.map(({ quantity, values }) => ({ quantity, values })),
    bands: profile.bands,
    volume_cm3: coverage.volume_cm3,
    share: coverage.share,
    limit: limits.constraints?.[0]?.value,
    difference: gamma.difference?.mean ?? null,
    surface: [isodose.triangles, isodose.volume_mm3],
    crossed: beam.crossed,
    lines: lines.levels,
  };
}

test('nor any number of any read-out', async () => {
  const expected = await numbers('alone');
  assert.ok(
    expected.value > 0 && expected.dvh.length === 1 && expected.surface[0] > 0 && expected.bands.length > 0,
    JSON.stringify(expected),
  );
  for (const name of isUsed) {
    const other = await numbers(name);
    assert.ok(Math.abs(other.value - 2 * expected.value) < 1e-6, `${name}: a dose that fits is added`);
    assert.equal(other.second, 1);
  }
  for (const name of Object.keys(beside).filter((each) => each !== 'alone' && !isUsed.includes(each))) {
    const found = await numbers(name);
    const free = name === 'plan' ? ['others'] : ['unit', 'per'].includes(name) ? ['others'] : []; // compared or read alone, not added
    for (const key of Object.keys(expected).filter((each) => !free.includes(each)))
      assert.deepEqual(found[key], expected[key], `${name}: ${key}`);
  }
});

test('the reason is said for each, and the plan says what it needs', async () => {
  const expected = {
    frame: ['frame', 'acceptance'],
    patient: ['patient', 'never'],
    absent: ['absent', 'acceptance'],
    apart: ['apart', 'acceptance'],
  };
  for (const [name, [relation, needs]] of Object.entries(expected)) {
    const other = `dose:${idOf(plans[name].doses, first(name))}`;
    const pair = plans[name].fits.find(({ thing, with: image }) => thing === other && image === 'image:ct');
    assert.deepEqual([pair?.relation, pair?.needs], [relation, needs], name);
    assert.match(pair.reason, /^Dose “B” is (not|never) used with .*: /, pair.reason);
  }
  for (const [name, relation] of [
    ['plan', 'plan'],
    ['unit', 'unit'],
    ['per', 'per'],
  ]) {
    const other = `dose:${idOf(plans[name].doses, first(name))}`;
    assert.equal(
      plans[name].fits.find(({ thing, with: dose }) => thing === other && dose === `dose:${first(name)}`)?.relation,
      relation,
      name,
    );
  }
});

test("a person's word uses a dose of another frame in that picture alone; of another patient it never counts", async () => {
  const dose = idOf(plans.frame.doses, first('frame')),
    words = 'registered in the other program';
  const scene = { ...asking('frame'), dose: { ...asking('frame').dose, id: dose, sum: {}, compare: { id: '' } } };
  const acceptances = [{ thing: `dose:${dose}`, with: 'image:ct', reason: 'registered-elsewhere', words }];
  const without = await picture('frame', scene, 'axial');
  assert.ok(!(await picture('frame', scene, 'axial', acceptances)).equals(without));
  assert.ok((await picture('frame', scene, 'axial')).equals(without), 'the next picture without it is as before');
  const patient = idOf(plans.patient.doses, first('patient'));
  const answer = await call(`${api}/plans/p-patient/render`, 'POST', {
    scene: { dose: { id: patient } },
    acceptances: [{ thing: `dose:${patient}`, with: 'image:ct', reason: 'other', words }],
  });
  assert.equal(answer.status, 403, answer.text);
});

/** Each way that a dose is drawn, alone, and the kind of picture that has it. */
const off = { wash: { visible: false }, lines: { visible: false }, surfaces: { visible: false }, coverage: { visible: false } };
const layers = [
  ['wash', 'axial', { wash: { visible: true } }],
  ['line', 'axial', { lines: { visible: true } }],
  ['coverage', 'axial', { coverage: { visible: true, region: 'box', low: 0.5, unit: 'dose' } }],
  ['surface', '3d', { surfaces: { visible: true } }],
  ['cap', '3d', { wash: { visible: true } }, { clip: { axial_high: { enabled: true, position_mm: 9 } } }],
  [
    'region',
    '3d',
    { wash: { visible: true } },
    { regions: { box: { visible: true, texture: 'dose' } }, image: { slices: { axial: { visible: false } } } },
  ],
];
const level = { value: 0.9, unit: 'dose', surface: true, line: true, wash: true };
const showing = (id, dose, more = {}) => ({
  ...more,
  dose: { id, quantity: 'total', reference: { kind: 'value', value: 1 }, levels: { x: level }, ...off, ...dose },
  ...(more.clip && { regions: { box: { visible: true } } }),
});
const without = (id, more = {}) =>
  showing(id, {}, { ...more, ...(more.regions && { regions: { box: { visible: true, texture: 'none' } } }) });
const strangers = ['frame', 'patient', 'absent', 'apart'];

test('a dose that does not fit the image and is the one shown is on no picture in no way; one that fits is, in each', async () => {
  for (const name of [...strangers, ...isUsed]) {
    const id = idOf(plans[name].doses, first(name));
    for (const [layer, kind, dose, more] of layers) {
      const [drawn, empty] = [await picture(name, showing(id, dose, more), kind), await picture(name, without(id, more), kind)];
      assert.equal(drawn.equals(empty), strangers.includes(name), `${name}, ${layer}`);
    }
  }
});

test('and no read-out nor snapshot of a room has anything of it, but the reason', async () => {
  for (const name of [...strangers, ...isUsed]) {
    const id = idOf(plans[name].doses, first(name)),
      isStranger = strangers.includes(name),
      reason = plans[name].fits.find(({ thing, with: image }) => thing === `dose:${id}` && image === 'image:ct')?.reason;
    await openPlan(daemon.url, `p-${name}`);
    const room = (await call(`${api}/rooms`, 'POST', { plan: `p-${name}` })).json.id;
    const patch = (scene) => call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' });
    const snapshot = async () => {
      const view = encodeURIComponent(JSON.stringify({ kind: 'axial', size_px: [160, 120] }));
      const answer = await fetch(`${api}/rooms/${room}/snapshot?view=${view}`);
      assert.equal(answer.status, 200);
      return Buffer.from(await answer.arrayBuffer());
    };
    assert.equal((await patch(showing(id, {}))).status, 200);
    const empty = await snapshot();
    const limits = { c: { region: 'box', quantity: 'total', metric: 'mean', limit: 1 } };
    const shown = { wash: { visible: true }, lines: { visible: true }, coverage: layers[2][2].coverage };
    assert.equal((await patch({ ...showing(id, shown), constraints: limits })).status, 200);
    assert.equal((await snapshot()).equals(empty), isStranger, `${name}, snapshot`);
    const ask = async (path) => (await call(`${api}/plans/p-${name}/${path}${path.includes('?') ? '&' : '?'}room=${room}`)).json;
    const at = 'x=14&y=14&z=9';
    const [dvh, dose, dosed, probe, profile, coverage, kept, surface, lines] = await Promise.all(
      [
        'dvh',
        'dose',
        `dose/probe?${at}`,
        `probe?${at}`,
        `profile?beam=${plans.alone.beams[0].id}`,
        'coverage',
        'constraints',
        'dose/levels/x/surface',
        'dose/isolines?view={"kind":"axial"}',
      ].map(ask),
    );
    const [limit] = kept.constraints;
    const figures = {
      dvh: dvh.curves.length,
      drawn: dose.drawn,
      probe: dosed.value ?? dosed.percent ?? dosed.components.find(({ value }) => value !== null)?.value,
      'probe of all': probe.doses.find((one) => one.id === id)?.value,
      profile: profile.curves.flatMap(({ values }) => values).find(Number.isFinite),
      coverage: coverage.volume_cm3 ?? coverage.share,
      limit: limit.value ?? limit.least ?? limit.most ?? limit.met,
      surface: surface.triangles ?? surface.area_mm2,
      lines: lines.levels.length,
    };
    for (const [read, value] of Object.entries(figures)) assert.equal(!value, isStranger, `${name}, ${read}: ${value}`);
    if (isStranger) for (const answer of [dvh, dose, dosed, profile, coverage, kept, surface]) assert.equal(answer.reason, reason, name);
    if (name === 'unstated') assert.match(dose.fit_reason, /^Dose “B” is used with CT: the files do not say whether/);
  }
});

test('where each beam has a dose and nothing has the whole plan, a new room shows their sum, and says so', async () => {
  await openPlan(daemon.url, 'p-beams');
  const { doses, treatment_plans: treatments } = (await call(`${api}/plans/p-beams`)).json;
  assert.deepEqual(
    doses.map(({ per, beam }) => [per, beam]),
    [
      ['beam', 1],
      ['beam', 2],
      ['fraction', null],
    ],
  );
  assert.deepEqual([treatments[0].beams, treatments[0].beam_doses], [2, doses.slice(0, 2).map(({ id }) => id)]);
  const room = (await call(`${api}/rooms`, 'POST', { plan: 'p-beams' })).json.id;
  const { dose } = (await call(`${api}/rooms/${room}/scene`)).json;
  assert.deepEqual(dose.sum, { [doses[1].id]: { factor: 1 } });
  const ask = async (path) => (await call(`${api}/plans/p-beams/${path}${path.includes('?') ? '&' : '?'}room=${room}`)).json;
  const patch = (scene) => call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' });
  const expected = 0.1 * (1 + 14 / 4 + 14 / 4 + 9 / 4); // of one beam at the point, trilinear
  const at = async () => {
    const { value, name, per } = await ask('dose/probe?x=14&y=14&z=9');
    return [Math.round(value * 1e6) / 1e6, name, per];
  };
  assert.deepEqual(await at(), [Math.round(2 * expected * 1e6) / 1e6, 'Sum of the doses of all 2 beams', '']);
  /** The answer about a dose that a view alone chooses, while the scene goes on to add that of beam 2: value, name, per, parts. */
  const chosen = async (id, of = 'dose/probe?x=14&y=14&z=9') => {
    const { value, name, per, parts } = await ask(`${of}&view=${encodeURIComponent(JSON.stringify({ override: { dose: { id } } }))}`);
    return [value && Math.round(value * 1e6) / 1e6, name, per, parts.map((part) => [part.id, part.used])];
  };
  const once = Math.round(expected * 1e6) / 1e6;
  const [, second, third] = doses;
  assert.deepEqual(await chosen(second.id), [once, second.name, 'beam 2 of 2', [[second.id, true]]]); // the dose shown counts once
  assert.deepEqual((await chosen(second.id, 'dvh?bins=1')).slice(1), [second.name, 'beam 2 of 2', [[second.id, true]]]);
  const ofThird = [
    once,
    third.name,
    'fraction',
    [
      [third.id, true],
      [second.id, false],
    ],
  ]; // prettier-ignore
  assert.deepEqual(await chosen(third.id), ofThird);
  assert.equal((await patch({ dose: { sum: { [doses[1].id]: null } } })).status, 200);
  assert.deepEqual(await at(), [Math.round(expected * 1e6) / 1e6, doses[0].name, 'beam 1 of 2']);
  assert.equal((await patch({ dose: { id: doses[2].id } })).status, 200);
  assert.deepEqual(await at(), [Math.round(expected * 1e6) / 1e6, doses[2].name, 'fraction']);
});

test('the program shows the dose that is asked for alone, and adds others where its scene does', async () => {
  await openPlan(daemon.url, 'p-beams');
  const out = join(root, 'out.png');
  const record = (...options) => {
    const words = ['render', join(root, 'p-beams'), '-o', out, '--size', '320x200', '--annotations', ...options];
    const { status, stderr } = spawnSync(join(bin, 'beamroom'), words, { encoding: 'utf8', timeout: 120_000 });
    assert.equal(status, 0, stderr);
    const bytes = readFileSync(out);
    const at = bytes.indexOf('iTXtbeamroom\0');
    return JSON.parse(inflateSync(bytes.subarray(at + 17, at + 4 + bytes.readUInt32BE(at - 4)))).scene.dose;
  };
  const [own, second] = (await call(`${api}/plans/p-beams`)).json.doses.map(({ id }) => id);
  assert.deepEqual(Object.keys(record().sum), [second]);
  const scene = join(root, 'scene.json');
  writeFileSync(scene, JSON.stringify({ dose: { sum: { [second]: { factor: 2 } } } }));
  const shown = (dose) => [dose.id, dose.sum];
  assert.deepEqual(shown(record('--dose', own)), [own, {}]);
  assert.deepEqual(shown(record('--dose', second)), [second, {}]);
  assert.deepEqual(shown(record('--scene', scene, '--dose', own)), [own, { [second]: { factor: 2 } }]);
});
