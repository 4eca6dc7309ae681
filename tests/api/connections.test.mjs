// Connections to the daemon: limits in all and per address, form of requests, stopping the daemon with connections open.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { FIRST, HOST, exchange, open, openEach, startWithPlan, statuses } from './plain_connection.mjs';
import { startManager } from './service_manager.mjs';
import { Client } from './ws_client.mjs';

describe('WebSockets of one address', () => {
  let daemon;
  before(async () => {
    daemon = await startWithPlan();
  });
  after(() => daemon?.stop());

  test('stop at 200; another address gets one, and those that end count no longer', async () => {
    const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
    const handshake = `GET /api/v1/rooms/${room}/ws HTTP/1.1\r\n${HOST}Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n\r\n`;
    const began = performance.now();
    const all = await openEach(230, () => open(daemon.url, handshake, { from: '127.0.2.1', ms: 60000 }));
    const took_ms = performance.now() - began;
    assert.equal(all.n(101) + all.n(429), 230);
    if (took_ms < 4000) assert.equal(all.n(101), 200); /* a connection without hello within 5 s is closed and no longer counted */
    const other = await openEach(1, () => open(daemon.url, handshake, { from: '127.0.2.2', ms: 30000 }));
    assert.deepEqual(other.list, [101]);
    all.drop();
    other.drop();
    const again = async () => {
      const c = open(daemon.url, handshake, { from: '127.0.2.1', ms: 60000 });
      await c.answered;
      c.socket.destroy();
      return statuses(c.text)[0];
    };
    assert.equal(await until(again, (status) => status === 101), 101, 'those that ended count no longer');
  });
});

describe('a later request of a connection', () => {
  let daemon;
  before(async () => {
    daemon = await startDaemon({ args: ['--stub'] });
  });
  after(() => daemon?.stop());
  const hidden = `GET /api/v1/plans HTTP/1.1\r\n${HOST}\r\n`;
  const post = (lines, body) => `POST /api/v1/rooms HTTP/1.1\r\n${HOST}Content-Type: application/json\r\n${lines}\r\n${body}`;

  const cases = [
    ['a length and chunks', post('Content-Length: 6\r\nTransfer-Encoding: chunked\r\n', `0\r\n\r\n${hidden}`), 400],
    ['chunks and a length', post('Transfer-Encoding: chunked\r\nContent-Length: 6\r\n', `0\r\n\r\n${hidden}`), 400],
    ['two lengths', post(`Content-Length: 2\r\nContent-Length: ${2 + hidden.length}\r\n`, `{}${hidden}`), 400],
    ['a space before the colon of Content-Length', post(`Content-Length : ${hidden.length}\r\n`, hidden), 400],
    ['a space before the colon of Transfer-Encoding', post('Transfer-Encoding : chunked\r\n', `0\r\n\r\n${hidden}`), 400],
    ['a folded line', post('X: y\r\n Transfer-Encoding: chunked\r\nContent-Length: 2\r\n', '{}'), 400],
    ['a CR in a value', `GET /healthz HTTP/1.1\r\n${HOST}X: a\rTransfer-Encoding: chunked\r\n\r\n`, 400],
    ['two Hosts', `GET /healthz HTTP/1.1\r\n${HOST}${HOST}\r\n`, 400],
    ['no Host', 'GET /healthz HTTP/1.1\r\n\r\n', 400],
    ['a coding that is not known', post('Transfer-Encoding: xchunked\r\n', `0\r\n\r\n${hidden}`), 400],
    ['a blank after chunked', post('Transfer-Encoding: chunked \r\n', '2\r\n{}\r\n0\r\n\r\n'), 400],
    ['a tab after chunked', post('Transfer-Encoding: chunked\t\r\n', '2\r\n{}\r\n0\r\n\r\n'), 400],
    ['a blank after its length', post('Content-Length: 2 \r\n', '{}'), 400],
    ['chunks in HTTP/1.0', post('Transfer-Encoding: chunked\r\n', '0\r\n\r\n').replace('HTTP/1.1', 'HTTP/1.0'), 400],
    ['2,000 parameters', `GET /api/v1/plans?${'a=b&'.repeat(2000)} HTTP/1.1\r\n${HOST}\r\n`, 413],
    ['a chunk with a sign', post('Transfer-Encoding: chunked\r\n', `-2\r\n{}\r\n0\r\n\r\n${hidden}`), 400],
    ['a chunk longer than it says', post('Transfer-Encoding: chunked\r\n', `1\r\n{}\r\n0\r\n\r\n${hidden}`), 400],
  ];
  for (const [what, bytes, status] of cases)
    test(`with ${what} is refused as the first would be, and what it hides is not served`, async () => {
      assert.deepEqual(statuses(await exchange(daemon.url, bytes)), [status]);
      const text = await exchange(daemon.url, FIRST + bytes);
      assert.deepEqual(statuses(text), [200, status], text);
      assert.match(text, /application\/problem\+json/);
    });

  test('that is as it should be is answered, a hundred of them sent at once in order, also with bodies', async () => {
    const requests = Array.from({ length: 100 }, (_, i) =>
      i % 3 === 0
        ? FIRST
        : i % 3 === 1
          ? post('Content-Length: 2\r\n', '{}')
          : post('Transfer-Encoding: chunked\r\n', '1\r\n{\r\n1\r\n}\r\n0\r\n\r\n'),
    );
    const text = await exchange(daemon.url, requests.join('') + `GET /nothing HTTP/1.1\r\n${HOST}Connection: close\r\n\r\n`, { ms: 60000 });
    assert.deepEqual(statuses(text), [...requests.map((_, i) => (i % 3 === 0 ? 200 : 422)), 404]);
  });

  test('is read however its bytes are cut', async () => {
    const whole = `${FIRST}${post('Transfer-Encoding: chunked\r\n', '1\r\n{\r\n1\r\n}\r\n0\r\n\r\n')}GET /nothing HTTP/1.1\r\n${HOST}Connection: close\r\n\r\n`;
    const connection = open(daemon.url, '', { ms: 60000 });
    connection.socket.setNoDelay(true);
    for (let at = 0; at < whole.length; at += 7) {
      connection.socket.write(whole.slice(at, at + 7));
      await new Promise((next) => setImmediate(next));
    }
    assert.equal(await connection.ended, 'end');
    assert.deepEqual(statuses(connection.text), [200, 422, 404]);
  });

  test('that stops in its head is told so within seconds', async () => {
    const text = await exchange(daemon.url, `${FIRST}GET /heal`, { ms: 30000 });
    assert.deepEqual(statuses(text), [200, 408]);
  });
});

