// How numbers are written.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { alongBeam, bytes, imageValue, number, position, signed, significant, unitText, volume, windowText } = await load('parts/format.js');

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
  assert.match(windowText({ center: 0.0123, width: 0.004 }, 'Gy'), /^C 0\.01230\s+W 0\.00400 Gy$/);
  assert.match(windowText({ center: 40, width: 400, gamma: 1 }, 'HU'), /^C 40\s+W 400 HU$/);
  assert.match(windowText({ center: 40, width: 400, gamma: 1.4 }, 'HU'), /^C 40\s+W 400 HU γ 1\.4$/);
  assert.match(windowText({ center: 40, width: 400 }, 'HU', true), /^C 40\s+W 400 HU\s+low white$/);
});

test('powers in units are raised, names that end in a digit are left alone', () => {
  assert.equal(unitText('1/cm2'), '1/cm²');
  assert.equal(unitText('minute at 1e10 n/cm2/s'), 'minute at 1e10 n/cm²/s');
  assert.equal(unitText('mm3, beam2, m3'), 'mm³, beam2, m³');
});

test("units that files give as DICOM's codes are words; a code that DICOM does not know stands in quotation marks", () => {
  const { cases } = JSON.parse(readFileSync(new URL('../../../data/unit_words.json', import.meta.url), 'utf8'));
  assert.equal(cases.length, 30);
  for (const [code, words] of [...cases, ['constructor', 'constructor']]) assert.equal(unitText(code), words);
  assert.equal(windowText({ center: 5, width: 10 }, 'GML'), 'C 5  W 10 g/mL (SUV)');
  assert.equal(windowText({ center: 5, width: 10 }, 'NONE'), 'C 5  W 10');
});

test('a place along a beam names the end it is counted from, and far ones are in metres', () => {
  const places = {
    44.26: '44.3 mm from source end',
    '-7.25': '7.3 mm before source end',
    '-4430.1': '4.4 m before source end',
    '-0.04': '0.0 mm from source end',
  };
  for (const [mm, words] of Object.entries(places)) assert.equal(alongBeam(Number(mm)), words);
});

test('a volume in a list has the figures that count, and is never none when there is one', () => {
  assert.deepEqual([67.152, 1043.1, 9.999, 0.027, 0.0031, 0].map(volume), [
    '67.2 cm³',
    '1043 cm³',
    '10.0 cm³',
    '0.03 cm³',
    '< 0.01 cm³',
    '0.00 cm³',
  ]);
});

test('a difference carries its sign, none carries none', () => {
  assert.deepEqual(
    [0.312, -0.04, 1e-14, -1e-14, 0].map((value) => signed(value, 2)),
    ['+0.31', '\u22120.04', '0.00', '0.00', '0.00'],
  );
});

test('a measured value has three figures that count, and its true minus', () => {
  const written = {
    4.8249: '4.82',
    0.0446999: '0.0447',
    0.00876: '0.00876',
    9.996: '10.0',
    999.6: '1000',
    139: '139',
    12345.6: '12\u2009346',
    0: '0',
  };
  for (const [value, text] of Object.entries(written)) assert.equal(significant(Number(value)), text);
  assert.equal(significant(-64.94), '\u221264.9');
  assert.equal(significant(1.2345e10), '1.23 × 10¹⁰');
  assert.equal(significant(-4.5e-7), '\u22124.50 × 10⁻⁷');
  assert.equal(significant(NaN), '–');
});

test('thousands are set apart from five figures on', () => {
  assert.deepEqual(
    [1043, 13028, 1234567.891].map((value) => number(value)),
    ['1043', '13\u2009028', '1\u2009234\u2009568'],
  );
});

test('an image has whole numbers as they are, others by three figures, with the unit', () => {
  assert.deepEqual(imageValue(-1024, 'HU'), { text: '\u22121024', unit: 'HU' });
  assert.deepEqual(imageValue(48.273, 'HU'), { text: '48.3', unit: 'HU' });
  assert.deepEqual(imageValue(0.5, '1/cm2'), { text: '0.500', unit: '1/cm²' });
});

test('a weighted dose is in Gy(w), also from files that say it in older words', () => {
  assert.deepEqual(['Gy-Eq', 'GyEq', 'Gyw', 'Gy(w)', 'Gy', 'cGy'].map(unitText), ['Gy(w)', 'Gy(w)', 'Gy(w)', 'Gy(w)', 'Gy', 'cGy']);
});

test('a position has its letters, one unit and tenths of it', () => {
  assert.match(position([24.9, 38.4, -64.94]), /^L 24\.9\s+P 38\.4\s+S \u221264\.9 mm$/);
});
