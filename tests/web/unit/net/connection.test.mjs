// The connection: when it is tried again, when it ends, and when silence counts as a loss. Sockets and clock are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { Connection } = await load('net/connection.js');

test('a lost connection is tried again after 0.5, 1, 2, 4 and 4 s, as the same member', () => {
  const sockets = [];
  const timers = [];
  const clock = { now: () => 0, setTimeout: (callback, ms) => timers.push({ callback, ms }), clearTimeout() {} };
  class Socket extends EventTarget {
    sent = [];
    send(text) {
      this.sent.push(JSON.parse(text));
    }
    close() {}
    tell(message) {
      const event = new Event('message');
      event.data = JSON.stringify(message);
      this.dispatchEvent(event);
    }
  }
  const connection = new Connection('ws://x', {
    clock,
    makeSocket: () => {
      const socket = new Socket();
      sockets.push(socket);
      return socket;
    },
  });
  connection.open();
  sockets[0].dispatchEvent(new Event('open'));
  sockets[0].tell({
    type: 'welcome',
    protocol: 2,
    room: 'r',
    member: 'm-1',
    secret: 'abc',
    name: 'R',
    plan_id: 'p',
    revision: 0,
    items: [],
  });
  const waits = [];
  for (let turn = 0; turn < 5; turn++) {
    timers.length = 0;
    sockets.at(-1).dispatchEvent(new Event('close'));
    waits.push(timers[0].ms);
    timers[0].callback();
  }
  assert.deepEqual(waits, [500, 1000, 1500, 1500, 1500]);
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
    send(text) {
      this.sent.push(JSON.parse(text));
    }
    close() {
      this.isClosed = true;
    }
    tell(message) {
      this.dispatchEvent(Object.assign(new Event('message'), { data: JSON.stringify(message) }));
    }
    open() {
      this.dispatchEvent(new Event('open'));
    }
    welcome() {
      this.tell({ type: 'welcome', protocol: 2, room: 'r', member: 'm-1', secret: 'abc', name: 'R', plan_id: 'p', revision: 0, items: [] });
    }
    lose() {
      waits.length = 0;
      this.dispatchEvent(new Event('close'));
    }
  }
  const clock = {
    now: () => 0,
    setTimeout: (callback, ms) => {
      waits.push(ms);
      timer = callback;
    },
    clearTimeout() {},
  };
  const connection = new Connection('ws://x', {
    clock,
    makeSocket: () => {
      const socket = new Socket();
      sockets.push(socket);
      return socket;
    },
    ...more,
  });
  const told = [];
  for (const type of ['up', 'lost', 'renewing', 'ended', 'paused'])
    connection.addEventListener(type, ({ detail }) => told.push({ type, ...detail }));
  connection.open();
  return { connection, told, waits, sockets, last: () => sockets.at(-1), n: () => sockets.length, wait: () => timer() };
}

for (const [retryMs, expected] of [
  [0, 500],
  [300, 500],
  [500, 500],
  [2000, 2000],
  [2500, 2500],
  [5000, 5000],
  [30000, 30000],
  [600000, 600000],
])
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
  fake.connection.retryNow(); // that attempt hangs: another one takes its place
  assert.equal(fake.n(), 3);
  fake.last().lose();
  assert.deepEqual(fake.waits, [500]);
});

