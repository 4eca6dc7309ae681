// The tables of proto/color_maps.json, held to what is published of them, and the page's gradients of them.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { colorAt, colorMaps } = await load('features/image/color_maps.js');
const { lookOf, lookPatch, showPatch } = await load('room/image_look.js');
const { mergePatch } = await load('wire/merge.js');
const { maps } = JSON.parse(readFileSync('proto/color_maps.json', 'utf8'));
const described = JSON.parse(readFileSync('proto/scene.json', 'utf8')).enums.color_map.values.map(([name]) => name);
const tables = Object.fromEntries(maps.map(({ name, colors }) => [name, colors.join('').match(/.{6}/g)]));

test('the tables have the entries 0, 64, 128, 192 and 255 that are published', () => {
  // of the first four as D3 has them (d3-scale-chromatic 3.1.1, dist); of the last two those of their authors
  const published = {
    viridis: '440154 3b528b 21918c 5ec962 fde725',
    magma: '000004 51127c b73779 fc8961 fcfdbf',
    inferno: '000004 57106e bc3754 f98e09 fcffa4',
    plasma: '0d0887 7e03a8 cc4778 f89540 f0f921',
  };
  for (const [name, colours] of Object.entries(published))
    assert.equal([0, 64, 128, 192, 255].map((i) => tables[name][i]).join(' '), colours, name);
  assert.deepEqual(
    [0, 255].map((i) => tables.cividis[i]),
    ['00224e', 'fee838'],
  );
  assert.deepEqual(
    [0, 128, 255].map((i) => tables.turbo[i]),
    ['30123b', 'a4fc3c', '7a0403'],
  );
});

/** CIE L* of "rrggbb". */
function lightness(color) {
  const [r, g, b] = [0, 2, 4].map((at) => {
    const c = Number.parseInt(color.slice(at, at + 2), 16) / 255;
    return c > 0.04045 ? ((c + 0.055) / 1.055) ** 2.4 : c / 12.92;
  });
  const y = 0.2126729 * r + 0.7151522 * g + 0.072175 * b;
  return y > 216 / 24389 ? 116 * Math.cbrt(y) - 16 : (24389 / 27) * y;
}

test('all but turbo grow lighter from end to end, in even steps; turbo has its lightest part in the middle', () => {
  for (const [name, colours] of Object.entries(tables)) {
    const light = colours.map(lightness);
    if (name === 'turbo') {
      const top = light.indexOf(Math.max(...light));
      assert.ok(top > 90 && top < 165, 'turbo');
      continue;
    }
    const step = (light[255] - light[0]) / 255;
    for (let i = 8; i < 256; i += 8) {
      const here = (light[i] - light[i - 8]) / 8;
      assert.ok(here > 0 && Math.abs(here - step) < 0.4 * step + 0.1, `${name} at ${i}: ${here}, the mean is ${step}`);
    }
  }
});

test('every colour map of the scene has a name, and its gradient is within 6 of 255 of the table', () => {
  assert.deepEqual([...colorMaps.map(([id]) => id)].sort(), [...described].sort());
  for (const [name, colours] of Object.entries(tables))
    for (let i = 0; i < 256; i += 1) {
      const page = colorAt(name, i / 255).slice(1);
      for (let c = 0; c < 6; c += 2) {
        const off = Math.abs(Number.parseInt(page.slice(c, c + 2), 16) - Number.parseInt(colours[i].slice(c, c + 2), 16));
        assert.ok(off <= 6, `${name} at ${i}: ${page}, not ${colours[i]}`);
      }
    }
});

const image = (id, more) => ({
  id,
  modality: 'MR',
  unit: '',
  low: 0,
  high: 1000,
  window: { center: 50, width: 300 },
  isInverted: false,
  ...more,
});
const plan = { images: [image('a'), image('b')] };
const scene = (window) => ({
  image: { id: 'a', window, color_map: 'grey', cull_below: -1e12, looks: {}, blend: { id: '', opacity: 0.5 } },
});

test('the gamma of an image stays with it, and another image begins with 1', () => {
  let now = scene({ center: 40, width: 400, gamma: 1.6 });
  now = mergePatch(now, showPatch(plan, now, plan.images[1]));
  assert.deepEqual(now.image.window, { center: 50, width: 300, gamma: 1 });
  now = mergePatch(now, showPatch(plan, now, plan.images[0]));
  assert.deepEqual(now.image.window, { center: 40, width: 400, gamma: 1.6 });
});

test('a window that is set keeps the gamma, also of an image that is not shown', () => {
  const before = scene({ center: 40, width: 400, gamma: 1 });
  const [, other] = plan.images;
  let now = mergePatch(before, lookPatch(plan, before, other, { window: { gamma: 2 } }));
  now = mergePatch(now, lookPatch(plan, now, other, { window: { center: 1, width: 2 } }));
  assert.deepEqual(lookOf(plan, now, other).window, { center: 1, width: 2, gamma: 2 });
});
