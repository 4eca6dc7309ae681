// The page's checks, for a description of the tests' own with every kind of field (tests/gen/trial.json): the same examples
// the generated C is held to. And what the generator refuses to write code for.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { checkedDocuments, checkedMessages } from '../../../../proto/gen/check.mjs';
import { openapi } from '../../../../proto/gen/openapi.mjs';
import { tableOf } from '../../../../proto/gen/reference.mjs';
import { undoWords } from '../../../../proto/gen/undo_words.mjs';
import { tables as tablesOf, wireScript } from '../../../../proto/gen/wire_js.mjs';
import { load, root } from '../page.mjs';

const { WireError, readDocument } = await load('wire/check.js');
const { mergePatch } = await load('wire/merge.js');
const readJson = (path) => JSON.parse(readFileSync(`${root}${path}`, 'utf8'));
const cases = readJson('tests/gen/cases.json');
const description = () => readJson('tests/gen/trial.json');
const tables = tablesOf(checkedDocuments(description()));
const complete = (document) => readDocument('trial', document, tables);

for (const { about, given, more } of cases.read)
  test(`defaults: ${about}`, () => {
    const document = complete(given);
    assert.deepEqual(document, mergePatch(cases.empty, more));
    assert.deepEqual(complete(document), document);
  });

for (const { given, code, pointer } of cases.refused)
  test(`${pointer} is refused: ${JSON.stringify(given)}`, () => {
    assert.throws(
      () => complete(given),
      (thrown) => {
        assert.ok(thrown instanceof WireError, String(thrown));
        assert.deepEqual([thrown.code, thrown.pointer], [code, pointer]);
        return true;
      },
    );
  });

for (const { about, current, changed, told } of cases.patches)
  test(`a copy that is told stays the server's document: ${about}`, () => {
    const before = complete(mergePatch(cases.defaults, current));
    assert.deepEqual(complete(mergePatch(before, told)), complete(mergePatch(cases.defaults, changed)));
  });

test('numbers that are not finite are refused', () => {
  for (const number of [Infinity, NaN]) assert.throws(() => complete({ cut: { normal: [0, number, 0] } }), { pointer: '/cut/normal/1' });
});

test('a document nested deeper than the description is refused where it leaves it', () => {
  const deep = JSON.parse(`${'{"a":'.repeat(5000)}null${'}'.repeat(5000)}`);
  assert.throws(() => complete({ cut: deep }), { code: 'unknown-field', pointer: '/cut/a' });
  assert.throws(() => complete({ marks: [{ region: 'skin', tags: { t: deep } }] }), {
    code: 'unknown-field',
    pointer: '/marks/0/tags/t/a',
  });
});

// ---- the generator -----------------------------------------------------------------------------------------------------

/** The description with a field of an object, or of the document itself, changed. */
function changedField(object, field, change) {
  const changed = description();
  const { fields } = changed.objects[object] ?? changed.documents[object];
  Object.assign(
    fields.find(({ name }) => name === field),
    change,
  );
  return changed;
}

test('words of undo stand by the path of their field, those of a map for all its keys, and not in the tables of fields', () => {
  const level = { fields: [{ name: 'value', undo: 'value of a level' }, { name: 'line' }] };
  const dose = { fields: [{ name: 'id' }, { name: 'levels', type: 'map', object: 'level', undo: 'levels' }] };
  const dots = { name: 'dots', type: 'list', object: 'level', undo: 'dots' };
  const scene = { fields: [{ name: 'dose', type: 'object', object: 'dose' }, { name: 'still' }, dots] };
  const given = { enums: {}, objects: { level, dose }, documents: { scene } };
  assert.deepEqual(undoWords(given), { scene: { dose: { levels: { '': 'levels', '*': { value: 'value of a level' } } }, dots: 'dots' } });
  assert.doesNotMatch(wireScript(given, { enums: {}, messages: [] }), /undo/);
});

