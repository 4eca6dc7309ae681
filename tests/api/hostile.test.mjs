// Hostile input: malformed requests, misbehaving sockets, damaged plans. The daemon answers or closes the connection, and goes on.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { gunzipSync, gzipSync } from 'node:zlib';
import { bin, call, openPlan, realData, sleep, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';
import { parseStrict } from './strict_json.mjs';

let folder, daemon, url, api;

/** A random generator with a seed, so that a failure can be repeated (mulberry32). */
function numbers(seed) {
  return (below) => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return Math.floor((((t ^ (t >>> 14)) >>> 0) / 4294967296) * below);
  };
}

/** Damages a file in one of several ways: header bits, any bits, cut short, empty; also inside a gzip stream. */
function damage(bytes, way, random) {
  const flip = (b, n, below) => {
    for (let i = 0; i < n; i++) b[random(Math.min(below, b.length))] ^= 1 << random(8);
    return b;
  };
  switch (way) {
    case 0:
      return flip(Buffer.from(bytes), 4, 400);
    case 1:
      return flip(Buffer.from(bytes), 20, bytes.length);
    case 2:
      return bytes.subarray(0, random(bytes.length));
    case 3:
      return Buffer.alloc(0);
    default: {
      if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return flip(Buffer.from(bytes), 2, 64);
      const inner = gunzipSync(bytes);
      return gzipSync(way === 4 ? flip(inner, 3, 400) : inner.subarray(0, random(inner.length)), { level: 1 });
    }
  }
}

function addDamaged(source, tag, n, random) {
  const files = readdirSync(source).filter((name) => /\.(nii|nii\.gz|json|uvh|uv|uv\.gz|qhd|qim|qim\.gz|info)$/.test(name));
  for (let i = 0; i < n; i++) {
    const plan = join(folder, 'plans', `${tag}-${i}`),
      name = files[random(files.length)];
    cpSync(source, plan, { recursive: true });
    rmSync(join(plan, name));
    writeFileSync(join(plan, name), damage(readFileSync(join(source, name)), i % 6, random));
  }
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-hostile-'));
  const plans = join(folder, 'plans'),
    random = numbers(20);
  mkdirSync(plans);
  execFileSync(join(bin, 'beamroom'), ['phantom', join(plans, 'good'), '--size', '48x48x24']);
  addDamaged(join(plans, 'good'), 'phantom', 24, random);
  if (realData) {
    const head = join(realData, 'sera-head', 'original'),
      odd = join(realData, 'hostile');
    if (existsSync(head)) addDamaged(head, 'head', 12, random);
    for (const name of existsSync(odd) ? readdirSync(odd).filter((file) => statSync(join(odd, file)).isFile()) : []) {
      const plan = join(plans, `odd-${name.toLowerCase().replace(/[^a-z0-9]/g, '-')}`);
      mkdirSync(plan);
      writeFileSync(join(plan, name), readFileSync(join(odd, name)));
    }
  }
  mkdirSync(join(plans, 'a\nb "<i>'));
  writeFileSync(
    join(plans, 'a\nb "<i>', 'plan.json'),
    '{"format":"beamroom-plan","version":1,"name":"\\u202e<script>","images":[{"id":"ct","path":"/etc/passwd"}]}',
  );
  daemon = await startDaemon({ plans: [plans], args: ['--stub', '--max-renderers', '2'] });
  url = daemon.url;
  api = `${url}/api/v1`;
});
after(async () => {
  await daemon?.stop();
  rmSync(folder, { recursive: true, force: true });
});

/** Writes bytes to a new connection; returns what is received until it is closed, or with headOnly until a head is complete. */
function exchange(bytes, { where = url, endsAtOnce = false, headOnly = false } = {}) {
  return new Promise((done) => {
    const { hostname, port } = new URL(where);
    let got = '';
    const socket = connect(Number(port), hostname);
    const end = () => {
      clearTimeout(timer);
      socket.destroy();
      done(got);
    };
    const timer = setTimeout(end, 60000);
    socket.setEncoding('latin1');
    socket.on('data', (text) => {
      got += text;
      if (headOnly && got.includes('\r\n\r\n')) end();
    });
    socket.on('error', () => {});
    socket.on('close', () => {
      clearTimeout(timer);
      done(got);
    });
    socket.write(bytes);
    if (endsAtOnce) socket.end();
  });
}

