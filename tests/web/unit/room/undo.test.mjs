// Undo and redo: steps, gestures, what somebody else has changed, and the words of the buttons; over a room that is a fake.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld } from '../fake_room.mjs';
import { load } from '../page.mjs';

const { Undo, maxSteps, joinMs } = await load('room/undo.js');
const { keepUndo } = await load('room/undo_kept.js');
const { stepName, stepTitle } = await load('shell/undo_words.js');
const { mergePatch } = await load('wire/merge.js');

function world() {
  let now = 1000;
  const told = [];
  const views = [
    { name: '3-D', nameWithin: '3-D', document: { value: { kind: '3d', size_px: [10, 10] } } },
    { name: 'Axial', nameWithin: 'axial', document: { value: { kind: 'axial' } } },
  ];
  const room = {
    id: 'abcd-efgh',
    member: { value: 'm1', peek: () => 'm1' },
    canChange: { value: true },
    following: { isPresenting: { value: true } },
    plan: {
      value: {
        images: [{ id: 'ct', unit: 'HU' }],
        regions: [
          { id: 'r1', name: 'brain' },
          { id: 'r2', name: 'tumor' },
        ],
      },
    },
    scene: {
      value: {
        regions: { r1: { opacity: 1, visible: true }, r2: { opacity: 1, visible: true } },
        image: {
          window: { center: 40, width: 400 },
          slices: { axial: { position_mm: 0 }, coronal: { position_mm: 0 }, sagittal: { position_mm: 0 } },
        },
      },
    },
    view: (number) => views[number - 1],
    patchScene(patch) {
      room.recorder('scene', patch, room.scene.value);
      room.scene.value = mergePatch(room.scene.value, patch);
    },
    patchView(number, patch) {
      const { document } = views[number - 1];
      room.recorder(number, patch, document.value);
      document.value = mergePatch(document.value, patch);
    },
  };
  const undo = new Undo(room, { clock: { now: () => now }, notify: (...words) => told.push(words) });
  const opacity = (value, id = 'r1') => room.patchScene({ regions: { [id]: { opacity: value } } });
  const other = (patch) => {
    room.scene.value = mergePatch(room.scene.value, patch);
  }; // another member
  return {
    room,
    undo,
    told,
    opacity,
    other,
    wait: (ms = joinMs + 1) => {
      now += ms;
    },
  };
}
const opacityOf = (room, id = 'r1') => room.scene.value.regions[id].opacity;

test('undo restores what was, redo what was done, one step at a time', () => {
  const { room, undo, opacity, wait } = world();
  opacity(0.5);
  wait();
  opacity(0.2);
  undo.undo();
  assert.equal(opacityOf(room), 0.5);
  undo.undo();
  assert.equal(opacityOf(room), 1);
  assert.equal(undo.next.value, null);
  undo.undo(); // nothing left
  undo.redo();
  undo.redo();
  assert.equal(opacityOf(room), 0.2);
  assert.equal(undo.nextAgain.value, null);
});

test('a new change ends what could be redone', () => {
  const { room, undo, opacity, wait } = world();
  opacity(0.5);
  undo.undo();
  wait();
  opacity(0.7);
  undo.redo();
  assert.equal(opacityOf(room), 0.7);
});

test('a change right after an undo is a step of its own', () => {
  const { room, undo, opacity, wait } = world();
  opacity(0.5);
  wait();
  opacity(0.4);
  undo.undo();
  opacity(0.3);
  undo.undo();
  assert.equal(opacityOf(room), 0.5);
});

test('all changes of one press are one step, however long it lasts and whatever it changes', () => {
  const { room, undo, wait } = world();
  undo.press();
  for (let at = 1; at <= 5; at++) {
    room.patchScene({ image: { slices: { axial: { position_mm: at }, coronal: { position_mm: 0 } } } });
    room.patchView(2, { camera: { height_mm: 100 + at } });
    wait(1000);
  }
  undo.release();
  undo.press();
  room.patchScene({ image: { slices: { axial: { position_mm: 9 } } } });
  undo.release();
  undo.undo();
  assert.equal(room.scene.value.image.slices.axial.position_mm, 5);
  undo.undo();
  assert.equal(room.scene.value.image.slices.axial.position_mm, 0);
  assert.equal(room.view(2).document.value.camera, undefined, 'the camera too');
  undo.redo();
  assert.deepEqual([room.scene.value.image.slices.axial.position_mm, room.view(2).document.value.camera], [5, { height_mm: 105 }]);
});

test('without a press, changes of the same field join within 400 ms, those of another do not', () => {
  const { room, undo, opacity, wait } = world();
  opacity(0.9);
  wait(joinMs);
  opacity(0.8);
  wait(joinMs);
  opacity(0.7);
  opacity(0.1, 'r2');
  undo.undo();
  assert.deepEqual([opacityOf(room), opacityOf(room, 'r2')], [0.7, 1]);
  undo.undo();
  assert.equal(opacityOf(room), 1);
});

