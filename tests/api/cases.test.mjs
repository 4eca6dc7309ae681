// Made inputs from public reports (cases in the shared data): what its README says that each must give, as the command line and the HTTP API give it.
// Every folder there has its test; a test fails for a case that has none. Unpacked by python3, tar and xz, which deploy/packages installs for tests.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, openPlan, realData, startDaemon, until } from './daemon.mjs';

const source = realData && join(realData, 'cases');
const lacks = (program, args) => spawnSync(program, args).error !== undefined;
const skip =
  !source || !existsSync(source)
    ? 'no made cases on this machine'
    : lacks('python3', ['--version']) || lacks('xz', ['--version'])
      ? 'python3 and xz are needed to unpack'
      : false;
const zips = skip
  ? []
  : readdirSync(source)
      .filter((name) => name.endsWith('.zip'))
      .map((name) => name.slice(0, -4));
const unpackZips = `import sys, zipfile, os
for name in sys.argv[3:]:
    zipfile.ZipFile(os.path.join(sys.argv[1], name + ".zip")).extractall(os.path.join(sys.argv[2], name))`;
let daemon, api, root;
const tested = [];

function run(program, args) {
  const { status, stderr } = spawnSync(program, args, { encoding: 'utf8' });
  assert.equal(status, 0, `${program}: ${stderr}`);
}

before(async () => {
  if (skip) return;
  root = mkdtempSync(join(tmpdir(), 'cases-'));
  run('python3', ['-c', unpackZips, source, root, ...zips.filter((name) => name !== 'deflate64')]); // python reads no Deflate64 either
  run('tar', ['-xJf', join(source, 'combining.tar.xz'), '-C', root]);
  cpSync(join(source, 'htj2k'), join(root, 'htj2k'), { recursive: true });
  cpSync(join(source, 'htj2k'), join(root, 'masked-image-htj2k'), { recursive: true });
  cpSync(join(root, 'masked-image'), join(root, 'masked-image-htj2k'), { recursive: true });
  daemon = await startDaemon({ plans: [root] });
  api = `${daemon.url}/api/v1`;
});
after(async () => {
  await daemon?.stop();
  if (root) rmSync(root, { recursive: true, force: true });
});

class Case {
  constructor(name, plan) {
    this.name = name;
    this.plan = plan;
  }
  /** Sentences of the report, with a code or about a file. */
  said(code, where) {
    return this.plan.report.lines
      .filter((line) => line.code === code && (where === undefined || line.where === where))
      .map(({ sentence }) => sentence);
  }
  about(where) {
    return this.plan.report.lines.filter((line) => line.where === where);
  }
  region(name) {
    return this.plan.regions.find((region) => region.name === name);
  }
  dose(id) {
    return this.plan.doses.find((dose) => dose.id === id);
  }
  fit(thing, other) {
    return this.plan.fits.find((fit) => fit.thing === thing && fit.with === other)?.relation;
  }
  names(kind) {
    return this.plan[kind].map(({ name }) => name);
  }
  /** A room with a scene. @returns asks a question about it */
  async room(scene) {
    const room = (await call(`${api}/rooms`, 'POST', { plan: this.name })).json.id;
    const patched = await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' });
    assert.equal(patched.status, 200, patched.text);
    return async (question) => {
      const { status, json, text } = await call(`${api}/plans/${this.name}/${question}${question.includes('?') ? '&' : '?'}room=${room}`);
      assert.equal(status, 200, text);
      return json;
    };
  }
}

/** One case: both ways in give the same plan, which the check then looks at. */
function given(name, sentence, check) {
  tested.push(name);
  test(`${name}: ${sentence}`, { skip }, async () => {
    const job = await openPlan(daemon.url, name);
    assert.equal(job.state, 'done', JSON.stringify(job.problem));
    const plan = (await call(`${api}/plans/${name}`)).json;
    const { stdout, stderr } = spawnSync(join(bin, 'beamroom'), ['info', '--json', join(root, name)], { encoding: 'utf8' });
    assert.ok(stdout, stderr);
    const told = JSON.parse(stdout);
    for (const key of ['images', 'regions', 'doses', 'beams', 'fits', 'patients', 'report']) assert.deepEqual(plan[key], told[key], key);
    await check(new Case(name, plan));
  });
}

