// Marks on the page and on paper where parts are used by a person's word, and the offer to say it. The words of templates are read without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

globalThis.document = {
  createTreeWalker: () => ({}),
  createComment: () => ({}),
  addEventListener() {},
  querySelector: () => null,
  head: { append() {} },
};
const { fitBar, fitBlock, numberMark, usedRows, usedSheet, wordMark } = await load('features/fits/later.js');
const { nothing } = await load('../lib/lit-html.js');
const { pairKey } = await load('room/accepted.js');

/** A template as text, tags included. */
function textOf(part) {
  if (part === nothing || part === null || part === undefined || typeof part === 'function') return '';
  if (Array.isArray(part)) return part.map(textOf).join('');
  if (part._$litDirective$) return part.values.flatMap((names) => Object.keys(names).filter((name) => names[name])).join(' '); // classMap
  if (part.strings) return part.strings.map((text, at) => text + textOf(part.values[at])).join('');
  return typeof part === 'object' ? '' : String(part);
}
/** The text as read, without tags. */
const read = (part) =>
  textOf(part)
    .replace(/<[^>]*>/g, ' ')
    .replace(/\s+/g, ' ')
    .trim();

const reason = 'Dose “Boost” is not used with MR: it was computed in another frame of reference. It may be shifted against this image.';
const fact = 'It was computed in another frame of reference. It may be shifted against this image.';
const plan = {
  images: [{ id: 'mr', name: 'MR', frame: 1 }],
  regions: [],
  beams: [],
  patients: [],
  treatmentPlans: [],
  doses: [
    { id: 'boost', name: 'Boost', frame: 0 },
    { id: 'own', name: 'Own' },
  ],
  fits: [
    { thing: 'dose:boost', with: 'image:mr', relation: 'frame', needs: 'acceptance', reason },
    { thing: 'dose:own', with: 'image:mr', relation: 'same', needs: 'nothing', reason: '' },
  ],
};
const row = {
  id: 'i-1',
  kind: 'acceptance',
  author_name: 'Ann',
  created_ms: Date.UTC(2026, 10, 27, 9, 30),
  body: { thing: 'dose:boost', with: 'image:mr', reason: 'same-session', words: 'one couch, one hour', fact: reason },
};

function worldOf({ isAccepted = true, id = 'boost', isPresenting = true } = {}) {
  const scene = {
    image: { id: 'mr', blend: { id: '' } },
    regions: {},
    beam: { looks: {} },
    tracks: { visible: false },
    dose: {
      id,
      sum: {},
      compare: { id: '', mode: 'none' },
      wash: { visible: true },
      lines: { visible: false },
      surfaces: { visible: false },
      coverage: { visible: false },
    },
  };
  const room = {
    plan: { value: plan },
    scene: { value: scene },
    accepted: { value: new Map(isAccepted ? [[pairKey('dose:boost', 'image:mr'), row]] : []) },
    canChange: { value: true },
    following: { isPresenting: { value: isPresenting } },
    items: { rows: { value: new Map() } },
    acceptances: { value: { items: [], known: true } },
  };
  return { room, ui: { selection: { value: { kind: 'dose', id: 'boost' } }, active: { value: 1 } } };
}

test('paper lists the parts, the fact, the words, who said it and when; nothing where all fits', () => {
  const words = read(usedSheet(worldOf()));
  for (const part of [
    'Parts used though they do not fit',
    'Dose “Boost” with MR',
    fact,
    'Same session and couch: one couch, one hour',
    'Ann, ',
  ])
    assert.ok(words.includes(part), `"${words}" has no "${part}"`);
  assert.ok(!words.includes('is not used'), 'it is used');
  assert.equal(usedSheet(worldOf({ isAccepted: false })), nothing);
});

test('numbers of an accepted dose are marked, those of another dose are not', () => {
  assert.equal(read(numberMark(worldOf())), 'other frame');
  assert.equal(read(wordMark(worldOf(), ['dose'])), 'other frame');
  assert.ok(textOf(numberMark(worldOf())).includes('one couch, one hour'), 'the tooltip has the words');
  assert.equal(numberMark(worldOf({ id: 'own' })), nothing);
  assert.equal(numberMark(worldOf({ isAccepted: false })), nothing);
});

test('files of numbers say it in a row', () => {
  assert.deepEqual(usedRows(worldOf()), [
    ['used though it does not fit', 'Dose “Boost” with MR', fact, 'Ann, 2026-11-27T09:30:00.000Z', 'one couch, one hour'],
  ]);
  assert.deepEqual(usedRows(worldOf({ id: 'own' })), []);
});

test('who does not present is not offered to have a part used, and is told why', () => {
  const [presenter, other] = [true, false].map((isPresenting) => textOf(fitBar(worldOf({ isAccepted: false, isPresenting }))));
  assert.match(presenter, /\?disabled=false title=\s*@click=[^>]*>Use it all the same/);
  assert.match(other, /\?disabled=true title=Only who presents may have it used\.\s*@click=[^>]*>Use it all the same/);
  assert.ok(other.includes('<span class="note why">Only who presents may have it used.</span>'));
  assert.ok(!presenter.includes('Only who presents'));
});

test('the form names the frames of both sides, the first one too', () => {
  const form = fitBlock(worldOf({ isAccepted: false }));
  const words = read(form);
  assert.match(textOf(form), /<tr class=warn><th scope="row">Frame/);
  assert.match(textOf(form), /<tr class=><th scope="row">Patient/);
  assert.match(words, /‘Boost’ does not fit MR/);
  assert.match(words, /Frame of reference frame 1 frame 2/);
  assert.match(words, /Patient not stated not stated/);
});
