// Changes by presets of beam, dose and volume, against a plan worked out by hand: a beam from the front, a target 40 mm behind its entry.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { applyPreset, presetChange, presetsOf } = await load('features/beams/beam_combinations.js');
const { mergePatch } = await load('wire/merge.js');
const { Undo } = await load('room/undo.js');
const { UiState } = await load('room/ui.js');
const { roomWorld, welcome } = await import('../../fake_room.mjs');

const home = { '3d': { position_mm: [200, -346.41, 100], target_mm: [0, 0, 0], up: [0, 0, 1] } }; // from the front, the left, above
const region = (id, depth, more = {}) => ({ id, name: id, depth, center_mm: [0, 0, 0], ...more });
const plan = {
  id: 'p',
  images: [{ id: 'ct', bounds: { low: [-100, -100, -100], high: [100, 100, 100] } }],
  bounds: { low: [-100, -100, -100], high: [100, 100, 100] },
  home,
  regions: [
    region('scalp', 0),
    region('brain', 1, { parent: 'scalp' }),
    region('tumour', 2, { parent: 'brain', is_target: true, center_mm: [5, -60, 12.34] }),
  ],
  doses: [{ id: 'd', components: [], fit: 'same' }],
  beams: [{ id: 'b1', entry_mm: [0, -100, 0], target_mm: [0, 0, 0], aperture_mm: 80 }],
};
const off = { enabled: false, position_mm: 0, cap: true };
const style = (opacity) => ({ visible: true, opacity });
const level = (value, surface) => ({
  value,
  unit: 'percent',
  color: '#ffffff',
  visible: true,
  line: true,
  wash: true,
  surface,
  opacity: 0.4,
});
const scene = {
  regions: { scalp: style(0.5), brain: style(0.3), tumour: style(1) },
  image: {
    id: 'ct',
    volume: { visible: false, clipped: true },
    slices: {
      axial: { visible: true, position_mm: 0 },
      coronal: { visible: false, position_mm: 0 },
      sagittal: { visible: false, position_mm: 0 },
    },
    obliques: {},
  },
  clip: {
    axial_low: off,
    axial_high: { ...off, enabled: true },
    coronal_low: off,
    coronal_high: off,
    sagittal_low: off,
    sagittal_high: off,
    beam: { enabled: false, id: '', along_mm: 0, cap: true },
    free: { enabled: false },
  },
  dose: {
    id: 'd',
    quantity: 'weighted',
    tissue: '',
    reference: { kind: 'body', region: '' },
    levels: { l90: level(90, false), l50: level(50, true) },
    surfaces: { visible: false },
    wash: { visible: false, volume: false },
  },
  beam: {
    id: '',
    looks: {},
    slice: { visible: false, along_mm: 0 },
    draft: { enabled: false, line: { entry_mm: [0, 0, 0], target_mm: [0, 0, 0], aperture_mm: null } },
  },
};
const after = (change) => mergePatch(scene, change.patch);
const near = (a, b) => a.forEach((value, axis) => assert.ok(Math.abs(value - b[axis]) < 1e-3, `${a} instead of ${b}`));

test('the beam slice lies at the middle of the target along the beam, and nothing hides it', () => {
  const change = presetChange(plan, scene, 'beam-slice');
  const now = after(change);
  assert.deepEqual(now.beam.slice, { visible: true, along_mm: 40 }); // from P -100 to P -60
  assert.equal(now.beam.looks.b1.visible, true);
  assert.deepEqual(now.regions, {
    scalp: { visible: false, opacity: 0.5 },
    brain: { visible: false, opacity: 0.3 },
    tumour: { visible: true, opacity: 0.35 },
  });
  assert.equal(now.image.slices.axial.visible, false);
  assert.ok(Object.values(now.clip).every(({ enabled }) => !enabled));
  assert.equal(change.kind, '3d');
  // against the beam, and aside by 0.8 of that, towards the home camera: of (0.485, -0.840, 0.242) without P
  const { position_mm: eye, target_mm: target } = change.view.camera;
  const distance = Math.hypot(...home['3d'].position_mm);
  const [x, z] = [200 / Math.hypot(200, 100), 100 / Math.hypot(200, 100)];
  near(
    eye.map((value, axis) => (value - target[axis]) / distance),
    [0.8 * x, -1, 0.8 * z].map((part) => part / Math.hypot(1, 0.8)),
  );
});

test('what is as wanted already is not told, and not changed', () => {
  const change = presetChange(plan, scene, 'beam-slice');
  assert.ok(!change.words.some((words) => /volume|isodose/.test(words)), change.words.join());
  assert.ok(change.words.includes('clip planes off') && change.words.includes('slices hidden'), change.words.join());
  assert.equal(change.patch.image.volume, undefined);
  assert.deepEqual(presetChange(plan, after(change), 'beam-slice').patch, {});
});

