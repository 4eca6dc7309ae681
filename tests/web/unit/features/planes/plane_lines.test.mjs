// Where planes cut the slice of a pane, against figures worked out by hand; the keys of a slider.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { handleBox, heightAt, heightsOver, keptPart, lineOf, namePlace, onLine, takenIn } = await load('features/planes/plane_lines.js');
const { sliderKey } = await load('parts/slider_keys.js');
const { overlap } = await load('parts/place.js');

const near = (actual, expected, tolerance = 1e-4) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${actual} is not ${expected}`));
/** An axial picture of 200 x 200 mm in 400 x 400 px whose middle is the patient's origin: x = L, y down = P, 2 px per mm. */
const matrix = Float32Array.from([1 / 100, 0, 0, 0, 0, -1 / 100, 0, 0, 0, 0, 1 / 1000, 0, 0, 0, 0, 1]);
const box = { x: 10, y: 20, width: 400, height: 400 };
const through = [0, 0, 30];
const of = (origin, normal) => heightsOver({ origin, normal }, matrix, through, box);

test('a sagittal plane is an upright line at its position, over it the side of its normal', () => {
  const heights = of([25, 0, 0], [1, 0, 0]);
  near([heightAt(heights, [10, 20]), heightAt(heights, [410, 420])], [-125, 75]);
  const line = lineOf(heights, box); // 25 mm left of the middle at (210, 220): 50 px to the right
  near([...line.from, ...line.to], [260, 20 + 26, 260, 420 - 26], 1e-3);
  near(line.over, [1, 0]);
  near(lineOf(of([25, 0, 0], [-1, 0, 0]), box).over, [-1, 0]);
});

test('a plane that leans against the slice cuts it where their heights meet', () => {
  // normal (1, 0, 1) through the origin: at S 30 it is met at L = -30, that is 60 px left of the middle
  const line = lineOf(of([0, 0, 0], [Math.SQRT1_2, 0, Math.SQRT1_2]), box);
  near([line.from[0], line.to[0]], [150, 150], 1e-3);
});

test('a plane along the slice, or outside the picture, has no line', () => {
  assert.equal(lineOf(of([0, 0, 12], [0, 0, 1]), box), null);
  assert.equal(lineOf(of([101, 0, 0], [1, 0, 0]), box), null);
});

test('a slanted line ends inside the picture, its left end first', () => {
  const heights = of(
    [0, 0, 0],
    [1, 2, 0].map((part) => part / Math.sqrt(5)),
  ); // L + 2 P = 0: 87 mm left of the middle 43.5 mm below it
  const { from, to } = lineOf(heights, box);
  near([...from, ...to], [36, 307, 384, 133], 1e-3);
  near(lineOf(heights, box, [-1, 0]).from, [384, 133], 1e-3); // as it ran before, so that a handle stays at its end while the line turns
  near(onLine({ from, to }, 0.5), [210, 220], 1e-3);
});

const area = (polygon) => Math.abs(polygon.reduce((sum, [x, y], n) => sum + polygon.at(n - 1)[0] * y - x * polygon.at(n - 1)[1], 0)) / 2;

test('what is kept is what no plane cuts off', () => {
  assert.equal(area(keptPart([], box)), 400 * 400);
  near([area(keptPart([of([25, 0, 0], [1, 0, 0])], box))], [250 * 400], 2);
  near([area(keptPart([of([25, 0, 0], [1, 0, 0]), of([0, -50, 0], [0, -1, 0])], box))], [250 * 300], 2);
  near([area(keptPart([of([0, 0, 0], [Math.SQRT1_2, Math.SQRT1_2, 0])], box))], [(400 * 400) / 2], 2);
  assert.deepEqual(
    keptPart([of([-10, 0, 0], [1, 0, 0]), of([10, 0, 0], [-1, 0, 0])], box),
    [],
    'two planes that have passed each other leave nothing',
  );
});

test('a slice beyond a plane along it is cut off as a whole; one in the plane is not', () => {
  assert.deepEqual(keptPart([of([0, 0, 29], [0, 0, 1])], box), []);
  assert.equal(area(keptPart([of([0, 0, 30], [0, 0, 1])], box)), 400 * 400);
  assert.equal(area(keptPart([of([0, 0, 31], [0, 0, 1])], box)), 400 * 400);
});

test('a name stands beside its line and over nothing else', () => {
  const line = lineOf(of([25, 0, 0], [1, 0, 0]), box);
  const taken = [...takenIn([420, 440], false), handleBox(onLine(line, 0.1))];
  const first = namePlace(line, 'Sagittal, keeps right', [420, 440], taken);
  assert.ok(first.x > 260, 'right of the line');
  const second = namePlace(line, 'Sagittal, keeps right', [420, 440], [...taken, first]);
  for (const other of [...taken, first]) assert.equal(overlap(second, other), 0);
  assert.equal(namePlace(line, 'Sagittal, keeps right', [420, 440], [{ x: 0, y: 0, width: 420, height: 440 }]), null);
});

test('keys of a slider: 1 mm, with Shift or page keys 10, and its ends', () => {
  const range = { low: -60, high: 60.1 };
  const go = (key, shiftKey = false) => sliderKey({ key, shiftKey }, 12.5, range);
  assert.deepEqual([go('ArrowUp'), go('ArrowRight'), go('ArrowDown'), go('ArrowLeft')], [13.5, 13.5, 11.5, 11.5]);
  assert.deepEqual([go('ArrowUp', true), go('PageDown'), go('Home'), go('End')], [22.5, 2.5, -60, 60.1]);
  assert.equal(sliderKey({ key: 'ArrowUp' }, 60, range), 60.1);
  assert.equal(go('c'), null);
  assert.equal(sliderKey({ key: 'ArrowUp', ctrlKey: true }, 12.5, range), null);
});
