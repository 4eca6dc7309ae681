// When panels are drawn while something is dragged, and when changes are sent; with frames and a clock that are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './page.mjs';

const { effect, signal } = await load('../lib/signals-core.js');
const { Redraw } = await load('panels/redraw.js');
const { soon } = await load('net/soon.js');

class FakePart {
  marks = new Set();
  constructor(pane = null, children = []) {
    this.pane = pane;
    this.children = children;
  }
  closest() { return this.pane; }
  contains(element) { return this.children.includes(element); }
  toggleAttribute(name, isOn) { this.marks[isOn ? 'add' : 'delete'](name); }
}

function fakeClock() {
  let now = 1000;
  const timers = [];
  return {
    now: () => now,
    setTimeout: (callback, ms) => timers.push({ callback, at: now + ms }),
    clearTimeout: (timer) => timers.splice(timer - 1, 1, null),
    pass(ms) {
      now += ms;
      for (const [index, timer] of [...timers.entries()]) {
        if (!timer || timer.at > now) continue;
        timers[index] = null;
        timer.callback();
      }
    },
  };
}

function world() {
  const clock = fakeClock();
  const frames = [];
  const redraw = new Redraw((callback) => frames.push(callback), clock);
  const target = new EventTarget();
  const stop = redraw.watch(target);
  const fire = (type, more = {}, of = null) => {
    const event = Object.assign(new Event(type), { buttons: 1, ...more });
    if (of) Object.defineProperty(event, 'target', { value: of }); // an element in the window
    target.dispatchEvent(event);
  };
  const value = signal(0);
  /** As mount() does: what was drawn, in order. */
  const part = (host) => {
    const [drawn, tick] = [[], signal(0)];
    let [isDrawn, isWaiting] = [false, false];
    effect(() => {
      isWaiting = isDrawn && !isWaiting && redraw.puts(host, tick);
      if (isWaiting) return void tick.value;
      isDrawn = true;
      drawn.push(value.value);
    });
    return drawn;
  };
  const frame = () => frames.splice(0).forEach((callback) => callback());
  const drag = () => {
    fire('pointerdown');
    fire('pointermove');
  };
  return { clock, frames, redraw, fire, value, part, frame, drag, stop };
}

test('at rest, and while a mouse only moves, everything is drawn at once', () => {
  const { fire, value, part, frames } = world();
  const drawn = part(new FakePart());
  fire('pointermove', { buttons: 0 });
  value.value = 1;
  fire('pointerdown');
  value.value = 2;
  assert.deepEqual(drawn, [0, 1, 2]);
  assert.equal(frames.length, 0);
});

test('while something is dragged a pane is drawn once for each frame, after the pictures of that frame', () => {
  const { redraw, value, part, frame, drag } = world();
  const drawn = part(new FakePart({ hidden: false }));
  drag();
  value.value = 1;
  value.value = 2;
  assert.deepEqual(drawn, [0]);
  redraw.schedule(() => { value.value = 3; }); // a picture that is painted
  frame();
  assert.deepEqual(drawn, [0, 3]);
  redraw.schedule(() => { value.value = 4; }); // notified in the frame for the first time
  frame();
  assert.deepEqual(drawn, [0, 3, 4]);
});

test('what is around the panes is drawn ten times a second, marked, and at once when the drag ends; a hidden pane only then', () => {
  const { clock, fire, value, part, frame, drag } = world();
  const host = new FakePart();
  const [around, hidden] = [part(host), part(new FakePart({ hidden: true }))];
  drag();
  for (let n = 1; n <= 50; n++) {
    value.value = n;
    clock.pass(10);
    frame();
  }
  assert.ok(around.length >= 5 && around.length <= 7, `${around}`);
  assert.deepEqual([...host.marks], ['data-pending']);
  assert.deepEqual(hidden, [0]);
  value.value = 77;
  fire('pointerup');
  assert.deepEqual([around.at(-1), hidden.at(-1)], [77, 77]);
  assert.deepEqual([...host.marks], []);
  value.value = 78;
  assert.deepEqual([around.at(-1), hidden.at(-1)], [78, 78]);
});

test('the last change is drawn though no other follows and the button stays pressed', () => {
  const { clock, value, part, frame, drag } = world();
  const drawn = part(new FakePart());
  drag();
  value.value = 1;
  clock.pass(0);
  frame();
  value.value = 2;
  clock.pass(100);
  frame();
  assert.deepEqual(drawn, [0, 1, 2]);
});

test('the panel in which something is dragged is drawn in every frame', () => {
  const { fire, value, part, frame } = world();
  const host = new FakePart();
  host.contains = () => true;
  const drawn = part(host);
  fire('pointerdown');
  fire('pointermove');
  for (const n of [1, 2, 3]) {
    value.value = n;
    frame();
  }
  assert.deepEqual(drawn, [0, 1, 2, 3]);
  assert.deepEqual([...host.marks], []);
});

test('a drag whose end was not seen ends with the next move, or with the window out of sight', () => {
  for (const end of [['pointermove', { buttons: 0 }], ['blur'], ['pointercancel']]) {
    const { fire, value, part, drag } = world();
    const drawn = part(new FakePart({ hidden: false }));
    drag();
    value.value = 1;
    assert.deepEqual(drawn, [0]);
    fire(...end);
    assert.deepEqual(drawn, [0, 1], end[0]);
  }
});

test('a focus that moves within the page, as it does at a press, ends no drag', () => {
  const { fire, value, part } = world();
  const drawn = part(new FakePart({ hidden: false }));
  const loseFocus = () => fire('blur', {}, new FakePart());
  fire('pointerdown');
  loseFocus();
  fire('pointermove');
  value.value = 1;
  loseFocus();
  assert.deepEqual(drawn, [0]);
});

test('changes go at once, those within 14 ms together after them', async () => {
  const clock = fakeClock();
  const send = soon(clock);
  const sent = [];
  const settle = () => new Promise((resolve) => { setImmediate(resolve); });
  send(() => sent.push('first'));
  assert.deepEqual(sent, [], 'not before the handler is through');
  await settle();
  assert.deepEqual(sent, ['first']);
  clock.pass(4);
  send(() => sent.push('second'));
  await settle();
  clock.pass(9);
  assert.deepEqual(sent, ['first']);
  clock.pass(1);
  assert.deepEqual(sent, ['first', 'second']);
  clock.pass(14);
  send(() => sent.push('third'));
  await settle();
  assert.deepEqual(sent, ['first', 'second', 'third']);
});
