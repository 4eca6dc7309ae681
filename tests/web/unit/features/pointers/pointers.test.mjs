// Pointers of members: where they stand in pictures with matrices computed by hand, how they fade, what is sent and shown when.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld } from '../../fake_room.mjs';
import { load } from '../../page.mjs';

const { colorOf, fading, farMm, isBehind, labelled, lookInSlice, placeOf } = await load('features/pointers/pointer_marks.js');
const { Pointing } = await load('features/pointers/pointing.js');

// A parallel picture 200 mm wide and 100 mm high around L 10, S 40, seen from anterior: x to the left of the patient, up superior. Column-major.
const coronal = [1 / 100, 0, 0, 0, 0, 0, 1 / 1000, 0, 0, 1 / 50, 0, 0, -10 / 100, -40 / 50, 0, 1];
// A pinhole at P -100 that looks towards posterior with 90 degrees across both sides: w is the distance from the eye along P.
const pinhole = [1, 0, 0, 0, 0, 0, 1, 1, 0, 1, 0, 0, 0, 0, 98, 100];
const box = { x: 5, y: 10, width: 400, height: 200 };

test('a point stands where the matrix of the picture puts it', () => {
  assert.deepEqual(placeOf(coronal, [10, 77, 40], box), { x: 205, y: 110 });
  const { x, y } = placeOf(coronal, [60, -5, 65], box); // 50 of 100 mm to the right, 25 of 50 mm up
  assert.ok(Math.abs(x - 305) < 1e-9 && Math.abs(y - 60) < 1e-9);
  assert.equal(placeOf(coronal, [111, 0, 40], box), null);
  assert.equal(placeOf(coronal, [10, 0, 91], box), null);
});

test('in perspective a point farther away stands nearer to the middle, and one behind the eye nowhere', () => {
  assert.deepEqual(placeOf(pinhole, [50, 0, 0], box), { x: 305, y: 110 }); // 50 mm of 100 to the right at 100 mm
  assert.deepEqual(placeOf(pinhole, [50, 100, 0], box), { x: 255, y: 110 }); // of 200 at 200 mm
  assert.equal(placeOf(pinhole, [0, -101, 0], box), null);
});

test('a pointer is hidden by what is seen nearer to the eye, not by the surface it lies on', () => {
  assert.equal(isBehind(pinhole, [0, 50, 0], [0, -20, 0]), true);
  assert.equal(isBehind(pinhole, [0, 50, 0], [0, 48, 0]), false);
  assert.equal(isBehind(pinhole, [0, 50, 0], [0, 80, 0]), false);
  assert.equal(isBehind(pinhole, [0, 50, 0], null), false);
  assert.equal(isBehind(coronal, [10, 50, 40], [10, -20, 40]), true);
});

test('in a slice it is whole within half a slice, then smaller and fainter with the distance said, and gone beyond some cm', () => {
  assert.deepEqual(lookInSlice(0.99, 1), { size: 1, strength: 1, words: '' });
  assert.deepEqual(lookInSlice(-1, 1), { size: 1, strength: 1, words: '' });
  const [near, far] = [lookInSlice(4.06, 1), lookInSlice(-31.7, 1)];
  assert.equal(near.words, '4.1 mm');
  assert.equal(far.words, '32 mm');
  assert.ok(far.size < near.size && near.size < 1 && far.strength < near.strength && near.strength < 1 && far.strength > 0.3);
  assert.ok(lookInSlice(farMm, 1).size >= 0.5);
  assert.equal(lookInSlice(farMm + 0.1, 1), null);
});

test('a pointer that stops fades after 3 s and is gone after 8 s', () => {
  assert.equal(fading(0), 1);
  assert.equal(fading(3000), 1);
  assert.equal(fading(5500), 1 - 0.75 / 2);
  assert.ok(fading(7999) > 0.2);
  assert.equal(fading(8000), 0);
});

test('labels cover neither each other nor the letters at the edges', () => {
  const pane = [420, 380];
  const marks = [
    [210, 190],
    [214, 192],
    [218, 188],
    [8, 190],
    [210, 6],
    [412, 190],
  ].map(([x, y], n) => ({ x, y, name: `Dr ${'ABCDEF'[n]} of the clinic`, words: '' }));
  const boxes = labelled(marks, pane, false).map(({ box: label }) => label);
  const letters = [
    [0, 177],
    [394, 177],
    [197, 0],
  ]
    .map(([x, y]) => ({ x, y, width: 26, height: 26 }))
    .concat({ x: 0, y: 350, width: 420, height: 30 });
  const overlap = (a, b) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
  for (const [n, label] of boxes.entries()) {
    assert.ok(label.x >= 0 && label.y >= 0 && label.x + label.width <= pane[0] && label.y + label.height <= pane[1], `${n} in the pane`);
    for (const other of [...boxes.slice(n + 1), ...letters]) assert.ok(!overlap(label, other), `${n}: ${JSON.stringify([label, other])}`);
  }
});

test('a long name is cut, and the distance is said beside it', () => {
  const [{ text }] = labelled([{ x: 100, y: 100, name: 'Professor Doctor Wolfgang Amadeus', words: '12 mm' }], [400, 400], false);
  assert.equal(text, 'Professor Doctor Wolfga… · 12 mm');
});

