// Clip planes: the part that they keep, their places and their changes, against figures worked out by hand.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const clip = await load('features/clip/clip.js');
const { Undo } = await load('room/undo.js');
const { stepName } = await load('shell/undo_words.js');
const { mergePatch } = await load('wire/merge.js');

const plan = {
  images: [],
  bounds: { low: [-100, -80, -60], high: [100, 80, 60.04] },
  beams: [{ id: 'b1', entry_mm: [0, -100, 0], target_mm: [0, 0, 0] }],
};
const off = { enabled: false, position_mm: 0, cap: true };
const sceneOf = (more = {}) => ({
  image: { id: '', slices: { sagittal: { position_mm: 11 }, coronal: { position_mm: 22 }, axial: { position_mm: 33 } } },
  clip: mergePatch(
    {
      axial_low: off,
      axial_high: off,
      coronal_low: off,
      coronal_high: off,
      sagittal_low: off,
      sagittal_high: off,
      beam: { enabled: false, id: '', along_mm: 0, cap: true },
      free: { enabled: false, origin_mm: [0, 0, 0], normal: [0, 0, 1], cap: true },
    },
    more,
  ),
});

test('each plane of an axis cuts off the side that its name says it does not keep', () => {
  const scene = sceneOf();
  const cutOff = Object.fromEntries(clip.clipTable.map(({ id }) => [id, clip.clipPlane(plan, scene, id).normal.map((part) => part || 0)]));
  // LPS: superior +z, posterior +y, left +x; the beam runs to the posterior, and what lies before the plane is cut
  assert.deepEqual(cutOff, {
    axial_high: [0, 0, 1],
    axial_low: [0, 0, -1],
    sagittal_high: [1, 0, 0],
    sagittal_low: [-1, 0, 0],
    coronal_low: [0, -1, 0],
    coronal_high: [0, 1, 0],
    beam: [0, -1, 0],
    free: [0, 0, 1],
  });
  assert.deepEqual(
    clip.clipTable.map(({ id }) => clip.clipName(id)),
    [
      'Axial, below',
      'Axial, above',
      'Sagittal, right of',
      'Sagittal, left of',
      'Coronal, behind',
      'Coronal, before',
      'Beam, behind',
      'Free',
    ],
  );
});

test('a plan without a beam has no plane along one', () => {
  assert.ok(clip.clipsOf(plan).some(({ id }) => id === 'beam'));
  const bare = { ...plan, beams: [] };
  assert.equal(clip.clipsOf(bare).length, 7);
  assert.equal(clip.enabledClips(bare, sceneOf({ beam: { enabled: true } })).length, 0);
});

test('planes move in steps of 0.1 mm inside the box of the plan', () => {
  const scene = sceneOf();
  assert.deepEqual(clip.rangeOfClip(plan, scene, 'axial_high'), { low: -60, high: 60.1 });
  assert.deepEqual(clip.rangeOfClip(plan, scene, 'beam'), { low: 20, high: 180 }); // from y = -80 to 80, seen from the entry at -100
  assert.deepEqual(clip.movedClip(plan, scene, 'axial_high', 12.345), { clip: { axial_high: { position_mm: 12.3 } } });
  assert.deepEqual(clip.movedClip(plan, scene, 'axial_high', -1000), { clip: { axial_high: { position_mm: -60 } } });
  assert.deepEqual(clip.movedClip(plan, scene, 'beam', 50.04), { clip: { beam: { along_mm: 50 } } });
});

test('the free plane keeps its direction and the place of its origin across it', () => {
  const scene = sceneOf({ free: { origin_mm: [5, 6, 7], normal: [0, 0, 2] } });
  assert.equal(clip.positionOfClip(plan, scene, 'free'), 7);
  assert.deepEqual(clip.movedClip(plan, scene, 'free', -20), { clip: { free: { origin_mm: [5, 6, -20] } } });
  assert.deepEqual(clip.freeByAngles(90, 0).clip.free.normal, [1, 0, 0]);
});

test('a plane that was never moved begins at the crosshair; another one where it was', () => {
  assert.deepEqual(clip.switchedClip(plan, sceneOf(), 'sagittal_low', true), {
    clip: { sagittal_low: { enabled: true, position_mm: 11 } },
  });
  assert.deepEqual(clip.switchedClip(plan, sceneOf(), 'beam', true), { clip: { beam: { enabled: true, along_mm: 122 } } });
  assert.deepEqual(clip.switchedClip(plan, sceneOf({ sagittal_low: { position_mm: -3 } }), 'sagittal_low', true), {
    clip: { sagittal_low: { enabled: true } },
  });
  assert.deepEqual(clip.switchedClip(plan, sceneOf(), 'sagittal_low', false), { clip: { sagittal_low: { enabled: false } } });
});

