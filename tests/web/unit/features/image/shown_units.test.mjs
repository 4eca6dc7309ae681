// Units of values of an image: nowhere on the page is one a code of a file.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';
import { drawn } from '../../template.mjs';

const { probe } = await load('shell/probe.js');
const { slicesBlock } = await load('features/image/picture.js');
const is = (value) => ({ value, peek: () => value });

const image = { id: 'pet', name: 'PET', modality: 'PT', unit: 'BQML', window: { center: 5, width: 10 } };
const slice = { visible: true, position_mm: 0 };
const scene = {
  image: { id: 'pet', cull_below: 3, window: image.window, slices: { axial: slice, coronal: slice, sagittal: slice } },
  regions: {},
  crosshair: { position_mm: [0, 0, 0] },
};

test('the probe and the threshold of slices name the unit of a PET in words', () => {
  const plan = { images: [image], regions: [], doses: [] };
  const result = { images: [{ id: 'pet', value: 7, unit: 'BQML' }], regions: [] };
  const room = { plan: is(plan), scene: is(scene) };
  for (const template of [
    probe({ room, ui: {}, probed: is({ result, error: '', isOld: false }) }),
    slicesBlock(scene, image, false, () => {}),
  ]) {
    const { text } = drawn(template);
    assert.match(text, /Bq\/mL/);
    assert.doesNotMatch(text, /BQML/);
  }
});
