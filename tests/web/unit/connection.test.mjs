// The connection: when it is tried again and when it ends. Sockets and clock are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './page.mjs';

const { Connection } = await load('net/connection.js');

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
