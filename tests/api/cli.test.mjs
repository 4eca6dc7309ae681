// The program `beamroom`: its output, its refusals, its exit codes.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { inflateSync } from 'node:zlib';
import { web } from './daemon.mjs';
import { parseStrict } from './strict_json.mjs';

const bin = join(process.env.BEAMROOM_BIN ?? 'build/release', 'beamroom');
const beamroom = (...args) => {
  const { status, stdout, stderr } = spawnSync(bin, args, { encoding: 'utf8', timeout: 120_000 });
  return { status, stdout, stderr };
};

let folder;
let plan;
before(() => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-cli-'));
  plan = join(folder, 'head one');
  const made = beamroom('phantom', plan, '--size', '96x96x64', '--seed', '5');
  assert.equal(made.status, 0, made.stderr);
});
after(() => rmSync(folder, { recursive: true, force: true }));

describe('beamroom', () => {
  it('explains itself and each command', () => {
    const help = beamroom('--help');
    assert.equal(help.status, 0);
    for (const command of ['convert', 'export', 'info', 'phantom', 'render', 'transport']) {
      assert.match(help.stdout, new RegExp(`^  ${command} `, 'm'));
      const own = beamroom(command, '--help');
      assert.equal(own.status, 0);
      assert.match(own.stdout, new RegExp(`^usage: beamroom ${command} DIR`));
    }
    assert.match(beamroom('--version').stdout, /^beamroom \d+\.\d+\.\d+\n$/);
  });

  it('says what is wrong with a command line and ends with 2', () => {
    for (const [args, sentence] of [
      [[], /^usage:/],
      [['dance'], /no command 'dance'/],
      [['export', plan, '-o', 'x.stl'], /one folder and one region are needed, 1 words are given/],
      [['export', plan, 'brain'], /-o OUT\.stl/],
      [['export', plan, 'brain', '-o', 'x.obj'], /does not end in \.stl, \.ply or \.glb/],
      [['export', plan, 'brain', '-o', 'x.stl', '--normals', 'up'], /--normals is "up", expected vertex, face/],
      [
        ['export', plan, 'brain', '-o', 'x.stl', '--algorithm', 'magic'],
        /--algorithm is "magic", expected marching-cubes, eight-cell, smooth/,
      ],
      [['info'], /one folder is needed, 0 are given/],
      [['info', plan, '--xml'], /'--xml' is not an option/],
      [['phantom', 'a', 'b'], /one folder is needed, 2 are given/],
      [['phantom', 'a', '--size', '96x96'], /--size '96x96' is not of the form/],
      [['phantom', 'a', '--size', '96x96x-1'], /is not of the form/],
      [['phantom', 'a', '--size', '96x96x9999'], /each side must be 16 to 1024/],
      [['phantom', 'a', '--seed', '-1'], /--seed '-1' is not a whole number/],
      [['phantom', 'a', '--seed'], /lacks its value/],
      [['transport', plan], /one folder and -o OUT are needed/],
      [['transport', plan, '-o', 'a', '--entry', '1,2,3'], /--entry and --target belong together/],
      [['transport', plan, '-o', 'a', '--entry', '1,2'], /--entry '1,2' is not of the form X,Y,Z/],
      [['transport', plan, '-o', 'a', '--histories', '15'], /--histories '15' is not a whole number from 16/],
      [['transport', plan, '-o', 'a', '--histories', '1e12'], /--histories '1e12'/],
      [['transport', plan, '-o', 'a', '--cells', '0.5'], /--cells '0\.5' is not a number from 1 to 50, mm/],
      [['transport', plan, '-o', 'a', '--cells', '5', '--sera-cells'], /--cells and --sera-cells are of different cells/],
      [['transport', plan, '-o', 'a', '--mode', 'fast'], /--mode is "fast", expected full or hybrid/],
      [['transport', plan, '-o', 'a', '--mode', 'hybrid', '--sera-cells'], /need --mode full/],
      [['render', plan], /-o OUT/],
      [['render', plan, '-o', 'x.gif'], /does not end in/],
      [['render', plan, '-o', 'x.png', '--size', '5000x10'], /--size '5000x10'/],
      [['render', plan, '-o', 'x.jpg', '--quality', '101'], /--quality '101'/],
      [['render', plan, '-o', 'x.jpg', '--gl', 'metal'], /--gl 'metal'/],
      [['render', plan, '-o', 'x.jpg', '--show', ''], /--show ''/],
      [['render', plan, '-o', 'x.jpg', '--show', 'brain=half'], /--show 'brain=half'/],
      [['render', plan, '-o', 'x.jpg', '--slices', 'axial=top'], /--slices 'axial=top'/],
      [['render', plan, '-o', 'x.jpg', '--volume', 'slices='], /--volume is ray/],
      [['render', plan, '-o', 'x.jpg', '--clip', 'axial=3'], /--clip 'axial=3'/],
      [['render', plan, '-o', 'x.jpg', '--clip', 'beam'], /--clip 'beam'/],
      [['render', plan, '-o', 'x.jpg', '--draft', '1,2,3'], /--draft '1,2,3' is not ENTRY:TARGET/],
      [['render', plan, '-o', 'x.jpg', '--draft', '1,2,3:1,2,3'], /--draft '1,2,3:1,2,3' is not/],
      [['render', plan, '-o', 'x.jpg', '--beam-slice', 'skin'], /--beam-slice 'skin' is not a number/],
      [['render', plan, '-o', 'x.jpg', '--tracks=lost,electron'], /--tracks 'lost,electron' is not some of neutron/],
      [['render', plan, '-o', 'x.jpg', '--ring', 'wide'], /--ring 'wide' is not a diameter/],
      [['render', plan, '-o', 'x.jpg', '--along', 'mid'], /--along 'mid' is not a number/],
      [['render', plan, '-o', 'x.jpg', '--ring', '40', '--kind', 'axial'], /--ring is of the beam's-eye view, and --kind is axial/],
      [['render', plan, '-o', 'x.jpg', '--window', '40'], /--window '40'/],
      [['render', plan, '-o', 'x.jpg', '--window', '40/400/bright'], /--window '40.400.bright' is not of the form 40.400, or 40.400.1.4/],
      [['render', plan, '-o', 'x.jpg', '--light', '31'], /--light '31' is not of the form 31,35/],
      [['render', plan, '-o', 'x.jpg', '--light', 'patient:1,2,x'], /--light 'patient:1,2,x'/],
      [['render', plan, '-o', 'x.jpg', '--background', '#12345'], /--background '#12345' is not white, black, or of the form #rrggbb/],
      [['render', plan, '-o', 'x.jpg', '--ambient', 'much'], /--ambient 'much' is not a number/],
      [['render', plan, '-o', 'x.jpg', '--from', '0,91'], /--from '0,91'/],
    ]) {
      const { status, stdout, stderr } = beamroom(...args);
      assert.equal(status, 2, `${args}: ${stderr}`);
      assert.match(stderr, sentence);
      assert.equal(stdout, '');
    }
    assert.ok(!existsSync('a') && !existsSync('x.png'));
  });

  it('refuses what is no plan with a sentence and 1', () => {
    const missing = beamroom('info', join(folder, 'nowhere'));
    assert.equal(missing.status, 1);
    assert.match(missing.stderr, /^beamroom info: .*nowhere: No such file or directory\n$/);
    const bad = mkdtempSync(join(folder, 'bad-'));
    writeFileSync(join(bad, 'plan.json'), '{"format": "beamroom-plan", "version": 1, "images": [{"path": "\\u001b[31m.nii"}]}');
    const refused = beamroom('info', bad);
    assert.equal(refused.status, 1);
    assert.equal(refused.stdout, '');
    assert.ok(!refused.stderr.includes('\u001b'), 'what a file says does not steer the terminal');
    const again = beamroom('phantom', plan);
    assert.equal(again.status, 1);
    assert.match(again.stderr, /is there already.*--force/);
  });
});

// The phantom's figures, calculated by hand: ellipsoids of Goorley, Kiger and Zamenhof 2002; voxels of 2.667 x 2.667 x 3.2 mm.
const ellipsoid = (a, b, c) => ((4 / 3) * Math.PI * a * b * c) / 1000; // cm3 from mm
const brain = ellipsoid(60, 90, 65) - ellipsoid(20, 22, 18);

describe('beamroom info', () => {
  it('prints a plan in words, in a hundred columns', () => {
    const { status, stdout, stderr } = beamroom('info', plan);
    assert.equal(status, 0, stderr);
    assert.match(stdout, /^Phantom: .*\[phantom, made up\]$/m);
    assert.match(stdout, /^ {2}ct +CT +96 x 96 x 64 +2\.667 x 2\.667 x 3\.2 mm +LPS +-1000 to 20\d\d HU$/m);
    assert.match(stdout, /^5 regions, inside each other as the plan says/m);
    assert.match(stdout, /^ {2}scalp .*\n {4}cranium .*\n {6}brain .*\n {8}target .*\n {10}tumour /m);
    assert.match(stdout, /^Dose goorley, Gy per minute at 1e10 n\/cm2\/s, with a mask/m);
    assert.match(stdout, /^ {2}boron +per ppm +41 x 57 x 49 +4 x 4 x 4 mm +LPS/m);
    assert.match(stdout, /from \(0\.0, 0\.0, 88\.0\) to \(0\.0, 0\.0, 10\.0\), aperture 100 mm$/m);
    assert.match(stdout, /^ {2}beam-line +1$/m);
    for (const line of stdout.split('\n')) assert.ok([...line].length <= 100, line);
  });

  it('refuses a plan that takes more than it may, with both figures', () => {
    const small = beamroom('info', plan, '--max-mib', '2');
    assert.equal(small.status, 1);
    assert.match(small.stderr, /would take about \d+ MiB of memory, and 2 MiB are allowed; the largest part is \S+ with \d+ MiB/);
    assert.equal(beamroom('info', '--max-mib=2000', plan).status, 0);
    assert.match(beamroom('info', plan, '--max-mib', 'x').stderr, /--max-mib needs a number/);
  });

  it('converts a plan to one that is the same but for the folder', () => {
    const out = join(folder, 'converted');
    const made = beamroom('convert', plan, out);
    assert.equal(made.status, 0, made.stderr);
    const [before, after] = [plan, out].map((dir) => parseStrict(beamroom('info', dir, '--json').stdout));
    for (const part of [
      'name',
      'note',
      'is_phantom',
      'images',
      'regions',
      'hierarchy',
      'doses',
      'beams',
      'tracks',
      'curves',
      'preferences',
    ])
      assert.deepEqual(after[part], before[part], part);
    const again = beamroom('convert', plan, out);
    assert.equal(again.status, 1);
    assert.match(again.stderr, /is there already and is not empty/);
  });

  it('gives the same as JSON', () => {
    const { status, stdout, stderr } = beamroom('info', plan, '--json');
    assert.equal(status, 0, stderr);
    const info = parseStrict(stdout);
    assert.deepEqual(Object.keys(info), [
      'id',
      'name',
      'note',
      'is_phantom',
      'load_ms',
      'bounds_mm',
      'home',
      'images',
      'regions',
      'hierarchy',
      'doses',
      'beams',
      'tracks',
      'curves',
      'fits',
      'preferences',
      'report',
      'patients',
      'statement',
      'treatment_plans',
      'shown_patient',
      'shown_plan',
    ]);
    assert.equal(info.id, 'head-one');
    assert.equal(info.is_phantom, true);
    const [image] = info.images;
    assert.deepEqual(image.grid.size, [96, 96, 64]);
    assert.equal(image.grid.orientation, 'LPS');
    assert.equal(image.unit, 'HU');
    assert.equal(image.low, -1000);
    const near = (value, expected, tolerance) => assert.ok(Math.abs(value - expected) <= tolerance, `${value}, expected ${expected}`);
    image.grid.bounds_mm.low.forEach((value, axis) => near(value, [-128, -128, -102.4][axis], 1e-3));
    assert.deepEqual(
      info.regions.map(({ id, parent }) => [id, parent]),
      [
        ['scalp', null],
        ['cranium', 'scalp'],
        ['brain', 'cranium'],
        ['target', 'brain'],
        ['tumour', 'target'],
      ],
    );
    assert.equal(info.hierarchy, 'file');
    assert.deepEqual(Object.keys(info.home), ['3d', 'axial', 'coronal', 'sagittal', 'oblique', 'beam', 'beam-slice']);
    const { position_mm: eye, target_mm: target, up } = info.home['3d'];
    assert.ok(eye[1] < -103 && up[2] === 1, 'from the front, the top up');
    near(Math.atan2(eye[0] - target[0], target[1] - eye[1]), Math.PI / 6, 1e-6); // 30 degrees towards the patient's left
    near(Math.asin((eye[2] - target[2]) / Math.hypot(...eye.map((value, axis) => value - target[axis]))), Math.PI / 15, 1e-6); // 12 up
    const region = Object.fromEntries(info.regions.map((entry) => [entry.id, entry]));
    near(region.brain.volume_cm3, brain, 0.01 * brain); // 1 %: border voxels at this size
    assert.equal(region.brain.color, '#d696a0');
    region.tumour.center_mm.forEach((value, axis) => near(value, [24, 24, 34][axis], 0.5)); // left, behind, above
    assert.equal(region.tumour.tissue.boron_ratio, null);
    assert.deepEqual(
      info.doses.map(({ id, unit, per, masked }) => [id, unit, per, masked]),
      [['goorley', 'Gy', 'minute at 1e10 n/cm2/s', true]],
    );
    const high = Object.fromEntries(info.doses[0].components.map((entry) => [entry.quantity, entry.high]));
    near(high.gamma, 0.971, 1e-3); // the largest value of the table
    near(high.boron, 0.1016, 1e-6);
    assert.deepEqual(
      info.doses[0].components.map(({ per_ppm: perPpm }) => perPpm),
      [true, false, false, false],
    );
    assert.deepEqual(info.beams, [
      {
        id: 'beam-1',
        entry_mm: [0, 0, 88],
        target_mm: [0, 0, 10],
        aperture_mm: 100,
        name: '',
        delivery: null,
        patient: null,
        plan: null,
        is_plan_absent: false,
        frame: null,
        study: null,
      },
    ]);
    assert.equal(
      info.tracks.segments,
      Object.values(info.tracks.classes).reduce((sum, n) => sum + n, 0),
    );
    assert.equal(Object.values(info.tracks.classes).filter((n) => n > 0).length, 8);
    assert.equal(info.report.dropped, 0);
    assert.deepEqual(
      info.report.lines.filter(({ code }) => !code.startsWith('file.')),
      [],
    );
    assert.deepEqual(
      info.report.lines.filter(({ code }) => code === 'file.not-read').map(({ where }) => where),
      ['README.txt'],
      'every other file is read',
    );
  });
});

describe('beamroom export', () => {
  it('writes the surface of a region as each format, twice the same', () => {
    for (const [ending, magic] of [
      ['stl', 'Beamroom mm LPS tumour'],
      ['PLY', 'ply\nformat binary_little_endian 1.0\n'],
      ['glb', 'glTF'],
    ]) {
      const out = join(folder, `tumour.${ending}`);
      const { status, stdout, stderr } = beamroom('export', plan, 'tumour', '-o', out);
      assert.equal(status, 0, stderr);
      const told = /: (\d+) triangles, (\d+) vertices, [\d.]+ cm2, ([\d.]+) cm3, (\d+) bytes\n$/.exec(stdout);
      const bytes = readFileSync(out);
      assert.equal(bytes.length, Number(told[4]));
      assert.equal(bytes.subarray(0, magic.length).toString(), magic);
      if (ending === 'stl') assert.equal(bytes.length, 84 + 50 * Number(told[1]));
      assert.equal(beamroom('export', plan, 'tumour', '-o', out).status, 0);
      assert.deepEqual(readFileSync(out), bytes);
    }
  });

  it('writes the surface by the algorithm asked for, and says which', () => {
    const out = join(folder, 'cells.ply');
    const cubes = Number(
      /: (\d+) triangles/.exec(beamroom('export', plan, 'tumour', '-o', out, '--algorithm', 'marching-cubes').stdout)[1],
    );
    const told = /: (\d+) triangles/.exec(beamroom('export', plan, 'tumour', '-o', out, '--algorithm', 'eight-cell').stdout);
    assert.ok(told[1] > 100 && told[1] < cubes * 0.85, `${told[1]} of ${cubes}`);
    assert.match(readFileSync(out).subarray(0, 700).toString('latin1'), /eight-cell/);
  });

  it('leaves vertex normals out of a PLY for flat shading', () => {
    const out = join(folder, 'flat.ply');
    assert.equal(beamroom('export', plan, 'tumour', '-o', out, '--normals', 'face').status, 0);
    assert.doesNotMatch(readFileSync(out).subarray(0, 700).toString('latin1'), /property float nx/);
    assert.match(readFileSync(out).subarray(0, 700).toString('latin1'), /comment a phantom, not a patient/);
  });

  it('refuses a region that is not there, naming those that are, and writes nothing', () => {
    const out = join(folder, 'never.stl');
    const { status, stderr } = beamroom('export', plan, 'liver', '-o', out);
    assert.equal(status, 1);
    assert.match(stderr, /no region "liver"; it has scalp, cranium, brain, target, tumour/);
    assert.ok(!existsSync(out));
    assert.equal(beamroom('export', plan, 'brain', '-o', join(folder, 'nowhere', 'x.stl')).status, 1);
  });
});

describe('beamroom render', () => {
  it('writes a caption below the picture when annotations are wanted', () => {
    const out = join(folder, 'annotated.png');
    const { status, stderr } = beamroom('render', plan, '-o', out, '--size', '320x200', '--annotations');
    assert.equal(status, 0, stderr);
    const bytes = readFileSync(out);
    assert.equal(bytes.readUInt32BE(16), 320);
    assert.ok(bytes.readUInt32BE(20) > 250);
    assert.ok(bytes.includes('iTXt') && bytes.includes('beamroom\0'));
  });

  it('writes a PNG of the size asked for, twice the same', () => {
    const [one, two] = [join(folder, 'one.png'), join(folder, 'two.png')];
    for (const out of [one, two]) {
      const { status, stdout, stderr } = beamroom('render', plan, '-o', out, '--size', '320x200');
      assert.equal(status, 0, stderr);
      assert.match(stdout, /one\.png|two\.png/);
      assert.match(stdout, /: 320 x 200, [1-9]\d* triangles, \d+ ms, (egl-device|egl-surfaceless|osmesa|soft)\n$/);
    }
    const bytes = readFileSync(one);
    assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [320, 200]);
    assert.ok(bytes.length > 2000, 'an empty picture packs smaller');
    assert.deepEqual(bytes, readFileSync(two));
  });

  it('takes scene and view as merge patches, and quality for JPEG', () => {
    const [scene, view] = [join(folder, 'scene.json'), join(folder, 'view.json')];
    writeFileSync(scene, JSON.stringify({ regions: { scalp: { visible: false }, cranium: { visible: false } } }));
    writeFileSync(view, JSON.stringify({ kind: 'axial', size_px: [200, 200] }));
    const sizes = ['20', '95'].map((quality) => {
      const out = join(folder, `q${quality}.jpg`);
      const { status, stderr } = beamroom('render', plan, '-o', out, '--scene', scene, '--view', view, '--quality', quality);
      assert.equal(status, 0, stderr);
      const bytes = readFileSync(out);
      assert.deepEqual([...bytes.subarray(0, 3)], [0xff, 0xd8, 0xff]);
      return bytes.length;
    });
    assert.ok(sizes[0] < sizes[1]);
  });

  it('refuses a scene or view that is wrong, naming file and field, and writes nothing', () => {
    const patch = join(folder, 'patch.json');
    const out = join(folder, 'never.png');
    for (const [option, text, sentence] of [
      ['--scene', '{"regions": {"brian": {"visible": true}}}', /patch\.json: \/regions\/brian: the plan has no region/],
      ['--scene', '{"image": {"window": {"width": -4}}}', /patch\.json: \/image\/window\/width is -4, expected/],
      ['--view', '{"kind": "upside-down"}', /patch\.json: \/kind is "upside-down", expected one of/],
      ['--view', '{"override": {"image": {"id": "pet"}}}', /patch\.json: \/override\/image\/id: the plan has no image/],
      ['--view', '{"override": {"image": {"window": {"width": 0}}}}', /patch\.json: \/override\/image\/window\/width is 0/],
      ['--view', '{', /patch\.json: /],
      ['--scene', `"${'x'.repeat(1 << 20)}"`, /longer than 1048576 bytes/],
    ]) {
      writeFileSync(patch, text);
      const { status, stderr } = beamroom('render', plan, '-o', out, option, patch);
      assert.equal(status, 1, stderr);
      assert.match(stderr, sentence);
    }
    for (const [option, value, sentence] of [
      ['--scene', '{"image": 3}', /the JSON given: \/image is not an object/],
      ['--view', '{', /the JSON given: /],
      ['--show', 'brian', /\/regions\/brian: the plan has no region/],
      ['--clip', 'axial-high=1e9', /\/clip\/axial_high\/position_mm is 1e\+09, expected/],
      ['--clip', 'beam=1e9', /\/clip\/beam\/along_mm is 1e\+09, expected/],
      ['--beam=beam-2', /--beam.*: \/beam\/id: the plan has no beam "beam-2"/],
      ['--kind', 'sideways', /\/kind is "sideways", expected one of/],
      ['--ring', '-3', /\/beam\/aperture_mm is -3, expected/],
    ]) {
      const { status, stderr } = beamroom('render', plan, '-o', out, ...(sentence ? [option, value] : [option]));
      assert.equal(status, 1, stderr);
      assert.match(stderr, sentence ?? value);
    }
    assert.equal(beamroom('render', plan, '-o', out, '--view', join(folder, 'none.json')).status, 1);
    assert.ok(!existsSync(out));
  });

  // The beam of the phantom comes from S 88 down to S 10. What its options say is read back from the record in the PNG.
  it('shows beams and tracks by short options', () => {
    const record = (...options) => {
      const out = join(folder, 'beam.png');
      const { status, stderr } = beamroom('render', plan, '-o', out, '--size', '320x200', '--annotations', ...options);
      assert.equal(status, 0, stderr);
      const bytes = readFileSync(out);
      const at = bytes.indexOf('iTXtbeamroom\0'); // after it: compressed, by deflate, no language, no translated keyword
      return parseStrict(inflateSync(bytes.subarray(at + 17, at + 4 + bytes.readUInt32BE(at - 4))).toString());
    };
    const eye = record('--beam', '--ring', '100', '--along', '-20', '--tracks=neutron,lost');
    assert.deepEqual([eye.view.kind, eye.view.beam.aperture_mm, eye.view.beam.along_mm], ['beam', 100, -20]);
    assert.deepEqual([eye.scene.beam.id, eye.scene.beam.looks['beam-1'].visible, eye.scene.tracks.visible], ['beam-1', true, true]);
    assert.deepEqual(
      Object.entries(eye.scene.tracks.classes)
        .filter(([, isShown]) => isShown)
        .map(([name]) => name),
      ['neutron_high', 'neutron_medium', 'neutron_low', 'lost'],
    );
    const shown = record('--show', 'scalp=0.25,brain').scene.regions;
    assert.deepEqual(
      ['scalp', 'cranium', 'brain'].map((id) => [shown[id].visible, shown[id].opacity]),
      [
        [true, 0.25],
        [false, shown.cranium.opacity],
        [true, 1],
      ],
    );
    const slice = record('--kind', 'beam-slice', '--beam-slice', '30', '--clip', 'beam=20', '--tracks');
    assert.equal(slice.view.kind, 'beam-slice');
    assert.deepEqual(slice.scene.beam.slice, { visible: true, along_mm: 30 });
    assert.deepEqual(slice.scene.clip.beam, { enabled: true, id: '', along_mm: 20, cap: true });
    assert.ok(Object.values(slice.scene.tracks.classes).every((isShown) => isShown));
    const { draft, looks } = record('--kind', '3d', '--draft', '0,-120,5:0,0,5').scene.beam;
    assert.deepEqual([draft.enabled, draft.line.entry_mm, draft.line.target_mm], [true, [0, -120, 5], [0, 0, 5]]);
    assert.deepEqual(looks, {});
  });

  it('refuses what is of a beam or of tracks in a plan without them, unless a draft is given', () => {
    const bare = join(folder, 'bare');
    assert.equal(beamroom('convert', plan, bare).status, 0);
    const { beams, tracks, ...rest } = JSON.parse(readFileSync(join(bare, 'plan.json'), 'utf8'));
    assert.ok(beams.length === 1 && tracks);
    writeFileSync(join(bare, 'plan.json'), JSON.stringify(rest));
    const refused = (...options) => beamroom('render', bare, '-o', join(folder, 'none.png'), '--size', '64x48', ...options);
    for (const [option, ...value] of [
      ['--beam'],
      ['--kind', 'beam'],
      ['--beam-slice', '3'],
      ['--clip', 'beam=3'],
      ['--ring', '30'],
      ['--along', '0'],
    ]) {
      const { status, stderr } = refused(option, ...value);
      assert.equal(status, 1);
      assert.match(stderr, new RegExp(`${option}.*: the plan has no beams; --draft ENTRY:TARGET draws one`));
    }
    assert.match(refused('--tracks').stderr, /--tracks: the plan has no tracks/);
    const drafted = refused('--kind', 'beam', '--draft', '0,0,120:0,0,0');
    assert.equal(drafted.status, 0, drafted.stderr);
  });

  it('writes only the picture into the picture, whatever is closed, and says so when standard output is full', () => {
    const out = join(folder, 'with a space\nand a line.png');
    spawnSync('sh', ['-c', '"$0" render "$1" -o "$2" --size 64x48 <&- >&- 2>&- || true', bin, plan, out]);
    const bytes = readFileSync(out);
    assert.equal(bytes.subarray(0, 8).toString('latin1'), '\x89PNG\r\n\x1a\n');
    assert.equal(bytes.subarray(-8, -4).toString('latin1'), 'IEND', 'nothing follows the picture');
    for (const to of ['>/dev/full', '>&-']) {
      const { status, stderr } = spawnSync('sh', ['-c', `"$0" info "$1" ${to}`, bin, plan], { encoding: 'utf8' });
      assert.equal(status, 1);
      assert.match(stderr, /standard output cannot be written/);
    }
  });
});

describe('beamroomd', () => {
  it('refuses a port that is none', () => {
    for (const port of ['65536', '99999', '-1', 'x', '']) {
      const { status, stderr } = spawnSync(
        join(dirname(bin), 'beamroomd'),
        ['--listen', `127.0.0.1:${port}`, '--data', join(folder, 'state'), '--web', web],
        { encoding: 'utf8', timeout: 60000 },
      );
      assert.ok(status === 1 || status === 2, `${port}: ${stderr}`); // 2: seen while the flags are read
      assert.match(stderr, /--listen 127\.0\.0\.1:/);
    }
  });
});
