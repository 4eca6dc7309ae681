// Where panels and panes stand: the widths and the exceptions as the interface document states them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { arrange, sizeOf } = await load('room/arrangement.js');
const { Layout, layoutId, layouts, placed } = await load('room/layout.js');
const chosen = { layout: '', isTreeOpen: true, section: '', isPinned: false, isInspectorOpen: true, sheet: '', active: 1, maximised: 0 };
const desk = (width, more = {}, height = 900) => arrange({ width, height, isCoarse: false }, { ...chosen, ...more });
const touch = (width, height, more = {}) => arrange({ width, height, isCoarse: true }, { ...chosen, ...more });

test('the size goes by width, and by fingers', () => {
  assert.deepEqual(
    [1400, 1399, 1100, 1099, 600, 599].map((width) => sizeOf({ width, isCoarse: false })),
    ['wide', 'compact', 'compact', 'tablet', 'tablet', 'phone'],
  );
  assert.equal(sizeOf({ width: 1600, isCoarse: true }), 'tablet');
});

test('from 1400 px on the tree stands at the left and the inspector at the right', () => {
  const { tree, inspector, overlay, layout } = desk(1400, { section: 'regions' });
  assert.deepEqual([tree, inspector, overlay, layout], ['tree', 'pushes', '', '2x2']);
});

test('below, a section beside the rail floats, and pushes when it is pinned', () => {
  assert.deepEqual([desk(1280).tree, desk(1280).overlay], ['rail', '']);
  assert.equal(desk(1280, { section: 'regions' }).overlay, 'floats');
  const pinned = desk(1280, { section: 'regions', isPinned: true });
  assert.deepEqual(
    [pinned.overlay, pinned.layout],
    ['pushes', 'row'],
    '48 + 272 + 320 leave 640: two panes of 320 are too narrow, a row of three is not',
  );
  assert.equal(desk(1280, { section: 'regions', isPinned: true, isInspectorOpen: false }).layout, '2x2', '48 + 272 + 48 leave 912');
});

test('where even a row of three would be too narrow a pinned section floats', () => {
  assert.equal(desk(1200, { section: 'regions', isPinned: true }).overlay, 'floats'); // 560: 1.28 + 1 + 1 parts of 171
});

test('the inspector floats where two panes beside it would be narrower than 420 px', () => {
  assert.equal(desk(1209).inspector, 'pushes');
  assert.equal(desk(1200).inspector, 'floats');
  assert.equal(desk(1200, { layout: 'single' }).inspector, 'pushes');
});

test('a row of three always has the active pane', () => {
  for (const active of [1, 2, 3, 4]) {
    const { visible } = desk(1600, { layout: 'row', active });
    assert.equal(visible.length, 3);
    assert.ok(visible.includes(active));
  }
});

test('on a tablet an open sheet turns one and three into one row of four', () => {
  assert.deepEqual([touch(1180, 820).layout, touch(1180, 820).sheet], ['1+3', '']);
  assert.equal(touch(1180, 820, { sheet: 'inspector' }).layout, 'row4');
  assert.equal(touch(820, 1180, { sheet: 'inspector' }).layout, '1+3', 'upright there is height enough');
});

test('a telephone shows one pane, the active one', () => {
  assert.deepEqual(touch(390, 844, { active: 3, layout: '2x2' }).visible, [3]);
});

test('a maximised pane stands alone at every size', () => {
  for (const { visible, layout } of [
    desk(1600, { maximised: 2 }),
    desk(1280, { maximised: 2 }),
    touch(1180, 820, { maximised: 2, sheet: 'tree' }),
  ]) {
    assert.deepEqual(visible, [2]);
    assert.equal(layout, 'single');
  }
});

test('two panes stand side by side, upright one above the other, and show what was put into them', () => {
  for (const { layout, visible } of [
    desk(1600, { layout: '2x1' }),
    desk(1280, { layout: '2x1' }),
    touch(1180, 820, { layout: '2x1', sheet: 'tree' }),
  ])
    assert.deepEqual([layout, visible], ['2x1', [1, 2]]);
  assert.equal(touch(820, 1180, { layout: '2x1' }).layout, '1x2');
  assert.deepEqual(desk(1600, { layout: '2x1', two: [1, 6] }).visible, [1, 6]);
  assert.equal(desk(1200, { layout: '2x1' }).inspector, 'floats', 'two columns of 420 px, as of four panes');
  assert.equal(desk(1280, { layout: '2x1', section: 'regions', isPinned: true }).overlay, 'floats', 'two panes make no row of three');
  assert.deepEqual(touch(390, 844, { layout: '2x1' }).visible, [1]);
});

