// `beamroom transport`: what it uses of a plan and a beam file, what it writes, its refusals.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { gunzipSync, gzipSync } from 'node:zlib';
import { realData } from './daemon.mjs';
import { putImages, putPlan, putStructs } from './made_dicom.mjs';

const bin = join(process.env.BEAMROOM_BIN ?? 'build/release', 'beamroom');
const beamroom = (...args) => {
  const { status, stdout, stderr } = spawnSync(bin, args, { encoding: 'utf8', timeout: 120_000 });
  return { status, stdout, stderr };
};

/** A dose's values from a written plan: NIfTI-2, 544 bytes before the voxels. */
const readVolume = (dir, dose, quantity) => {
  const bytes = gunzipSync(readFileSync(join(dir, 'doses', `${dose}_${quantity}.nii.gz`)));
  return { bytes, floats: Array.from({ length: (bytes.length - 544) / 4 }, (_, i) => bytes.readFloatLE(544 + 4 * i)) };
};

let folder;
let plan;
before(() => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-transport-'));
  plan = join(folder, 'head one');
  const made = beamroom('phantom', plan, '--size', '96x96x64', '--seed', '5');
  assert.equal(made.status, 0, made.stderr);
});
after(() => rmSync(folder, { recursive: true, force: true }));

describe('beamroom transport', () => {
  it('adds a dose with errors to the plan, the same for a seed, and says what it assumed', () => {
    const beam = join(folder, 'beam.json');
    writeFileSync(
      beam,
      JSON.stringify({
        format: 'beamroom-beam',
        version: 1,
        name: 'made',
        per: 'minute',
        spectrum: { radius_mm: 50, neutrons: { energy_ev: [1e4, 0.5], share: [1], per_cm2: 1e10 } },
        materials: { brain: { icru46: 'brain', ppm: 15 }, cranium: { g_cm3: 1.6, weights: { H: 0.05, C: 0.2, O: 0.45, Ca: 0.3 } } },
      }),
    );
    const outs = ['one', 'two'].map((name) => join(folder, `simulated ${name}`));
    for (const out of outs) {
      const { status, stdout, stderr } = beamroom('transport', plan, '-o', out, '--beam', beam, '--histories', '4000');
      assert.equal(status, 0, stderr);
      assert.match(stdout, /^ {2}brain .* brain, 1\.04 g\/cm3, 15 ppm of boron-10$/m);
      assert.match(stdout, /^ {2}cranium .* own, 1\.6 g\/cm3, 0 ppm of boron-10$/m);
      assert.match(stdout, /^approximate, not for treatment$/m);
    }
    const [before, after] = [plan, outs[0]].map((dir) => JSON.parse(beamroom('info', dir, '--json').stdout));
    assert.equal(after.doses.length, before.doses.length + 1);
    assert.deepEqual(
      after.regions.map((region) => region.id),
      before.regions.map((region) => region.id),
    );
    const dose = after.doses.at(-1);
    assert.equal(dose.name, 'Simulated here, approximate');
    assert.equal(dose.per, 'minute');
    assert.deepEqual(dose.components.map((component) => component.quantity).sort(), [
      ...['boron', 'epithermal-fluence', 'fast', 'fast-fluence', 'gamma', 'nitrogen', 'thermal-fluence'],
    ]);
    for (const file of ['boron', 'boron-error', 'gamma', 'valid']) {
      const [one, two] = outs.map((out) => readFileSync(join(out, 'doses', `${dose.id}_${file}.nii.gz`)));
      assert.ok(one.equals(two), `${file} is the same for a seed`);
    }
    const hybrid = join(folder, 'simulated hybrid');
    const quick = beamroom('transport', plan, '-o', hybrid, '--beam', beam, '--histories', '2000', '--mode', 'hybrid');
    assert.equal(quick.status, 0, quick.stderr);
    assert.match(JSON.parse(readFileSync(join(hybrid, 'plan.json'), 'utf8')).note, /transport model \d+ in hybrid mode, 2000 histories/);
    const again = beamroom('transport', plan, '-o', outs[0], '--beam', beam);
    assert.equal(again.status, 1);
    assert.match(again.stderr, /is there already and is not empty/);
  });

  it('takes the particles of another program, and asks how many real ones they stand for', () => {
    // 2000 neutrons of 1 keV and an electron, along the file's +x from a disk of 5 cm at x = 40: MCPL with one weight for all.
    const n = 2001;
    const head = Buffer.alloc(61);
    head.write('MCPL003L');
    head.writeBigUInt64LE(BigInt(n), 8);
    for (const [at, value] of [
      [32, 1],
      [40, 32],
      [44, 1],
      [56, 1],
    ])
      head.writeUInt32LE(value, at);
    head.writeDoubleLE(0.5, 48);
    head.write('t', 60);
    const body = Buffer.alloc(n * 32);
    for (let i = 0; i < n; i++) {
      const radius = 5 * Math.sqrt(i / n);
      // A direction is 1 / z, y, and the sign of the energy for x, its largest component.
      const numbers = [40, radius * Math.cos(2.4 * i), radius * Math.sin(2.4 * i), Infinity, 0, 1e-3, 0];
      for (const [k, value] of numbers.entries()) body.writeFloatLE(value, i * 32 + 4 * k);
      body.writeInt32LE(i ? 2112 : 11, i * 32 + 28);
    }
    writeFileSync(join(folder, 'it.mcpl'), Buffer.concat([head, body]));
    const beam = join(folder, 'particles.json');
    const made = { format: 'beamroom-beam', version: 1, per: 'minute', entry_mm: [0, 0, 120], target_mm: [0, 0, 0] };
    const particles = { file: 'it.mcpl', neutrons_per_unit: 1e12, origin_mm: [400, 0, 0], direction: [1, 0, 0], across: [0, 0, 1] };
    const run = (out, ...more) => beamroom('transport', plan, '-o', join(folder, out), '--histories', '2000', ...more);
    writeFileSync(beam, JSON.stringify({ ...made, particles: { ...particles, across_lps: [1, 1, 0] } }));
    const { status, stdout, stderr } = run('of particles', '--beam', beam);
    assert.equal(status, 0, stderr);
    assert.match(stdout, /^particles of it\.mcpl, by t, read in cm and MeV:$/m);
    assert.match(stdout, /1 particles that are neither neutrons nor photons, left out/);
    assert.match(stdout, /centre is 40, 0, 0 cm in the file; the beam goes to 1, 0, 0; its x is 0, 0, 1$/m);
    assert.match(stdout, /that x lies along 0\.707, 0\.707, -?0\.000 in patient LPS$/m);
    assert.match(stdout, /^ {2}2000 neutrons, 1e\+12 per unit of the source$/m);
    // A spectrum of the same beam gives the same dose within the noise.
    const spectrum = {
      radius_mm: 50,
      neutrons: { energy_ev: [1001, 1000], share: [1], per_cm2: 1e12 / (25 * Math.PI), by_lethargy: true },
    };
    writeFileSync(beam, JSON.stringify({ ...made, spectrum }));
    assert.equal(run('of a spectrum', '--beam', beam).status, 0);
    const sums = ['of particles', 'of a spectrum'].map((out) => {
      const { id } = JSON.parse(beamroom('info', join(folder, out), '--json').stdout).doses.at(-1);
      const file = gunzipSync(readFileSync(join(folder, out, 'doses', `${id}_thermal-fluence.nii.gz`)));
      let sum = 0;
      for (let at = Number(file.readBigInt64LE(168)); at < file.length; at += 4) sum += file.readFloatLE(at);
      return sum;
    });
    assert.ok(Math.abs(sums[0] / sums[1] - 1) < 0.15, `${sums}`);
    for (const [change, sentence] of [
      [{ neutrons_per_unit: undefined }, /neutrons_per_unit: expected either "neutrons_per_unit" or "histories_per_unit"/],
      [{ neutrons_per_unit: undefined, histories_per_unit: 1 }, /it\.mcpl does not say how many histories it comes of/],
      [{ file: 'none.mcpl' }, /none\.mcpl: the file of particles is not there/],
      [{ direction: [-1, 0, 0] }, /of 2000 neutrons 0 go through the aperture plane/],
      [{ across: [2, 0, 0] }, /are parallel/],
      [{ across_lps: [0, 0, 1] }, /across_lps has no part across the beam/],
    ]) {
      writeFileSync(beam, JSON.stringify({ ...made, particles: { ...particles, ...change } }));
      const refused = run('refused', '--beam', beam);
      assert.equal(refused.status, 1);
      assert.match(refused.stderr, sentence);
    }
    const bare = run('refused', '--beam', join(folder, 'it.mcpl'), '--entry', '0,0,120', '--target', '0,0,0');
    assert.match(bare.stderr, /it\.mcpl does not say how many real neutrons it stands for; --neutrons-per-unit does/);
    assert.match(
      run('refused', '--beam', join(folder, 'it.mcpl'), '--neutrons-per-unit', '1').stderr,
      /where its aperture is in the patient/,
    );
    assert.match(run('refused', '--beam', 'goorley', '--neutrons-per-unit', '1e9').stderr, /is for files of particles/);
    assert.ok(!existsSync(join(folder, 'refused')));
  });

  it("gives the dose in the plan's unit, on cells of the size asked for, and notes it in whatever note there is", () => {
    const simulate = (name, unit, note, ...more) => {
      const dir = join(folder, `in ${name}`);
      cpSync(plan, dir, { recursive: true });
      const text = JSON.parse(readFileSync(join(dir, 'plan.json'), 'utf8'));
      text.doses[0].unit = unit;
      writeFileSync(join(dir, 'plan.json'), JSON.stringify({ ...text, note }));
      const { status, stderr } = beamroom('transport', dir, '-o', `${dir} out`, '--histories', '1000', ...more);
      assert.equal(status, 0, stderr);
      const values = (quantity) => readVolume(`${dir} out`, 'simulated-here', quantity);
      return { written: JSON.parse(readFileSync(join(`${dir} out`, 'plan.json'), 'utf8')), values };
    };
    const long = 'ä'.repeat(255);
    const [gy, cgy] = [simulate('Gy', 'Gy', 'Short.'), simulate('cGy', 'cGy', long)];
    const said = "Dose 'simulated-here': beamroom ";
    assert.ok(gy.written.note.startsWith(`Short. ${said}`), gy.written.note);
    assert.match(cgy.written.note, /^ä+\.\.\. Dose 'simulated-here': .*; approximate, not for treatment\.$/);
    assert.deepEqual(
      [gy, cgy].map(({ written }) => written.doses.at(-1).unit),
      ['Gy', 'cGy'],
    );
    for (const quantity of ['boron', 'gamma', 'boron-error']) {
      const [one, hundred] = [gy, cgy].map(({ values }) => values(quantity).floats);
      assert.ok(one.some((value) => value > 0));
      assert.ok(
        one.every((value, i) => Math.abs(hundred[i] - 100 * value) <= 1e-6 * hundred[i]),
        quantity,
      );
    }
    assert.ok(gy.values('thermal-fluence').bytes.equals(cgy.values('thermal-fluence').bytes), 'a fluence has no gray');
    const coarse = simulate('coarse', 'Gy', '', '--cells', '10').values('boron');
    assert.deepEqual(
      [112, 120, 128].map((at) => Math.round(1e6 * coarse.bytes.readDoubleLE(at)) / 1e6),
      [10, 10, 10],
    );
  });

  it('refuses a beam or a region that is not there by its name', () => {
    const out = join(folder, 'not simulated');
    const none = beamroom('transport', plan, '-o', out, '--beam', join(folder, 'none.json'));
    assert.equal(none.status, 1);
    assert.match(
      none.stderr,
      /none\.json: no such file, and no beam of the library \(fir1-like, goorley, mono-10ev, mono-100ev, mono-1kev, mono-10kev\)/,
    );
    const beam = join(folder, 'other.json');
    const made = { format: 'beamroom-beam', version: 1, source: 'x.source' };
    for (const [change, sentence] of [
      [{ source: '../x.source' }, /source/],
      [{ source: 'x.source' }, /x\.source: the beam file names it, and it is not there/],
      [{ version: 2 }, /version: this program reads version 1/],
      [{ spectrum: { radius_mm: 5 }, source: undefined }, /spectrum\.neutrons/],
    ]) {
      writeFileSync(beam, JSON.stringify({ ...made, ...change }));
      const refused = beamroom('transport', plan, '-o', out, '--beam', beam);
      assert.equal(refused.status, 1);
      assert.match(refused.stderr, sentence);
    }
    const spectrum = { radius_mm: 5, neutrons: { energy_ev: [2, 1], share: [1], per_cm2: 1 } };
    for (const [materials, sentence] of [
      [{ spleen: { icru46: 'brain' } }, /no region 'spleen'/],
      [{ brain: { icru46: 'cheese' } }, /'cheese' is no material/],
      [{ brain: { g_cm3: 1, weights: { Xx: 1 } } }, /'Xx' is no element/],
    ]) {
      writeFileSync(beam, JSON.stringify({ ...made, source: undefined, spectrum, materials }));
      const refused = beamroom('transport', plan, '-o', out, '--beam', beam);
      assert.equal(refused.status, 1);
      assert.match(refused.stderr, sentence);
    }
    assert.ok(!existsSync(out));
  });

  it('gives each region the material of its name, none to what shapes a dose, and knows equal materials', () => {
    const text = (name) => readFileSync(join(plan, name), 'utf8');
    const volume = gunzipSync(readFileSync(join(plan, 'labels.nii.gz')));
    const { labels } = JSON.parse(text('labels.json'));
    for (let node = 0, at = volume.indexOf(3, 352); node < 40; node++, at = volume.indexOf(3, at)) {
      labels.push({ value: 10 + node, name: `node ${node}` });
      volume[at] = 10 + node;
    }
    const simulate = (target) => {
      const [dir, out] = [join(folder, `with ${target}`), join(folder, `with ${target} out`)];
      const named = (json) => json.replaceAll('"target"', `"${target}"`);
      mkdirSync(dir);
      const { format, version, hierarchy, beams, regions } = JSON.parse(named(text('plan.json')));
      writeFileSync(join(dir, 'plan.json'), JSON.stringify({ format, version, hierarchy, beams, regions }));
      writeFileSync(join(dir, 'labels.json'), named(JSON.stringify({ labels })));
      writeFileSync(join(dir, 'labels.nii.gz'), gzipSync(volume, { level: 1 }));
      const { status, stdout, stderr } = beamroom('transport', dir, '-o', out, '--histories', '2000');
      assert.equal(status, 0, stderr);
      return { stdout, out };
    };
    const target = simulate('target');
    assert.match(target.stdout, /^ {2}cranium +cranium \(by its name\), 1\.61 g\/cm3/m);
    assert.match(target.stdout, /^ {2}node 39 +soft-tissue \(assumed: the name tells nothing\)/m);
    const ring = simulate('Ring');
    assert.match(ring.stdout, /^ {2}Ring +no material of its own/m);
    for (const file of ['boron', 'valid']) {
      const [one, two] = [target, ring].map(({ out }) => readFileSync(join(out, 'doses', `simulated-here_${file}.nii.gz`)));
      assert.ok(one.equals(two), `${file}: a ring's voxels have the material around it`);
    }
  });

  it('leaves air that a region says is air where a ring of another file lies over it', () => {
    const [dir, out] = ['ring over air', 'ring over air out'].map((name) => join(folder, name));
    mkdirSync(dir);
    const labels = gunzipSync(readFileSync(join(plan, 'labels.nii.gz')));
    const ring = Buffer.from(labels);
    for (let at = 352; at < ring.length; at++) ring[at] = ring[at] >= 3 ? 1 : 0;
    writeFileSync(join(dir, 'labels.nii.gz'), gzipSync(labels, { level: 1 }));
    writeFileSync(join(dir, 'ring.nii.gz'), gzipSync(ring, { level: 1 }));
    writeFileSync(join(dir, 'labels.json'), readFileSync(join(plan, 'labels.json'), 'utf8').replace('"target"', '"Airway"'));
    writeFileSync(join(dir, 'ring.json'), JSON.stringify({ labels: [{ value: 1, name: 'Ring' }] }));
    const { format, version, beams, regions } = JSON.parse(readFileSync(join(plan, 'plan.json'), 'utf8'));
    const hierarchy = { scalp: ['cranium'], cranium: ['brain'], brain: ['Airway', 'Ring'], Airway: ['tumour'] };
    const doses = [[], [{ path: 'ring.nii.gz', names: 'ring.json' }]].map((more) => {
      const inside = more.length ? hierarchy : { ...hierarchy, brain: ['Airway'] };
      writeFileSync(join(dir, 'plan.json'), JSON.stringify({ format, version, beams, regions: [...regions, ...more], hierarchy: inside }));
      rmSync(out, { recursive: true, force: true });
      const { status, stdout, stderr } = beamroom('transport', dir, '-o', out, '--histories', '2000');
      assert.equal(status, 0, stderr);
      assert.match(stdout, /^ {2}Airway +air \(by its name\)$/m);
      assert.equal(/^ {2}Ring +no material of its own/m.test(stdout), more.length > 0);
      return ['boron', 'valid'].map((quantity) => readVolume(out, 'simulated-here', quantity).bytes);
    });
    for (const i of [0, 1]) assert.ok(doses[0][i].equals(doses[1][i]), 'a ring changes no material');
  });

  // seraMC's dose of its sample head, in its unit and cells; 5 % on the sum, and 15 % cell by cell: twice the noise of 40,000 histories.
  it("gives seraMC's dose of its sample head", { skip: !realData }, () => {
    const [head, out] = [join(realData, 'sera-head'), join(folder, 'as seraMC')];
    const made = beamroom('transport', head, '--beam', join(head, 'beam.json'), '-o', out, '--sera-cells', '--histories', '40000');
    assert.equal(made.status, 0, made.stderr);
    const { doses } = JSON.parse(readFileSync(join(out, 'plan.json'), 'utf8'));
    assert.equal(doses.at(-1).unit, doses[0].unit);
    for (const [quantity, within] of Object.entries({ boron: 0.05, nitrogen: 0.05, 'thermal-fluence': 0.05, gamma: 0.09 })) {
      const [theirs, ours] = ['seramc', 'simulated-here'].map((dose) => readVolume(out, dose, quantity).floats);
      const most = Math.max(...theirs);
      let [sum, expected, apart] = [0, 0, 0];
      for (const [i, value] of theirs.entries()) {
        if (value < 0.3 * most) continue;
        sum += ours[i];
        expected += value;
        apart += Math.abs(ours[i] - value);
      }
      assert.ok(Math.abs(sum / expected - 1) < within, `${quantity}: ${sum / expected}`);
      assert.ok(apart / expected < 0.15, `${quantity}, cell by cell: ${apart / expected}`);
    }
  });

  // SERA's sample head: its tracks begin in the source's disk, 50 mm before the aperture plane of its beam.json.
  it('puts the aperture as far before the source of a beam of the plan as the beam file says', { skip: !realData }, () => {
    const head = join(realData, 'sera-head');
    const here = mkdtempSync(join(folder, 'pose-'));
    const { entry_mm, target_mm, ...file } = JSON.parse(readFileSync(join(head, 'beam.json'), 'utf8'));
    copyFileSync(join(head, file.source), join(here, 'x.source'));
    writeFileSync(join(here, 'beam.json'), JSON.stringify({ ...file, source: 'x.source' }));
    const made = beamroom('transport', head, '-o', join(here, 'out'), '--beam', join(here, 'beam.json'), '--histories', '16');
    assert.equal(made.status, 0, made.stderr);
    const [aperture, axis] = made.stdout
      .match(/aperture at (.*), to (.*) mm$/m)
      .slice(1, 3)
      .map((text) => text.split(', ').map(Number));
    assert.ok(Math.hypot(...aperture.map((value, i) => value - entry_mm[i])) < 1, `${aperture}`);
    const [way, expected] = [
      [aperture, axis],
      [entry_mm, target_mm],
    ].map(([from, to]) => to.map((value, i) => value - from[i]));
    const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
    assert.ok(dot(way, expected) / Math.hypot(...way) / Math.hypot(...expected) > 0.9999);
  });

  it('uses no part of another patient or frame, and takes no aperture from a treatment plan', () => {
    const anna = { id: 'A-1001', name: 'Alpha^Anna', birthDate: '19610412' };
    const berta = { id: 'B-2002', name: 'Beta^Berta', birthDate: '19701231' };
    const other = { uid: '1.2.65', file: 'structs-z.dcm', name: 'Zother' };
    const simulate = (name, put, ...more) => {
      const dir = join(folder, `gate-${name}`);
      mkdirSync(dir);
      putImages(dir, anna);
      putStructs(dir, anna);
      put(dir);
      return beamroom('transport', dir, '-o', `${dir}-out`, '--histories', '2000', ...more);
    };
    const pose = ['--entry', '20,8,-60', '--target', '20,8,6'];
    const alone = simulate('alone', () => {}, ...pose);
    assert.equal(alone.status, 0, alone.stderr);
    const patient = simulate('patient', (dir) => putStructs(dir, berta, other), ...pose);
    assert.equal(patient.status, 0, patient.stderr);
    assert.match(patient.stdout, /^ {2}Zother +left out: of another patient$/m);
    assert.match(patient.stderr, /another patient/);
    for (const file of ['boron', 'gamma', 'valid']) {
      const [one, two] = ['alone', 'patient'].map((name) =>
        readFileSync(join(folder, `gate-${name}-out`, 'doses', `simulated-here_${file}.nii.gz`)),
      );
      assert.ok(one.equals(two), `${file} is that of the folder without the other patient`);
    }
    const frame = simulate('frame', (dir) => putStructs(dir, { ...anna, frame: '1.2.49', study: '1.2.39' }, other), ...pose);
    assert.equal(frame.status, 1);
    assert.match(frame.stderr, /frame of reference/);
    const treatment = simulate('treatment', (dir) => putPlan(dir, anna, { approval: 'APPROVED' }));
    assert.equal(treatment.status, 1);
    assert.match(treatment.stderr, /is of a treatment plan, and its entry is the source; --entry and --target say where the aperture is/);
    for (const name of ['frame', 'treatment']) assert.ok(!existsSync(join(folder, `gate-${name}-out`)));
  });
});
