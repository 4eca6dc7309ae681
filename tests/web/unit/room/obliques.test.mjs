// Planes in any direction, against figures worked out by hand.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const planes = await load('room/obliques.js');

const near = (actual, expected, tolerance = 1e-9) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${actual} is not ${expected}`));
const half = Math.SQRT1_2;

test('a normal along a patient axis gives exactly that slice, whichever way it points', () => {
  assert.deepEqual(planes.planeOfNormal([3, 4, 5], [0, 0, -2]), { origin: [0, 0, 5], right: [1, 0, 0], up: [0, -1, 0], normal: [0, 0, 1] });
  assert.deepEqual(planes.planeOfNormal([3, 4, 5], [0, 7, 0]), { origin: [0, 4, 0], right: [1, 0, 0], up: [0, 0, 1], normal: [0, 1, 0] });
  assert.deepEqual(planes.planeOfNormal([3, 4, 5], [1, 0, 0]), { origin: [3, 0, 0], right: [0, 1, 0], up: [0, 0, 1], normal: [1, 0, 0] });
});

test('a coronal plane tilted by 30 degrees about the left axis keeps right, and up leans with it', () => {
  // normal (0, cos 30, sin 30): up stays as superior as the plane allows, so it is (0, -sin 30, cos 30)
  const { right, up, normal } = planes.planeOfNormal([0, 0, 0], [0, Math.cos(Math.PI / 6), 0.5]);
  near(normal, [0, Math.sqrt(3) / 2, 0.5]);
  near(up, [0, -0.5, Math.sqrt(3) / 2]);
  near(right, [1, 0, 0]);
});

test('a sagittal plane turned by 30 degrees about the long axis: up stays superior, right turns', () => {
  // normal (cos 30, sin 30, 0); right of the sagittal slice is posterior (0, 1, 0), here (-sin 30, cos 30, 0)
  const { right, up } = planes.planeOfNormal([0, 0, 0], [Math.sqrt(3) / 2, 0.5, 0]);
  near(up, [0, 0, 1]);
  near(right, [-0.5, Math.sqrt(3) / 2, 0]);
});

test('of equally near slices axial comes before coronal, coronal before sagittal; a normal to the negative side is turned over', () => {
  near(planes.planeOfNormal([0, 0, 0], [0, -1, -1]).normal, [0, half, half]);
  near(planes.planeOfNormal([0, 0, 0], [0, -1, -1]).up, [0, -half, half]); // the axial up, anterior, as far as it lies in the plane
  near(planes.planeOfNormal([0, 0, 0], [-1, -1, 0]).normal, [half, half, 0]);
  near(planes.planeOfNormal([0, 0, 0], [-1, -1, 0]).up, [0, 0, 1]);
});

test('right, up and normal are at right angles in any direction, with the handedness of the nearest slice', () => {
  for (const [direction, side] of [
    [[1, 2, 5], -1],
    [[1, -5, 2], -1],
    [[5, 1, -2], 1],
  ]) {
    const { right, up, normal } = planes.planeOfNormal([0, 0, 0], direction);
    const cross = [right[1] * up[2] - right[2] * up[1], right[2] * up[0] - right[0] * up[2], right[0] * up[1] - right[1] * up[0]];
    near(
      cross,
      normal.map((part) => part * side),
    ); // axial: L x A = -S, coronal: L x S = -P, sagittal: P x S = L
  }
});

test('turn and tilt name a direction: 0 anterior, 90 left, upwards superior; and back', () => {
  near(planes.normalOfAngles(0, 0), [0, -1, 0], 1e-6);
  near(planes.normalOfAngles(90, 0), [1, 0, 0], 1e-6);
  near(planes.normalOfAngles(-90, 0), [-1, 0, 0], 1e-6);
  near(planes.normalOfAngles(12, 90), [0, 0, 1], 1e-6);
  near(planes.normalOfAngles(30, 60), [0.25, -Math.sqrt(3) / 4, Math.sqrt(3) / 2], 1e-6);
  assert.deepEqual(planes.anglesOf([0, -3, 0]), { turn: 0, tilt: 0 });
  assert.deepEqual(planes.anglesOf([0, 0, -1]), { turn: 0, tilt: -90 });
  const { turn, tilt } = planes.anglesOf([0.25, -Math.sqrt(3) / 4, Math.sqrt(3) / 2]);
  near([turn, tilt], [30, 60], 1e-3);
  assert.equal(planes.facing([0.25, -Math.sqrt(3) / 4, Math.sqrt(3) / 2]), '30° left of anterior, 60° up');
  assert.equal(planes.facing([0, 0, 1]), 'superior');
});

test('the plane through three points holds them; three on a line make none', () => {
  const points = [
    [10, 0, 0],
    [0, 20, 0],
    [0, 0, 20],
  ];
  const { origin_mm: origin, normal } = planes.throughPoints(...points);
  near(
    normal,
    [2, 1, 1].map((part) => part / Math.sqrt(6)),
    1e-6,
  ); // x / 10 + y / 20 + z / 20 = 1
  for (const point of points) near([point.reduce((sum, value, axis) => sum + (value - origin[axis]) * normal[axis], 0)], [0], 1e-3);
  assert.equal(planes.throughPoints([0, 0, 0], [1, 1, 1], [5, 5, 5]), null);
});

test('the plane through a line drawn on an axial slice stands upright on it', () => {
  const plane = planes.throughLine(planes.planeOfKind('axial', 12), [0, 0, 12], [30, 30, 12]);
  near(plane.origin_mm, [15, 15, 12]);
  near(
    plane.normal,
    [half, -half, 0].map((part) => -part),
    1e-6,
  ); // across the line, to the posterior side: the coronal slice is as near as the sagittal one and comes first
  assert.equal(planes.throughLine(planes.planeOfKind('axial', 0), [1, 1, 0], [1, 1, 0]), null);
});

test('the plane along a beam holds its axis and is upright; along a vertical beam it is sagittal', () => {
  const beam = { entry_mm: [0, -100, 0], target_mm: [100, 0, 50] };
  const { origin_mm: origin, normal } = planes.alongBeam(beam);
  near(origin, beam.target_mm);
  near([normal[0] * 100 + normal[1] * 100 + normal[2] * 50], [0], 1e-3);
  near([normal[2]], [0]);
  assert.deepEqual(planes.alongBeam({ entry_mm: [5, 5, 100], target_mm: [5, 5, 0] }).normal, [1, 0, 0]);
});

test('the crosshair is seen at its nearest point in an oblique plane, which moves along its normal inside the box', () => {
  const plane = planes.planeOfNormal([0, 0, 10], [0, 1, 1]);
  near(planes.nearestIn(plane, [7, 0, 20]), [7, -5, 15]); // 10 / sqrt 2 above the plane, so (5, 5) back along (0, 1, 1)
  near([planes.positionOf(plane)], [10 * half]);
  near(planes.scrolledOrigin(plane, Math.SQRT2, { low: [-50, -50, -50], high: [50, 50, 50] }), [0, 1, 11]);
  // the plane last touches the box at its corner (y, z) = (50, 50), at 100 / sqrt 2
  const end = planes.scrolledOrigin(plane, 1e6, { low: [-50, -50, -50], high: [50, 50, 50] });
  near([end[1] * half + end[2] * half], [100 * half], 1e-3);
});

test('a step of the wheel across a plane is the step of the slice it is nearest to', () => {
  near([planes.stepAcross([0, 0, 1], [1, 1, 3])], [3]);
  near([planes.stepAcross([0, half, half], [1, 1, 3])], [2]);
});

test('a view shows the plane it names; one that is not there is the axial slice', () => {
  const scene = {
    image: {
      slices: { sagittal: { position_mm: 1 }, coronal: { position_mm: 2 }, axial: { position_mm: 3 } },
      obliques: { a: { origin_mm: [1, 1, 1], normal: [1, 0, 0] } },
    },
  };
  assert.deepEqual(planes.planeOfView(scene, { kind: 'coronal' }).origin, [0, 2, 0]);
  assert.deepEqual(planes.planeOfView(scene, { kind: 'oblique', plane: 'a' }).normal, [1, 0, 0]);
  assert.deepEqual(planes.planeOfView(scene, { kind: 'oblique', plane: 'b' }), planes.planeOfKind('axial', 3));
});

test('ids and names of planes: the first number that is free', () => {
  assert.equal(planes.freeId({ 'plane-1': {}, 'plane-3': {} }), 'plane-2');
  assert.equal(planes.obliqueName('plane-2'), 'Plane 2');
  assert.equal(planes.obliqueName('plane-2', { name: 'Optic nerve' }), 'Optic nerve');
});