test('panes show the views that were put into them, and a row leaves out the last', () => {
  const four = [6, 2, 5, 4];
  assert.deepEqual(desk(1600, { four }).visible, four);
  assert.deepEqual(desk(1600, { four, layout: 'row', active: 6 }).visible, [6, 2, 5]);
  assert.deepEqual(desk(1600, { four, layout: 'row', active: 4 }).visible, [6, 2, 4]);
});

test('a view that stands in another pane already changes places', () => {
  assert.deepEqual(placed([1, 2, 3, 4], 2, 5), [1, 5, 3, 4]);
  assert.deepEqual(placed([1, 2, 3, 4], 1, 4), [4, 2, 3, 1]);
  assert.deepEqual(placed([1, 2, 3, 4], 3, 3), [1, 2, 3, 4]);
});

function storage(kept = {}) {
  return {
    kept,
    getItem: (key) => kept[key] ?? null,
    setItem: (key, value) => {
      kept[key] = value;
    },
  };
}

test('the browser keeps layout, panes and links', () => {
  const kept = storage();
  const before = new Layout(kept);
  before.choose('oblique');
  before.place('2x2', 2, 6);
  before.isZoomLinked.value = true;
  const after = new Layout(kept);
  assert.deepEqual(
    [after.layout.value, after.two.value, after.four.value, after.isZoomLinked.value, after.areCamerasLinked.value],
    ['2x1', [1, 5], [1, 6, 3, 4], true, false],
  );
});

test('what a browser keeps and no page has written is the standard', () => {
  for (const text of [
    '',
    'null',
    '[]',
    '{"layout":"3x3","two":[1,1],"four":[1,2,3]}',
    '{"two":[0,1],"four":[1,2,3,99],"isZoomLinked":1}',
    '{"four":"1234"}',
  ]) {
    const layout = new Layout(storage({ 'beamroom panes': text }));
    assert.deepEqual(
      [layout.layout.value, layout.two.value, layout.four.value, layout.isZoomLinked.value],
      ['', [1, 2], [1, 2, 3, 4], false],
      text,
    );
  }
  const refuses = {
    getItem() {
      throw new Error('no');
    },
    setItem() {
      throw new Error('no');
    },
  };
  assert.equal(new Layout(refuses).layout.value, '');
});

test('two panes keep what was put into them; 3-D and oblique is a pair of its own', () => {
  const layout = new Layout(null);
  layout.place('2x1', 2, 6);
  layout.choose('2x2');
  layout.choose('2x1');
  assert.deepEqual(layout.two.value, [1, 6]);
  assert.equal(layoutId('2x1', layout.two.value), '2x1');
  layout.choose('oblique');
  assert.equal(layoutId('1x2', layout.two.value), 'oblique');
  layout.choose('2x1');
  assert.deepEqual(layout.two.value, [1, 2]);
  assert.deepEqual(
    layouts.map(({ id }) => layoutId(id === 'oblique' ? '2x1' : id, id === 'oblique' ? [1, 5] : [1, 2])),
    layouts.map(({ id }) => id),
  );
});

test('in a low window panes above the drawer stand in one row, and whole in a high one', () => {
  assert.deepEqual([desk(1280, { drawer: 'bottom' }, 720).layout, desk(1280, { drawer: 'bottom' }, 720).drawer], ['row', 'bottom']);
  assert.equal(desk(1280, { drawer: 'bottom', layout: '1+3' }, 799).layout, 'row');
  assert.equal(desk(1280, { drawer: 'bottom' }, 800).layout, '2x2');
  assert.equal(desk(1280, { drawer: '' }, 720).layout, '2x2');
  assert.equal(desk(1280, { drawer: 'bottom', layout: '2x1' }, 720).layout, '2x1');
  assert.deepEqual(desk(1280, { drawer: 'bottom', maximised: 2 }, 720).visible, [2]);
  assert.equal(
    desk(1280, { drawer: 'bottom', section: 'regions', isPinned: true }, 720).overlay,
    'pushes',
    'a row of three has room beside a section',
  );
});

test('beside the panes, from 1400 px on, the drawer leaves two panes of 420 px one above the other', () => {
  const right = desk(1400, { drawer: 'right', two: [2, 1], section: 'regions', isPinned: true });
  assert.deepEqual(
    [right.drawer, right.tree, right.layout, right.visible, right.overlay, right.inspector],
    ['right', 'rail', '1x2', [2, 1], 'floats', 'pushes'],
  );
  assert.equal(desk(1399, { drawer: 'right' }).drawer, 'bottom');
  assert.equal(desk(1600, { drawer: 'right', layout: 'single', active: 3 }).layout, 'single');
});

test('fingers have a sheet in place of the drawer', () => {
  assert.equal(touch(1180, 820, { drawer: 'bottom' }).drawer, '');
  assert.equal(touch(1180, 820, { drawer: 'bottom' }).layout, '1+3');
});
