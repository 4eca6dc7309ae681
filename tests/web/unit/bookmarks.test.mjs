// Saved views in the page: what is kept, what makes one scene of another, their order, a presentation.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './page.mjs';
import { members, roomWorld } from './fake_room.mjs';

const { Bookmarks, arrangeAs, bookmarksOf, canEdit, canSave, freeName, linkOf, move, patchTo, rename, save, stateNow, update } = await load('state/bookmarks.js');
const { mergePatch } = await load('wire/merge.js');
const { UiState } = await load('state/ui.js');

const row = (id, order, more = {}) => ({ id, kind: 'bookmark', version: 1, author: 'm1', author_name: 'A', created_ms: 1, changed_ms: 1, body: { format: 'beamroom-bookmark', version: 1, name: id, order, scene: {}, views: [], token: `t${id}`, later: 7, ...more } });

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
  assert.deepEqual(state.views.map(({ view, document }) => [view, document.kind, document.camera?.position_mm ?? null]), [[1, '3d', [1, 2, 3]], [2, 'axial', null]]);
  assert.deepEqual([state.scene, state.layout, 'override' in state], [null, { layout: '2x1', cells: [1, 2], maximised: 0, active: 1 }, false]);
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
  assert.deepEqual([of.puts()[0].item, of.puts()[0].version, of.puts()[0].body.later, of.puts()[0].body.token, of.puts()[0].body.name.length], ['i-1', 1, 7, 'ti-1', 80]);
  void update(of, one);
  assert.deepEqual([of.puts()[1].body.scene, of.puts()[1].body.name, of.puts()[1].body.token], [null, 'i-1', 'ti-1']);
  assert.equal(linkOf(one, 'https://host/at/#/rooms/r/p'), 'https://host/at/#/p/ti-1');
});

test('rows stand in their order, and are moved between their neighbours', () => {
  const of = world(undefined, [row('b', 2), row('a', 1), row('c', 3)]);
  const rows = bookmarksOf(of.room);
  assert.deepEqual(rows.map(({ id }) => id), ['a', 'b', 'c']);
  assert.equal(freeName(rows), 'View 4');
  const wanted = [];
  for (const [item, by] of [[rows[2], -1], [rows[1], -1], [rows[0], 1], [rows[1], 1], [rows[0], -1], [rows[2], 1]]) {
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
  assert.deepEqual([alone, follower, observer].map(({ room }) => [canSave(room), canEdit(room, mine), canEdit(room, hers)]), [[true, true, true], [true, true, false], [false, false, false]]);
});

test('a layout that this page does not have, or nonsense, changes nothing', () => {
  const { ui } = world();
  arrangeAs(ui, { layout: '2x1', cells: [3, 1], maximised: 0, active: 3 });
  assert.deepEqual([ui.visible.value, ui.active.value], [[3, 1], 3]);
  for (const bad of [undefined, { layout: 'spiral', cells: [9, 9], maximised: 'x', active: -1 }, { layout: '2x1', cells: [1, 1] }]) arrangeAs(ui, bad);
  assert.deepEqual([ui.visible.value, ui.active.value, ui.maximised.value], [[3, 1], 3, 0]);
});

test('a presentation goes from one to the next, and stays at its ends', async () => {
  const of = world(undefined, [row('a', 1), row('b', 2)]);
  const asked = [];
  const api = { bookmark: async (_, id) => (asked.push(id), { name: id, scene: { ...of.room.scene.value, axes: { visible: id === 'b' } }, views: [], layout: {}, report: [], n_report: 0 }) };
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