const near = (value, expected, by, what = '') => assert.ok(Math.abs(value - expected) <= by, `${what} ${value}, not ${expected}`);
const shares = (dose) => {
  const highs = dose.components.map(({ high }) => high),
    all = highs.reduce((sum, high) => sum + high, 0);
  return Object.fromEntries(dose.components.map(({ quantity }, i) => [quantity, Math.round((10 * highs[i]) / all)]));
};
const fourShares = { boron: 6, nitrogen: 1, fast: 1, gamma: 2 };

given('two-patients', 'two patients are named, and the dose of one is not used with the CT of the other', async (made) => {
  assert.match(made.said('patient.several')[0], /2 patients: A\. A\. …A and B\. B\. …B/);
  const other = made.plan.images.find(({ patient }) => patient !== made.plan.doses[0].patient).id;
  assert.equal(made.fit('dose:dose', `image:${other}`), 'patient');
  const ask = await made.room({ image: { id: other }, dose: { id: 'dose' } });
  const { value, fit, fit_reason: reason } = await ask('dose/probe?x=0&y=0&z=1');
  assert.deepEqual([value, fit], [null, 'patient']);
  assert.match(reason, /belongs to another patient/);
  assert.deepEqual((await ask('dvh')).curves, []);
});

given('ct-mr-other-frame', 'the dose in the frame of the CT differs from the MR, alone or blended', async (made) => {
  assert.deepEqual([made.fit('dose:dose', 'image:ct'), made.fit('dose:dose', 'image:mr')], ['same', 'frame']);
  for (const image of [{ id: 'mr' }, { id: 'mr', blend: { id: 'ct', opacity: 0.5 } }]) {
    const { value, fit } = await (await made.room({ image, dose: { id: 'dose' } }))('dose/probe?x=0&y=0&z=-41');
    assert.deepEqual([value, fit], [null, 'frame']);
  }
  near((await (await made.room({ image: { id: 'ct' }, dose: { id: 'dose' } }))('dose/probe?x=0&y=0&z=-41')).value, 20 - 0.2 * 41, 1e-3); // 20 + 0.1x + 0.05y + 0.2z
});

given('seg-sparse', 'two lesions far apart are two regions, the CT opens, and nothing is called empty', (made) => {
  assert.deepEqual(
    made.plan.images.map(({ grid }) => grid.size[2]),
    [200],
  );
  assert.deepEqual(
    made.plan.regions.map(({ volume_cm3: volume }) => volume),
    [0.288, 0.288],
  );
  near(Math.abs(made.plan.regions[0].center_mm[2] - made.plan.regions[1].center_mm[2]), 168 + 4, 8, 'distance'); // mm, between 3 and 3 frames
  assert.deepEqual(made.said('region.none'), []);
});

for (const [name, words] of [
  ['seg-labelmap', /label map segmentation/],
  ['seg-labelmap-rle', /label map segmentation/],
  ['seg-deflated-frame', /deflated image frames, 1\.2\.840\.10008\.1\.2\.8\.1/],
])
  given(name, 'what is not read yet is named and hides nothing else', (made) => {
    assert.deepEqual([made.plan.images.length, made.plan.regions.length], [1, 0]);
    assert.match(made.about('seg.dcm')[0].sentence, words);
    assert.notEqual(made.about('seg.dcm')[0].severity, 'note');
  });

given('names-first-dot', 'names keep their dots', (made) => {
  assert.deepEqual(made.names('regions').sort(), ['case7.liver_mask', 'case7.spleen_mask']);
  const images = made.plan.images.map(({ id }) => id);
  assert.ok(images.includes('sub-01-ses-2-t1w') && images.includes('sub-01-ses-2-t2w'), `${images}`);
});

for (const name of ['openpint-names', 'dose-words-nifti'])
  given(name, 'files of components are one dose, and the CT is first', (made) => {
    assert.deepEqual(made.plan.doses.map(shares), [fourShares]);
    assert.match(made.plan.images[0].id, /ct$/);
    assert.match(made.said('dose.components')[0], /put together by the names of 4 files/);
  });

