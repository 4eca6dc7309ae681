// Colours of the isodose levels that are there: Sera3d's, those told apart with any colour vision, colour maps.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { coloursNow, coloursPatch, levelColours } = await load('features/dose/level_colors.js');
const { addedLevel } = await load('features/dose/level_list.js');
const { mergePatch } = await load('wire/merge.js');
const tables = JSON.parse(readFileSync('proto/dose_presets.json', 'utf8')).level_tables;
const coloursOf = (name) => tables.find((table) => table.name === name).levels.map(({ color }) => color);
const safe = coloursOf('Colour-vision-safe');

/** Levels of these values in per cent, in an order that is not theirs. */
const scene = (...values) => ({
  dose: {
    levels: Object.fromEntries(
      values.map((value, i) => [`level-${i + 1}`, { value, unit: 'percent', color: '#123456', visible: i > 0, line: true, opacity: 0.3 }]),
    ),
  },
});
const colourAt = (of, value) => Object.values(of.dose.levels).find((level) => level.value === value).color;

test('the highest level has the first colour; values and switches stay', () => {
  const before = scene(50, 95, 80);
  const after = mergePatch(before, coloursPatch(before, null, 'sera'));
  assert.deepEqual(
    [95, 80, 50].map((value) => colourAt(after, value)),
    coloursOf('Thesis').slice(0, 3),
  );
  assert.deepEqual(after.dose.levels['level-1'], { ...before.dose.levels['level-1'], color: colourAt(after, 50) });
  assert.equal(coloursNow(before, null), null, 'of their own');
  assert.equal(coloursNow(after, null), 'sera');
});

test('one to eight levels have different colours of the safe table, in its order', () => {
  for (let n = 1; n <= 8; n += 1) {
    const before = scene(...Array.from({ length: n }, (_, i) => 10 + 10 * i));
    const after = mergePatch(before, coloursPatch(before, null, 'safe'));
    const found = Array.from({ length: n }, (_, i) => safe.indexOf(colourAt(after, 10 * n - 10 * i)));
    assert.ok(
      found.every((at, i) => at >= 0 && (i === 0 || at > found[i - 1])),
      `${n}: ${found}`,
    );
    assert.equal(coloursNow(after, null), 'safe');
  }
});

test('more levels than a list has colours for are not given them', () => {
  assert.equal(coloursPatch(scene(1, 2, 3, 4, 5, 6, 7, 8, 9), null, 'safe'), null);
  assert.equal(coloursPatch(scene(1, 2, 3, 4, 5, 6, 7), null, 'sera'), null);
  assert.equal(coloursPatch(scene(), null, 'sera'), null, 'without levels there is nothing to colour');
  for (const [id, , , most] of levelColours) assert.equal(coloursPatch(scene(1, 2), null, id) === null, most < 2);
});

test('a map gives the highest level its last colour, and no level is black', () => {
  const before = scene(90, 60, 30);
  for (const id of ['viridis', 'inferno', 'magma', 'plasma', 'cividis', 'turbo', 'hot-iron', 'rainbow']) {
    const after = mergePatch(before, coloursPatch(before, null, id));
    const bytes = Object.values(after.dose.levels).map(({ color }) => Number.parseInt(color.slice(1), 16));
    assert.equal(new Set(bytes).size, 3, id);
    assert.ok(
      bytes.every((rgb) => Math.max(rgb >> 16, (rgb >> 8) & 255, rgb & 255) > 80),
      id,
    );
  }
  const { color } = mergePatch(before, coloursPatch(before, null, 'viridis')).dose.levels['level-1'];
  assert.equal(color, '#fde725');
});

test('a level that is added to safe ones gets a safe colour', () => {
  const before = scene(90, 60, 30);
  const after = mergePatch(before, coloursPatch(before, null, 'safe'));
  const { id, patch } = addedLevel(after, null);
  const { color } = patch.dose.levels[id];
  assert.ok(safe.includes(color) && !Object.values(after.dose.levels).some((level) => level.color === color), color);
});
