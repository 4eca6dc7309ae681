// Pointer on a picture: taps and double taps, the pointer at rest and its card; with an element, a clock and a server that are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { PointerReader } = await load('pane/pointer.js');
const { Pointed, restMs } = await load('room/pointed.js');
const { cardOf, overlap, placeBeside } = await load('parts/place.js');

class FakeElement extends EventTarget {
  getBoundingClientRect() {
    return { left: 0, top: 0, width: 400, height: 300 };
  }
  setPointerCapture() {}
  focus() {}
  fire(type, x, y, { at = 0, ...how } = {}) {
    const event = Object.assign(new Event(type, { cancelable: true }), {
      pointerId: 1,
      pointerType: 'mouse',
      button: 0,
      buttons: 0,
      clientX: x,
      clientY: y,
      ...how,
    });
    Object.defineProperty(event, 'timeStamp', { value: at });
    this.dispatchEvent(event);
  }
}

function reader() {
  const element = new FakeElement();
  const told = [];
  const handlers = Object.fromEntries(
    ['start', 'move', 'end', 'tap', 'doubleTap', 'longPress', 'hover', 'leave', 'wheel', 'pinch'].map((name) => [
      name,
      (...words) => told.push([name, ...words]),
    ]),
  );
  const pointer = new PointerReader(element, handlers);
  const click = (x, y, at, how) => {
    element.fire('pointerdown', x, y, { at, ...how });
    element.fire('pointerup', x, y, { at: at + 20, ...how });
  };
  return { element, pointer, click, names: () => told.map(([name]) => name), told };
}

/** Turns a wheel: events of {deltaY, wheelDeltaY, deltaMode}, everyMs apart. @returns {number[]} the steps that were told */
function turn(events, everyMs) {
  const { element, told } = reader();
  let at = 1000;
  for (const how of events) {
    element.fire('wheel', 10, 10, { deltaMode: 0, ctrlKey: false, ...how, at });
    at += everyMs;
  }
  return told.map(([, { steps }]) => steps);
}
const times = (n, how) => Array.from({ length: n }, () => how);

// as Chromium 150 tells a notch: 100 px and 120 at 100 %, both by the zoom less; whatever the pixels of the screen
test('a notch of a wheel is a step at every zoom of the page, quick or slow, whatever its px', () => {
  for (const zoom of [0.5, 0.8, 1, 1.1, 1.25, 1.5, 2, 2.5, 3])
    for (const px of [53, 100, 120, 300]) {
      const notch = { deltaY: px / zoom, wheelDeltaY: -Math.trunc(120 / zoom) };
      assert.deepEqual(turn(times(6, notch), 400), times(6, 1), `slowly, ${px} px at ${zoom}`);
      assert.deepEqual(turn(times(6, notch), 16), times(6, 1), `quickly, ${px} px at ${zoom}`);
    }
  const back = { deltaY: -50, wheelDeltaY: 60 };
  assert.deepEqual(turn([back, back, { deltaY: 50, wheelDeltaY: -60 }], 50), [-1, -1, 1], 'back and forth');
  assert.deepEqual(turn([back, { deltaY: -100, wheelDeltaY: 120 }], 16), [-1, -2], 'two notches in one event');
});

test('a notch of Firefox is a step: lines, pages, px', () => {
  assert.deepEqual(turn(times(6, { deltaMode: 1, deltaY: 3, wheelDeltaY: -120 }), 50), times(6, 1));
  assert.deepEqual(turn(times(6, { deltaMode: 1, deltaY: 3 }), 50), times(6, 1), 'without wheelDeltaY');
  assert.deepEqual(turn(times(3, { deltaMode: 2, deltaY: -1 }), 50), times(3, -1), 'a page');
  assert.deepEqual(turn(times(3, { deltaMode: 0, deltaY: 48, wheelDeltaY: -120 }), 50), times(3, 1), 'px');
});

test('small strokes of a trackpad add up to steps of 100 px', () => {
  const sum = (steps) => steps.reduce((all, step) => all + step, 0);
  const linux = times(40, { deltaY: 8, wheelDeltaY: -10 });
  assert.equal(sum(turn(linux, 8)), 3);
  assert.equal(sum(turn(linux, 300)), 3, 'slowly');
  const mac = [4, 20, 64, 80, 72, 40, 16, 4].map((deltaY) => ({ deltaY, wheelDeltaY: -3 * deltaY }));
  assert.equal(sum(turn(mac, 8)), 3);
  assert.equal(sum(turn(mac.slice(2), 8)), 2, 'begun at once');
  assert.deepEqual(
    turn([...times(5, { deltaY: 10, wheelDeltaY: -12 }), { deltaY: -100, wheelDeltaY: 120 }], 300),
    [-1],
    'a wheel after it',
  );
});