for (const [name, file] of [
  ['label-float64', 'segmentation.nii.gz'],
  ['label-float-nrrd', 'Segmentation-label.nrrd'],
])
  given(name, 'whole numbers stored as floats are labels', (made) => {
    assert.deepEqual(
      made.plan.regions.map(({ voxels }) => voxels),
      [288, 216],
    );
    assert.deepEqual(
      made.plan.images.map(({ id }) => id),
      ['ct'],
    );
    assert.deepEqual(made.said('file.read', file), ['Read as regions.']);
  });

given('one-mask-cut', 'a mask that is cut short is named, and the CT opens', (made) => {
  assert.deepEqual(
    made.plan.images.map(({ grid }) => grid.size[2]),
    [30],
  );
  const [line] = made.about('gtv_mask.nii.gz');
  assert.equal(line.severity, 'error');
  assert.match(line.sentence, /gtv_mask\.nii\.gz: the gzip stream is cut short/);
});

given('sform-qform-sides', 'left on opposite sides is said', (made) =>
  assert.match(made.said('geometry.forms-disagree')[0], /to the patient's right by sform, to the left by qform/),
);

given('mr-padding', 'the window comes from the pixels that were measured', (made) => {
  const { low, high, window } = made.plan.images[0];
  assert.ok(low >= -800 && high <= -200, `${low} to ${high}`); // x + 3y + 10z; the padding is -32768
  assert.ok(window.center - window.width / 2 > -800 && window.center + window.width / 2 < 0, JSON.stringify(window));
  assert.match(made.said('image.padding')[0], /720 of 4800 pixels/);
});

given('japanese-ir13-ir87', 'names in two sets of characters', (made) =>
  assert.deepEqual(made.names('regions'), ['ｼｭﾖｳ 腫瘍', '腫瘍 GTV']),
);

given('unknown-files-beside', 'each file that is not read is named', (made) => {
  assert.equal(made.plan.images.length, 1);
  for (const file of [
    'meshtal',
    'deposit.out',
    'dose.vti',
    'brain.stl',
    'case.mat',
    'DoseAtPhantom.csv',
    'report.pdf',
    'thumbs.db',
    'plan.xlsx',
  ])
    assert.match(made.said('file.not-read', file)[0] ?? '', /^Not read: ./, file);
});

given('masked-image', 'an image called masked stays one', (made) =>
  assert.deepEqual([made.names('images').length, made.plan.regions.length], [2, 0]),
);

given('lowdose-ct', 'a CT of low dose is no dose', (made) =>
  assert.deepEqual([made.plan.images.map(({ id }) => id), made.plan.doses], [['high-dose-ct', 'lowdose-ct'], []]),
);

given('nnunet-prediction', 'the prediction is regions, and the image comes first', (made) => {
  assert.deepEqual([made.plan.images.map(({ id }) => id), made.plan.regions.map(({ voxels }) => voxels)], [['brats-001-0000'], [288, 216]]);
});

given('dose-grid-smaller', 'the volume without a dose stands with the histogram, and its figures are bounds', async (made) => {
  const [curve] = (await (await made.room({}))('dvh')).curves;
  near(curve.volume_cm3, 84.9, 0.05);
  near(curve.missing_cm3, 69.5, 0.05);
  assert.deepEqual([curve.is_partial, curve.mean, curve.least.min], [true, null, 0]);
});

test('htj2k: alone it is refused by its name; beside images it is named and hides none', { skip }, async () => {
  const words = /CT1_JPH\.dcm: .*High-Throughput JPEG 2000 lossless, RPCL \(1\.2\.840\.10008\.1\.2\.4\.202\)/;
  const opened = await call(`${api}/plans/htj2k/open`, 'POST'); // refused at once where the list of plans has already seen it
  const problem =
    opened.status === 202
      ? (
          await until(
            async () => (await call(`${api}/jobs/${opened.json.id}`)).json,
            ({ state }) => state !== 'running',
          )
        ).problem
      : opened.json;
  assert.match(problem?.detail ?? opened.text, words);
});

given('masked-image-htj2k', 'an encoding that is not read hides no image', (made) => {
  assert.equal(made.plan.images.length, 2);
  assert.match(
    made
      .about('CT1_JPH.dcm')
      .map(({ sentence }) => sentence)
      .join(' '),
    /High-Throughput JPEG 2000/,
  );
});

test('deflate64: the refusal says so, and not "damaged"', { skip }, async () => {
  const sent = await fetch(`${api}/plans`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/zip' },
    body: readFileSync(join(source, 'deflate64.zip')),
  });
  const { id } = await sent.json();
  const job = await until(
    async () => (await call(`${api}/jobs/${id}`)).json,
    ({ state }) => state !== 'running' && state !== 'queued',
  );
  assert.equal(job.state, 'failed');
  assert.match(job.problem.detail, /Deflate64/);
  assert.doesNotMatch(job.problem.detail, /damaged/);
});

