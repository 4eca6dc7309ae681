// Own changes and other people's: what the page shows, with a connection and a clock that are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './page.mjs';

const { Replica } = await load('state/replica.js');
const { RoomState } = await load('state/room.js');
const { fidelity, worst } = await load('state/fidelity.js');
const { Connection } = await load('net/connection.js');
const { isLowWhite, soloPatch } = await load('state/plan.js');

test('an own change shows at once; the server\'s order wins', () => {
  const replica = new Replica({ opacity: 1, color: 'red' });
  replica.queue({ opacity: 0.5 });
  assert.equal(replica.value.opacity, 0.5);
  assert.deepEqual(replica.take(1), { opacity: 0.5 });
  replica.accept({ opacity: 0.2, color: 'blue' }); // somebody else, before ours on the server
  assert.deepEqual(replica.value, { opacity: 0.5, color: 'blue' }, 'ours comes after it');
  replica.accept({ opacity: 0.5 }, 1);
  replica.accept({ opacity: 0.7 }); // somebody else, after ours
  assert.deepEqual(replica.value, { opacity: 0.7, color: 'blue' });
  assert.equal(replica.isPending, false);
});

test('a refused change goes back to the old value and leaves others alone', () => {
  const replica = new Replica({ a: 1, b: 1 });
  replica.queue({ a: 2 });
  replica.take(1);
  replica.queue({ b: 2 });
  replica.take(2);
  replica.refuse(1);
  assert.deepEqual(replica.value, { a: 1, b: 2 });
});

test('changes of one animation frame go as one patch', () => {
  const replica = new Replica({});
  replica.queue({ camera: { fov_deg: 20 } });
  replica.queue({ camera: { up: [0, 0, 1] } });
  assert.deepEqual(replica.take(1), { camera: { fov_deg: 20, up: [0, 0, 1] } });
  assert.equal(replica.take(2), null);
});

test('a picture that shows an input settles it', () => {
  const replica = new Replica({ x: 0 });
  replica.queue({ x: 1 });
  replica.take(5);
  replica.settle(4);
  assert.equal(replica.isPending, true);
  replica.settle(5);
  assert.deepEqual([replica.isPending, replica.value], [false, { x: 1 }]);
});

// ---- a room over a fake connection -------------------------------------------------------------------------------------

class FakeConnection extends EventTarget {
  sent = [];

  send(message) {
    this.sent.push(message);
    return true;
  }

  receive(message) {
    const event = new Event('message');
    event.detail = message;
    this.dispatchEvent(event);
  }
}

const scene = {
  regions: { brain: { visible: true, opacity: 1, color: '#ffffff' } },
  image: { id: '', window: { center: 40, width: 400 }, slices: { axial: { position_mm: 0 }, coronal: { position_mm: 0 }, sagittal: { position_mm: 0 } } },
};

function roomWorld() {
  const connection = new FakeConnection();
  const frames = [];
  const told = [];
  let now = 1000;
  const room = new RoomState('r', { connection, clock: { now: () => now }, schedule: (callback) => frames.push(callback), notify: (...words) => told.push(words) });
  connection.receive({ type: 'welcome', room: 'r', member: 'm1', secret: 's', name: 'Reviewer 1', plan_id: 'p', plan: { id: 'p' }, revision: 1, scene, gl: '' });
  const flush = () => frames.splice(0).forEach((callback) => callback());
  return { room, connection, flush, told, advance: (ms) => { now += ms; } };
}

test('many changes before a paint become one message with a growing input', () => {
  const { room, connection, flush } = roomWorld();
  room.showView(1, [800, 600]);
  connection.sent.length = 0;
  for (const opacity of [0.9, 0.8, 0.7]) room.patchScene({ regions: { brain: { opacity } } }, { view: 1 });
  room.patchView(1, { camera: { fov_deg: 20 } });
  flush();
  assert.deepEqual(connection.sent.map(({ type, patch }) => [type, patch]), [
    ['view.patch', { camera: { fov_deg: 20 } }],
    ['scene.patch', { regions: { brain: { opacity: 0.7 } } }],
  ]);
  assert.ok(connection.sent[1].input > connection.sent[0].input);
  flush();
  assert.equal(connection.sent.length, 2);
});

test('a refusal brings the old value back and says why', () => {
  const { room, connection, flush, told } = roomWorld();
  room.patchScene({ regions: { brain: { opacity: 7 } } });
  flush();
  const { input } = connection.sent.at(-1);
  connection.receive({ type: 'problem', to: 'scene.patch', view: 0, input, problem: { detail: 'opacity is 7, expected 0 to 1' } });
  assert.equal(room.scene.value.regions.brain.opacity, 1);
  assert.deepEqual(told, [['err', 'opacity is 7, expected 0 to 1']]);
});

