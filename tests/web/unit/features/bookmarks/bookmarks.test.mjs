// Saved views in the page: what is kept, what makes one scene of another, their order, a presentation.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';
import { members, roomWorld } from '../../fake_room.mjs';

const { Bookmarks, arrangeAs, bookmarksOf, canEdit, canSave, freeName, linkOf, move, patchTo, rename, save, stateNow, update } =
  await load('features/bookmarks/bookmarks.js');
const { mergePatch } = await load('wire/merge.js');
const { UiState } = await load('room/ui.js');

const row = (id, order, more = {}) => ({
  id,
  kind: 'bookmark',
  version: 1,
  author: 'm1',
  author_name: 'A',
  created_ms: 1,
  changed_ms: 1,
  body: { format: 'beamroom-bookmark', version: 1, name: id, order, scene: {}, views: [], token: `t${id}`, later: 7, ...more },
});

function world(list, rows = []) {
  const made = roomWorld(list);
  const ui = new UiState({ now: () => 0, setTimeout: () => 0 });
  ui.window.value = { width: 1600, height: 1000, isCoarse: false };
  for (const item of rows) made.connection.receive({ type: 'item', id: item.id, item, by: 'm2', input: 0 });
  const puts = () => made.connection.sent.filter(({ type }) => type.startsWith('item.'));
  const answer = (item) => made.connection.receive({ type: 'item', id: item.id, item, by: 'm1', input: puts().at(-1).input });
  return { ...made, ui, puts, answer };
}

test('a patch makes one scene of another, also where one has more', () => {
  const plain = { a: { x: 1, y: [1, 2] }, map: {} };
  const rich = { a: { x: 2, y: [1, 3] }, map: { m1: { visible: true, at: [0] }, kept: { name: 'n' } } };
  assert.deepEqual(mergePatch(plain, patchTo(plain, rich)), rich);
  assert.deepEqual(mergePatch(rich, patchTo(rich, plain)), plain);
  assert.deepEqual(patchTo(rich, rich), {});
  assert.deepEqual(patchTo(rich, plain, true), { a: { x: 1, y: [1, 2] }, map: { m1: { visible: false } } }); // an override cannot take away
  assert.deepEqual(patchTo({ map: {} }, JSON.parse('{"map": {"__proto__": {"visible": true}}}')).map.polluted, undefined);
});

test('what is saved are the visible views with their cameras, the layout and the own override', async () => {
  const of = world();
  const { room, ui, answer, puts } = of;
  room.patchView(1, { camera: { position_mm: [1, 2, 3] } });
  ui.setLayout('2x1');
  const state = stateNow(of);
  assert.deepEqual(
    state.views.map(({ view, document }) => [view, document.kind, document.camera?.position_mm ?? null]),
    [
      [1, '3d', [1, 2, 3]],
      [2, 'axial', null],
    ],
  );
  assert.deepEqual(
    [state.scene, state.layout, 'override' in state],
    [null, { layout: '2x1', cells: [1, 2], maximised: 0, active: 1 }, false],
  );
  assert.ok(!('size_px' in state.views[0].document));
  const saved = save(of, '');
  assert.deepEqual([puts()[0].type, puts()[0].kind, puts()[0].body.name, puts()[0].body.order], ['item.put', 'bookmark', 'View 1', 1]);
  answer(row('i-1', 1));
  assert.equal((await saved).id, 'i-1');

  const alone = world(members('m2', ['m1']));
  alone.room.patchScene({ regions: { brain: { opacity: 0.5 } } });
  assert.equal(stateNow(alone).override.regions.brain.opacity, 0.5);
});

test('a change keeps what this version does not know, and the link', async () => {
  const of = world(undefined, [row('i-1', 1)]);
  const [one] = bookmarksOf(of.room);
  void rename(of, one, 'x'.repeat(100));
  assert.deepEqual(
    [of.puts()[0].item, of.puts()[0].version, of.puts()[0].body.later, of.puts()[0].body.token, of.puts()[0].body.name.length],
    ['i-1', 1, 7, 'ti-1', 80],
  );
  void update(of, one);
  assert.deepEqual([of.puts()[1].body.scene, of.puts()[1].body.name, of.puts()[1].body.token], [null, 'i-1', 'ti-1']);
  assert.equal(linkOf(one, 'https://host/rooms/r'), 'https://host/#/p/ti-1');
});

