// Beams as the page knows them: which one a scene shows, the axes of pictures along it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { alongOf, beamPlane, beamPoint, beamShown } = await load('room/beam_line.js');
const { layoutId, layouts } = await load('room/layout.js');

const plan = {
  beams: [
    { id: 'a', name: 'Field A', entry_mm: [0, -100, 0], target_mm: [0, 0, 0], aperture_mm: 120 },
    { id: 'b', name: '', entry_mm: [0, 0, 90], target_mm: [0, 0, 0], aperture_mm: null },
  ],
};
const draft = { enabled: true, line: { name: '', entry_mm: [10, 0, 0], target_mm: [0, 0, 0], aperture_mm: null } };
const sceneWith = (beam) => ({ beam: { id: '', draft: { ...draft, enabled: false }, ...beam } });
const isNear = (a, b) => a.forEach((value, axis) => assert.ok(Math.abs(value - b[axis]) < 1e-12, `${a} is not ${b}`));

test('a scene shows the chosen beam, else the first, as its draft while that is on', () => {
  assert.equal(beamShown(plan, sceneWith({})).name, 'Field A');
  assert.equal(beamShown(plan, sceneWith({ id: 'b' })).name, 'b');
  const drafted = beamShown(plan, sceneWith({ id: 'a', draft }));
  assert.deepEqual([drafted.isDraft, drafted.length, drafted.aperture], [true, 10, 120]);
  isNear(drafted.direction, [-1, 0, 0]);
  assert.equal(beamShown(plan, sceneWith({ draft }), 'b').isDraft, false, 'a beam that is named is the planned one');
  assert.equal(beamShown({ beams: [] }, sceneWith({})), null);
  assert.equal(beamShown({ beams: [] }, sceneWith({ draft })).isDraft, true);
  assert.equal(
    beamShown({ beams: [] }, sceneWith({ draft: { ...draft, line: { ...draft.line, target_mm: [10, 0, 0] } } })),
    null,
    'a line without length is none',
  );
});

test('a picture along a beam has superior up, and anterior where the beam runs along the patient', () => {
  const [fromFront, fromAbove] = plan.beams.map(({ id }) => beamShown(plan, sceneWith({ id })));
  const front = beamPlane(fromFront, 40); // a view from the front: the patient's left is at the right
  isNear(front.origin, [0, -60, 0]);
  isNear(front.up, [0, 0, 1]);
  isNear(front.right, [1, 0, 0]);
  isNear(front.normal, [0, -1, 0]);
  const above = beamPlane(fromAbove, 0); // from the top of the head, the nose up: the patient's left is at the left
  isNear(above.up, [0, -1, 0]);
  isNear(above.right, [-1, 0, 0]);
  isNear(beamPoint(fromAbove, 90), [0, 0, 0]);
  assert.equal(alongOf(fromFront, [7, -60, 3]), 40);
});

test('the pairs of views that have a layout of their own are told apart', () => {
  for (const { id, two } of layouts.filter((layout) => layout.two)) assert.equal(layoutId('2x1', two), id);
  assert.equal(layoutId('1x2', [1, 8]), '2x1');
});

// ---- the eye: a plan of 200 mm edges around the origin, and beam a, 100 mm along posterior to the origin --------------------------------------

const { cameraAsSeen, eyeAlong, ringPatch, zoomedEye } = await load('features/beams/beam_eye.js');
const box = { low: [-100, -100, -100], high: [100, 100, 100] };
const cube = { ...plan, images: [], bounds: box };
const beamA = beamShown(cube, sceneWith({}));
const tan15 = Math.tan(Math.PI / 12);
const homeDistance = 108 / tan15 + 100; // the nearest corners are 100 mm before the target and, with the margin of 8 %, 108 mm aside

test('the eye of a view that says nothing is where the whole plan is seen, and zooming leaves it there', () => {
  assert.ok(Math.abs(eyeAlong(cube, beamA, {}) - (100 - homeDistance)) < 1e-9);
  const { camera, beam } = zoomedEye(cube, beamA, {}, 2);
  assert.ok(Math.abs(Math.tan((camera.fov_deg * Math.PI) / 360) - tan15 / 2) < 1e-12);
  assert.ok(Math.abs(beam.along_mm - (100 - homeDistance)) < 1e-3);
  assert.deepEqual(zoomedEye(cube, beamA, { camera: { height_mm: 80 }, beam: { aperture_mm: 50 } }, 2), { camera: { height_mm: 40 } });
});

test('the ring makes the projection parallel and takes that back, and what is at the target keeps its size', () => {
  const on = ringPatch(cube, beamA, { camera: { fov_deg: 30 }, beam: { along_mm: -900 } }, 120);
  assert.ok(Math.abs(on.camera.height_mm - 2000 * tan15) < 1e-9); // the eye is 1000 mm before the target
  assert.equal(on.beam.aperture_mm, 120);
  const near = { camera: { fov_deg: 30 }, beam: { along_mm: 50 } }; // 27 mm of the target are seen
  assert.deepEqual(ringPatch(cube, beamA, near, 120).camera, { height_mm: 150 }, 'the ring has room');
  const off = ringPatch(
    cube,
    beamA,
    { camera: { fov_deg: 30, height_mm: 1000 * tan15 }, beam: { along_mm: -900, aperture_mm: 120 } },
    null,
  );
  assert.ok(Math.abs(Math.tan((off.camera.fov_deg * Math.PI) / 360) - tan15 / 2) < 1e-12);
  assert.deepEqual([off.beam.aperture_mm, off.beam.along_mm], [null, -900]);
  assert.deepEqual(
    ringPatch(cube, beamA, { camera: { projection: 'parallel' }, beam: { aperture_mm: 120 } }, null),
    { beam: { aperture_mm: null } },
    'a view that is parallel anyway stays so',
  );
});

