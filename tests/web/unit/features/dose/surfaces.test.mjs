// Which levels come with the isodose surfaces when they are switched on.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { surfacesPatch } = await load('features/dose/level_list.js');
const level = (value, more = {}) => ({ value, unit: 'percent', visible: true, line: true, wash: true, surface: false, ...more });
const sceneOf = (levels) => ({ dose: { levels, surfaces: { visible: false } } });
const chosen = (levels, reference = 40) => Object.keys(surfacesPatch(sceneOf(levels), reference, true).dose.levels ?? {}).sort();

test('with none chosen those of 90, 70 and 50 %', () => {
  const levels = Object.fromEntries([95, 90, 80, 70, 60, 50].map((value) => [`p${value}`, level(value)]));
  assert.deepEqual(chosen(levels), ['p50', 'p70', 'p90']);
  assert.deepEqual(surfacesPatch(sceneOf(levels), 40, true).dose.surfaces, { visible: true });
});

test('else the nearest visible ones, also where levels are doses; never one twice', () => {
  assert.deepEqual(chosen({ a: level(95), b: level(80), c: level(40), d: level(20) }), ['a', 'b', 'c']);
  assert.deepEqual(chosen({ a: level(90, { visible: false }), b: level(85), c: level(72), d: level(30) }), ['b', 'c', 'd']);
  assert.deepEqual(
    chosen({
      a: level(36, { unit: 'dose' }),
      b: level(28, { unit: 'dose' }),
      c: level(20, { unit: 'dose' }),
      d: level(10, { unit: 'dose' }),
    }),
    ['a', 'b', 'c'],
  );
  assert.deepEqual(chosen({ a: level(90) }), ['a']);
});

test('a choice that was made stays, and so it does when they are switched off', () => {
  const levels = { a: level(90), b: level(30, { surface: true }) };
  assert.deepEqual(surfacesPatch(sceneOf(levels), 40, true), { dose: { surfaces: { visible: true } } });
  assert.deepEqual(surfacesPatch(sceneOf({ a: level(90) }), 40, false), { dose: { surfaces: { visible: false } } });
});
