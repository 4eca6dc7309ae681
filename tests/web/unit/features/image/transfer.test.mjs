// The transfer function as its editor changes it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const {
  axisOf,
  bars,
  fromPlot,
  gapBeside,
  inserted,
  mostPoints,
  moved,
  nearest,
  recolored,
  removed,
  sampleAt,
  showPatchWithVolume,
  toPlot,
  visiblePatch,
} = await load('features/image/transfer.js');
const { mergePatch } = await load('wire/merge.js');

const axis = { low: 0, high: 1000 };
const points = [
  { value: 100, color: '#000000', opacity: 0 },
  { value: 300, color: '#ff8000', opacity: 0.5 },
  { value: 500, color: '#ffffff', opacity: 1 },
];
const isNear = (a, b) => assert.ok(Math.abs(a - b) < 1e-9, `${a}, expected ${b}`);

test('places and points say the same: half of the height stands for a quarter of the light', () => {
  assert.deepEqual(toPlot({ value: 250, opacity: 0.25 }, axis), [0.25, 0.5]);
  assert.deepEqual(fromPlot([0.25, 0.5], axis), { value: 250, opacity: 0.25 });
  assert.deepEqual([fromPlot([0, 1.2], axis).opacity, fromPlot([0, -0.2], axis).opacity], [1, 0], 'no further than the plot');
});

test('between points colour and opacity are linear, beyond the first and the last constant', () => {
  assert.deepEqual(sampleAt(points, 200), { color: '#804000', opacity: 0.25 });
  assert.deepEqual(sampleAt(points, 0), { color: '#000000', opacity: 0 });
  assert.deepEqual(sampleAt(points, 9999), { color: '#ffffff', opacity: 1 });
  assert.deepEqual(sampleAt(points, 300), { color: '#ff8000', opacity: 0.5 });
});

test('a new point keeps the order and takes the colour that is there', () => {
  const { points: list, index } = inserted(points, axis, 400, 0.2);
  assert.equal(index, 2);
  assert.deepEqual(list[2], { value: 400, color: '#ffc080', opacity: 0.2 });
  assert.deepEqual(
    list.map(({ value }) => value),
    [100, 300, 400, 500],
  );
  assert.equal(inserted(points, axis, 400).points[2].opacity, 0.75, 'without an opacity: the one that is there');
  assert.equal(inserted(points, axis, 300).index, -1, 'no second point of the same value');
  assert.equal(inserted([], axis, 10, 0.1).points.length, 1);
});

test('there are at most sixteen', () => {
  let list = [];
  for (let n = 0; n < 20; n++) list = inserted(list, axis, 10 * n + 5, 0.1).points;
  assert.equal(list.length, mostPoints);
});

test('a point never passes its neighbours', () => {
  assert.equal(moved(points, axis, 1, { value: 450 })[1].value, 450);
  assert.equal(moved(points, axis, 1, { value: 900 })[1].value, 500);
  assert.equal(moved(points, axis, 1, { value: -900 })[1].value, 100);
  assert.equal(moved(points, axis, 0, { value: -900 })[0].value, -900, 'the first has none below');
  assert.equal(moved(points, axis, 1, { opacity: 3 })[1].opacity, 1);
  assert.deepEqual(points[1], { value: 300, color: '#ff8000', opacity: 0.5 }, 'the list is not changed in place');
});

test('a point is recoloured and removed alone', () => {
  assert.deepEqual(
    recolored(points, 1, '#123456').map(({ color }) => color),
    ['#000000', '#123456', '#ffffff'],
  );
  assert.deepEqual(
    removed(points, 1).map(({ value }) => value),
    [100, 500],
  );
});

test('a point added by key lies in the wider gap beside the chosen one', () => {
  const uneven = [points[0], { ...points[1], value: 150 }, points[2]];
  assert.equal(gapBeside(uneven, axis, 1), 325);
  assert.equal(gapBeside(uneven, axis, 0), 50);
  assert.equal(gapBeside(uneven, axis, 2), 750, 'between the last and the end of the plot');
  assert.equal(gapBeside([], axis, -1), 500);
});

test('a press takes the nearest point within reach', () => {
  const size = [300, 100]; // px: the points lie at 30, 90 and 150 px from the left, at 0, 71 and 100 px from the foot
  assert.equal(nearest(points, axis, [35 / 300, 0.05], size, 12), 0);
  assert.equal(nearest(points, axis, [35 / 300, 0.2], size, 12), -1);
  assert.equal(nearest(points, axis, [130 / 300, 0.9], size, 26), 2);
});

test('the plot spans nearly all voxels and every point, with a margin of 3 %', () => {
  const found = axisOf({ low: -1000, high: 30000 }, { low: -1000, high: 30000, percentiles: { 0.1: -990, 99.9: 1510 } }, points);
  isNear(found.low, -990 - 75);
  isNear(found.high, 1510 + 75);
  isNear(axisOf({ low: 0, high: 100 }, null, points).high, 500 + 15);
});

test('bars are heights by the logarithm of the counts', () => {
  const heights = bars({ low: 0, high: 1000, counts: [0, 99, 9, 0] }, axis, 4).map(([, height]) => height);
  assert.deepEqual([heights[0], heights[1], heights[3]], [0, 1, 0]);
  isNear(heights[2], 0.5); // log 10 / log 100
});

const ct = { id: 'ct', modality: 'CT', unit: 'HU', isInverted: false, window: { center: 40, width: 400 } };
const mr = { id: 'mr', modality: 'MR', unit: '', isInverted: false, window: { center: 50, width: 100 } };
const mr2 = { id: 'mr2', modality: 'MR', unit: '', isInverted: false, window: { center: 500, width: 1000 } };
const plan = { images: [ct, mr, mr2] };
const scene = (image, list) => ({
  image: {
    id: image.id,
    window: image.window,
    color_map: 'grey',
    cull_below: -1e12,
    looks: {},
    blend: { id: '' },
    volume: { visible: false, points: list, cull_below: -1e12 },
  },
});

test('with an image in another unit the volume gets a preset of that unit; with one of the same kind the same parts of the window', () => {
  const first = mergePatch(scene(ct, points), showPatchWithVolume(plan, scene(ct, points), mr));
  assert.ok(first.image.volume.points.length > 1);
  assert.ok(
    first.image.volume.points.every(({ value }) => value >= 0 && value <= 100),
    'within the window',
  );
  const list = [
    { value: 0, color: '#000000', opacity: 0 },
    { value: 100, color: '#ffffff', opacity: 1 },
  ]; // the ends of the window
  assert.deepEqual(
    showPatchWithVolume(plan, scene(mr, list), mr2).image.volume.points.map(({ value }) => value),
    [0, 1000],
  );
});

test('a volume that has no transfer function yet gets one when it is shown', () => {
  assert.ok(visiblePatch(plan, scene(ct, []), true).image.volume.points.length > 1);
  assert.deepEqual(visiblePatch(plan, scene(ct, points), true), { image: { volume: { visible: true } } });
  assert.deepEqual(visiblePatch(plan, scene(ct, []), false), { image: { volume: { visible: false } } });
});
