// When panels are drawn while something is dragged, and when changes are sent; with frames and a clock that are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { effect, signal } = await load('../lib/signals-core.js');
const { Redraw } = await load('parts/redraw.js');
const { soon } = await load('net/soon.js');

class FakePart {
  marks = new Set();
  constructor(pane = null, children = []) {
    this.pane = pane;
    this.children = children;
  }
  closest() {
    return this.pane;
  }
  contains(element) {
    return this.children.includes(element);
  }
  toggleAttribute(name, isOn) {
    this.marks[isOn ? 'add' : 'delete'](name);
  }
}

class FakePane extends FakePart {
  constructor({ hidden = false, pressed = null } = {}) {
    super(null, pressed ? [pressed] : []);
    this.pane = this;
    this.hidden = hidden;
  }
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
  const pressed = {}; // an element
  /** Draws like mount(), and notes the order. */
  const part = (host, costMs = 0) => {
    const [drawn, tick] = [[], signal(0)];
    let [isDrawn, isWaiting] = [false, false];
    effect(() => {
      isWaiting = isDrawn && !isWaiting && redraw.puts(host, tick);
      if (isWaiting) return void tick.value;
      isDrawn = true;
      drawn.push(value.value);
      if (costMs) clock.pass(costMs);
    });
    return drawn;
  };
  const frame = () => frames.splice(0).forEach((callback) => callback());
  const drag = () => {
    fire('pointerdown', {}, pressed);
    fire('pointermove');
  };
  return { clock, frames, redraw, fire, value, part, frame, drag, pressed, stop };
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

test('the pane in which something is dragged is drawn once for each frame, after the pictures of that frame', () => {
  const { redraw, value, part, frame, drag, pressed } = world();
  const drawn = part(new FakePane({ pressed }));
  drag();
  value.value = 1;
  value.value = 2;
  assert.deepEqual(drawn, [0]);
  redraw.schedule(() => {
    value.value = 3;
  }); // a picture that is painted
  frame();
  assert.deepEqual(drawn, [0, 3]);
  redraw.schedule(() => {
    value.value = 4;
  }); // notified in the frame for the first time
  frame();
  assert.deepEqual(drawn, [0, 3, 4]);
});

test('another pane is drawn with its picture, also when that brings the change, or within 40 ms', () => {
  const { clock, redraw, frames, value, part, frame, drag } = world();
  const pane = new FakePane();
  const drawn = part(pane);
  const paint = (of, more = () => {}) =>
    redraw.schedule(() => {
      redraw.painted(of);
      more();
    });
  drag();
  value.value = 1;
  assert.equal(frames.length, 0, 'no frame for it alone');
  paint(new FakePane());
  frame();
  assert.deepEqual(drawn, [0], 'the picture of another one');
  paint(pane);
  frame();
  assert.deepEqual(drawn, [0, 1]);
  paint(pane, () => {
    value.value = 2;
  });
  frame();
  assert.deepEqual(drawn, [0, 1, 2]);
  value.value = 3;
  clock.pass(39);
  frame();
  assert.deepEqual(drawn, [0, 1, 2]);
  clock.pass(1);
  frame();
  assert.deepEqual(drawn, [0, 1, 2, 3]);
});

test('while pictures follow one another where something is dragged, those of other panes share a frame 25 ms later, and its own do not wait', () => {
  const { clock, frames, redraw, frame, drag, pressed } = world();
  const [here, one, other] = [new FakePane({ pressed }), new FakePane(), new FakePane()];
  const painted = [];
  const paint = (pane, name) =>
    redraw.schedulePicture(pane, () => {
      redraw.painted(pane);
      painted.push(name);
    });
  drag();
  paint(one, 'one'); // nothing came for this pane yet: the other's is all there is to see
  frame();
  assert.deepEqual(painted.splice(0), ['one']);
  paint(here, 'here');
  paint(one, 'one');
  frame();
  assert.deepEqual(painted.splice(0), ['here']);
  clock.pass(12);
  paint(other, 'other');
  assert.equal(frames.length, 0);
  clock.pass(13);
  frame();
  assert.deepEqual(painted.splice(0), ['one', 'other']);
  paint(one, 'one');
  clock.pass(24);
  paint(here, 'here');
  frame();
  assert.deepEqual(painted.splice(0), ['here'], 'the other one has a millisecond yet');
  clock.pass(1);
  frame();
  assert.deepEqual(painted.splice(0), ['one']);
  clock.pass(99);
  paint(one, 'one');
  frame();
  assert.deepEqual(painted, ['one'], '100 ms without a picture');
});

test('a picture that waits to share a frame is painted when the drag ends, and none waits at rest', () => {
  const { frames, redraw, fire, frame, drag, pressed } = world();
  const [here, other] = [new FakePane({ pressed }), new FakePane()];
  const painted = [];
  drag();
  redraw.schedulePicture(here, () => painted.push('here'));
  frame();
  redraw.schedulePicture(other, () => painted.push('waiting'));
  assert.equal(frames.length, 0);
  fire('pointerup');
  frame();
  assert.deepEqual(painted.splice(0), ['here', 'waiting']);
  redraw.schedulePicture(other, () => painted.push('at rest'));
  frame();
  assert.deepEqual(painted, ['at rest']);
});

test('what an input changes where something is dragged shares the frame of pictures that wait, and else has the next one', () => {
  const { clock, frames, redraw, value, part, frame, drag, pressed } = world();
  const [pane, other] = [new FakePane({ pressed }), new FakePane()];
  const drawn = part(pane);
  const picture = (of) => redraw.schedulePicture(of, () => redraw.painted(of));
  drag();
  picture(pane);
  frame();
  value.value = 1;
  frame();
  assert.deepEqual(drawn, [0, 1], 'no picture waits');
  picture(other);
  clock.pass(10);
  value.value = 2;
  assert.equal(frames.length, 0);
  clock.pass(15);
  frame();
  assert.deepEqual(drawn, [0, 1, 2]);
  picture(other);
  value.value = 3;
  picture(pane);
  frame();
  assert.deepEqual(drawn, [0, 1, 2, 3], 'with its own picture before');
});

test('what is around the panes is drawn ten times a second, marked, and at once when the drag ends; a hidden pane only then', () => {
  const { clock, fire, value, part, frame, drag } = world();
  const host = new FakePart();
  const [around, hidden] = [part(host), part(new FakePane({ hidden: true }))];
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

test('what is around the panes is drawn sooner in a frame without pictures, so that pictures need not wait for it', () => {
  const { clock, redraw, value, part, frame, drag, pressed } = world();
  part(new FakePane({ pressed })); // has a frame for each change
  const [one, other] = [part(new FakePart()), part(new FakePart())];
  drag();
  value.value = 1;
  frame();
  assert.deepEqual(
    [one, other],
    [
      [0, 1],
      [0, 1],
    ],
  );
  clock.pass(70);
  value.value = 2;
  redraw.schedule(() => {});
  frame();
  assert.deepEqual(
    [one, other],
    [
      [0, 1],
      [0, 1],
    ],
    'with a picture, and not due yet',
  );
  value.value = 3;
  frame();
  assert.deepEqual(
    [one, other],
    [
      [0, 1, 3],
      [0, 1, 3],
    ],
  );
});

test('a frame is not filled with panels around the panes', () => {
  const { clock, value, part, frame, drag } = world();
  const all = [new FakePart(), new FakePart(), new FakePart()].map((host) => part(host, 1.5));
  const last = () => all.map((drawn) => drawn.at(-1));
  drag();
  value.value = 1;
  clock.pass(0);
  frame();
  assert.deepEqual(last(), [1, 1, 0]);
  clock.pass(0);
  frame();
  assert.deepEqual(last(), [1, 1, 1]);
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
    const drawn = part(new FakePane());
    drag();
    value.value = 1;
    assert.deepEqual(drawn, [0]);
    fire(...end);
    assert.deepEqual(drawn, [0, 1], end[0]);
  }
});

test('a focus that moves within the page, as it does at a press, ends no drag', () => {
  const { fire, value, part } = world();
  const drawn = part(new FakePane());
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
  const settle = () =>
    new Promise((resolve) => {
      setImmediate(resolve);
    });
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
