// Measures: lengths, angles and areas by hand, planes of panes, points that are moved, statistics of ellipses.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const m = await load('features/measures/measures.js');
const { Ellipses, restMs } = await load('features/measures/ellipses.js');
const { labelBox, takenIn } = await load('features/measures/measure_label.js');

const isNear = (a, b, tolerance = 1e-9) => assert.ok(Math.abs(a - b) <= tolerance, `${a}, expected ${b}`);
const areNear = (a, b, tolerance) => a.forEach((value, at) => isNear(value, b[at], tolerance));
const measure = (kind, ...points) => ({ kind, name: '', visible: true, image: '', points: m.listed(points) });

test("a distance is Pythagoras' in three dimensions", () => {
  assert.equal(m.valueOf(measure('distance', [1, 2, 3], [3, 5, 9])), 7); // 2, 3, 6
  assert.equal(m.valueOf(measure('distance', [1, 2, 3])), null);
});

test('an angle is at the second point, from 0 to 180 degrees', () => {
  isNear(m.valueOf(measure('angle', [1, 0, 0], [0, 0, 0], [0, 5, 0])), 90);
  isNear(m.valueOf(measure('angle', [2, 0, 0], [0, 0, 0], [-7, 0, 0])), 180);
  isNear(m.valueOf(measure('angle', [1, 0, 0], [0, 0, 0], [Math.cos(Math.PI / 3), 0, Math.sin(Math.PI / 3)])), 60, 0.05); // points are kept to 1 um
  isNear(m.angleDeg([10, 0, 0], [0, 0, 0], [10, 1e-6, 0]), (1e-7 * 180) / Math.PI, 1e-12); // no loss of digits by an arc cosine
  assert.ok(Number.isNaN(m.valueOf(measure('angle', [0, 0, 0], [0, 0, 0], [1, 0, 0]))));
});

test('a polyline is as long as its parts', () => {
  assert.equal(m.valueOf(measure('polyline', [0, 0, 0], [3, 4, 0], [3, 4, 12], [3, 5, 12])), 18); // 5 + 12 + 1
});

test('an ellipse has the area pi a b, also by half diameters that are not at right angles', () => {
  isNear(m.valueOf(measure('ellipse', [10, 10, 10], [13, 10, 10], [10, 12, 10])), 6 * Math.PI);
  isNear(
    m.areaMm2([
      [0, 0, 0],
      [3, 0, 0],
      [3, 2, 0],
    ]),
    6 * Math.PI,
  ); // sheared: the same area
  for (const [x, y] of m.around([
    [0, 0, 0],
    [3, 0, 0],
    [0, 2, 0],
  ]))
    isNear((x / 3) ** 2 + (y / 2) ** 2, 1);
});

test('a measure lies in a plane when all of it is within half a voxel', () => {
  const image = {
    lpsFromIjk: [
      [1, 0, 0, 0],
      [0, 1, 0, 0],
      [0, 0, 3, 0],
    ],
  };
  const plane = { origin: [0, 0, 10], normal: [0, 0, 1] };
  const half = m.halfVoxelMm(image, plane.normal);
  assert.equal(half, 1.5);
  isNear(m.halfVoxelMm(image, [0, 0.6, 0.8]), (0.6 + 2.4) / 2);
  assert.equal(
    m.isIn(
      [
        [0, 0, 10],
        [5, 5, 11.5],
      ],
      plane,
      half,
    ),
    true,
  );
  assert.equal(
    m.isIn(
      [
        [0, 0, 10],
        [5, 5, 11.6],
      ],
      plane,
      half,
    ),
    false,
  );
});

test("ids are the first that is free, and one's own are never the presenter's", () => {
  assert.equal(m.freeId({ m1: {}, m3: {} }, true), 'm2');
  assert.equal(m.freeId({ m1: {} }, false), 'own1');
  assert.deepEqual(m.removePatch('m1', true), { measures: { m1: null } });
  assert.deepEqual(m.removePatch('m1', false), { measures: { m1: { visible: false } } });
  assert.deepEqual(m.removePatch('own1', false), { measures: { own1: null } });
});