const get = (target, lines = '') => `GET ${target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n${lines}\r\n`;
const post = (lines, body) =>
  Buffer.concat([
    Buffer.from(`POST /api/v1/rooms HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: application/json\r\n${lines}\r\n`),
    Buffer.from(body),
  ]);
const statusOf = (answer) => Number(/^HTTP\/1\.[01] (\d+)/.exec(answer)?.[1] ?? 0);
const openFiles = () => readdirSync(`/proc/${daemon.child.pid}/fd`).length;

describe('a stranger on the line', () => {
  test('is refused with a problem that says what is wrong with a request, and nothing else happens', async () => {
    const handshake = (room, { drop = '', more = '' } = {}) =>
      ['Connection: Upgrade', 'Upgrade: websocket', 'Sec-WebSocket-Version: 13', 'Sec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw=='].reduce(
        (text, line) => (drop && line.startsWith(drop) ? text : `${text}${line}\r\n`),
        `GET /api/v1/rooms/${room}/ws HTTP/1.1\r\nHost: localhost\r\n`,
      ) + `${more}\r\n`;
    const room = (await call(`${api}/rooms`, 'POST', { plan: 'good' })).json.id;
    const cases = [
      ['a header of 200 KB', get('/healthz', `X: ${'a'.repeat(200000)}\r\n`), 431, /32768 bytes/],
      ['an address of 200 KB', get(`/${'a'.repeat(200000)}`), 414, /24576 bytes/],
      ['an address of 20 KB', get(`/${'a'.repeat(20000)}`), 404, /20001 bytes/],
      ['101 headers', get('/healthz', 'X: y\r\n'.repeat(99)), 431, /100 headers/],
      ['another version', 'GET /healthz HTTP/9.9\r\nHost: localhost\r\n\r\n', 505, /HTTP\/9\.9/],
      ['no version', 'GET /healthz\r\n\r\n', 400, /line 1/],
      ['the beginning of TLS', Buffer.concat([Buffer.from('16030100f8010000f40303', 'hex'), Buffer.from('\n')]), 400, /line 1/],
      ['a method nobody knows', get('/healthz').replace('GET', 'BREW'), 405, /GET/],
      ['a header without a colon', get('/healthz', 'nonsense\r\n'), 400, /header 3, "nonsense"/],
      ['a header over two lines', get('/healthz', 'A: b\r\n c\r\n'), 400, /header 4/],
      ['a NUL in a header', get('/healthz', 'A: b\0c\r\n'), 400, /control character/],
      ['no Host', 'GET /healthz HTTP/1.1\r\n\r\n', 400, /Host is there 0 times/],
      ['two of them', get('/healthz', 'Host: localhost\r\n'), 400, /Host is there 2 times/],
      ['a body with a wrong length', post('Content-Length: -5\r\n', ''), 400, /Content-Length is "-5"/],
      ['two lengths', post('Content-Length: 2\r\nContent-Length: 3\r\n', '{}'), 400, /there 2 times/],
      ['a length and chunks', post('Content-Length: 2\r\nTransfer-Encoding: chunked\r\n', '0\r\n\r\n'), 400, /both/],
      ['a coding nobody knows', post('Transfer-Encoding: gzip\r\n', ''), 400, /"gzip"/],
      ['a NUL in an address', get('/healthz%00x'), 404, /healthz%00x/],
      ['bytes that are no UTF-8 in an address', get('/api/v1/plans/%ff%fe%0d%0aX:y'), 404, /is not an id/],
      ['a NUL in JSON', post('Content-Length: 23\r\n', '{"plan":"good\\u0000xy"}'), 400, /u0000/],
      ['200 KB of brackets', post('Content-Length: 200000\r\n', '['.repeat(200000)), 400, /nested/],
      ['a handshake without a key', handshake(room, { drop: 'Sec-WebSocket-Key' }), 400, /Sec-WebSocket-Key is ""/],
      [
        'a handshake of a version nobody knows',
        handshake(room, { drop: 'Sec-WebSocket-Version', more: 'Sec-WebSocket-Version: 8\r\n' }),
        426,
        /is "8"; expected is 13/,
      ],
      ['a handshake that does not say Upgrade', handshake(room, { drop: 'Upgrade' }), 426, /GET with Upgrade/],
      ['a handshake whose Connection does not', handshake(room, { drop: 'Connection' }), 426, /Connection is ""/],
      ['a handshake for a room that is not there', handshake('zzzz-zzzz'), 404, /no such room/],
      ['a handshake for a room by way of another', handshake(`x%2f..%2f${room}`), 404, /no such room/],
      ['a handshake for a room with a letter as a number', handshake(room.replace('-', '%2d')), 404, /no such room/],
      ['a handshake with a body', handshake(room, { more: 'Content-Length: 5\r\n' }), 400, /announces a body/],
      ['a handshake with a wrong length', handshake(room, { more: 'Content-Length: -1\r\n' }), 400, /Content-Length is "-1"/],
      ['a handshake with chunks', handshake(room, { more: 'Transfer-Encoding: chunked\r\n' }), 400, /announces a body/],
      ['a handshake with two Hosts', handshake(room, { more: 'Host: localhost\r\n' }), 400, /Host is there 2 times/],
      ['a handshake to somebody else', handshake(room).replace('Host: localhost', 'Host: evil.example'), 403, /evil\.example/],
      [
        'a handshake of two origins',
        handshake(room, { more: 'Origin: http://localhost\r\nOrigin: http://evil.example\r\n' }),
        400,
        /Origin is there 2 times/,
      ],
      ['a handshake of another page', handshake(room, { more: 'Origin: http://evil.example\r\n' }), 403, /evil\.example/],
      ['a handshake with 13 KB of cookies', handshake(room, { more: `Cookie: ${'a'.repeat(13000)}\r\n` }), 431, /12288/],
    ];
    for (const [what, bytes, status, words] of cases) {
      const answer = await exchange(bytes),
        [head, body] = [answer.slice(0, answer.indexOf('\r\n\r\n')), answer.slice(answer.indexOf('\r\n\r\n') + 4)];
      assert.equal(statusOf(answer), status, `${what}: ${answer.slice(0, 200)}`);
      assert.match(head, /content-type: application\/problem\+json/i, what);
      const problem = parseStrict(body);
      assert.equal(problem.status, status, what);
      assert.match(problem.type, /^\/problems\/[a-z-]+$/, what);
      assert.match(problem.detail, words, what);
    }
    const large = await exchange(handshake(room, { more: `Cookie: ${'a'.repeat(11000)}\r\n` }), { headOnly: true });
    assert.equal(statusOf(large), 101, 'as much as is read of a handshake, the library behind takes too');
    assert.equal((await call(`${url}/healthz`)).status, 200);
  });

  test('is refused for a later request as for the first', async () => {
    const first = 'GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n';
    const cases = [
      ['chunks without a size', post('Transfer-Encoding: chunked\r\n', 'zz\r\n{}\r\n'), [400]],
      ['a chunk of 2^72', post('Transfer-Encoding: chunked\r\n', 'ffffffffffffffffff\r\n{}\r\n'), [400, 413]],
      ['a later request with a header of 200 KB', first + get('/healthz', `X: ${'a'.repeat(200000)}\r\n`), [431]],
      ['a later request with a wrong length', first + post('Content-Length: -5\r\n', ''), [400]],
      ['a later request of another version', `${first}GET /healthz HTTP/9.9\r\nHost: localhost\r\n\r\n`, [505]],
    ];
    for (const [what, bytes, expected] of cases) {
      const answer = await exchange(bytes),
        last = [...answer.matchAll(/HTTP\/1\.1 \d{3} [\s\S]*?(?=HTTP\/1\.1 \d{3} |$)/g)].at(-1)?.[0] ?? '';
      assert.ok(expected.includes(statusOf(last)), `${what}: ${last.slice(0, 100)}`);
    }
    assert.equal((await call(`${url}/healthz`)).status, 200);
  });

  test('that gave its own name our address gets nothing, whichever request of a connection it is', async () => {
    const evil = (path) => get(path).replace('Host: localhost', 'Host: evil.example:8080');
    for (const bytes of [
      evil('/'),
      evil('/api/v1/plans'),
      evil('/healthz'),
      `GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n${evil('/api/v1/plans')}`,
      `GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n${evil('/')}`,
    ]) {
      const answer = await exchange(bytes),
        last = answer.slice(answer.lastIndexOf('HTTP/1.1'));
      assert.equal(statusOf(last), 403);
      const problem = parseStrict(last.slice(last.indexOf('\r\n\r\n') + 4));
      assert.equal(problem.type, '/problems/this-machine');
      assert.match(problem.detail, /evil\.example:8080.*localhost/);
    }
    const names = ['--public-name', 'beamroom.example', '--public-name', 'other.example'];
    const named = await startDaemon({ plans: [], args: ['--stub', '--open-to-everybody', ...names] });
    try {
      for (const [host, status] of [
        ['beamroom.example', 200],
        ['Other.Example:443', 200],
        ['evil.example', 421],
      ])
        assert.equal(statusOf(await exchange(get('/healthz').replace('localhost', host), { where: named.url })), status, host);
    } finally {
      await named.stop();
    }
  });

  test('hears what is missing when it ends early or comes too slowly', async () => {
    const problemOf = (answer) => parseStrict(answer.slice(answer.indexOf('\r\n\r\n') + 4));
    const early = await exchange('GET /hea', { endsAtOnce: true });
    assert.equal(statusOf(early), 400);
    assert.match(problemOf(early).detail, /ended after 8 bytes/);
    const slow = await exchange('GET /healthz HTTP/1.1\r\n');
    assert.equal(statusOf(slow), 408);
    assert.match(problemOf(slow).detail, /23 bytes .* in 5 s; expected is the empty line/);
  });

  test('hears that a body is too large before it sends one, when it waits to be told', async () => {
    const answer = await exchange(
      'POST /api/v1/rooms HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Type: application/json\r\nContent-Length: 2000000000\r\n\r\n',
    );
    assert.equal(statusOf(answer), 413);
    assert.match(answer, /application\/problem\+json/);
    assert.doesNotMatch(answer, / 100 | 408 /); /* neither 100 Continue nor waiting for the body */
  });

  test('may name the server in the address, as a proxy does', async () => {
    assert.match(await exchange(get('http://beamroom.example/healthz')), /^HTTP\/1\.1 200 [\s\S]*\r\n\r\nok\n$/);
  });

  test('is answered in order when it asks for several things at once', async () => {
    const answer = await exchange(
      'GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\nGET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n' + get('/healthz'),
    );
    assert.deepEqual(
      [...answer.matchAll(/HTTP\/1\.1 (\d+)/g)].map((m) => m[1]),
      ['200', '404', '200'],
    );
  });

  test('cannot use up the descriptors with connections that say nothing or half of it', async () => {
    const { hostname, port } = new URL(url);
    const before_ = openFiles();
    const sockets = Array.from({ length: 300 }, (_, i) => {
      const socket = connect(Number(port), hostname);
      socket.on('error', () => {});
      if (i % 3) socket.write(i % 3 === 1 ? 'GET /hea' : 'POST /api/v1/rooms HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{');
      return socket;
    });
    await sleep(300);
    assert.ok(openFiles() <= before_ + 64 + 3 * 200, `${openFiles()} descriptors`);
    for (const socket of sockets) socket.destroy();
    assert.ok(
      (await until(
        async () => openFiles(),
        (n) => n <= before_ + 4,
      )) <=
        before_ + 4,
      'who hangs up frees its place',
    );
    assert.equal((await call(`${url}/healthz`)).status, 200);
    assert.ok(
      daemon
        .log()
        .split('\n')
        .filter((line) => line.includes('too many connections')).length <= 1,
      'a flood is one line in the log',
    );
  });

  test('gets no more than some seconds of drawing at a time; the rest is told when to come again', async () => {
    assert.equal((await openPlan(url, 'good')).state, 'done');
    const ask = () =>
      fetch(`${api}/plans/good/render`, {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: '{"view":{"size_px":[2048,2048]}}',
      });
    let answers,
      refused = [];
    for (let round = 0; round < 5 && !refused.length; round++) {
      /* none is refused when requests arrive more slowly than they are drawn */
      answers = await Promise.all(Array.from({ length: 30 }, ask));
      refused = answers.filter((answer) => answer.status === 503);
      assert.ok(answers.filter((answer) => answer.status === 200).length >= 8); /* 8 x 2048 x 2048 is 32 << 20 */
      for (const answer of answers) await answer.arrayBuffer();
    }
    assert.ok(refused.length > 0);
    for (const answer of refused) {
      assert.equal(answer.headers.get('content-type'), 'application/problem+json');
      assert.ok(Number(answer.headers.get('retry-after')) >= 1);
    }
    assert.equal((await ask()).status, 200);
  });
});