describe('behind a proxy', () => {
  let daemon;
  before(async () => {
    daemon = await startDaemon({ args: ['--stub', '--open-to-everybody', '--trusted-proxy', '127.0.3.0/24'] });
  });
  after(() => daemon?.stop());
  const ask = (forwarded, from) =>
    open(daemon.url, `GET /healthz HTTP/1.1\r\n${HOST}X-Forwarded-For: ${forwarded}\r\n\r\n`, { from, ms: 60000 });
  /** Number of 220 simultaneous connections that were served. Connections of an earlier test may still be closing. */
  const served = (forwarded, from) =>
    until(
      async () => {
        const all = await openEach(220, (i) => ask(forwarded(i), from));
        all.drop();
        return all.n(200);
      },
      (n) => n >= 200,
      20000,
    );

  test('each client has the limit of one address, though all come from the proxy', async () => {
    assert.equal(await served((i) => `198.51.100.${i % 2}`, '127.0.3.1'), 220);
    assert.equal(await served(() => 'unknown, 198.51.100.7', '127.0.3.1'), 200);
  });

  test('what a client that is no proxy says of itself is not believed', async () => {
    assert.equal(await served((i) => `198.51.100.${i}`, '127.0.4.1'), 200);
  });

  test('requests of many clients on one connection are counted for each', async () => {
    const text = await exchange(
      daemon.url,
      Array.from(
        { length: 300 },
        (_, i) =>
          `GET /healthz HTTP/1.1\r\n${HOST}X-Forwarded-For: 203.0.113.${i % 250}\r\n${i === 299 ? 'Connection: close\r\n' : ''}\r\n`,
      ).join(''),
      { from: '127.0.3.1', ms: 60000 },
    );
    assert.deepEqual(statuses(text), Array(300).fill(200));
  });
});

