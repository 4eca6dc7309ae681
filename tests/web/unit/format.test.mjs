// How numbers are written.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './page.mjs';

const { bytes, signed, unitText, volume, windowText } = await load('panels/format.js');

test('a size is never made up: what was not counted is a dash', () => {
  assert.equal(bytes(0), '–');
  assert.equal(bytes(undefined), '–');
  assert.equal(bytes(12), '12 B');
  assert.equal(bytes(28500), '28.5 kB');
  assert.equal(bytes(518799), '519 kB');
  assert.equal(bytes(2.2e6), '2.2 MB');
  assert.equal(bytes(3.14e9), '3.1 GB');
});

test('a window is written centre first, with the unit of its image', () => {
  assert.match(windowText({ center: 40, width: 400 }, 'HU'), /^C 40\s+W 400 HU$/);
  assert.match(windowText({ center: 0.5, width: 1 }, ''), /^C 0\.50\s+W 1\.00$/);
  assert.match(windowText({ center: 40, width: 400 }, 'HU', true), /^C 40\s+W 400 HU\s+low white$/);
});

test('powers in units are raised, names that end in a digit are left alone', () => {
  assert.equal(unitText('1/cm2'), '1/cm²');
  assert.equal(unitText('minute at 1e10 n/cm2/s'), 'minute at 1e10 n/cm²/s');
  assert.equal(unitText('mm3, beam2, m3'), 'mm³, beam2, m³');
});

test('a volume in a list has the figures that count, and is never none when there is one', () => {
  assert.deepEqual([67.152, 1043.1, 9.999, 0.027, 0.0031, 0].map(volume), ['67.2 cm³', '1043 cm³', '10.0 cm³', '0.03 cm³', '< 0.01 cm³', '0.00 cm³']);
});

test('a difference carries its sign, none carries none', () => {
  assert.deepEqual([0.312, -0.04, 1e-14, -1e-14, 0].map((value) => signed(value, 2)), ['+0.31', '\u22120.04', '0.00', '0.00', '0.00']);
});