/** The timers of the page stand still while the test runs, and go on by pass(ms). */
const withTimers = (name, run) =>
  test(name, () => {
    const { setTimeout, clearTimeout } = globalThis;
    const waiting = new Map();
    let [now, last] = [0, 0];
    globalThis.setTimeout = (callback, ms) => {
      waiting.set(++last, { callback, at: now + ms });
      return last;
    };
    globalThis.clearTimeout = (timer) => waiting.delete(timer);
    const pass = (ms) => {
      now += ms;
      for (const [timer, { callback, at }] of [...waiting].sort(([, a], [, b]) => a.at - b.at)) {
        if (at > now || !waiting.delete(timer)) continue;
        callback();
      }
    };
    try {
      return run(pass);
    } finally {
      Object.assign(globalThis, { setTimeout, clearTimeout });
    }
  });

withTimers('a tap is reported once no second one can make it a double tap', (pass) => {
  const { click, names } = reader();
  click(10, 10, 0);
  pass(249);
  assert.deepEqual(names(), ['start', 'end']);
  pass(1);
  assert.deepEqual(names(), ['start', 'end', 'tap']);
});

withTimers('a double tap is no tap', (pass) => {
  const { click, names } = reader();
  click(10, 10, 0);
  pass(200);
  click(12, 11, 220);
  pass(1000);
  assert.deepEqual(
    names().filter((name) => /tap/i.test(name)),
    ['doubleTap'],
  );
});

withTimers('the second press of a double tap may take its time', (pass) => {
  const { element, click, names } = reader();
  click(10, 10, 0);
  pass(240);
  element.fire('pointerdown', 10, 10, { at: 260 });
  pass(400);
  element.fire('pointerup', 10, 10, { at: 660 });
  assert.deepEqual(
    names().filter((name) => /tap/i.test(name)),
    ['doubleTap'],
  );
});

withTimers('taps apart from each other are two, in their order, and so are a tap and a drag', (pass) => {
  const { element, click, told } = reader();
  click(10, 10, 0);
  click(100, 10, 100);
  pass(1000);
  assert.deepEqual(
    told.filter(([name]) => name === 'tap').map(([, { x }]) => x),
    [10, 100],
  );
  told.length = 0;
  click(10, 10, 2000);
  element.fire('pointerdown', 10, 10, { at: 2100 });
  element.fire('pointermove', 40, 10, { at: 2120, buttons: 1 });
  element.fire('pointerup', 40, 10, { at: 2140 });
  pass(1000);
  assert.deepEqual(
    told.map(([name]) => name),
    ['start', 'end', 'start', 'tap', 'move', 'end'],
  );
});

withTimers('a drag is reported at once', () => {
  const { element, told } = reader();
  element.fire('pointerdown', 10, 10, { at: 0 });
  element.fire('pointermove', 12, 10, { at: 5, buttons: 1 }); // not yet a drag
  element.fire('pointermove', 20, 10, { at: 10, buttons: 1, altKey: true });
  assert.deepEqual(
    told.map(([name]) => name),
    ['start', 'move'],
  );
  assert.deepEqual(told[1][2], { x: 20, y: 10, dx: 10, dy: 0, alt: true, at: 10 });
});

withTimers('a slow click does not wait', () => {
  const { element, names } = reader();
  element.fire('pointerdown', 10, 10, { at: 0 });
  element.fire('pointerup', 10, 10, { at: 400 });
  assert.deepEqual(names(), ['start', 'end', 'tap']);
});

withTimers('a mouse that moves with nothing pressed hovers, a finger never', () => {
  const { element, told } = reader();
  element.fire('pointermove', 5, 6, { at: 1, shiftKey: true });
  element.fire('pointermove', 5, 6, { at: 2, pointerType: 'touch' });
  element.fire('pointerleave', 0, 0);
  assert.deepEqual(told, [['hover', { x: 5, y: 6, shift: true, alt: undefined, at: 1 }], ['leave']]);
});