test('the 3-D camera that takes over has the same eye, direction, up and extent', () => {
  const camera = cameraAsSeen(cube, beamA, { camera: { fov_deg: 20 }, beam: { along_mm: -300 } });
  isNear(camera.position_mm, [0, -400, 0]);
  isNear(camera.target_mm, [0, 0, 0]);
  isNear(camera.up, [0, 0, 1]);
  assert.deepEqual([camera.projection, camera.fov_deg, camera.height_mm], ['perspective', 20, null]);
  const behind = cameraAsSeen(cube, beamA, { camera: { height_mm: 150 }, beam: { along_mm: 130, aperture_mm: 120 } }); // the target lies behind this eye
  isNear(behind.position_mm, [0, 30, 0]);
  assert.ok(behind.target_mm[1] > 30);
  assert.deepEqual([behind.projection, behind.height_mm], ['parallel', 150]);
});

// ---- what slides ----------------------------------------------------------------------------------------------------------------------------

const { clipInFront, rangeAlong, regionAt, slidPatch, ticksOf } = await load('features/beams/beam_along.js');
const bands = [
  { region: 'scalp', from_mm: 20, to_mm: 30 },
  { region: 'brain', from_mm: 30, to_mm: 185.2 },
];
const sliding = (clip = {}, slice = {}) => ({
  image: { id: '' },
  beam: { id: 'a', draft: { enabled: false }, slice: { along_mm: 12, ...slice } },
  clip: { beam: { id: '', enabled: false, along_mm: 0, ...clip } },
});

test('the slider goes from before the entry to behind the last region', () => {
  assert.deepEqual(rangeAlong(cube, sliding(), beamA, bands), { low: -10, high: 196 });
  assert.deepEqual(
    rangeAlong(cube, sliding(), beamA, []),
    { low: -10, high: 210 },
    'without regions over the box: its back is 200 mm from the entry',
  );
  assert.deepEqual(ticksOf({ low: -10, high: 196 }, 5), [0, 50, 100, 150]);
  assert.deepEqual([regionAt(bands, 25), regionAt(bands, 100), regionAt(bands, 5)], ['scalp', 'brain', '']);
});

test('slice and clip plane move by one patch, or each alone, to tenths and within the range', () => {
  const range = { low: -10, high: 196 };
  assert.deepEqual(slidPatch(sliding(), 'slice', true, 44.26, range), {
    beam: { slice: { along_mm: 44.3 } },
    clip: { beam: { along_mm: 44.3 } },
  });
  assert.deepEqual(slidPatch(sliding(), 'slice', false, 500, range), { beam: { slice: { along_mm: 196 } } });
  assert.deepEqual(
    slidPatch(sliding({ id: 'b' }), 'clip', false, 7, range),
    { clip: { beam: { along_mm: 7, id: '' } } },
    'a plane across another beam comes to this one',
  );
  assert.deepEqual(clipInFront(sliding(), beamA, true, true), { clip: { beam: { enabled: true, along_mm: 12 } } });
  assert.deepEqual(clipInFront(sliding({ along_mm: 30 }), beamA, false, true), { clip: { beam: { enabled: true } } });
  assert.deepEqual(
    clipInFront(sliding({}, { along_mm: 0 }), beamA, true, true),
    { clip: { beam: { enabled: true, along_mm: 100 } }, beam: { slice: { along_mm: 100 } } },
    'what was never moved begins at the target',
  );
});

// ---- leaving the presenter -------------------------------------------------------------------------------------------------------------------

const { asShown, ownBeam, widen } = await load('room/own_camera.js');

test('an own view keeps the eye that the shared picture has, although it widens', () => {
  // perspective from (0, -400, 0) along posterior: x right, z up, w grows along posterior
  const matrix = new Float64Array([3, 0, 0, 0, 0, 0, 1, 1, 0, 3, 0, 0, 0, 0, 390, 400]);
  assert.ok(Math.abs(ownBeam(undefined, { pixels_per_mm: 0, clip_from_lps_mm: matrix }, beamA).along_mm + 300) < 1e-9);
  assert.deepEqual(ownBeam({ along_mm: 5 }, { pixels_per_mm: 0, clip_from_lps_mm: matrix }, beamA), { along_mm: 5 });
  assert.deepEqual(ownBeam({ along_mm: null, aperture_mm: 100 }, { pixels_per_mm: 2, clip_from_lps_mm: matrix }, beamA), {
    along_mm: null,
    aperture_mm: 100,
  });
  const camera = { position_mm: [0, -900, 0], target_mm: [0, 0, 0], up: [0, 0, 1], projection: 'perspective', fov_deg: 30, height_mm: 100 };
  assert.equal(widen(asShown(camera, { aperture_mm: 100 }), 'beam', 1.5).height_mm, 150, 'with a ring it is parallel');
});