describe('a refused upload', () => {
  test('gives its connection back at once, while its sender still sends', async () => {
    const daemon = await startDaemon({ args: ['--stub'] });
    try {
      const upload = `POST /api/v1/plans?name=x HTTP/1.1\r\n${HOST}Origin: http://evil.example\r\nContent-Type: application/zip\r\nContent-Length: 1000000\r\n\r\nPK`;
      const all = await openEach(210, () => open(daemon.url, upload, { from: '127.0.5.1', ms: 60000 }));
      assert.equal(all.n(403), 210);
      const more = await exchange(daemon.url, `GET /healthz HTTP/1.1\r\n${HOST}Connection: close\r\n\r\n`, { from: '127.0.5.1' });
      assert.deepEqual(statuses(more), [200]);
      all.drop();
    } finally {
      await daemon.stop();
    }
  });
});

describe('a page of another origin', () => {
  let daemon, room;
  before(async () => {
    daemon = await startWithPlan();
    room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  });
  after(() => daemon?.stop());

  for (const [what, line, isOwn] of [
    ['its own origin', (host) => `Origin: http://${host}`, true],
    ['its own origin behind TLS', (host) => `Origin: https://${host}`, true],
    ['another scheme with its own name', (host) => `Origin: evil://${host}`, false],
    ['its own name as the end of a path', (host) => `Origin: http://evil.example/http://${host}`, false],
    ['no origin', () => 'Origin: null', false],
    ['no Origin, but a browser that says cross-site', () => 'Sec-Fetch-Site: cross-site', false],
    ['no Origin, but a browser that says same-origin', () => 'Sec-Fetch-Site: same-origin', true],
  ])
    test(`with ${what} ${isOwn ? 'may' : 'may not'} change anything`, async () => {
      const { host } = new URL(daemon.url);
      const post = `POST /api/v1/rooms HTTP/1.1\r\nHost: ${host}\r\nConnection: close\r\n${line(host)}\r\nContent-Type: application/json\r\nContent-Length: 2\r\n\r\n{}`;
      assert.deepEqual(statuses(await exchange(daemon.url, post)), [isOwn ? 422 : 403]);
      if (!line(host).startsWith('Origin')) return;
      const [name, value] = line(host).split(': ');
      const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, { [name]: value });
      assert.equal(client.status, isOwn ? 101 : 403);
      client.cut();
    });

  test('finds no room at an address that only becomes one when it is decoded', async () => {
    assert.equal((await Client.open(daemon.url, `/api/v1/rooms/x%2f..%2f${room}/ws`)).status, 404);
    assert.equal((await Client.open(daemon.url, `/api/v1/rooms/../rooms/${room}/ws`)).status, 404);
  });
});

describe('a condition', () => {
  let daemon, room;
  before(async () => {
    daemon = await startWithPlan();
    await openPlan(daemon.url, 'phantom');
    room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  });
  after(() => daemon?.stop());

  for (const path of ['/index.html', '/api/v1/rooms/{room}/scene'])
    test(`of RFC 9110 on ${path} is read as a list, with weak tags, or as *`, async () => {
      const url = daemon.url + path.replace('{room}', room);
      const { headers } = await until(
        () => call(url),
        (answer) => answer.status === 200,
      );
      const etag = headers.get('etag');
      for (const [value, status] of [
        [etag, 304],
        ['*', 304],
        [`W/${etag}`, 304],
        [`"x", ${etag}`, 304],
        [`"x,y" ,W/${etag} , "z"`, 304],
        ['"x"', 200],
        [`"x ${etag}`, 200],
        [etag.replaceAll('"', ''), 200],
      ])
        assert.equal((await call(url, 'GET', undefined, { 'If-None-Match': value })).status, status, value);
    });
});

describe('the process', () => {
  test('tells the service manager that it is ready, that it lives, and that it stops', async () => {
    const manager = await startManager();
    const daemon = await startDaemon({ args: ['--stub'], env: { NOTIFY_SOCKET: manager.path, WATCHDOG_USEC: '800000' } });
    try {
      await until(manager.lines, (lines) => lines.filter((line) => line === 'WATCHDOG=1').length >= 3);
      assert.equal(manager.lines()[0], 'READY=1');
      assert.ok(manager.lines().filter((line) => line === 'WATCHDOG=1').length >= 3);
      assert.equal(await daemon.stop(), 0);
      await until(manager.lines, (lines) => lines.at(-1) === 'STOPPING=1');
      assert.equal(manager.lines().at(-1), 'STOPPING=1');
    } finally {
      await daemon.stop();
      manager.stop();
    }
  });
});