test('flipped, the other plane of the axis cuts at the same place, and the free one turns over', () => {
  const scene = sceneOf({
    axial_high: { enabled: true, position_mm: 10, cap: false },
    axial_low: { position_mm: -50 },
    free: { normal: [0, 0.6, 0.8] },
  });
  const { id, patch } = clip.flippedClip(scene, 'axial_high');
  assert.equal(id, 'axial_low');
  const after = mergePatch(scene, patch);
  assert.deepEqual(after.clip.axial_low, { enabled: true, position_mm: 10, cap: false });
  assert.deepEqual(after.clip.axial_high, { enabled: false, position_mm: -50, cap: false });
  assert.deepEqual(clip.flippedClip(scene, 'free').patch.clip.free.normal, [0, -0.6, -0.8]);
  assert.equal(clip.flippedClip(scene, 'beam'), null);
});

test('two planes of an axis that have passed each other leave nothing', () => {
  assert.ok(
    clip.leavesNothing(sceneOf({ axial_high: { enabled: true, position_mm: 10 }, axial_low: { enabled: true, position_mm: 12 } }), 'axial'),
  );
  assert.ok(
    !clip.leavesNothing(
      sceneOf({ axial_high: { enabled: true, position_mm: 10 }, axial_low: { enabled: false, position_mm: 12 } }),
      'axial',
    ),
  );
  assert.ok(
    !clip.leavesNothing(
      sceneOf({ axial_high: { enabled: true, position_mm: 12 }, axial_low: { enabled: true, position_mm: 10 } }),
      'axial',
    ),
  );
});

test('clipping is turned off as a whole and on again as it was', () => {
  const scene = sceneOf({ axial_high: { enabled: true, position_mm: 10 }, free: { enabled: true, origin_mm: [0, 0, 5] } });
  const first = clip.toggledClips(plan, scene, []);
  assert.deepEqual(first, {
    patch: { clip: { axial_high: { enabled: false }, free: { enabled: false } } },
    remembered: ['axial_high', 'free'],
  });
  const again = clip.toggledClips(plan, mergePatch(scene, first.patch), first.remembered);
  assert.deepEqual(mergePatch(mergePatch(scene, first.patch), again.patch), scene);
  assert.deepEqual(clip.toggledClips(plan, sceneOf(), []).patch, { clip: { axial_high: { enabled: true, position_mm: 33 } } });
});

test('caps are turned off when all planes that cut have one, else on', () => {
  const scene = sceneOf({ axial_high: { enabled: true }, coronal_low: { enabled: true, cap: false } });
  assert.deepEqual(clip.toggledCaps(plan, scene), { clip: { axial_high: { cap: true }, coronal_low: { cap: true } } });
  assert.deepEqual(clip.toggledCaps(plan, sceneOf({ axial_high: { enabled: true } })), { clip: { axial_high: { cap: false } } });
  assert.equal(clip.toggledCaps(plan, sceneOf()), null);
});

test('all planes go through the crosshair in one patch', () => {
  const scene = sceneOf({ axial_high: { enabled: true }, sagittal_low: { enabled: true }, free: { enabled: true } });
  assert.deepEqual(clip.allThroughCrosshair(plan, scene), {
    clip: { axial_high: { position_mm: 33 }, sagittal_low: { position_mm: 11 }, free: { origin_mm: [11, 22, 33] } },
  });
});

test('a plane that was made is undone whole, and made again; the steps have names', () => {
  const room = {
    canChange: { value: true },
    following: { isPresenting: { value: true } },
    plan: { value: { images: [], regions: [{ id: 'r', name: 'brain' }] } },
    view: () => null,
    scene: { value: { ...sceneOf(), image: { obliques: {} } } },
    patchScene(patch) {
      room.recorder('scene', patch, room.scene.value);
      room.scene.value = mergePatch(room.scene.value, patch);
    },
  };
  const undo = new Undo(room, { clock: { now: () => 0 }, notify: (...words) => assert.fail(words.join()) });
  const made = { visible: true, name: '', origin_mm: [1, 2, 3], normal: [0, 0, 1] };
  room.patchScene({ image: { obliques: { 'plane-1': made } } });
  undo.undo();
  assert.deepEqual(room.scene.value.image.obliques, {});
  undo.redo();
  assert.deepEqual(room.scene.value.image.obliques, { 'plane-1': made });
  room.patchScene({ image: { obliques: { 'plane-1': null } } });
  undo.undo();
  assert.deepEqual(room.scene.value.image.obliques, { 'plane-1': made });
  const name = (...path) => stepName([{ of: 'scene', path }], room);
  assert.deepEqual(
    [
      name('clip', 'axial_high', 'position_mm'),
      name('clip', 'free', 'normal'),
      name('clip', 'cap', 'regions'),
      name('image', 'obliques', 'plane-1'),
      name('image', 'clipped'),
      name('image', 'volume', 'clipped'),
      name('regions', 'r', 'clipped'),
    ],
    [
      'clip axial high',
      'clip free',
      'what caps show',
      'oblique plane',
      'clipping of slices',
      'clipping of the volume',
      'clipping of brain',
    ],
  );
});