test('the surface of 90 % is the only one, whether the scene has that level or not', () => {
  const now = after(presetChange(plan, scene, 'ninety'));
  assert.deepEqual([now.dose.surfaces.visible, now.dose.levels.l90.surface, now.dose.levels.l50.surface], [true, true, false]);
  assert.deepEqual([now.regions.tumour, now.regions.brain.visible], [{ visible: true, opacity: 0.5 }, false]);
  assert.deepEqual([now.dose.tissue, now.dose.reference], ['brain', { kind: 'region-max', region: 'brain' }]);
  const bare = { ...scene, dose: { ...scene.dose, levels: { l50: level(50, false) } } };
  const made = mergePatch(bare, presetChange(plan, bare, 'ninety').patch).dose.levels;
  assert.deepEqual(
    Object.values(made)
      .filter(({ surface }) => surface)
      .map(({ value, unit }) => [value, unit]),
    [[90, 'percent']],
  );
});

test('the surface of 90 % is of the reference and weights that somebody has chosen', () => {
  const dose = { quantity: 'weighted', tissue: 'scalp', reference: { kind: 'value', value: 20 } };
  assert.deepEqual(Object.keys(presetChange(plan, mergePatch(scene, { dose }), 'ninety').patch.dose).sort(), ['levels', 'surfaces']);
  assert.equal(presetChange(plan, mergePatch(scene, { dose: { quantity: 'boron' } }), 'ninety').patch.dose.tissue, undefined);
});

test('the volume is cut through the target, beside the beam, where the camera stands', () => {
  const change = presetChange(plan, scene, 'washed-volume');
  const now = after(change);
  assert.deepEqual([now.image.volume.visible, now.dose.wash.visible, now.dose.wash.volume], [true, true, true]);
  // the beam runs along P; from the left: sagittal, what is to the left of L 5 is cut off
  assert.deepEqual(
    Object.entries(now.clip)
      .filter(([, { enabled }]) => enabled)
      .map(([id, { position_mm }]) => [id, position_mm]),
    [['sagittal_high', 5]],
  );
  near(change.view.camera.position_mm, home['3d'].position_mm);
});

test("the ring of the beam's eye is the aperture, and what lies before the target is transparent", () => {
  const change = presetChange(plan, scene, 'beams-eye');
  assert.deepEqual([change.kind, change.view.beam.aperture_mm], ['beam', 80]);
  const now = after(change);
  assert.deepEqual([now.regions.scalp.opacity, now.regions.brain.opacity, now.regions.tumour.opacity], [0.25, 0.3, 1]);
  const hidden = mergePatch(scene, {
    regions: { scalp: { visible: false }, brain: { visible: false } },
    clip: { beam: { enabled: true } },
  });
  const shown = mergePatch(hidden, presetChange(plan, hidden, 'beams-eye').patch);
  assert.ok(shown.regions.scalp.visible && shown.regions.brain.visible, 'what the target lies in');
  assert.deepEqual([shown.clip.axial_high.enabled, shown.clip.beam.enabled], [false, true]);
  const drafted = mergePatch(scene, {
    beam: { draft: { enabled: true, line: { entry_mm: [0, 0, 100], target_mm: [0, 0, 0], aperture_mm: 60 } } },
  });
  assert.equal(presetChange(plan, drafted, 'beams-eye').view.beam.aperture_mm, 60);
});

test('a preset that the plan cannot have says why', () => {
  const whys = (of, shown = scene) => Object.fromEntries(presetsOf(of, shown).map(({ id, why }) => [id, why]));
  assert.deepEqual(whys(plan), { 'beam-slice': '', ninety: '', 'washed-volume': '', 'beams-eye': '' });
  assert.deepEqual(whys({ ...plan, beams: [] }), { 'beam-slice': 'no beam', ninety: '', 'washed-volume': '', 'beams-eye': 'no beam' });
  assert.deepEqual(whys({ ...plan, doses: [] }), { 'beam-slice': '', ninety: 'no dose', 'washed-volume': 'no dose', 'beams-eye': '' });
  assert.deepEqual(whys({ ...plan, regions: [], images: [] }), {
    'beam-slice': 'no image',
    ninety: 'no target',
    'washed-volume': 'no image',
    'beams-eye': '',
  });
});

test('a preset is one step of undo, of scene and camera', () => {
  const { room, connection } = roomWorld();
  connection.receive(
    welcome({
      scene,
      plan: { id: 'p', regions: plan.regions, beams: plan.beams, doses: plan.doses, home, bounds_mm: plan.bounds, images: [] },
    }),
  );
  room.showView(1, [400, 300]);
  const ui = new UiState({ now: () => 0, setTimeout: () => 0 });
  const undo = new Undo(room, { clock: { now: () => 0 }, notify: () => {} });
  const before = [room.scene.value, room.view(1).document.value];
  applyPreset({ room, ui, undo }, 'ninety', 0);
  applyPreset({ room, ui, undo }, 'washed-volume', 0);
  assert.equal(room.scene.value.dose.wash.volume, true);
  assert.ok(room.view(1).document.value.camera);
  assert.match(
    ui.toasts.value.at(-1).text,
    /^Clipped volume with wash: volume shown, wash on it, sagittal clip plane through the target, tumour shown/,
  );
  undo.undo();
  assert.deepEqual(
    [room.scene.value.dose.wash.volume, room.scene.value.dose.surfaces.visible, room.view(1).document.value.camera],
    [false, true, undefined],
  );
  undo.undo();
  assert.deepEqual([room.scene.value, room.view(1).document.value], before);
  assert.equal(undo.next.value, null);
});
