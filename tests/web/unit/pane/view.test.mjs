// Cameras, letters and the painter, against figures worked out by hand.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load } from '../page.mjs';

const cameras = await load('room/camera.js');
const { turnedFor } = await load('features/image/turning.js');
const { planeOfKind, planeOfNormal } = await load('room/obliques.js');
const { axisEnds, cubeSides } = await load('pane/orientation.js');
const { edgeLetters, letters } = await load('pane/letters.js');
const { barMm, fromPicture, toPicture } = await load('parts/vec.js');
const { homeCamera } = await load('room/home.js');
const { Decoder } = await load('pane/decoder.js');
const { Painter } = await load('pane/painter.js');
const { visibleText } = await load('parts/visible_text.js');

const near = (actual, expected, tolerance = 1e-9) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${actual} is not ${expected}`));
const front = { position_mm: [0, -500, 0], target_mm: [0, 0, 0], up: [0, 0, 1], projection: 'perspective', fov_deg: 30, height_mm: null };

/** Column-major clip matrix of a parallel picture, 200 mm high and wide, from its axes. */
const parallel = (right, up, forward) =>
  Float32Array.from([0, 1, 2].flatMap((i) => [right[i] / 100, up[i] / 100, forward[i] / 1000, 0]).concat([0, 0, 0, 1]));

test('the picture from the front has patient left at its right and superior up', () => {
  const { right, up, forward } = cameras.axes(front);
  near(right, [1, 0, 0]);
  near(up, [0, 0, 1]);
  near(forward, [0, 1, 0]);
});

test("the home camera is the server's; that of oblique views, which it may not give, is as high as the highest of the slices", () => {
  const slice = (height_mm) => ({
    position_mm: [0, 0, -1000],
    target_mm: [1, 2, 3],
    up: [0, -1, 0],
    projection: 'parallel',
    fov_deg: 30,
    height_mm,
  });
  const given = { position_mm: [1, 2, 3], target_mm: [4, 5, 6], up: [0, 0, 1], projection: 'perspective', fov_deg: 30 };
  const plan = { home: { '3d': given, axial: slice(200), coronal: slice(300), sagittal: slice(250) } };
  assert.deepEqual(homeCamera(plan, '3d'), { ...given, height_mm: null });
  assert.deepEqual(homeCamera(plan, 'axial'), slice(200));
  const { target_mm, height_mm } = homeCamera(plan, 'oblique');
  assert.deepEqual([target_mm, height_mm], [[1, 2, 3], 300]);
  assert.equal(homeCamera({ home: { ...plan.home, oblique: slice(7) } }, 'oblique').height_mm, 7);
});

test("a quarter turn about the long axis looks from the patient's left", () => {
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
  const zoomed = cameras.zoomSlice(camera, planeOfKind('axial', 0), 2, [100, -50], [400, 400]);
  // before: 0.5 mm a pixel, the point lies 50 mm left, 25 mm anterior; after: 0.25 mm a pixel
  near(zoomed.target_mm, [25, -12.5, 0]);
});

test('parallel shows at the target what perspective showed, and back', () => {
  const there = cameras.project(front, 'parallel');
  assert.ok(Math.abs(there.height_mm - 1000 * Math.tan(Math.PI / 12)) < 1e-9);
  near(cameras.project(there, 'perspective').position_mm, front.position_mm, 1e-9);
});

test('locked to an axis of the patient, a drag turns about it alone, and what is seen goes with the drag', () => {
  // from anterior, right is L and up is S: a drag to the right by 30 degrees (yaw -30) about S brings the patient's right into view
  const free = cameras.orbit(front, -30, 0);
  near(cameras.orbitAbout(front, [0, 0, 1], -30, 0).position_mm, free.position_mm, 1e-9);
  // a drag down about L (pitch 30): the eye rises by 30 degrees, as without a lock
  near(cameras.orbitAbout(front, [1, 0, 0], 0, 30).position_mm, cameras.orbit(front, 0, 30).position_mm, 1e-9);
  // across the axis nothing turns
  near(cameras.orbitAbout(front, [0, 0, 1], 0, 30).position_mm, front.position_mm, 1e-9);
  near(cameras.orbitAbout(front, [1, 0, 0], 30, 0).position_mm, front.position_mm, 1e-9);
  // along the line of sight the picture rolls, and the eye stays
  const rolled = cameras.orbitAbout(front, [0, 1, 0], 30, 0);
  near(rolled.position_mm, front.position_mm, 1e-9);
  near(rolled.up, [Math.sin(Math.PI / 6), 0, Math.cos(Math.PI / 6)], 1e-9);
  // over a pole, where a free drag ends
  const over = cameras.orbitAbout(front, [1, 0, 0], 0, 120);
  near(over.position_mm, [0, 250, 500 * Math.sin((120 * Math.PI) / 180)], 1e-9);
});

test('a step of turning by itself is speed times time, and never a jump', () => {
  const angle = ({ position_mm: [x, y] }) => (Math.atan2(x, -y) * 180) / Math.PI;
  assert.ok(Math.abs(angle(turnedFor(front, 'patient', 20, 0.1)) - 2) < 1e-9, 'towards the left of the patient');
  assert.ok(Math.abs(angle(turnedFor(front, 'patient', -20, 60)) + 5) < 1e-9, 'after a wait as after a quarter of a second');
  const tilted = cameras.orbit(front, 0, 40);
  const about = cameras.axes(tilted).up;
  near(cameras.axes(turnedFor(tilted, 'picture', 30, 0.2)).up, about, 1e-9);
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
  const fixture = JSON.parse(readFileSync(new URL('../../../data/edge_letters.json', import.meta.url), 'utf8'));
  const list = ({ left, right, top, bottom }) => [left, right, top, bottom];
  for (const { kind, letters: expected } of fixture.planes)
    assert.deepEqual(list(edgeLetters(parallel(planeOfKind(kind, 0).right, planeOfKind(kind, 0).up, [0, 0, 0]))), expected, kind);
  for (const {
    about,
    camera: [position_mm, target_mm, up],
    letters: expected,
  } of fixture.cameras) {
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

test('the cube shows the sides that face the eye, each in its place', () => {
  const sides = (matrix) => Object.fromEntries(cubeSides(matrix).map((side) => [side.letter, side]));
  const front = sides(parallel([1, 0, 0], [0, 0, 1], [0, 1, 0]));
  assert.deepEqual(Object.keys(front), ['A']);
  near(front.A.middle, [0, 0]);
  assert.deepEqual(
    front.A.corners
      .map((corner) => corner.map((part) => Math.round(part * 10) / 10 || 0))
      .sort()
      .join(' '),
    '-0.5,-0.5 -0.5,0.5 0.5,-0.5 0.5,0.5',
  );
  // from 60 degrees to the patient's left and 30 above: the cosines of the sides are those of the direction to the eye
  const [c60, s60, c30, s30] = [0.5, Math.sqrt(3) / 2, Math.sqrt(3) / 2, 0.5];
  const back = [c30 * s60, -c30 * c60, s30];
  const turned = sides(
    parallel(
      [c60, s60, 0],
      [-s30 * s60, s30 * c60, c30],
      back.map((part) => -part),
    ),
  );
  assert.deepEqual(Object.keys(turned), ['A', 'S', 'L'], 'the side that faces the eye most is drawn last');
  near([turned.L.facing, turned.A.facing, turned.S.facing], [0.75, c30 / 2, 0.5], 1e-6);
  near(turned.S.middle, [0, -c30 / 2], 1e-6);
});

test('a side of the cube lies where its letter stands at the edge of the picture', () => {
  const matrix = parallel([0, -1, 0], [0, 0, 1], [1, 0, 0]); // from the right: anterior at the picture's right
  assert.equal(edgeLetters(matrix).right, 'A');
  const ends = Object.fromEntries(axisEnds(matrix, { low: [-10, -20, -30], high: [10, 20, 30] }).map((end) => [end.letter, end]));
  // 0.6 of 40 and 60 mm of 200 mm
  near([ends.A.x, ends.A.y, ends.S.x, ends.S.y], [0.5 + 24 / 200, 0.5, 0.5, 0.5 - 36 / 200], 1e-6);
  const box = { low: [-10, -20, -30], high: [10, 20, 30] };
  const through = Object.fromEntries(axisEnds(matrix, box, 'crosshair', [3, -8, 10]).map((end) => [end.letter, end]));
  near([through.A.x, through.A.y, through.S.x, through.S.y], [0.5 + 24 / 200, 0.5 - 10 / 200, 0.5 + 8 / 200, 0.5 - 36 / 200], 1e-6);
  const corner = axisEnds(matrix, box, 'corner', [0, 0, 0], [400, 200]);
  assert.deepEqual(
    corner.map(({ letter }) => letter),
    ['L', 'P', 'S'],
  );
  // 0.15 and 0.2 of 200 px from left and below, letters 0.105 of it away: P to the left, S up
  near([corner[1].x, corner[1].y, corner[2].x, corner[2].y], [(30 - 21) / 400, 1 - 40 / 200, 30 / 400, 1 - 61 / 200], 1e-6);
});

test('rolling turns the picture about its middle and nothing else', () => {
  const rolled = cameras.roll(front, 90);
  near(rolled.up, [1, 0, 0]);
  assert.deepEqual([rolled.position_mm, rolled.target_mm], [front.position_mm, front.target_mm]);
});

const box = { low: [10, 20, 30], high: [50, 60, 130] }; // its middle is 30, 40, 80

test('fitting shows the whole box from the same side, in perspective and parallel', () => {
  const fitted = cameras.fit(front, box);
  near(fitted.target_mm, [30, 40, 80]);
  near(cameras.axes(fitted).forward, [0, 1, 0]);
  // the near corners, 20 mm before the middle, are 50 mm above and below it: at tan 15 / 1.08
  assert.ok(Math.abs(cameras.distance(fitted) - ((50 * 1.08) / Math.tan(Math.PI / 12) + 20)) < 1e-9);
  assert.ok(Math.abs(cameras.fit({ ...front, projection: 'parallel', height_mm: 9 }, box).height_mm - 108) < 1e-9);
});

test('fitting a slice takes the sides of the box that lie in it', () => {
  const slice = { ...front, projection: 'parallel', height_mm: 9 };
  near(
    [cameras.fitSlice(slice, planeOfKind('axial', 0), box).height_mm, cameras.fitSlice(slice, planeOfKind('sagittal', 0), box).height_mm],
    [43.2, 108],
  );
  near(cameras.fitSlice(slice, planeOfKind('axial', 0), box).target_mm, [30, 40, 80]);
  // 45 degrees between axial and coronal: half of 40 and 100 mm along the picture's up
  near([cameras.fitSlice(slice, planeOfNormal([0, 0, 0], [0, -1, 1]), box).height_mm], [1.08 * (40 + 100) * Math.SQRT1_2], 1e-9);
});

test('a linked slice has as many mm per pixel, and the crosshair at the same place', () => {
  const axial = { ...front, target_mm: [10, 0, 0], height_mm: 200 };
  const crosshair = [30, 20, 50]; // 20 mm right of the axial picture's middle, 20 mm below it
  const other = cameras.linkedSlice(
    axial,
    planeOfKind('axial', 50),
    [400, 500],
    { ...front, height_mm: 90 },
    planeOfKind('sagittal', 30),
    [200, 300],
    crosshair,
  );
  assert.equal(other.height_mm, 100); // half a mm per pixel, 200 pixels
  near(other.target_mm, [30, 0, 70]); // right in a sagittal slice is posterior, up is superior
  const far = cameras.linkedSlice(
    { ...axial, target_mm: [-400, 0, 0] },
    planeOfKind('axial', 50),
    [400, 500],
    front,
    planeOfKind('coronal', 20),
    [200, 200],
    crosshair,
  );
  near(far.target_mm, [30 - 45, 20, 50 + 20], 1e-9); // inside the picture still
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
      return new Promise((resolve, reject) =>
        decodes.push({
          done: (name) => {
            running -= 1;
            resolve({ name, close() {} });
          },
          fail: () => {
            running -= 1;
            reject(new Error('broken'));
          },
        }),
      );
    },
    schedule: (callback) => scheduled.push(callback),
    onPainted: (header, isDrawn) => shown.push(`${isDrawn ? 'shown' : 'passed'} ${header.sequence}`),
  });
  const offer = (sequence) =>
    painter.offer({ header: { sequence, view: 1, media_type: 'image/jpeg', width_px: 4, height_px: 3 }, picture: new Uint8Array(1) });
  const settle = () =>
    new Promise((resolve) => {
      setImmediate(resolve);
    });
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

// ---- decoder ------------------------------------------------------------------------------------------------------------

class FakeWorker extends EventTarget {
  asked = [];
  isTerminated = false;
  postMessage(message) {
    this.asked.push(message);
  }
  terminate() {
    this.isTerminated = true;
  }
  tell(data) {
    this.dispatchEvent(Object.assign(new Event('message'), { data }));
  }
}

function decoderWorld() {
  const worker = new FakeWorker();
  const here = [];
  const { decode } = new Decoder({
    makeWorker: () => worker,
    decodeHere: async (picture, type) => {
      here.push([picture[0], type]);
      return `here ${picture[0]}`;
    },
  });
  return { worker, here, decode };
}

test('pictures are decoded here until the worker is ready, then there, in the order of its answers', async () => {
  const { worker, here, decode } = decoderWorld();
  assert.equal(await decode(new Uint8Array([1]), 'image/jpeg'), 'here 1');
  worker.tell({ isReady: true });
  const two = [decode(new Uint8Array([2]), 'image/jpeg'), decode(new Uint8Array([3]), 'image/png')];
  assert.deepEqual(
    worker.asked.map(({ picture, type }) => [picture[0], type]),
    [
      [2, 'image/jpeg'],
      [3, 'image/png'],
    ],
  );
  worker.tell({ id: worker.asked[1].id, bitmap: 'there 3' });
  worker.tell({ id: worker.asked[0].id, bitmap: 'there 2' });
  assert.deepEqual(await Promise.all(two), ['there 2', 'there 3']);
  assert.deepEqual(here, [[1, 'image/jpeg']]);
});

test('what the worker cannot decode is decoded here, and all of it once the worker has failed', async () => {
  const { worker, decode } = decoderWorld();
  await decode(new Uint8Array([1]), 'image/jpeg');
  worker.tell({ isReady: true });
  const broken = decode(new Uint8Array([2]), 'image/jpeg');
  worker.tell({ id: worker.asked[0].id, bitmap: null });
  assert.equal(await broken, 'here 2');
  const waiting = [3, 4].map((n) => decode(new Uint8Array([n]), 'image/jpeg'));
  worker.dispatchEvent(new Event('error'));
  assert.deepEqual(await Promise.all(waiting), ['here 3', 'here 4']);
  assert.equal(worker.isTerminated, true);
  assert.equal(await decode(new Uint8Array([5]), 'image/jpeg'), 'here 5');
  assert.equal(worker.asked.length, 3, 'a worker that has failed is asked nothing');
});

test('a browser that allows no worker decodes here', async () => {
  const { decode } = new Decoder({
    makeWorker: () => {
      throw new Error('not allowed');
    },
    decodeHere: async () => 'here',
  });
  assert.equal(await decode(new Uint8Array(1), 'image/jpeg'), 'here');
});

test('characters that do not show are the tags that captions have', () => {
  const { cases } = JSON.parse(readFileSync(new URL('../../../data/invisible_characters.json', import.meta.url), 'utf8'));
  for (const [text, shown] of cases) assert.equal(visibleText(text), shown);
  assert.equal(visibleText('\u202e'), '«RLO»');
});
