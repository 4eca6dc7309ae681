// Texts with places and plurals, and another language: keys that it lacks stay English.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { sentences } from '../../../../web/js/parts/sentences.js';

test('places take values, numbers choose the form, templates make a list', () => {
  const say = sentences('test', {
    plain: 'Show',
    valueOf: 'Value of {n}',
    named: 'Show {plane}',
    many: '{n} {n|row|rows} of {all}',
    twice: '{a} and {a}',
  });
  assert.equal(say.plain, 'Show');
  assert.equal(say.valueOf({ n: 2 }), 'Value of 2', 'a key may have the name of what every object has');
  assert.equal(say.named({ plane: 'Oblique 1' }), 'Show Oblique 1');
  assert.equal(say.many({ n: 1, all: 4 }), '1 row of 4');
  assert.equal(say.many({ n: 0, all: 4 }), '0 rows of 4');
  assert.equal(say.twice({ a: '{b}' }), '{b} and {b}', 'a value is never a text with places');
  const template = { strings: [] };
  assert.deepEqual(say.named({ plane: template }), ['Show ', template, '']);
  const nothing = Symbol('nothing');
  assert.deepEqual(say.named({ plane: nothing }), ['Show ', nothing, '']);
  assert.equal(say.named({ plane: null }), 'Show ', 'no value is no text');
});

test('a browser of another language has what that language has', async (t) => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-language-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  for (const part of ['languages', 'parts']) cpSync(`web/js/${part}`, join(folder, part), { recursive: true });
  writeFileSync(join(folder, 'package.json'), '{"type":"module"}');
  const list = join(folder, 'languages/index.js');
  const text = readFileSync(list, 'utf8');
  writeFileSync(list, text.replace('languages = {}', "languages = { pl: () => import('./pl.js'), cs: () => import('./gone.js') }"));
  assert.notEqual(readFileSync(list, 'utf8'), text);
  // the four forms of Polish in the order of CLDR: one (1), few (2 to 4), many (5 and more), other (fractions)
  writeFileSync(
    join(folder, 'languages/pl.js'),
    "export default { test: { rows: '{n} {n|a|b|c|d}' }, server: { 'view-not-open': 'v{view}', 'disk-full': 'p', 'is-used': '{thing}={with}: {fact}', 'same-frame': 's' } };",
  );
  const inLanguages = async (...languages) => {
    Object.defineProperty(globalThis, 'navigator', { value: { languages }, configurable: true });
    const copy = join(folder, `run-${languages.join('-')}`);
    for (const part of ['languages', 'parts', 'package.json']) cpSync(join(folder, part), join(copy, part), { recursive: true });
    const module = await import(pathToFileURL(join(copy, 'parts/sentences.js')).href);
    return { ...module.sentences('test', { rows: '{n} {n|row|rows}', other: 'Stays' }), told: module.told };
  };
  const before = Object.getOwnPropertyDescriptor(globalThis, 'navigator');
  t.after(() => (before ? Object.defineProperty(globalThis, 'navigator', before) : delete globalThis.navigator));
  const polish = await inLanguages('xx', 'pl-PL');
  assert.deepEqual(
    [1, 3, 7, 1.5].map((n) => polish.rows({ n })),
    ['1 a', '3 b', '7 c', '1.5 d'],
  );
  assert.equal(polish.other, 'Stays');
  const sent = () => ({
    problem: { detail: 'view 3 is not open', detail_code: 'view-not-open', detail_values: { view: 3 }, code: 'range' },
    lines: [
      { sentence: 'Full.', sentence_code: 'disk-full' },
      { sentence: 'New.', sentence_code: 'not-in-this-language' },
      { sentence: 'Free.' },
      null,
    ],
  });
  const translated = polish.told(sent());
  assert.equal(translated.problem.detail, 'v3');
  assert.deepEqual(
    translated.lines.map((line) => line?.sentence),
    ['p', 'New.', 'Free.', undefined],
  );
  assert.equal(polish.told(null), null);
  const fit = {
    reason: 'A is used with B: both are in one frame of reference.',
    reason_code: 'is-used',
    reason_values: { thing: 'A', with: 'B', fact: 'both are in one frame of reference', fact_code: 'same-frame', may: '' },
  };
  assert.equal(polish.told(fit).reason, 'A=B: s');
  const english = await inLanguages('en-GB', 'pl');
  assert.deepEqual(english.told(sent()), sent(), 'English is said by the server');
  assert.equal(english.rows({ n: 2 }), '2 rows', 'English comes first');
  assert.equal((await inLanguages('cs')).rows({ n: 1 }), '1 row', 'a language that cannot be loaded');
});