for (const [what, changed, words] of [
  ['a number without limits', changedField('style', 'opacity', { max: undefined }), /style\.opacity: needs min and max/],
  ['a default out of range', changedField('style', 'opacity', { default: 2 }), /style\.opacity: the default is out of range/],
  ['a list without a limit', changedField('volume', 'points', { max_items: undefined }), /volume\.points: needs max_items/],
  ['undo without words', changedField('style', 'opacity', { undo: '' }), /style\.opacity: "undo" is words for a person/],
  ['a map without a limit', changedField('dose_style', 'levels', { max_items: 0 }), /dose_style\.levels: needs max_items/],
  [
    'an object inside itself',
    changedField('volume', 'points', { object: 'volume' }),
    /volume\.points: volume is not an object that is described above/,
  ],
  ['an unknown type', changedField('level', 'value', { type: 'float' }), /level\.value: unknown type float/],
  ['an unknown enum', changedField('level', 'unit', { enum: 'units' }), /level\.unit: unknown enum units/],
  ["a word that is none of the enum's", changedField('level', 'unit', { default: 'rad' }), /not a word of unit/],
  ['a reference to what no plan has', changedField('trial', 'beam', { names: 'couch' }), /trial\.beam: names "couch"/],
  ['a number that names something', changedField('level', 'value', { names: 'region' }), /only an id and the keys of a map/],
  [
    'a direction of no length by default',
    changedField('draft', 'along', { default: [0, 0, 0] }),
    /draft\.along: the default has no length/,
  ],
  ['a list that may be null', changedField('volume', 'points', { nullable: true }), /a list cannot be null/],
  ['a field without a sentence', changedField('level', 'value', { about: '' }), /needs a sentence/],
  ['two fields of one name', changedField('level', 'value', { name: 'unit' }), /level: a name stands twice/],
  ['JSON that is not described', changedField('level', 'value', { type: 'json' }), /only a message/],
  [
    'an object that cannot be left out',
    changedField('level', 'value', { type: 'object', object: 'point', default: undefined }),
    /point has a required field/,
  ],
])
  test(`the generator refuses ${what}`, () => assert.throws(() => checkedDocuments(changed), words));

test('the generator refuses a document without a plan that names something of one', () => {
  const changed = description();
  delete changed.documents.trial.of_plan;
  assert.throws(() => checkedDocuments(changed), /trial: names something of the plan/);
});

test('the generator refuses objects deeper than the parsers follow', () => {
  const changed = description();
  let below = 'point';
  for (let depth = 0; depth < 6; depth++) {
    changed.objects[`deep_${depth}`] = {
      about: 'Deep.',
      fields: [{ name: 'inner', type: 'list', object: below, max_items: 1, about: 'Deeper.' }],
    };
    below = `deep_${depth}`;
  }
  changed.documents.trial.fields.push({ name: 'deep', type: 'object', object: below, about: 'Too deep.' });
  assert.throws(() => checkedDocuments(changed), /trial: objects in it are more than \d+ deep/);
});

test('the shipped descriptions pass', () => {
  checkedDocuments(readJson('proto/scene.json'));
  checkedMessages(readJson('proto/messages.json'));
});

test('the reference page and the description of the API know every kind of field', () => {
  const trial = checkedDocuments(description());
  const page = Object.values({ ...trial.objects, ...trial.documents })
    .map(({ fields }) => tableOf(fields, trial.enums))
    .join('');
  assert.match(page, /list of <a href="#object-point">point<\/a>, at most 4/);
  assert.match(page, /map from the id of a region of the plan to <a href="#object-weight">/);
  assert.match(page, /id of an image of the plan/);
  assert.match(page, /a direction, of any length but 0/);
  const { schemas } = openapi({ about: '', ids: '', routes: [] }, trial, '1').components;
  assert.deepEqual(schemas.volume.properties.points, {
    type: 'array',
    items: { $ref: '#/components/schemas/point' },
    maxItems: 4,
    description: 'A transfer function.',
  });
  assert.deepEqual(schemas.trial.properties.cut, { $ref: '#/components/schemas/plane' });
  assert.equal(schemas.plane.properties.normal.minItems, 3);
  assert.deepEqual(schemas.trial.properties.draft.oneOf, [{ $ref: '#/components/schemas/draft' }, { type: 'null' }]);
});
