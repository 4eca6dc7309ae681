// The transfer functions the page begins with: those that fit an image, in its own values.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { presetPoints, presetsOfImage, volumePresets } = await load('features/image/volume_presets.js');
const { readDocument } = await load('wire/check.js');

test('presets in HU are for images in HU, the others are laid over the window', () => {
  assert.ok(presetsOfImage({ unit: 'HU' }).every(({ modality }) => modality === 'CT'));
  assert.ok(presetsOfImage({ unit: '' }).length > 0);
  const preset = { unit: 'window', points: [{ value: 0 }, { value: 0.25 }, { value: 1 }] };
  assert.deepEqual(
    presetPoints(preset, { center: 100, width: 40 }).map(({ value }) => value),
    [80, 90, 120],
  );
});

test('every preset is a transfer function that the scene accepts', () => {
  for (const preset of volumePresets) {
    const points = presetPoints(preset, { center: 0, width: 1 });
    assert.deepEqual(readDocument('scene', { image: { volume: { points } } }).image.volume.points, points, preset.name);
  }
});

test('a transfer function whose points are out of order is refused', () => {
  const points = [{ value: 2 }, { value: 1 }];
  assert.throws(() => readDocument('scene', { image: { volume: { points } } }), { code: 'order', pointer: '/image/volume/points' });
});