test('a member has the colour that the room gives', () => {
  assert.equal(colorOf({ id: 'm3', color: '#12aB34' }), '#12aB34');
  assert.match(colorOf({ id: 'm3' }), /^#[0-9a-f]{6}$/);
  assert.notEqual(colorOf({ id: 'm3' }), colorOf({ id: 'm4' }));
});

function meeting() {
  const world = roomWorld(members('m1', ['m2', 'm3']));
  const receive = (message) => world.connection.receive(message);
  const at = (member, point_mm) => receive({ type: 'pointer.at', member, view: 1, point_mm });
  return { ...world, receive, at, pointers: world.room.pointers };
}

test('of several places that come before a frame of the screen the newest is shown', () => {
  const { at, pointers, flush } = meeting();
  at('m2', [1, 0, 0]);
  at('m2', [2, 0, 0]);
  at('m3', [9, 0, 0]);
  assert.equal(pointers.all.value.size, 0);
  flush();
  assert.deepEqual(
    [...pointers.all.value.values()].map(({ member, point }) => [member, point[0]]),
    [
      ['m2', 2],
      ['m3', 9],
    ],
  );
  at('m2', [3, 0, 0]);
  at('m2', null);
  flush();
  assert.deepEqual([...pointers.all.value.keys()], ['m3']);
});

test('after a lost connection the server tells the pointers anew', () => {
  const { at, pointers, flush, lose, back, receive } = meeting();
  at('m2', [1, 0, 0]);
  flush();
  receive({ type: 'look', number: 4, by: 'm2', point_mm: [1, 2, 3], came: [] });
  assert.equal(pointers.look.value.number, 4);
  lose();
  back();
  assert.equal(pointers.all.value.size, 0);
  assert.equal(pointers.look.value, null);
});

test('a request to look ends by its own number only', () => {
  const { pointers, receive } = meeting();
  receive({ type: 'look', number: 4, by: 'm2', point_mm: [1, 2, 3], came: ['m3'] });
  receive({ type: 'look', number: 3, by: 'm3', point_mm: null, came: [] });
  assert.deepEqual(pointers.look.value, { number: 4, by: 'm2', point: [1, 2, 3], came: ['m3'] });
  receive({ type: 'look', number: 4, by: 'm2', point_mm: null, came: [] });
  assert.equal(pointers.look.value, null);
});

test('an observer does not point', () => {
  const { pointers, receive } = meeting();
  assert.equal(pointers.mayPoint.value, true);
  receive(members('m2', ['m1'], { m1: { role: 'observer' } }));
  assert.equal(pointers.mayPoint.value, false);
});

/** A clock whose timers are run by hand. */
function fakeClock() {
  let [now, timers, id] = [0, [], 0];
  return {
    now: () => now,
    setTimeout: (run, ms) => {
      timers.push({ id: ++id, at: now + ms, run });
      return id;
    },
    clearTimeout: (which) => {
      timers = timers.filter((timer) => timer.id !== which);
    },
    advance: (ms) => {
      now += ms;
      const due = timers.filter(({ at }) => at <= now);
      timers = timers.filter(({ at }) => at > now);
      for (const { run } of due) run();
    },
  };
}

test('a moving pointer sends thirty places a second, and the last one always', () => {
  const clock = fakeClock();
  const sent = [];
  const pointing = new Pointing({ point: (view, point) => sent.push([view, point]) }, clock);
  for (let n = 0; n < 200; n++, clock.advance(5)) pointing.at(2, [n, 0, 0]); // 1 s
  assert.ok(sent.length >= 30 && sent.length <= 34, `${sent.length}`);
  clock.advance(42);
  assert.deepEqual(sent.at(-1), [2, [199, 0, 0]]);
  pointing.stop();
  clock.advance(42);
  assert.deepEqual(sent.at(-1), [0, null]);
});

test('in 3-D one question is asked at a time, then about the newest place', async () => {
  const clock = fakeClock();
  const sent = [];
  const pointing = new Pointing({ point: (view, point) => sent.push(point?.[0] ?? null) }, clock);
  const open = [];
  const ask = (n) => () => new Promise((done) => open.push({ n, done: () => done([n, 0, 0]) }));
  const turn = async () => {
    await new Promise(setImmediate);
    clock.advance(45);
  };
  for (let n = 1; n <= 5; n++) pointing.seen(1, ask(n));
  await turn();
  assert.deepEqual(
    open.map(({ n }) => n),
    [1],
  );
  open[0].done();
  await turn();
  assert.deepEqual(
    open.map(({ n }) => n),
    [1, 5],
  );
  pointing.at(2, [77, 0, 0]); // the pointer went to a slice
  open[1].done();
  await turn();
  await turn();
  assert.deepEqual(sent, [1, 77]);
});

test('whether pointers are hidden is kept by the browser', () => {
  const kept = new Map();
  const storage = { getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value) };
  const { pointers } = meeting();
  pointers.keepIn(storage)(true);
  assert.equal(pointers.isHidden.value, true);
  const again = meeting().pointers;
  again.keepIn(storage);
  assert.equal(again.isHidden.value, true);
});
