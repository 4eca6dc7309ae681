// How an image is shown: presets, windows, another image with its own look, a second image.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const {
  blendedImage,
  draggedWindow,
  endsOf,
  isSameWindow,
  lookOf,
  lookPatch,
  roundedWindow,
  showPatch,
  usualCull,
  windowFrom,
  windowPresets,
} = await load('room/image_look.js');
const { Histograms } = await load('features/image/histograms.js');
const { mergePatch } = await load('wire/merge.js');

const image = (id, modality, unit, window, more = {}) => ({
  id,
  modality,
  unit,
  low: -1000,
  high: 3000,
  isInverted: false,
  window,
  ...more,
});
const ct = image('ct', 'CT', 'HU', { center: 40, width: 400 });
const pet = image('pet', 'PET', 'Bq/ml', { center: 500, width: 1000 }, { low: 0, high: 20000 });
const mr = image('mr', 'MR', '', { center: 50, width: 300 }, { low: 0, high: 900 });
const plan = { images: [ct, pet, mr] };
const scene = () => ({
  image: {
    id: '',
    window: { center: 40, width: 400 },
    color_map: 'grey',
    cull_below: -500,
    low_values: 'own',
    looks: {},
    blend: { id: '', opacity: 0.5 },
  },
});

test('presets of a CT are in HU, width before centre as radiologists say them: soft 400/40, lung 1500/-600, brain 80/40, bone 2500/480', () => {
  const presets = windowPresets(ct);
  assert.deepEqual(
    presets.slice(0, 4).map(({ key, width, center }) => [key, width, center]),
    [
      ['1', 400, 40],
      ['2', 1500, -600],
      ['3', 80, 40],
      ['4', 2500, 480],
    ],
  );
  assert.deepEqual(presets[4], { key: '5', name: 'Full range', center: 1000, width: 4000 });
  assert.deepEqual(
    presets.slice(5).map(({ name, width, center }) => [name, width, center]),
    [
      ['Head', 125, 45],
      ['Spine', 300, 30],
      ['Abdomen', 350, 40],
      ['CT bone', 1000, 400],
    ],
  );
});

test('presets of MR and PET are between percentiles, and only those that are known', () => {
  const presets = windowPresets(mr, { percentiles: { 0.1: 10, 1: 20, 99: 600, 99.9: 810 } });
  assert.deepEqual(
    presets.map(({ key, center, width }) => [key, center, width]),
    [
      ['1', 410, 800],
      ['2', 310, 580],
      ['3', 50, 300],
      ['5', 450, 900],
    ],
  );
  assert.deepEqual(
    windowPresets(mr).map(({ key }) => key),
    ['3', '5'],
  );
  assert.deepEqual(
    windowPresets(mr, { percentiles: { 0.1: 0, 1: 0, 99: 0, 99.9: 5 } }).map(({ key }) => key),
    ['1', '3', '5'],
    'an image that is nearly all air has no window between equal percentiles',
  );
});

test('a window has two ends, whichever is given first', () => {
  assert.deepEqual(endsOf({ center: 40, width: 400 }), { low: -160, high: 240 });
  assert.deepEqual(windowFrom(240, -160), { center: 40, width: 400 });
  assert.ok(windowFrom(7, 7).width > 0);
});

test('a window is rounded to a thousandth of its width, and to 0.1 where it is wide', () => {
  assert.deepEqual(roundedWindow({ center: 40.04, width: 400.26 }), { center: 40, width: 400.3 });
  assert.deepEqual(roundedWindow({ center: 0.123456, width: 0.5 }), { center: 0.1235, width: 0.5 });
  assert.deepEqual(roundedWindow({ center: 5e-14, width: 1e-13 }), { center: 5e-14, width: 1e-13 });
  assert.deepEqual(roundedWindow({ center: 1e12, width: 2e12 }), { center: 1e12, width: 2e12 });
});

test('a drag by 250 px to the right doubles the width, by 125 px down lowers the centre by half a width', () => {
  assert.deepEqual(draggedWindow(ct, { center: 40, width: 400 }, 250, 0), { center: 40, width: 800 });
  assert.deepEqual(draggedWindow(ct, { center: 40, width: 400 }, 0, 125), { center: -160, width: 400 });
  assert.equal(draggedWindow(ct, { center: 40, width: 400 }, -1000, 0).width, 1, 'never under 1 HU');
  assert.equal(draggedWindow(pet, { center: 40, width: 400 }, -1000, 0).width, 2, "nor under a 10000th of the image's range");
});

test('each image keeps its own window and colours, and is shown with them again; one patch each', () => {
  let now = scene();
  now = mergePatch(now, { image: { window: { center: 300, width: 1500 } } });
  now = mergePatch(now, showPatch(plan, now, pet));
  assert.deepEqual([now.image.id, now.image.window, now.image.color_map], ['pet', { center: 500, width: 1000 }, 'grey']);
  now = mergePatch(now, lookPatch(plan, now, pet, { color_map: 'hot-iron' }));
  now = mergePatch(now, showPatch(plan, now, ct));
  assert.deepEqual([now.image.window, now.image.color_map], [{ center: 300, width: 1500 }, 'grey']);
  now = mergePatch(now, showPatch(plan, now, pet));
  assert.deepEqual(lookOf(plan, now, pet), { window: { center: 500, width: 1000 }, color_map: 'hot-iron' });
  assert.deepEqual(lookOf(plan, now, mr), { window: { center: 50, width: 300 }, color_map: 'grey' }, 'never shown: its own');
});

test('the look of an image that is not shown is written whole', () => {
  assert.deepEqual(lookPatch(plan, scene(), mr, { color_map: 'rainbow' }), {
    image: { looks: { mr: { window: { center: 50, width: 300 }, color_map: 'rainbow' } } },
  });
});

test("the threshold of slices in 3-D is the new image's, and stays off where it was off", () => {
  assert.equal(showPatch(plan, scene(), pet).image.cull_below, 50, 'a twentieth of the window above its lower end');
  const off = mergePatch(scene(), { image: { cull_below: -1e12 } });
  assert.equal('cull_below' in showPatch(plan, off, pet).image, false);
  assert.equal(usualCull(ct), -500);
  assert.equal(usualCull({ ...mr, isInverted: true }), -1e12);
});

test('an image that is blended over another is not any more when it is shown itself', () => {
  const now = mergePatch(scene(), { image: { blend: { id: 'pet' } } });
  assert.equal(blendedImage(plan, now), pet);
  assert.equal(mergePatch(now, showPatch(plan, now, pet)).image.blend.id, '');
  assert.equal(blendedImage(plan, mergePatch(now, { image: { id: 'pet' } })), null);
});

test('equal windows differ by less than what rounding leaves', () => {
  assert.equal(isSameWindow({ center: 40, width: 400 }, { center: 40.1, width: 400.1 }), true);
  assert.equal(isSameWindow({ center: 40, width: 400 }, { center: 41, width: 400 }), false);
});

test('a histogram is asked for once; an image without one is not asked for again', async () => {
  const asked = [];
  const histograms = new Histograms(async (plan_, id) => {
    asked.push(id);
    if (id === 'none') throw new Error('404');
    return { low: 0, high: 10, counts: [1, 2], percentiles: {} };
  });
  assert.equal(histograms.of('p', 'mr'), null);
  assert.equal((await histograms.load('p', 'mr')).high, 10);
  assert.deepEqual(histograms.of('p', 'mr').counts, [1, 2]);
  assert.equal(await histograms.load('p', 'none'), null);
  assert.equal(histograms.of('p', 'none'), null);
  assert.deepEqual(asked, ['mr', 'none']);
});