withTimers('a finger held half a second presses long, and is no tap afterwards', (pass) => {
  const { element, names } = reader();
  const touch = { pointerType: 'touch' };
  element.fire('pointerdown', 5, 6, { at: 0, ...touch });
  pass(500);
  element.fire('pointerup', 5, 6, { at: 900, ...touch });
  pass(1000);
  assert.deepEqual(names(), ['longPress']);
});

// ---- the pointer at rest ------------------------------------------------------------------------------------------------

function resting() {
  const timers = [];
  const asked = [];
  const clock = {
    setTimeout: (callback, ms) => timers.push({ callback, ms }),
    clearTimeout: (timer) => {
      if (timer) timers[timer - 1].callback = () => {};
    },
  };
  const pointed = new Pointed((x, y) => new Promise((resolve, reject) => asked.push({ x, y, resolve, reject })), clock);
  const pass = (time = restMs) => {
    const due = timers.filter(({ ms }) => ms === time).map(({ callback }) => callback);
    for (const timer of timers) if (timer.ms === time) timer.callback = () => {};
    for (const callback of due) callback();
  };
  const settle = () => new Promise((resolve) => setImmediate(resolve));
  return { pointed, asked, pass, settle, timers, facts: () => pointed.shown.value?.facts };
}

test('facts are asked once the pointer rests, and shown where it rests', async () => {
  const { pointed, asked, pass, settle, timers } = resting();
  pointed.hover(1, 1);
  pointed.hover(50, 60);
  assert.equal(timers.at(-1).ms, restMs);
  assert.equal(asked.length, 0);
  pass();
  assert.deepEqual(
    asked.map(({ x, y }) => [x, y]),
    [[50, 60]],
  );
  asked[0].resolve({ name: 'brain' });
  await settle();
  assert.deepEqual(pointed.shown.value, { x: 50, y: 60, isHeld: false, facts: { name: 'brain' } });
  pointed.hover(52, 60);
  assert.ok(pointed.shown.value, 'a hand is never quite still');
  pointed.hover(60, 60);
  assert.equal(pointed.shown.value, null);
});

test('the card goes after 3 s of rest, and no picture of the presenter brings it back until the pointer moves', async () => {
  const { pointed, asked, pass, settle, facts } = resting();
  const answer = async () => {
    asked.at(-1).resolve({ of: asked.length });
    await settle();
  };
  pointed.hover(10, 10);
  pass();
  await answer();
  pointed.picture('the next slice');
  pass();
  await answer();
  assert.deepEqual(facts(), { of: 2 }, 'of the new picture, within the 3 s');
  pass(3000);
  assert.equal(facts(), undefined);
  pointed.picture('the slice after');
  pointed.hover(12, 10);
  pass();
  assert.equal(asked.length, 2, 'a hand is never quite still');
  pointed.hover(20, 10);
  pass();
  await answer();
  assert.deepEqual(facts(), { of: 3 });
});

test('one question at a time, and then the newest place', async () => {
  const { pointed, asked, pass, settle, facts } = resting();
  for (const x of [10, 30, 50]) {
    pointed.hover(x, 0);
    pass();
  }
  assert.deepEqual(
    asked.map(({ x }) => x),
    [10],
  );
  asked[0].resolve({ of: 10 });
  await settle();
  assert.equal(facts(), undefined, 'the pointer has gone on');
  assert.deepEqual(
    asked.map(({ x }) => x),
    [10, 50],
  );
  asked[1].resolve({ of: 50 });
  await settle();
  assert.deepEqual(facts(), { of: 50 });
});

test('an answer that comes after the pointer has left, or was pressed, is not shown', async () => {
  const { pointed, asked, pass, settle, facts } = resting();
  pointed.hover(10, 0);
  pass();
  pointed.hide();
  asked[0].resolve({ of: 10 });
  await settle();
  assert.equal(facts(), undefined);
  pointed.hover(10, 0);
  pass();
  asked[1].reject(new Error('busy'));
  await settle();
  assert.equal(facts(), undefined, 'nobody waits for it: no message');
});

test('another picture takes the facts of an older one away, and they are asked again', async () => {
  const { pointed, asked, pass, settle, facts } = resting();
  pointed.picture('1');
  pointed.hover(10, 0);
  pass();
  pointed.picture('2');
  asked[0].resolve({ of: 'an old slice' });
  await settle();
  assert.equal(facts(), undefined);
  pass();
  asked[1].resolve({ of: 'this slice' });
  await settle();
  assert.deepEqual(facts(), { of: 'this slice' });
  pointed.picture('2');
  assert.deepEqual(facts(), { of: 'this slice' });
});

