// Several panes of one room: which pictures a change of the scene leaves as they are, and acts on several views.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld } from '../fake_room.mjs';
import { load } from '../page.mjs';

const { Undo, joinMs } = await load('room/undo.js');
const { stepTitle } = await load('shell/undo_words.js');
const { boxOfSelection } = await load('pane/pane_camera.js');

const frame = (view, input_id, scene_revision, sequence = 1) => ({ view, sequence, input_id, scene_revision });
const moved = { image: { slices: { coronal: { position_mm: 5 } } } };
const told = (input, revision, unchanged) => ({ type: 'scene', revision, patch: moved, by: 'm1', input, unchanged });

function twoPanes() {
  const world = roomWorld();
  world.room.showView(1, [400, 300]);
  world.room.showView(4, [400, 300]);
  world.flush();
  return world;
}

test('a picture that a change does not reach is one of the new revision too, be it there already or on its way', () => {
  const { room, connection } = twoPanes();
  const revisions = () => [1, 4].map((number) => room.view(number).painted.value.scene_revision);
  room.frameShown(frame(1, 0, 1));
  room.frameShown(frame(4, 0, 1));
  connection.receive(told(0, 2, [1]));
  assert.deepEqual(revisions(), [2, 1]);
  room.frameShown(frame(1, 0, 1, 2)); // was on its way
  assert.deepEqual(revisions(), [2, 1]);
  connection.receive(told(0, 3, [4]));
  assert.deepEqual(revisions(), [2, 1], 'the picture of view 4 is older than the change before, which did reach it');
  room.frameShown(frame(4, 0, 2, 2));
  assert.deepEqual(revisions(), [2, 3]);
  connection.receive(told(0, 4, null));
  assert.deepEqual(revisions(), [2, 3]);
});

test('an input in a pane that it does not reach is answered by the first one that it does, with its own time', () => {
  const { room, connection, flush } = twoPanes();
  room.frameShown(frame(1, 99, 1));
  room.frameShown(frame(4, 99, 1));
  room.patchScene(moved, { view: 1, at: 990 });
  flush();
  const { input } = connection.sent.at(-1);
  assert.ok(room.view(1).staleSince.value > 0);
  connection.receive(told(input, 2, [1]));
  assert.equal(room.view(1).staleSince.value, 0, 'no picture is due there');
  assert.deepEqual(
    room.frameShown(frame(4, input, 2, 2)).map(({ at }) => at),
    [990],
  );
});

test('an input that no picture shows is waited for nowhere', () => {
  const { room, connection, flush } = twoPanes();
  room.frameShown(frame(1, 99, 1));
  room.frameShown(frame(4, 99, 1));
  room.patchScene(moved, { view: 1, at: 990 });
  flush();
  connection.receive(told(connection.sent.at(-1).input, 2, [1, 4]));
  assert.deepEqual(
    [1, 4].map((number) => room.view(number).staleSince.value),
    [0, 0],
  );
});

function undoWorld(list) {
  const world = roomWorld(list);
  let now = 0;
  const undo = new Undo(world.room, { clock: { now: () => now }, notify: () => {} });
  for (const view of [1, 2, 3, 6]) world.room.showView(view, [400, 400]);
  return {
    ...world,
    undo,
    wait: (ms) => {
      now += ms;
    },
  };
}
const heights = (room) => [2, 3].map((number) => room.view(number).document.value.camera?.height_mm);
const zoomTo = (room, height_mm) =>
  room.patchViews([
    [2, { camera: { height_mm } }],
    [3, { camera: { height_mm } }],
  ]);

test('an act on several views is one step, and one with the same act just before it', () => {
  const { room, undo, wait } = undoWorld();
  zoomTo(room, 90);
  wait(joinMs);
  zoomTo(room, 80); // the wheel is turned on
  wait(joinMs + 1);
  zoomTo(room, 70);
  assert.equal(stepTitle('undo', undo.next.value, room), 'Undo: camera of axial, sagittal');
  undo.undo();
  assert.deepEqual(heights(room), [80, 80]);
  undo.undo();
  assert.deepEqual(heights(room), [undefined, undefined]);
  assert.equal(undo.next.value, null);
  undo.redo();
  assert.deepEqual(heights(room), [80, 80]);
});

test('an act on several views of a follower leaves once, and keeps the scale of each', () => {
  const { room, connection, flush } = undoWorld(members('m2', ['m1']));
  zoomTo(room, 90);
  flush();
  assert.equal(connection.sent.filter(({ type }) => type === 'follow').length, 1);
  assert.equal(room.following.isFollowing.value, false);
  assert.deepEqual(heights(room), [90, 90]);
});

test('who leaves keeps the second 3-D view, and oblique planes where they are', () => {
  const { room, connection, flush } = undoWorld(members('m2', ['m1']));
  connection.receive({
    type: 'scene',
    revision: 2,
    patch: { image: { obliques: { a: { visible: false, name: '', origin_mm: [1, 2, 3], normal: [0, 1, 1] } } } },
    by: 'm2',
    input: 0,
  });
  room.following.leave();
  flush();
  const { views } = connection.sent.find(({ type }) => type === 'follow');
  const documentOf = (number) => views.find(({ view }) => view === number).document;
  assert.deepEqual([documentOf(6).kind, documentOf(6).number, documentOf(1).number], ['3d', 2, undefined]);
  assert.deepEqual(documentOf(1).override.image.obliques, { a: { origin_mm: [1, 2, 3], normal: [0, 1, 1] } });
});

test('what is selected has a box: a region its own, a measure that of its points, and no box is flat', () => {
  const plan = {
    regions: [
      { id: 'r', bounds_mm: { low: [0, 0, 0], high: [20, 30, 40] } },
      { id: 'empty', bounds_mm: null },
    ],
  };
  const scene = { measures: { m: { points: [{ at_mm: [5, 0, 0] }, { at_mm: [25, 0, 40] }] } } };
  assert.deepEqual(boxOfSelection({ kind: 'region', id: 'r' }, plan, scene), plan.regions[0].bounds_mm);
  assert.deepEqual(boxOfSelection({ kind: 'measure', id: 'm' }, plan, scene), { low: [5, -5, 0], high: [25, 5, 40] });
  for (const selection of [
    { kind: 'region', id: 'empty' },
    { kind: 'measure', id: 'gone' },
    { kind: 'view', id: '' },
  ])
    assert.equal(boxOfSelection(selection, plan, scene), null);
});
