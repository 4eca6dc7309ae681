// Cameras, letters and the painter, against figures worked out by hand.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load } from './page.mjs';

const cameras = await load('view/camera.js');
const { axesFigure, edgeLetters, letters } = await load('view/letters.js');
const { barMm, fromPicture, toPicture } = await load('view/vec.js');
const { homeCamera } = await load('view/home.js');
const { Painter } = await load('view/painter.js');

const near = (actual, expected, tolerance = 1e-9) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${actual} is not ${expected}`));
const front = { position_mm: [0, -500, 0], target_mm: [0, 0, 0], up: [0, 0, 1], projection: 'perspective', fov_deg: 30, height_mm: null };

/** Column-major clip matrix of a parallel picture, 200 mm high and wide, from its axes. */
const parallel = (right, up, forward) => Float32Array.from([0, 1, 2].flatMap((i) => [right[i] / 100, up[i] / 100, forward[i] / 1000, 0]).concat([0, 0, 0, 1]));

test('the picture from the front has patient left at its right and superior up', () => {
  const { right, up, forward } = cameras.axes(front);
  near(right, [1, 0, 0]);
  near(up, [0, 0, 1]);
  near(forward, [0, 1, 0]);
});

test('the home picture is a three-quarter view that holds the whole plan and touches its corners', () => {
  // the box, angles and margin of tests/unit/test_camera.c: 100 x 80 x 60 mm around (10, 20, 30)
  const bounds = { low: [-40, -20, 0], high: [60, 60, 60] };
  const home = homeCamera({ bounds, images: [], home: {} }, '3d');
  const c30 = Math.sqrt(3) / 2, c12 = Math.cos(Math.PI / 15), s12 = Math.sin(Math.PI / 15);
  const { right, up, forward } = cameras.axes(home);
  near(home.target_mm, [10, 20, 30]);
  near(right, [c30, 0.5, 0]);
  near(up, [-s12 / 2, s12 * c30, c12]);
  near(forward, [-c12 / 2, c12 * c30, -s12]);
  const along = (a, b) => a.reduce((sum, value, axis) => sum + value * b[axis], 0);
  const shares = [0, 1, 2, 3, 4, 5, 6, 7].map((at) => {
    const corner = [0, 1, 2].map((axis) => bounds[at >> axis & 1 ? 'high' : 'low'][axis] - home.position_mm[axis]);
    return Math.max(Math.abs(along(corner, right)), Math.abs(along(corner, up))) / along(corner, forward) / Math.tan(Math.PI / 12);
  });
  near([Math.max(...shares)], [1 / 1.08]);
});

test('a small lesion in a large image is framed by the image', () => {
  const plan = { bounds: { low: [0, 0, 0], high: [10, 10, 10] }, images: [{ bounds: { low: [-95, -94, -93], high: [105, 106, 107] } }], home: {} };
  near(homeCamera(plan, '3d').target_mm, [5, 6, 7]);
});

test('a quarter turn about the long axis looks from the patient\'s left', () => {
  const turned = cameras.orbit(front, 90, 0);
  near(turned.position_mm, [500, 0, 0]);
  near(turned.up, [0, 0, 1]);
});

test('turning up by 30 degrees lifts the eye by half the distance', () => {
  near(cameras.orbit(front, 0, 30).position_mm, [0, -500 * Math.cos(Math.PI / 6), 250]);
});

test('turning stops at the pole, with anterior down the picture from above', () => {
  const top = cameras.orbit(front, 0, 200);
  near(top.position_mm, [0, 0, 500], 1e-6);
  near(top.up, [0, 1, 0], 1e-6);
});

test('panning moves what is at the target with the pointer', () => {
  // 30 degrees across 600 px at 500 mm: 2 * 500 * tan 15 / 600 mm a pixel
  const mm = (1000 * Math.tan(Math.PI / 12)) / 600;
  near(cameras.pan(front, 100, 50, [800, 600]).target_mm, [-100 * mm, 0, 50 * mm]);
});

test('zooming by two halves the distance, and the height where there is one', () => {
  near(cameras.zoom(front, 2).position_mm, [0, -250, 0]);
  assert.equal(cameras.zoom({ ...front, height_mm: 300 }, 2).height_mm, 150);
});

test('a slice zoomed about a point keeps that point', () => {
  const camera = { ...front, projection: 'parallel', height_mm: 200 };
  const zoomed = cameras.zoomSlice(camera, 'axial', 2, [100, -50], [400, 400]);
  // before: 0.5 mm a pixel, the point lies 50 mm left, 25 mm anterior; after: 0.25 mm a pixel
  near(zoomed.target_mm, [25, -12.5, 0]);
});

test('parallel shows at the target what perspective showed, and back', () => {
  const there = cameras.project(front, 'parallel');
  assert.ok(Math.abs(there.height_mm - 1000 * Math.tan(Math.PI / 12)) < 1e-9);
  near(cameras.project(there, 'perspective').position_mm, front.position_mm, 1e-9);
});

test('from superior, anterior is up', () => {
  const top = cameras.lookFrom(front, 'superior');
  near(top.position_mm, [0, 0, 500]);
  near(cameras.axes(top).right, [-1, 0, 0]);
});

test('letters of the standard slices', () => {
  assert.deepEqual(edgeLetters(parallel([1, 0, 0], [0, -1, 0], [0, 0, 1])), { left: 'R', right: 'L', top: 'A', bottom: 'P' });
  assert.deepEqual(edgeLetters(parallel([0, 1, 0], [0, 0, 1], [-1, 0, 0])), { left: 'A', right: 'P', top: 'S', bottom: 'I' });
  assert.deepEqual(edgeLetters(parallel([1, 0, 0], [0, 0, 1], [0, 1, 0])), { left: 'R', right: 'L', top: 'S', bottom: 'I' });
});

test('letters are those that the pictures of reports have', () => {
  const fixture = JSON.parse(readFileSync(new URL('../../data/edge_letters.json', import.meta.url), 'utf8'));
  const list = ({ left, right, top, bottom }) => [left, right, top, bottom];
  for (const { kind, letters: expected } of fixture.planes)
    assert.deepEqual(list(edgeLetters(parallel(cameras.planes[kind].right, cameras.planes[kind].up, [0, 0, 0]))), expected, kind);
  for (const { about, camera: [position_mm, target_mm, up], letters: expected } of fixture.cameras) {
    const axes = cameras.axes({ ...front, position_mm, target_mm, up });
    assert.deepEqual(list(edgeLetters(parallel(axes.right, axes.up, axes.forward))), expected, about);
  }
});

test('oblique directions get a second letter from a cosine of 0.30 on', () => {
  const at = (degrees) => [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180), 0];
  assert.equal(letters(at(17)), 'L'); // sine 0.292
  assert.equal(letters(at(18)), 'LP'); // sine 0.309
  assert.equal(letters(at(60)), 'PL');
  assert.equal(letters(at(-150)), 'RA');
});

test('the axes figure tells what points away', () => {
  const ends = Object.fromEntries(axesFigure(parallel([1, 0, 0], [0, 0, 1], [0, 1, 0])).map((end) => [end.letter, end]));
  near([ends.L.x, ends.L.y, ends.S.x, ends.S.y], [1, 0, 0, -1]);
  assert.ok(ends.P.isAway && !ends.A.isAway && !ends.L.isAway);
});

test('points go into a picture and back', () => {
  const matrix = parallel([1, 0, 0], [0, -1, 0], [0, 0, 1]);
  near(toPicture(matrix, [50, -50, 7]), [0.75, 0.25], 1e-6);
  near(fromPicture(matrix, [0.75, 0.25], [0, 0, 7]), [50, -50, 7], 1e-4);
});

test('the scale bar is the longest round length within 110 px', () => {
  assert.equal(barMm(2), 50);
  assert.equal(barMm(2.3), 20);
  assert.equal(barMm(0.5), 200);
});

// ---- painter ------------------------------------------------------------------------------------------------------------

function painterWorld() {
  const decodes = [];
  const scheduled = [];
  const shown = [];
  let running = 0;
  let most = 0;
  const canvas = { width: 0, height: 0, getContext: () => ({ drawImage: (bitmap) => shown.push(bitmap.name) }) };
  const painter = new Painter(canvas, {
    decode: () => {
      most = Math.max(most, ++running);
      return new Promise((resolve, reject) => decodes.push({
        done: (name) => { running -= 1; resolve({ name, close() {} }); },
        fail: () => { running -= 1; reject(new Error('broken')); },
      }));
    },
    schedule: (callback) => scheduled.push(callback),
    onPainted: (header, isDrawn) => shown.push(`${isDrawn ? 'shown' : 'passed'} ${header.sequence}`),
  });
  const offer = (sequence) => painter.offer({ header: { sequence, view: 1, media_type: 'image/jpeg', width_px: 4, height_px: 3 }, picture: new Uint8Array(1) });
  const settle = () => new Promise((resolve) => { setImmediate(resolve); });
  const paint = () => scheduled.splice(0).forEach((callback) => callback());
  return { painter, offer, decodes, shown, settle, paint, most: () => most };
}

test('one picture is decoded at a time, one waits, the newest wins', async () => {
  const { offer, decodes, shown, settle, paint, most } = painterWorld();
  for (const sequence of [1, 2, 3, 4]) offer(sequence);
  assert.equal(decodes.length, 1);
  decodes[0].done('one');
  await settle();
  assert.equal(decodes.length, 2, 'the newest goes next');
  decodes[1].done('four');
  await settle();
  paint();
  assert.deepEqual(shown, ['four', 'shown 4'], 'what was not painted is not told as shown');
  assert.equal(most(), 1);
});

test('a picture that cannot be decoded is acknowledged and not drawn', async () => {
  const { offer, decodes, shown, settle } = painterWorld();
  offer(7);
  decodes[0].fail();
  await settle();
  assert.deepEqual(shown, ['passed 7']);
});