test('rows stand in their order, and are moved between their neighbours', () => {
  const of = world(undefined, [row('b', 2), row('a', 1), row('c', 3)]);
  const rows = bookmarksOf(of.room);
  assert.deepEqual(
    rows.map(({ id }) => id),
    ['a', 'b', 'c'],
  );
  assert.equal(freeName(rows), 'View 4');
  const wanted = [];
  for (const [item, by] of [
    [rows[2], -1],
    [rows[1], -1],
    [rows[0], 1],
    [rows[1], 1],
    [rows[0], -1],
    [rows[2], 1],
  ]) {
    const before = of.puts().length;
    void move(of, item, by);
    wanted.push(of.puts().length === before ? null : of.puts().at(-1).body.order);
  }
  assert.deepEqual(wanted, [1.5, 0, 2.5, 4, null, null]);
});

test('who may save and change: not observers, and others only where they present', () => {
  const mine = row('i-1', 1);
  const hers = { ...row('i-2', 2), author: 'm2' };
  const [alone, follower, observer] = [world(), world(members('m2', ['m1'])), world(members('m2', ['m1'], { m1: { role: 'observer' } }))];
  assert.deepEqual(
    [alone, follower, observer].map(({ room }) => [canSave(room), canEdit(room, mine), canEdit(room, hers)]),
    [
      [true, true, true],
      [true, true, false],
      [false, false, false],
    ],
  );
});

test('a layout that this page does not have, or nonsense, changes nothing', () => {
  const { ui } = world();
  arrangeAs(ui, { layout: '2x1', cells: [3, 1], maximised: 0, active: 3 });
  assert.deepEqual([ui.visible.value, ui.active.value], [[3, 1], 3]);
  for (const bad of [undefined, { layout: 'spiral', cells: [9, 9], maximised: 'x', active: -1 }, { layout: '2x1', cells: [1, 1] }])
    arrangeAs(ui, bad);
  assert.deepEqual([ui.visible.value, ui.active.value, ui.maximised.value], [[3, 1], 3, 0]);
});

test('a presentation goes from one to the next, and stays at its ends', async () => {
  const of = world(undefined, [row('a', 1), row('b', 2)]);
  const asked = [];
  const api = {
    bookmark: async (_, id) => (
      asked.push(id),
      { name: id, scene: { ...of.room.scene.value, axes: { visible: id === 'b' } }, views: [], layout: {}, report: [], n_report: 0 }
    ),
  };
  const bookmarks = new Bookmarks({ ...of, api }, { createObjectURL: () => 'blob:x', revokeObjectURL: () => {} });
  await bookmarks.play();
  assert.deepEqual([bookmarks.position(), bookmarks.isPlaying.value], [0, true]);
  await bookmarks.step(-1);
  await bookmarks.step(1);
  await bookmarks.step(1);
  assert.deepEqual([asked, bookmarks.position(), of.room.scene.value.axes.visible], [['a', 'b'], 1, true]);
  bookmarks.end();
  assert.equal(bookmarks.isPlaying.value, false);
});

// ---- what others made since -----------------------------------------------------------------------------------------------

const { mergedScene, toldOfMerge } = await load('room/scene_merge.js');