test('after a lost connection every open picture is asked for again', () => {
  const { room, connection } = roomWorld();
  room.showView(1, [800, 600]);
  room.showView(3, [400, 300]);
  const lost = new Event('lost');
  lost.detail = { retryMs: 500 };
  connection.dispatchEvent(lost);
  assert.equal(room.canChange.value, false);
  connection.sent.length = 0;
  connection.receive({ type: 'welcome', room: 'r', member: 'm1', secret: 's', name: 'n', plan_id: 'p', plan: { id: 'p' }, revision: 9, scene, gl: '' });
  assert.deepEqual(connection.sent.map(({ type, view }) => [type, view]), [['view.open', 1], ['view.open', 3]]);
  assert.equal(room.revision.value, 9);
});

test('a size that comes before the connection, or without one, is the one asked for', () => {
  const connection = new FakeConnection();
  const room = new RoomState('r', { connection, clock: { now: () => 0 }, schedule: () => {}, notify: () => {} });
  const welcome = { type: 'welcome', room: 'r', member: 'm1', secret: 's', name: 'n', plan_id: 'p', plan: { id: 'p' }, revision: 1, scene, gl: '' };
  const opened = () => connection.sent.filter(({ type }) => type === 'view.open').map(({ document }) => document.size_px);
  room.showView(1, [456, 218]); // before the page has its final layout
  room.showView(1, [456, 270]);
  connection.sent.length = 0;
  connection.receive(welcome);
  assert.deepEqual(opened(), [[456, 270]]);
  const lost = new Event('lost');
  lost.detail = { retryMs: 500 };
  connection.dispatchEvent(lost);
  room.showView(1, [800, 600]);
  connection.sent.length = 0;
  connection.receive(welcome);
  assert.deepEqual(opened(), [[800, 600]]);
});

test('a member who has left is here no more', () => {
  const { room, connection } = roomWorld();
  connection.receive({ type: 'members', members: [{ id: 'm1', name: 'A', connected: true }, { id: 'm2', name: 'B', connected: false }] });
  assert.deepEqual(['m1', 'm2', 'm3', ''].map((id) => room.isHere(id)), [true, false, false, false]);
});

test('the time an input waits ends with the picture that shows it', () => {
  const { room, connection, flush } = roomWorld();
  room.showView(1, [800, 600]);
  room.patchView(1, { camera: { fov_deg: 20 } }, { at: 990 });
  flush();
  const { input } = connection.sent.at(-1);
  const frame = (input_id) => ({ view: 1, sequence: 1, input_id, scene_revision: 1 });
  assert.equal(room.frameShown(frame(input - 1)).filter((entry) => entry.input === input).length, 0);
  assert.deepEqual(room.frameShown(frame(input)).map(({ at }) => at), [990]);
  assert.equal(connection.sent.at(-1).type, 'frame.shown');
});

// ---- badges ---------------------------------------------------------------------------------------------------------------

const facts = {
  link: { state: 'open', retryAt: 0 }, renderer: 'ready', staleSince: 0, revision: 3, revisionAt: 0, fps: 27, now: 10000,
  header: { is_still: false, is_lossless: false, is_coarse: false, scale_percent: 100, quality: 80, scene_revision: 3 },
};
const still = { ...facts.header, is_still: true };
for (const [what, change, state] of [
  ['nothing before the first picture', { header: null }, undefined],
  ['moving at full size', {}, 'live'],
  ['half size', { header: { ...facts.header, scale_percent: 50 } }, 'reduced'],
  ['coarse surfaces', { header: { ...facts.header, is_coarse: true } }, 'reduced'],
  ['a still', { header: still }, 'full'],
  ['an input unanswered for 0.9 s', { header: still, staleSince: 9100 }, 'full'],
  ['an input unanswered for 1.1 s', { header: still, staleSince: 8900 }, 'stale'],
  ['an older scene for 1.1 s', { header: { ...still, scene_revision: 2 }, revisionAt: 8900 }, 'stale'],
  ['a view that cannot be drawn as it is', { header: still, refusal: 'the camera looks at itself' }, 'stale'],
  ['a restarting renderer', { header: still, renderer: 'restarting' }, 'stale'],
  ['a lost connection', { header: still, link: { state: 'lost', retryAt: 12000 } }, 'disconnected'],
])
  test(`badge of ${what}`, () => assert.equal(fidelity({ ...facts, ...change })?.state, state));

test('the badge of all panes is the worst of them', () => {
  assert.equal(worst([{ state: 'full' }, null, { state: 'stale' }, { state: 'live' }]).state, 'stale');
});

// ---- connection -------------------------------------------------------------------------------------------------------------