given('f01-two-doses-one-other-frame', 'a dose of another frame that nobody accepted is not added', async (made) => {
  const answer = await (await made.room({ dose: { id: 'a', sum: { b: { factor: 1 } } } }))('dvh');
  near(answer.curves[0].mean, 19.7, 0.005);
  const part = answer.parts.find(({ id }) => id === 'b');
  assert.equal(part.used, false);
  assert.match(part.reason, /another frame of reference/);
});

given('d76-dose-mr-and-ct', 'the dose in the frame of the MR does not fit the CT', (made) =>
  assert.deepEqual([made.fit('dose:dose', 'image:ct'), made.fit('dose:dose', 'image:mr')], ['frame', 'same']),
);

given('u01-gy-and-cgy', 'Gy and cGy are brought to one unit', async (made) => {
  const compared = await (await made.room({ dose: { id: 'a', compare: { id: 'b' } } }))('dvh');
  assert.deepEqual(
    compared.curves.map(({ dose, mean, unit }) => [dose, mean, unit]),
    [
      ['a', 30, 'Gy'],
      ['b', 15, 'Gy'],
    ],
  );
  assert.equal((await (await made.room({ dose: { id: 'a', sum: { b: { factor: 1 } } } }))('dvh')).curves[0].mean, 45);
  assert.equal((await (await made.room({ dose: { id: 'a', compare: { id: 'b', mode: 'difference' } } }))('gamma')).difference.mean, -15);
});

given(
  'u04-matrix',
  'per plan, per fraction, per minute and no unit: added and compared where that means something, else refused with the reason',
  async (made) => {
    for (const [id, reason] of [
      ['b', null],
      ['c', /per fraction, that one per plan/],
      ['d', /does not say its unit/],
      ['e', /per minute, that one per plan/],
    ]) {
      const ask = await made.room({ dose: { id: 'a', sum: { [id]: { factor: 1 } }, compare: { id } } });
      const sum = await ask('dvh'),
        gamma = await ask('gamma');
      const part = sum.parts.find((each) => each.id === id);
      near(sum.curves[0].mean, 7.740322757 * (id === 'b' ? 1.01 : 1), 1e-5, id); // the same numbers in cGy are a hundredth; the mean is numpy's
      assert.equal(part.used, reason === null);
      assert.equal(sum.curves.length, reason === null ? 2 : 1, id);
      if (reason) assert.match(part.reason, reason);
      if (reason) assert.match(gamma.comparison_reason, reason);
      assert.equal(gamma.difference.mean === null, reason !== null, id);
    }
  },
);

given('s03-duplicate-contours', 'contours given twice count once', (made) => {
  assert.equal(made.plan.regions.length, 6);
  for (const { name, volume_cm3: volume } of made.plan.regions) near(volume, 78.4, 0.784, name); // on voxels of 30 mm3
});

given('s02-overlapping', 'the union of overlapping contours is filled, and said', (made) => {
  assert.equal(made.region('two-overlapping').volume_cm3, 48);
  assert.match(made.said('region.contours-overlap')[0], /Their union was filled: 48 cm3/);
});