test('held facts stay while the picture changes, until something is pressed', () => {
  const { pointed, facts } = resting();
  pointed.hold(5, 5, { of: 'a finger' });
  pointed.picture('3');
  assert.deepEqual(facts(), { of: 'a finger' });
  pointed.hide();
  assert.equal(facts(), undefined);
});

// ---- the card -----------------------------------------------------------------------------------------------------------

const size = [170, 80];
const box = ({ x, y }) => ({ x, y, width: size[0], height: size[1] });

test('a card lies beside its point, inside the pane, on no letter', () => {
  const pane = [500, 400];
  const letters = [
    { x: 10, y: 190, width: 12, height: 16 },
    { x: 478, y: 190, width: 12, height: 16 },
    { x: 244, y: 8, width: 12, height: 16 },
    { x: 244, y: 378, width: 12, height: 16 },
  ];
  for (let x = 0; x <= pane[0]; x += 20)
    for (let y = 0; y <= pane[1]; y += 20) {
      const card = box(placeBeside({ x, y }, size, pane, letters, 16));
      assert.ok(card.x >= 0 && card.y >= 0 && card.x + card.width <= pane[0] && card.y + card.height <= pane[1], `inside at ${x} ${y}`);
      for (const letter of letters) assert.equal(overlap(card, letter), 0, `on a letter at ${x} ${y}`);
      assert.equal(overlap(card, { x: x - 2, y: y - 2, width: 4, height: 4 }), 0, `on its point at ${x} ${y}`);
    }
});

test('where nothing is free a card covers as little as it can', () => {
  const { x, y } = placeBeside({ x: 50, y: 40 }, size, [180, 90], [{ x: 0, y: 0, width: 180, height: 90 }], 16);
  assert.ok(x >= 0 && y >= 0);
});

test('a card is no wider than its pane, where the position takes two lines', () => {
  const words = {
    name: 'tumor',
    value: { label: 'MR', text: '138', unit: '' },
    lines: ['in brain, scalp', 'L \u2212124.9  P 138.4  S \u221264.9 mm'],
  };
  const wide = cardOf(words, 500, false);
  assert.deepEqual(wide.lines, words.lines);
  const narrow = cardOf(words, 150, false);
  assert.ok(narrow.width <= 150 - 12, `${narrow.width} px, with 6 px at each side`);
  assert.deepEqual(narrow.lines, ['in brain, scalp', 'L \u2212124.9  P 138.4', 'S \u221264.9 mm']);
  assert.equal(narrow.height - wide.height, 16, 'one line of 16 px more');
  assert.ok(cardOf(words, 150, true).height > narrow.height, 'the value is larger for a finger');
});

test('a drag takes a place as soon as the mouse has it, and no place twice', () => {
  const { element, told } = reader();
  element.fire('pointerdown', 10, 10, { at: 0 });
  element.fire('pointerrawupdate', 30, 10, { at: 2 });
  assert.deepEqual(
    told.filter(([name]) => name === 'move'),
    [],
    'a press is a drag once the pointer has moved',
  );
  element.fire('pointermove', 30, 10, { at: 8 });
  element.fire('pointerrawupdate', 35, 10, { at: 12 }); // 4 ms later: it waits for the next frame
  element.fire('pointerrawupdate', 40, 10, { at: 23 });
  element.fire('pointermove', 40, 10, { at: 23 });
  element.fire('pointermove', 41, 10, { at: 30 });
  element.fire('pointerup', 41, 10, { at: 31 });
  element.fire('pointerrawupdate', 90, 10, { at: 80 });
  const moves = told.filter(([name]) => name === 'move').map(([, mode, { x, dx, at }]) => [mode, x, dx, at]);
  assert.deepEqual(moves, [
    ['primary', 30, 20, 8],
    ['primary', 40, 10, 23],
    ['primary', 41, 1, 30],
  ]);
});

test('two fingers pinch by the places of the animation frames alone', () => {
  const { element, names } = reader();
  for (const pointerId of [1, 2]) element.fire('pointerdown', 100 * pointerId, 10, { pointerId, pointerType: 'touch' });
  element.fire('pointerrawupdate', 300, 10, { pointerId: 2, pointerType: 'touch', at: 40 });
  assert.deepEqual(names(), []);
  element.fire('pointermove', 300, 10, { pointerId: 2, pointerType: 'touch', at: 40 });
  assert.deepEqual(names(), ['pinch']);
});