test('a lost connection is tried again after 0.5, 1, 2, 4 and 4 s, as the same member', () => {
  const sockets = [];
  const timers = [];
  const clock = { now: () => 0, setTimeout: (callback, ms) => timers.push({ callback, ms }), clearTimeout() {} };
  class Socket extends EventTarget {
    sent = [];
    send(text) { this.sent.push(JSON.parse(text)); }
    close() {}
    tell(message) {
      const event = new Event('message');
      event.data = JSON.stringify(message);
      this.dispatchEvent(event);
    }
  }
  const connection = new Connection('ws://x', { clock, makeSocket: () => { const socket = new Socket(); sockets.push(socket); return socket; } });
  connection.open();
  sockets[0].dispatchEvent(new Event('open'));
  sockets[0].tell({ type: 'welcome', protocol: 1, room: 'r', member: 'm-1', secret: 'abc', name: 'R', plan_id: 'p', revision: 0 });
  const waits = [];
  for (let turn = 0; turn < 5; turn++) {
    timers.length = 0;
    sockets.at(-1).dispatchEvent(new Event('close'));
    waits.push(timers[0].ms);
    timers[0].callback();
  }
  assert.deepEqual(waits, [500, 1000, 2000, 4000, 4000]);
  sockets.at(-1).dispatchEvent(new Event('open'));
  const [hello] = sockets.at(-1).sent;
  assert.deepEqual([hello.type, hello.member, hello.secret], ['hello', 'm-1', 'abc']);
});

/** A connection with fakes: what it waits for, and the sockets it made. */
function fakeConnection(more = {}) {
  const sockets = [];
  const waits = [];
  let timer = () => {};
  class Socket extends EventTarget {
    sent = [];
    send(text) { this.sent.push(JSON.parse(text)); }
    close() { this.isClosed = true; }
    tell(message) { this.dispatchEvent(Object.assign(new Event('message'), { data: JSON.stringify(message) })); }
    open() { this.dispatchEvent(new Event('open')); }
    welcome() { this.tell({ type: 'welcome', protocol: 1, room: 'r', member: 'm-1', secret: 'abc', name: 'R', plan_id: 'p', revision: 0 }); }
    lose() { waits.length = 0; this.dispatchEvent(new Event('close')); }
  }
  const clock = { now: () => 0, setTimeout: (callback, ms) => { waits.push(ms); timer = callback; }, clearTimeout() {} };
  const connection = new Connection('ws://x', { clock, makeSocket: () => { const socket = new Socket(); sockets.push(socket); return socket; }, ...more });
  const told = [];
  for (const type of ['up', 'lost', 'ended']) connection.addEventListener(type, ({ detail }) => told.push({ type, ...detail }));
  connection.open();
  return { connection, told, waits, last: () => sockets.at(-1), n: () => sockets.length, wait: () => timer() };
}

for (const [retryMs, expected] of [[0, 500], [300, 500], [500, 500], [2000, 2000], [2500, 2500], [5000, 5000], [30000, 30000], [600000, 600000]])
  test(`a bye that asks to wait ${retryMs} ms is heeded: ${expected} ms`, () => {
    const fake = fakeConnection();
    fake.last().open();
    fake.last().welcome();
    fake.last().tell({ type: 'bye', reason: 'enough', retry_ms: retryMs });
    fake.last().lose();
    assert.deepEqual(fake.waits, [expected]);
    assert.deepEqual(fake.told.at(-1), { type: 'lost', retryMs: expected });
    fake.wait();
    fake.last().lose(); // the next attempt fails without a word: the pages' own waits go on
    assert.deepEqual(fake.waits, [1000]);
  });

test('"Try now" does not wait for what a bye asked for', () => {
  const fake = fakeConnection();
  fake.last().open();
  fake.last().tell({ type: 'bye', reason: 'enough', retry_ms: 30000 });
  fake.last().lose();
  fake.connection.retryNow();
  assert.equal(fake.n(), 2);
  fake.last().lose();
  assert.deepEqual(fake.waits, [500]);
});

test('a page that could not get back asks whether the room is there, and ends where it is gone', async () => {
  let asked = 0, isGone = false;
  const fake = fakeConnection({ isGone: async () => { asked += 1; return isGone; } });
  fake.last().open();
  fake.last().welcome();
  fake.last().lose(); // it was open: nobody asks
  await Promise.resolve();
  assert.equal(asked, 0);
  fake.wait();
  fake.last().lose(); // refused
  await new Promise(setImmediate);
  assert.equal(asked, 1);
  assert.equal(fake.told.at(-1).type, 'lost');
  isGone = true;
  fake.wait();
  fake.last().lose();
  await new Promise(setImmediate);
  assert.equal(asked, 2);
  assert.equal(fake.told.at(-1).type, 'ended');
  assert.match(fake.told.at(-1).reason, /no longer/);
  const n = fake.n();
  fake.connection.open();
  assert.equal(fake.n(), n, 'it stays ended');
});

test('solo shows one region only, and all again the second time', () => {
  const regions = [{ id: 'a' }, { id: 'b' }];
  const both = { regions: { a: { visible: true }, b: { visible: true } } };
  assert.deepEqual(soloPatch(regions, both, 'b').regions, { a: { visible: false }, b: { visible: true } });
  const alone = { regions: { a: { visible: false }, b: { visible: true } } };
  assert.deepEqual(soloPatch(regions, alone, 'b').regions, { a: { visible: true }, b: { visible: true } });
});

test('low values are white where the scene says so, else where the image does', () => {
  for (const isInverted of [false, true])
    for (const [low_values, expected] of [['own', isInverted], ['black', false], ['white', true]])
      assert.equal(isLowWhite({ isInverted }, { image: { low_values } }), expected);
});
