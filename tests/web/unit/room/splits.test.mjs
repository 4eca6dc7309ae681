// Splitters: which there are, and how far they go (interface F.9.5).
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { readSplits, splitVariables, splittersOf } = await load('room/splits.js');
const desk = { size: 'wide', tree: 'tree', inspector: 'pushes', drawer: 'bottom', layout: '2x2' };
const large = { width: 2560, height: 1440 };
const found = (chosen, arrangement = desk, window = large, mainPx = 1000) =>
  Object.fromEntries(splittersOf(chosen, arrangement, window, mainPx).map(({ name, value, low, high }) => [name, [value, low, high]]));

test('tree 200 to 420, inspector 280 to 480, drawer 140 to a half, panes', () => {
  assert.deepEqual(found({}), {
    tree: [272, 200, 420],
    inspector: [320, 280, 480],
    drawer: [220, 140, 500],
    columns: [0.5, 0.2, 0.8],
    rows: [0.5, 0.2, 0.8],
  });
  const far = found({ tree: 9999, inspector: 1, drawer: 9999, columns: 2, rows: -1 });
  assert.deepEqual(
    Object.values(far).map(([value]) => value),
    [420, 280, 500, 0.8, 0.2],
  );
});

test('dragged panels leave 300 px to each pane, and never go below what they have without being dragged', () => {
  assert.equal(found({ tree: 420 }, desk, { width: 1440, height: 900 }).tree[2], 420, '1440 - 320 - 600 leave 520');
  assert.equal(found({ inspector: 480, tree: 420 }, desk, { width: 1440, height: 900 }).inspector[0], 420, '1440 - 420 - 600');
  assert.equal(found({ tree: 420, inspector: 480 }, { ...desk, layout: 'row' }, { width: 1440, height: 900 }).tree[0], 272);
});

test('a splitter stands only where there is something on both of its sides; not on tablets and telephones', () => {
  assert.deepEqual(Object.keys(found({}, { ...desk, tree: 'rail', inspector: 'floats', drawer: '', layout: 'single' })), []);
  assert.deepEqual(Object.keys(found({}, { ...desk, drawer: '', layout: '1x2' })), ['tree', 'inspector', 'rows']);
  assert.deepEqual(found({ large: 0.6 }, { ...desk, drawer: '', layout: '1+3' }).columns, [0.6, 0.2, 0.8]);
  for (const size of ['tablet', 'phone']) assert.deepEqual(splittersOf({ tree: 300 }, { ...desk, size }, large), []);
});

test('only what was dragged has a style; what the browser kept wrongly is left out', () => {
  const set = (chosen) => Object.fromEntries(Object.entries(splitVariables(splittersOf(chosen, desk, large))).filter(([, value]) => value));
  assert.deepEqual(set({}), { '--column-at': '0.5', '--row-at': '0.5' });
  assert.deepEqual(set({ tree: 300.4, columns: 0.25 }), {
    '--tree': '300px',
    '--columns': '0.25fr',
    '--columns-rest': '0.75fr',
    '--column-at': '0.25',
    '--row-at': '0.5',
  });
  assert.deepEqual(readSplits({ tree: 300, rows: '1', other: 4, drawer: NaN }), { tree: 300 });
  for (const wrong of [null, undefined, 7, 'x', []]) assert.deepEqual(readSplits(wrong), {});
});