test('what somebody else has changed since is left, and a message says so', () => {
  const { room, undo, told, opacity, other, wait } = world();
  opacity(0.5);
  other({ regions: { r1: { opacity: 0.3 } } });
  undo.undo();
  assert.equal(opacityOf(room), 0.3);
  assert.match(told[0][1], /^Not undone: .* somebody else/);
  wait();
  room.patchScene({ regions: { r1: { visible: false }, r2: { visible: false } } });
  other({ regions: { r2: { visible: true } } });
  other({ regions: { r2: { visible: false, opacity: 0.6 } } }); // another field, and the same value again
  undo.undo();
  assert.deepEqual(room.scene.value.regions, { r1: { opacity: 0.3, visible: true }, r2: { opacity: 0.6, visible: true } });
  assert.equal(told.length, 1);
  room.patchScene({ regions: { r1: { opacity: 1 }, r2: { opacity: 1 } } });
  other({ regions: { r2: { opacity: 0.2 } } });
  undo.undo();
  assert.deepEqual([opacityOf(room), opacityOf(room, 'r2')], [0.3, 0.2]);
  assert.match(told[1][1], /^Only in part undone/);
});

test('a camera goes back whole or not at all', () => {
  const { room, undo, told } = world();
  room.view(1).document.value.camera = { position_mm: [0, 0, 1], fov_deg: 30 };
  room.patchView(1, { camera: { position_mm: [0, 0, 2], fov_deg: 30, height_mm: 7 } });
  room.view(1).document.value = mergePatch(room.view(1).document.value, { camera: { fov_deg: 40 } });
  undo.undo();
  assert.deepEqual(room.view(1).document.value.camera, { position_mm: [0, 0, 2], fov_deg: 40, height_mm: 7 });
  assert.equal(told.length, 1);
  room.patchView(1, { camera: { position_mm: [0, 0, 3], height_mm: null } });
  undo.undo();
  assert.deepEqual(room.view(1).document.value.camera, { position_mm: [0, 0, 2], fov_deg: 40, height_mm: 7 });
});

test('a change that the server refused is passed over, the size of a pane is no step', () => {
  const { room, undo, told, opacity, other, wait } = world();
  opacity(0.5);
  wait();
  opacity(0.9, 'r2');
  other({ regions: { r2: { opacity: 1 } } }); // refused: as it was
  room.patchView(1, { size_px: [20, 20] });
  undo.undo();
  assert.equal(opacityOf(room), 1);
  assert.deepEqual(told, []);
});

test('what a step has made is taken away whole, and comes back whole, also when the same press changed it again', () => {
  const { room, undo, wait } = world();
  undo.press();
  room.patchScene({ image: { looks: { mr: { window: { center: 1, width: 2 }, color_map: 'grey' } } } });
  room.patchScene({ image: { looks: { mr: { color_map: 'rainbow' } } } });
  undo.release();
  const made = { mr: { window: { center: 1, width: 2 }, color_map: 'rainbow' } };
  assert.deepEqual(room.scene.value.image.looks, made);
  undo.undo();
  assert.deepEqual(room.scene.value.image.looks ?? {}, {});
  undo.redo();
  assert.deepEqual(room.scene.value.image.looks, made);
  wait();
  room.patchScene({ image: { looks: { mr: null } } });
  undo.undo();
  assert.deepEqual(room.scene.value.image.looks, made);
});

test('numbers that came back from the server with other last digits are the same', () => {
  const { room, undo, told, opacity, other } = world();
  opacity(0.1 + 0.2);
  other({ regions: { r1: { opacity: 0.3 } } });
  undo.undo();
  assert.deepEqual([opacityOf(room), told.length], [1, 0]);
});

test('the oldest of more than 100 steps is forgotten', () => {
  const { room, undo, wait } = world();
  for (let step = 1; step <= maxSteps + 5; step++) {
    room.patchScene({ image: { window: { center: 40 + step, width: 400 } } });
    wait();
  }
  for (let step = 0; step < maxSteps + 20; step++) undo.undo();
  assert.equal(room.scene.value.image.window.center, 45);
});

