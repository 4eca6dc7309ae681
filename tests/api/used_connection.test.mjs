// A WebSocket on a connection that has carried requests before: reverse proxies keep connections to the daemon and send the next handshake on any of
// them (nginx with keepalive, HAProxy with http-reuse always). --stub: grey pictures.
import assert from 'node:assert/strict';
import { connect } from 'node:net';
import { after, before, describe, test } from 'node:test';
import { call, openPlan, until } from './daemon.mjs';
import { FIRST, HOST, exchange, startWithPlan, statuses } from './plain_connection.mjs';
import { Client } from './ws_client.mjs';

const KEY = 'Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n';
const post = (lines, body) => `POST /api/v1/rooms HTTP/1.1\r\n${HOST}Content-Type: application/json\r\n${lines}\r\n${body}`;

describe('a WebSocket', () => {
  let daemon, room;
  before(async () => {
    daemon = await startWithPlan();
    await openPlan(daemon.url, 'phantom');
    room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  });
  after(async () => assert.equal(await daemon?.stop(), 0));
  const path = () => `/api/v1/rooms/${room}/ws`;

  /** A connection on which these requests were answered, each before the next was sent. */
  async function used(requests, from = '127.0.0.1') {
    const { hostname, port } = new URL(daemon.url);
    const socket = connect({ host: hostname, port: Number(port), localAddress: from });
    const found = [];
    for (const request of requests) {
      let text = '';
      const answer = new Promise((done, failed) => {
        socket.on('data', function take(bytes) {
          text += bytes.toString('latin1');
          const head = text.indexOf('\r\n\r\n'),
            length = Number(/content-length: (\d+)/i.exec(text)?.[1] ?? 0);
          if (head < 0 || text.length < head + 4 + length) return;
          socket.off('data', take);
          done();
        });
        socket.once('error', failed);
      });
      socket.write(request);
      await answer;
      found.push(...statuses(text));
    }
    socket.removeAllListeners('error');
    return { socket, found };
  }

  async function isWelcomed(client) {
    assert.equal(client.status, 101);
    client.send({ type: 'hello', protocol: 2 });
    await client.message('welcome');
    client.send({ type: 'view.open', view: 1, document: { size_px: [64, 64] } });
    await client.frame();
  }

  const cases = [
    ['one request', [FIRST], [200]],
    ['three requests', [FIRST, `GET /index.html HTTP/1.1\r\n${HOST}\r\n`, `GET /api/v1/plans HTTP/1.1\r\n${HOST}\r\n`], [200, 200, 200]],
    ['a request with a body', [post('Content-Length: 2\r\n', '{}')], [422]],
    ['a request with chunks', [post('Transfer-Encoding: chunked\r\n', '1\r\n{\r\n1\r\n}\r\n0\r\n\r\n')], [422]],
  ];
  for (const [what, requests, expected] of cases)
    test(`opens on a connection that carried ${what}, is welcomed and gets pictures`, async () => {
      const { socket, found } = await used(requests);
      assert.deepEqual(found, expected);
      const client = await Client.open(daemon.url, path(), {}, socket);
      await isWelcomed(client);
      client.cut();
    });

  test('opens there also when its head comes byte for byte, and with the first message behind it', async () => {
    const { socket } = await used([FIRST]);
    const bytes = `GET ${path()} HTTP/1.1\r\n${HOST}Connection: Upgrade\r\nUpgrade: websocket\r\n${KEY}\r\n`;
    let text = '';
    socket.setNoDelay(true);
    socket.on('data', (some) => (text += some.toString('latin1')));
    for (const byte of bytes) {
      socket.write(byte);
      await new Promise((next) => setImmediate(next));
    }
    await new Promise((done) => socket.once('data', done));
    assert.match(text, /^HTTP\/1\.1 101 /);
    socket.destroy();
    const { socket: other } = await used([FIRST]);
    const hello = Buffer.from(JSON.stringify({ type: 'hello', protocol: 2 }));
    let came = Buffer.alloc(0);
    other.on('data', (some) => (came = Buffer.concat([came, some])));
    other.write(Buffer.concat([Buffer.from(bytes), Buffer.from([0x81, 0x80 | hello.length, 0, 0, 0, 0]), hello]));
    await until(
      () => came,
      (bytes) => bytes.includes('"welcome"'),
    );
    other.destroy();
  });

  test('opens thirty times after three requests each', async () => {
    for (let i = 0; i < 30; i++) {
      const { socket } = await used([FIRST, FIRST, FIRST]);
      const client = await Client.open(daemon.url, path(), {}, socket);
      assert.equal(client.status, 101);
      client.cut();
    }
  });

  test('is refused there as on a new connection', async () => {
    for (const [where, headers, status] of [
      [path(), { Origin: 'http://evil.example' }, 403],
      ['/api/v1/rooms/7q4k-m2wz/ws', {}, 404],
      [path(), { 'Sec-WebSocket-Version': '8' }, 426],
      [path(), { Connection: 'keep-alive' }, 426],
      [path(), { Host: 'evil.example' }, 403],
    ]) {
      const { socket } = await used([FIRST]);
      assert.equal((await Client.open(daemon.url, where, headers, socket)).status, status);
    }
  });

  test('that is sent before the answer to the request in front of it is refused, and nothing hides in it', async () => {
    const shake = `GET ${path()} HTTP/1.1\r\n${HOST}Connection: Upgrade\r\nUpgrade: websocket\r\n${KEY}\r\n`;
    const text = await exchange(daemon.url, `${FIRST}${shake}GET /nothing HTTP/1.1\r\n${HOST}Connection: close\r\n\r\n`);
    assert.deepEqual(statuses(text), [200, 426]);
  });

  test('counts for its address, and the connection that carried it no longer as one of HTTP', async () => {
    const began = performance.now(),
      all = [];
    for (let i = 0; i < 205; i++) all.push(await Client.open(daemon.url, path(), {}, (await used([FIRST], '127.0.7.1')).socket));
    const opened = all.filter(({ status }) => status === 101).length;
    const isQuick = performance.now() - began < 4000; /* a connection without hello within 5 s is closed and no longer counted */
    assert.ok(isQuick ? opened === 200 : opened >= 200, `${opened} were opened`);
    assert.ok(all.every(({ status }) => status === 101 || status === 429));
    assert.deepEqual((await used([FIRST], '127.0.7.1')).found, [200]);
    for (const client of all) client.cut();
  });
});
