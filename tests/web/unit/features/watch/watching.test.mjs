// The small picture of the presenter: whom it shows, what is said of it, what the browser keeps.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld } from '../../fake_room.mjs';
import { load } from '../../page.mjs';

const { Watching, WorkedIn, corners, liveness, watched } = await load('features/watch/watching.js');
const open = { state: 'open', quietSince: 0 };
const now = { link: open, renderer: 'ready', isLate: false, paintedAt: Date.UTC(2026, 0, 1, 10, 22, 31), isAway: false };

test('it shows whoever presents to a member who is on their own, and to nobody else', () => {
  const { room, connection } = roomWorld(members('m2', ['m1']));
  connection.receive({ type: 'view', view: 1, document: { kind: '3d' }, follow: true, by: 'm2' });
  assert.equal(watched(room), null, 'who follows sees it anyway');
  room.following.isFollowing.value = false;
  assert.deepEqual(watched(room), { name: 'Dr A', isAway: false });
  connection.receive(members('m2', ['m1'], { m2: { connected: false } }));
  assert.deepEqual(watched(room), { name: 'Dr A', isAway: true });
  connection.receive(members('m3', ['m1', 'm2']));
  assert.deepEqual(watched(room), { name: 'Dr B', isAway: false }, 'it goes with control');
  connection.receive(members(null, ['m1', 'm2']));
  assert.equal(watched(room), null, 'nobody presents');
});

test('in a room that plays a recording it shows the replay', () => {
  const { room, connection } = roomWorld(members(null, ['m1']));
  room.following.isFollowing.value = false;
  assert.equal(watched(room), null);
  connection.receive({ type: 'replay', started_ms: 1 });
  assert.deepEqual(watched(room), { name: 'The replay', isAway: false });
});

test('it says when its picture is old, and why', () => {
  assert.deepEqual(liveness(now), { state: 'live', text: 'Live', why: '' });
  assert.equal(liveness({ ...now, paintedAt: 0 }).state, 'wait');
  const cases = [
    [{ link: { state: 'lost', quietSince: 0 } }, 'lost', /connection/],
    [{ link: { ...open, quietSince: 5 } }, 'old', /does not answer/],
    [{ renderer: 'restarting' }, 'old', /not being drawn/],
    [{ isLate: true }, 'old', /not come yet/],
  ];
  for (const [more, state, why] of cases) {
    const said = liveness({ ...now, ...more });
    assert.equal(said.state, state, JSON.stringify(more));
    assert.match(said.text, /^Old, of \d\d:\d\d:\d\d$/);
    assert.match(said.why, why);
  }
  assert.deepEqual([liveness({ ...now, isAway: true }).text, liveness({ ...now, isAway: true }).state], ['Away', 'old']);
});

test('corner, folded and closed are kept, and what is kept badly is not taken', () => {
  const kept = new Map();
  const storage = { getItem: (key) => kept.get(key) ?? null, setItem: (key, text) => kept.set(key, text) };
  const first = new Watching(storage);
  assert.deepEqual([first.corner.value, first.isFolded.value, first.isClosed.value], ['', false, false]);
  first.corner.value = 'top-left';
  first.isFolded.value = true;
  first.stop();
  const again = new Watching(storage);
  assert.deepEqual([again.corner.value, again.isFolded.value, again.isClosed.value], ['top-left', true, false]);
  again.stop();
  for (const text of ['null', '[]', '{', '{"corner":"middle","isFolded":1,"isClosed":"yes"}']) {
    kept.set('beamroom watch', text);
    const { corner, isFolded, isClosed } = new Watching(storage);
    assert.deepEqual([corner.value, isFolded.value, isClosed.value], ['', false, false], text);
  }
  assert.equal(new Set(corners).size, 4);
  assert.equal(new Watching(null).isClosed.value, false);
});

test('the view worked in is the one acted in last, once it lasts, and not back and forth', () => {
  const told = [];
  let now = 0;
  let timer = null;
  const worked = new WorkedIn((view) => told.push([now, view]), {
    now: () => now,
    setTimeout: (run, ms) => {
      timer = { run, at: now + ms };
      return timer;
    },
    clearTimeout: (old) => {
      if (old === timer) timer = null;
    },
  });
  const pass = (ms) => {
    const end = now + ms;
    for (let due; timer && timer.at <= end; due.run()) {
      due = timer;
      timer = null;
      now = due.at;
    }
    now = end;
  };
  worked.acted(1);
  pass(5000);
  for (let turn = 0; turn < 5; turn++) {
    // a wheel over the axial pane
    worked.acted(2);
    pass(100);
  }
  assert.deepEqual(told, [[0, 1]]);
  pass(100);
  assert.deepEqual(told.at(-1), [5600, 2]);
  worked.acted(1); // and back: not before 2 s are over
  pass(1900);
  assert.deepEqual(told.at(-1), [5600, 2]);
  pass(100);
  assert.deepEqual(told.at(-1), [7600, 1]);
  worked.acted(3);
  pass(300);
  worked.acted(1); // a slip
  pass(9000);
  assert.deepEqual(told.at(-1), [7600, 1]);
  worked.restart();
  worked.acted(1);
  assert.deepEqual(told.at(-1), [now, 1]);
});