test('the points of an ellipse keep its half axes at right angles and in its plane', () => {
  const circle = m.circle(
    [
      [0, 0, 7],
      [3, 0, 7],
    ],
    [0, 0, 1],
  );
  areNear(circle[2], [0, 3, 7]);
  const turned = m.withPoint('ellipse', circle, 1, [0, 5, 7]); // the first half axis now along P, 5 long; the other one stays 3 long
  isNear(m.areaMm2(turned), 15 * Math.PI);
  isNear(m.distanceMm(turned[0], turned[2]), 3);
  isNear(turned[2][1], 0);
  const flat = m.withPoint('ellipse', circle, 2, [100, 1, 7]); // only its distance from the first axis counts
  areNear(flat[2], [0, 1, 7]);
  areNear(m.withPoint('ellipse', circle, 0, [1, 1, 7])[2], [1, 4, 7], 1e-12);
  assert.deepEqual(
    m.withPoint(
      'distance',
      [
        [0, 0, 0],
        [1, 0, 0],
      ],
      1,
      [2, 0, 0],
    ),
    [
      [0, 0, 0],
      [2, 0, 0],
    ],
  );
});

test('a measure made by key is 40 mm across', () => {
  const axes = { right: [1, 0, 0], up: [0, 0, 1] };
  for (const [kind, value] of [
    ['distance', 40],
    ['angle', 90],
    ['polyline', 40 * Math.SQRT2],
    ['ellipse', 200 * Math.PI],
  ])
    isNear(m.valueOf(measure(kind, ...m.pointsAround(kind, [5, 6, 7], axes))), value, 0.01);
});

test('statistics are asked for when an ellipse rests, and only the newest answer counts', async () => {
  const timers = [];
  const clock = {
    setTimeout: (act, ms) => timers.push({ act, ms }) - 1,
    clearTimeout: (at) => {
      if (timers[at]) timers[at].act = () => {};
    },
  };
  const asked = [];
  const ellipses = new Ellipses((plan, image, points) => {
    asked.push(points[0][0]);
    return Promise.resolve({ mean: points[0][0], sd: 1, n: 10 });
  }, clock);
  const of = (x) =>
    ellipses.of('m1', 'p', 'ct', [
      [x, 0, 0],
      [1, 0, 0],
      [0, 1, 0],
    ]);
  assert.deepEqual(of(1), { isOld: true, statistics: null });
  of(2);
  of(2);
  assert.equal(timers.length, 2, 'the same ellipse is not asked for twice');
  assert.equal(timers[1].ms, restMs);
  for (const { act } of timers) act();
  await new Promise((done) => {
    setImmediate(done);
  });
  assert.deepEqual(asked, [2], 'one that moved on is not asked for');
  assert.deepEqual(of(2), { isOld: false, statistics: { mean: 2, sd: 1, n: 10 } });
  assert.equal(of(3).statistics.mean, 2, 'the last ones stay until the new ones come');
  assert.equal(of(3).isOld, true);
});

test('no value lies over the crosshair, a letter or another value', () => {
  const mark = { x: 100, y: 100 };
  const isFree = (a, b) => a.x >= b.x + b.width || a.x + a.width <= b.x || a.y >= b.y + b.height || a.y + a.height <= b.y;
  const around = ([x, y]) => ({ x: x - 13, y: y - 13, width: 26, height: 26 });
  const taken = takenIn([260, 200], false, mark);
  const values = [
    [80, 80],
    [100, 100],
    [40, 12],
    [250, 100],
    [95, 5],
    [100, 100],
  ].map(([x, y]) => labelBox(['123.4 mm'], { x, y }, [260, 200], taken));
  for (const [at, value] of values.entries()) {
    for (const place of [
      [100, 100],
      [13, 100],
      [247, 100],
      [130, 13],
    ])
      assert.ok(isFree(value, around(place)), `${JSON.stringify(value)} over ${place}`);
    for (const other of values.slice(0, at)) assert.ok(isFree(value, other));
    assert.ok(
      value.x >= 0 && value.y >= 0 && value.x + value.width <= 260 && value.y + value.height <= 170,
      'inside, above the strip at the foot',
    );
  }
});