describe('a socket that misbehaves', () => {
  let room, neighbour;
  before(async () => {
    room = (await call(`${api}/rooms`, 'POST', { plan: 'good' })).json.id;
    neighbour = await Client.open(url, `/api/v1/rooms/${room}/ws`);
    neighbour.send({ type: 'hello', protocol: 2 });
    await neighbour.message('welcome');
  });
  after(() => neighbour?.cut());

  const cases = [
    ['a continuation of nothing', 1002, (c) => c.write(0, Buffer.from('{}'))],
    ['an opcode that is none', 1002, (c) => c.write(3, Buffer.from('{}'))],
    ['a ping in fragments', 1002, (c) => c.write(9, Buffer.from('a'), { isFinal: false })],
    ['a ping of 126 bytes', 1002, (c) => c.write(9, Buffer.alloc(126))],
    ['a frame that is not masked', 1002, (c) => c.writeRaw(Buffer.from([0x81, 2, 0x7b, 0x7d]))],
    ['a length in more bytes than it needs', 1002, (c) => c.writeRaw(Buffer.from([0x81, 0xfe, 0, 2, 0, 0, 0, 0, 0x7b, 0x7d]))],
    ['a reserved bit', 1002, (c) => c.writeRaw(Buffer.from([0xc1, 0x82, 0, 0, 0, 0, 0x7b, 0x7d]))],
    ['a close with a code that is not sent', 1002, (c) => c.write(8, Buffer.from([1005 >> 8, 1005 & 255]))],
    [
      '300 pings at once',
      1008,
      (c) => {
        for (let i = 0; i < 300; i++) c.write(9, Buffer.alloc(0));
      },
    ],
    [
      '64 MiB at once',
      1008,
      (c) => {
        for (let i = 0; i < 1024; i++) c.write(1, Buffer.alloc(65536, ' '));
      },
      true,
    ] /* more than the limit of 14 s, however slow the machine */,
    ['text that is no UTF-8', 1007, (c) => c.write(1, Buffer.from([0x22, 0xff, 0xfe, 0x22]))],
    ['a surrogate in UTF-8', 1007, (c) => c.write(1, Buffer.from([0x22, 0xed, 0xa0, 0x80, 0x22]))],
    ['64 KiB and one byte', 1009, (c) => c.write(1, Buffer.alloc(65537, ' '))],
    [
      'seventy fragments of 1000 bytes',
      1009,
      (c) => {
        for (let i = 0; i < 70; i++) c.write(i ? 0 : 1, Buffer.alloc(1000, ' '), { isFinal: false });
      },
    ],
  ];
  for (const [what, code, act, sendsOn] of cases)
    test(`${what} closes it with ${code}`, async () => {
      const client = await Client.open(url, `/api/v1/rooms/${room}/ws`);
      client.send({ type: 'hello', protocol: 2 });
      await client.message('welcome');
      act(client);
      await client.until(() => client.closeCode, 'the end');
      if (sendsOn)
        assert.ok(
          [code, 1006].includes(client.closeCode),
          `closed with ${client.closeCode}`,
        ); /* 1006: the rest of its data reached a closed socket */
      else assert.equal(client.closeCode, code);
    });

  test('a camera whose eye is its target is told to who set it, once', async () => {
    const client = await Client.open(url, `/api/v1/rooms/${room}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    await client.message('welcome');
    client.send({
      type: 'view.open',
      view: 1,
      document: { kind: '3d', size_px: [64, 64], camera: { position_mm: [1, 2, 3], target_mm: [1, 2, 3], up: [0, 0, 1] } },
    });
    const problem = await client.message('problem');
    assert.equal(problem.view, 1);
    assert.equal(problem.problem.type, '/problems/validation');
    await sleep(600);
    assert.equal(client.messages.filter((m) => m.type === 'problem').length, 1);
    client.cut();
  });

  test('neighbours in the room notice nothing of it', async () => {
    const from = neighbour.messages.length;
    neighbour.send({ type: 'ping', time_ms: 7 });
    await neighbour.message('pong', (m) => m.time_ms === 7, from);
    assert.equal(neighbour.closeCode, 0);
  });
});

describe('a damaged plan', () => {
  test('is listed with its parts or with the reason, and opened or refused with a sentence; another plan is not touched', async () => {
    const expected = readdirSync(join(folder, 'plans')).length;
    const { plans } = await until(
      async () => (await call(`${api}/plans`)).json,
      (list) => list.plans.length === expected && list.plans.every((p) => p.parts.length || p.reason),
    );
    assert.equal(plans.length, expected);
    const room = (await call(`${api}/rooms`, 'POST', { plan: 'good' })).json.id;
    const generation = daemon
      .log()
      .split('\n')
      .filter((line) => line.includes('plan good: ready')).length;
    let opened = 0;
    for (const plan of plans.filter((p) => p.id !== 'good')) {
      if (plan.state === 'unreadable') {
        assert.ok(plan.reason.length > 10, plan.id);
        continue;
      }
      const job = await openPlan(url, plan.id);
      assert.ok(['done', 'failed'].includes(job.state), `${plan.id}: ${job.state}`);
      if (job.state === 'failed') {
        assert.ok(job.problem.detail.length > 20, `${plan.id}: ${job.problem.detail}`);
        assert.doesNotMatch(job.problem.detail, /stopped|signal|memory|did not/, plan.id);
      }
      opened++;
      await call(`${api}/plans/${plan.id}/close`, 'POST');
    }
    assert.ok(opened > 5, `${opened} plans were worth opening`);
    assert.equal((await call(`${api}/rooms/${room}`)).json.renderer, 'ready');
    assert.equal(
      daemon
        .log()
        .split('\n')
        .filter((line) => line.includes('plan good: ready')).length,
      generation,
      'the good plan was never restarted',
    );
    assert.doesNotMatch(daemon.log(), /signal \d/);
  });

  test('with a name full of tricks has a clean id, and its name is only text', async () => {
    const plan = (await call(`${api}/plans`)).json.plans.find((p) => /passwd/.test(p.reason ?? ''));
    assert.match(plan.id, /^[a-z0-9-]{1,63}$/);
    assert.equal(plan.state, 'unreadable');
    assert.ok(
      daemon
        .log()
        .split('\n')
        .every((line) => line === '' || /^\d{4}-\d\d-\d\dT/.test(line)),
      'no name breaks a line of the log',
    );
  });
});