test("what was changed on one's own is no step any more after the return, the steps of the room stay", () => {
  const { room, connection, told, flush, advance } = roomWorld(members('m1', ['m2']));
  const undo = new Undo(room, { clock: { now: () => 0 }, notify: (...words) => told.push(words) });
  room.showView(2, [400, 400]);
  const opacity = (value) => {
    room.patchScene({ regions: { brain: { opacity: value } } });
    flush();
  };
  opacity(0.5); // as the presenter
  connection.receive({
    type: 'scene',
    revision: 2,
    patch: { regions: { brain: { opacity: 0.5 } } },
    by: 'm1',
    input: connection.sent.at(-1).input,
  });
  connection.receive(members('m2', ['m1']));
  const isOwn = () => !room.following.isFollowing.value;
  undo.undo();
  assert.deepEqual([undo.next.value, isOwn()], [null, false], "a step of the room is the presenter's");
  opacity(0.4);
  advance(joinMs + 1);
  room.patchView(2, { camera: { height_mm: 200 } });
  undo.undo();
  assert.notEqual(undo.next.value, null);
  assert.notEqual(undo.nextAgain.value, null);
  undo.undo();
  assert.equal(room.scene.value.regions.brain.opacity, 0.5, 'the own change of the same field is a step of its own');
  undo.undo();
  assert.equal(room.scene.value.regions.brain.opacity, 0.5);
  undo.redo();
  room.following.return();
  told.length = 0;
  undo.undo();
  undo.redo();
  assert.deepEqual([undo.next.value, undo.nextAgain.value, isOwn(), told], [null, null, false, []]);
  connection.receive(members('m1', ['m2']));
  assert.notEqual(undo.next.value, null);
  undo.undo();
  assert.equal(room.scene.value.regions.brain.opacity, 1);
});

test("what was changed on one's own is no step any more after the presenter has called everybody back", () => {
  const { room, connection, told, flush } = roomWorld(members('m2', ['m1']));
  const undo = new Undo(room, { clock: { now: () => 0 }, notify: (...words) => told.push(words) });
  room.showView(2, [400, 400]);
  room.patchScene({ regions: { brain: { opacity: 0.4 } } });
  flush();
  const view = (follow) =>
    connection.receive({ type: 'view', view: 2, document: { kind: 'axial', size_px: [400, 400] }, follow, by: 'm2' });
  view(false);
  assert.notEqual(undo.next.value, null);
  connection.receive({ type: 'scene', revision: 2, patch: { regions: { brain: { opacity: 0.7 } } }, by: 'm2' });
  view(true);
  told.length = 0;
  undo.undo();
  assert.deepEqual([undo.next.value, room.following.isFollowing.value, told], [null, true, []]);
});

test('a reload keeps the steps of the same member, but not those of another, nor own views', () => {
  const items = new Map();
  const storage = {
    getItem: (key) => items.get(key) ?? null,
    setItem: (key, value) => items.set(key, value),
    removeItem: (key) => items.delete(key),
  };
  const first = world();
  const target = new EventTarget();
  keepUndo(first.room, first.undo, storage, target);
  first.opacity(0.5);
  first.wait();
  first.opacity(0.25);
  first.undo.undo();
  target.dispatchEvent(new Event('pagehide'));
  const name = `undo ${first.room.id}`;
  assert.ok(items.has(name));
  const again = world();
  again.room.scene.value = first.room.scene.value; // what the server kept
  keepUndo(again.room, again.undo, storage, new EventTarget());
  assert.notEqual(again.undo.nextAgain.value, null);
  again.undo.redo();
  assert.equal(opacityOf(again.room), 0.25);
  again.undo.undo();
  again.undo.undo();
  assert.equal(opacityOf(again.room), 1);
  for (const wrong of [
    '',
    '{',
    'null',
    JSON.stringify({ ...JSON.parse(items.get(name)), member: 'm9' }),
    JSON.stringify({ member: 'm1', done: [{ place: 'room', changes: [{}] }], undone: [] }),
  ]) {
    const other = world();
    items.set(name, wrong);
    keepUndo(other.room, other.undo, storage, new EventTarget());
    assert.equal(other.undo.next.value, null, wrong.slice(0, 60));
  }
});

test('steps are named, with the value and its unit', () => {
  const { room, undo, opacity, wait } = world();
  const title = () => stepTitle('undo', undo.next.value, room);
  assert.equal(title(), 'Undo');
  opacity(0.5);
  assert.equal(title(), 'Undo: opacity of brain, to 100 %');
  wait();
  room.patchScene({ image: { window: { center: 80, width: 200 } } });
  assert.equal(title(), 'Undo: window, to C 40  W 400 HU');
  const name = (of, ...paths) =>
    stepName(
      paths.map((path) => ({ of, path: path.split('.') })),
      room,
    );
  assert.equal(name('scene', 'regions.r1.visible', 'regions.r2.visible'), 'visibility of 2 regions');
  assert.equal(name('scene', 'image.slices.axial.position_mm', 'image.slices.coronal.position_mm'), 'crosshair');
  assert.equal(name('scene', 'outline.width_px'), 'outline width');
  assert.equal(name(1, 'camera'), 'camera of 3-D');
  assert.equal(name('scene', 'image.id', 'image.window', 'image.color_map', 'image.looks.ct'), 'image shown', 'its look goes with it');
  assert.equal(name('scene', 'image.volume.points'), 'transfer function');
  assert.equal(name('scene', 'image.blend.opacity'), 'opacity of the second image');
  assert.equal(name('scene', 'measures.m1'), 'measure');
  assert.equal(name('scene', 'measures.m1.points'), 'points of a measure');
});