test('a page that could not get back asks whether the room is there, and ends where it is gone', async () => {
  let asked = 0,
    isGone = false;
  const fake = fakeConnection({
    isGone: async () => {
      asked += 1;
      return isGone;
    },
  });
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

// ---- silence ----------------------------------------------------------------------------------------------------------------

/** A connection with a clock that runs, and a server that answers pings until it is silent. */
function runningConnection() {
  const sockets = [];
  const told = [];
  let timers = [];
  let now = 10000;
  let isSilent = false;
  class Socket extends EventTarget {
    send(text) {
      const message = JSON.parse(text);
      if (isSilent) return;
      if (message.type === 'hello')
        this.tell({
          type: 'welcome',
          protocol: 2,
          room: 'r',
          member: 'm-1',
          secret: 'abc',
          name: 'R',
          plan_id: 'p',
          revision: 0,
          items: [],
        });
      if (message.type === 'ping') this.tell({ type: 'pong', time_ms: message.time_ms });
    }
    close() {
      this.isClosed = true;
    } // and never says so, as without a network
    tell(message) {
      this.dispatchEvent(Object.assign(new Event('message'), { data: JSON.stringify(message) }));
    }
  }
  const clock = {
    now: () => now,
    setTimeout: (callback, ms) => {
      timers.push({ callback, at: now + ms });
      return timers.at(-1);
    },
    clearTimeout: (timer) => {
      timers = timers.filter((other) => other !== timer);
    },
  };
  const advance = (ms) => {
    const end = now + ms;
    for (;;) {
      timers.sort((a, b) => a.at - b.at);
      if (!timers.length || timers[0].at > end) break;
      const next = timers.shift();
      now = Math.max(now, next.at);
      next.callback();
    }
    now = end;
  };
  const connection = new Connection('ws://x', {
    clock,
    makeSocket: () => {
      sockets.push(new Socket());
      return sockets.at(-1);
    },
  });
  for (const type of ['quiet', 'heard', 'lost', 'up']) connection.addEventListener(type, ({ detail }) => told.push([type, now, detail]));
  connection.open();
  sockets[0].dispatchEvent(new Event('open'));
  told.length = 0;
  return {
    connection,
    sockets,
    told,
    advance,
    sleep: (ms) => {
      now += ms;
    },
    silence: (value) => {
      isSilent = value;
    },
  };
}

test('a server that answers is never quiet', () => {
  const { told, advance } = runningConnection();
  advance(60000);
  assert.deepEqual(told, []);
});

test('2 s without an answer that is due: quiet; 5 s: lost, and tried again on a new socket without waiting for the old one to close', () => {
  const { connection, sockets, told, advance, silence } = runningConnection();
  advance(10000); // a ping each second, the last at 20000
  silence(true);
  connection.send({ type: 'view.patch', view: 1, patch: {}, input: 1 });
  advance(1000); // a ping went unanswered at 20000 + 500 or + 1000
  assert.deepEqual(told, []);
  advance(2500);
  assert.deepEqual(
    told.map(([type]) => type),
    ['quiet'],
  );
  assert.equal(told[0][2].since, 20000, 'its age counts from the last answer');
  advance(3000);
  assert.deepEqual(
    told.map(([type]) => type),
    ['quiet', 'lost'],
  );
  assert.ok(told[1][1] - told[0][1] >= 3000 - 500 && told[1][1] - told[0][1] <= 3000 + 500, 'a beat is 500 ms');
  assert.equal(sockets[0].isClosed, true);
  silence(false);
  advance(500);
  assert.equal(sockets.length, 2);
  sockets[1].dispatchEvent(new Event('open'));
  assert.equal(told.at(-1)[0], 'up');
  sockets[0].dispatchEvent(new Event('close')); // at last
  assert.equal(told.at(-1)[0], 'up');
});

test('an answer after 3 s ends the doubt', () => {
  const { sockets, told, advance, silence } = runningConnection();
  silence(true);
  advance(4000);
  assert.deepEqual(
    told.map(([type]) => type),
    ['quiet'],
  );
  silence(false);
  sockets[0].tell({ type: 'pong', time_ms: 1 });
  assert.deepEqual(
    told.map(([type]) => type),
    ['quiet', 'heard'],
  );
  advance(10000);
  assert.equal(told.length, 2);
});

test('a socket that opens and then says nothing is given up after 8 s', () => {
  const { sockets, told, advance, silence } = runningConnection();
  silence(true);
  advance(8000); // lost, and tried again
  const n = sockets.length;
  assert.equal(n, 2);
  sockets[1].dispatchEvent(new Event('open'));
  advance(10000);
  assert.ok(sockets.length > n);
  assert.ok(told.filter(([type]) => type === 'lost').length >= 2);
});

test('connections that end soon after their welcome get more time, so that one large picture can come through', () => {
  const { sockets, told, advance, silence } = runningConnection();
  silence(true);
  advance(7000); // a ping after at most 1 s, and 5 s
  assert.equal(told.at(-1)[0], 'lost');
  silence(false);
  sockets.at(-1).dispatchEvent(new Event('open'));
  told.length = 0;
  silence(true);
  advance(8000);
  assert.deepEqual(
    told.map(([type]) => type),
    ['quiet'],
  );
  advance(4000); // 1 s and 10 s
  assert.deepEqual(
    told.map(([type]) => type),
    ['quiet', 'lost'],
  );
});

test('a page that slept is not a lost connection', () => {
  const { sockets, told, advance, silence, sleep } = runningConnection();
  advance(900);
  silence(true);
  advance(600); // a ping is out
  sleep(3600000); // the answer lies in the socket, behind the timer
  advance(0);
  assert.deepEqual(told, []);
  silence(false);
  sockets[0].tell({ type: 'pong', time_ms: 1 });
  advance(10000);
  assert.deepEqual(told, []);
});

test('another name comes back as the same member on a new socket; the old one stays until the welcome, and nothing is lost to the eye', () => {
  const { connection, told, sockets } = fakeConnection();
  sockets[0].open();
  sockets[0].welcome();
  connection.rename('Dr Chen');
  assert.equal(sockets.length, 2);
  assert.equal(sockets[0].isClosed, undefined, 'the member is not away meanwhile');
  sockets[0].tell({ type: 'bye', reason: 'replaced', retry_ms: null });
  sockets[0].lose();
  sockets[1].open();
  const [hello] = sockets[1].sent;
  assert.deepEqual([hello.name, hello.member, hello.secret], ['Dr Chen', 'm-1', 'abc']);
  assert.equal(connection.send({ type: 'view.close', view: 1 }), false);
  sockets[1].welcome();
  assert.equal(sockets[0].isClosed, true);
  assert.equal(connection.send({ type: 'view.close', view: 1 }), true);
  assert.deepEqual(
    told.map(({ type }) => type),
    ['up', 'renewing', 'up'],
  );
});

test('a link that is dead shows 2 s after another name was given; the name goes with the next hello', () => {
  const { connection, told, waits, last, wait } = fakeConnection();
  last().open();
  last().welcome();
  waits.length = 0;
  connection.rename('Dr Chen');
  assert.deepEqual(waits, [2000]);
  wait();
  assert.deepEqual(
    told.map(({ type }) => type),
    ['up', 'renewing', 'lost'],
  );
  connection.rename('Dr Chang'); // without a connection
  last().open();
  assert.equal(last().sent[0].name, 'Dr Chang');
  assert.deepEqual(
    told.map(({ type }) => type),
    ['up', 'renewing', 'lost'],
  );
});

test('at the end of a sign-in it stands still until it is told to go on, as the same member', () => {
  const told = (_, socket) => socket.tell({ type: 'bye', reason: 'your sign-in has ended', code: 'sign-in', retry_ms: null });
  for (const end of [told, (connection) => connection.pause()]) {
    const { connection, told: events, sockets, waits } = fakeConnection();
    sockets[0].open();
    sockets[0].welcome();
    waits.length = 0;
    end(connection, sockets[0]);
    sockets[0].lose();
    assert.deepEqual([sockets.length, waits], [1, []], 'no attempt by itself');
    assert.equal(connection.send({ type: 'view.close', view: 1 }), false);
    connection.retryNow();
    assert.equal(sockets.length, 2);
    sockets[1].open();
    assert.deepEqual([sockets[1].sent[0].member, sockets[1].sent[0].secret], ['m-1', 'abc']);
    sockets[1].welcome();
    assert.deepEqual(
      events.map(({ type }) => type),
      ['up', 'paused', 'up'],
    );
  }
});

test('by a new sign-in it comes back on a new socket, as the old one ends with the old sign-in', () => {
  const { connection, sockets } = fakeConnection();
  sockets[0].open();
  sockets[0].welcome();
  connection.renew();
  assert.deepEqual([sockets.length, sockets[0].isClosed], [2, undefined]);
  sockets[1].open();
  assert.deepEqual([sockets[1].sent[0].member, sockets[1].sent[0].secret], ['m-1', 'abc']);
  sockets[0].tell({ type: 'bye', reason: 'your sign-in has ended', code: 'sign-in', retry_ms: null });
  sockets[1].welcome();
  assert.equal(connection.isOpen, true);
  connection.pause({ member: 'm-0', secret: 'own', name: 'A' });
  connection.renew();
  sockets[2].open();
  assert.deepEqual([sockets[2].sent[0].member, sockets[2].sent[0].secret], ['m-0', 'own'], 'as whom it was told to');
});