given('d32-other-patient', 'both patients are named, and the dose of the other is never used', (made) => {
  assert.match(made.said('patient.several')[0], /N\. T\. …1 and N\. T\. …R/);
  assert.equal(made.fit('dose:dose', 'image:ct'), 'patient');
});

given('c33-two-patients-two-cts', 'both patients are named, and their CTs are not blended', (made) => {
  assert.match(made.said('patient.several')[0], /N\. T\. …ENT and N\. T\. …1/);
  assert.deepEqual([made.fit('image:ct-2', 'image:ct'), made.fit('image:ct', 'image:ct-2')], ['patient', 'patient']);
});

given('d44-two-plans', 'doses and beams have the name of their plan', (made) => {
  assert.deepEqual(
    [made.names('doses'), made.names('beams')],
    [
      ['planA, Dose', 'planB, Dose'],
      ['planA, B1', 'planB, B1'],
    ],
  );
  assert.equal(made.fit('beam:planb-b1', 'dose:plana-dose'), 'plan');
});

given('d45-same-uid-other-values', 'one UID with other values is no copy', (made) => {
  assert.deepEqual(
    made.plan.doses.map(({ components: [{ high }] }) => Math.round(high * 1000)),
    [36725, 18362],
  );
  assert.equal(made.said('dicom.same-uid').length, 1);
});

given('d46-dose-of-absent-plan', 'a plan that is not here is said', (made) => {
  assert.match(made.said('dose.plan-absent', 'doseB.dcm')[0], /refers to a treatment plan \(RTPLAN\) that is not in this folder/);
  assert.equal(made.fit('dose:dose', 'image:ct'), 'absent');
});

given('d41-plan-and-beams', 'the dose of the plan is first', (made) =>
  assert.deepEqual(
    made.plan.doses.map(({ per }) => per),
    ['plan', 'beam', 'beam'],
  ),
);

given('d50-photon-plan-and-neutron-boost', 'words alone join nothing', (made) => {
  assert.deepEqual(
    made.plan.doses.map(({ components }) => components.map(({ quantity }) => quantity)),
    [['total'], ['total']],
  );
  assert.match(made.said('dose.words-not-joined')[0], /each is a dose of its own/);
});

given('c26-padding-value', 'the padding value is no HU', (made) => {
  assert.ok(made.plan.images[0].low > -1000, `${made.plan.images[0].low}`);
  assert.match(made.said('image.padding')[0], /stored as -2000/);
});

given('d71-more-pixels-than-frames', 'surplus frames are said', (made) =>
  assert.match(made.said('dicom.surplus-pixels', 'dose.dcm')[0], /\(4 frames more\)/),
);

given('g04-identical', 'a difference has no artefact at the border', async (made) => {
  const { difference } = await (await made.room({ dose: { id: 'a', compare: { id: 'b', mode: 'difference' } } }))('gamma');
  near(difference.high, 0.0571967, 1e-5); // both by numpy, the second field tri-linear at the voxels of the first
  near(difference.low, -0.5267307, 1e-5); // at the peak, where a straight line lies below it
});

given('d79-sum-of-unequal-grids', 'a sum does not depend on its order', async (made) => {
  const [one, other] = await Promise.all(
    [
      ['big', 'small'],
      ['small', 'big'],
    ].map(async ([id, added]) => {
      const ask = await made.room({ dose: { id, sum: { [added]: { factor: 1 } } } });
      const {
        curves: [{ missing_cm3: missing, least, counts_cm3: counts }],
      } = await ask('dvh');
      return {
        missing,
        least,
        counts,
        at: await Promise.all(
          [
            [0, 0, 0],
            [40, 40, 0],
            [3, 2, 1],
          ].map(async ([x, y, z]) => (await ask(`dose/probe?x=${x}&y=${y}&z=${z}`)).value),
        ),
      };
    }),
  );
  assert.deepEqual(one, other);
  near(one.at[0], 40, 1e-4); // 20 and 20 Gy at the origin
});

test('every case of the shared data has its test', { skip }, () => {
  assert.deepEqual(
    readdirSync(root).filter((name) => !['htj2k', ...tested].includes(name)),
    [],
  );
});