test('a saved view hides planes and levels that it does not hold, and leaves marks as they are now', () => {
  const line = (name, visible = true) => ({ kind: 'distance', name, author: 'Dr A', visible, points: [] });
  const draft = (enabled, x) => ({ enabled, shows_planned: false, line: { name: '', entry_mm: [x, 0, 0], target_mm: [0, 0, 0] } });
  const now = {
    measures: { 'm1-m2': line('since'), 'm2-m3': line('moved since') },
    probes: { 'pin-1-m2': { at_mm: [1, 2, 3] } },
    constraints: { 'limit-1-m2': { region: 'brain', limit: 9 } },
    image: { obliques: { b: { visible: true, origin_mm: [1, 1, 1] }, c: { visible: false } } },
    dose: { levels: { 90: { value: 90, visible: true } } },
    beam: { kept: { k: { name: 'AP' } }, draft: draft(true, 7) },
  };
  const saved = {
    measures: { 'm2-m3': line('as saved', false), m9: line('deleted since') },
    probes: {},
    constraints: {},
    image: { obliques: {} },
    dose: { levels: { 50: { value: 50, visible: true } } },
    beam: { kept: {}, draft: draft(false, 0) },
  };
  const { scene, hidden, changed } = mergedScene(now, saved);
  assert.deepEqual(scene.measures, { 'm1-m2': line('since'), 'm2-m3': line('moved since', false), m9: line('deleted since') });
  assert.deepEqual(
    [scene.probes, scene.constraints, scene.beam.kept, scene.beam.draft],
    [now.probes, now.constraints, now.beam.kept, draft(false, 7)],
  );
  assert.deepEqual(scene.image.obliques, { b: { visible: false, origin_mm: [1, 1, 1] }, c: { visible: false } });
  assert.deepEqual(scene.dose.levels, { 90: { value: 90, visible: false }, 50: { value: 50, visible: true } });
  assert.equal(
    toldOfMerge({ hidden, changed, left: [] }),
    'Hidden, not deleted: 1 measure, 1 oblique plane, 1 isodose level, the draft beam. Changed since, and left so: 1 measure.',
  );
  assert.equal(toldOfMerge(mergedScene(now, now)), '');
});

test('whatever was made before and since, showing a saved view deletes none of it, and says what it hides', () => {
  let state = 1;
  const below = (n) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state >>> 16) % n;
  };
  const pick = (make) => Object.fromEntries(Array.from({ length: 40 }, (_, at) => [`e${at}`, make(at)]).filter(() => below(2)));
  const mark = () => ({ visible: below(2) > 0, value: below(3) });
  const made = () => ({
    measures: pick(mark),
    probes: pick(() => ({ value: below(3) })),
    constraints: pick(() => ({ value: below(3) })),
    image: { obliques: Object.fromEntries(Object.entries(pick(mark)).slice(0, 4)) },
    dose: { levels: Object.fromEntries(Object.entries(pick(mark)).slice(0, 20)), weights: pick(() => ({ boron_ratio: 1 })) },
    beam: { kept: pick(() => ({ value: below(3) })), draft: { enabled: below(2) > 0, line: { x: below(9) } } },
  });
  const of = (scene) => [scene.measures, scene.probes, scene.constraints, scene.image.obliques, scene.dose.levels, scene.beam.kept];
  for (let run = 0; run < 200; run++) {
    const [now, saved] = [made(), made()];
    for (const isOwn of [false, true]) {
      const merge = mergedScene(now, saved);
      const after = mergePatch(now, patchTo(now, merge.scene, isOwn));
      let hidden = 0;
      of(now).forEach((map, kind) => {
        for (const [id, entry] of Object.entries(map)) {
          const is = of(after)[kind][id];
          assert.ok(is, `entry ${id} of map ${kind} is gone`);
          if (![3, 4].includes(kind)) assert.equal(is.value, entry.value, 'a mark stays as it is now');
          if (entry.visible && !is.visible) hidden += 1;
        }
      });
      const told = merge.hidden.filter((words) => words !== 'the draft beam').reduce((sum, words) => sum + Number.parseInt(words, 10), 0);
      assert.equal(told, hidden);
      assert.equal(merge.hidden.includes('the draft beam'), now.beam.draft.enabled && !after.beam.draft.enabled);
      if (!saved.beam.draft.enabled) assert.deepEqual(after.beam.draft.line, now.beam.draft.line);
      [64, 32, 64, 8, 32, 16].forEach((most, kind) =>
        assert.ok(Object.keys(of(after)[kind]).length <= Math.max(most, Object.keys(of(now)[kind]).length)),
      );
    }
  }
});
