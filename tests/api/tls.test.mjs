// TLS at the port: page, API and WebSocket; which versions and ciphers; slow and broken handshakes; the certificate and its renewal. --stub: grey pictures.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { ask, encryptKey, makeCertificate, makeWeak, shakeHands } from './certificates.mjs';
import { bin, call, openPlan, sleep, startDaemon, until, web } from './daemon.mjs';
import { FIRST, open, statuses } from './plain_connection.mjs';
import { Client } from './ws_client.mjs';

const folder = mkdtempSync(join(tmpdir(), 'beamroom-tls-'));
const first = makeCertificate(folder, 'first.example'),
  second = makeCertificate(folder, 'second.example', 'rsa');
const used = { cert: join(folder, 'used.pem'), key: join(folder, 'used.key') };
const flags = ['--stub', '--tls-cert', used.cert, '--tls-key', used.key];
function use({ cert, key }) {
  copyFileSync(cert, used.cert);
  copyFileSync(key, used.key);
}
use(first);
after(() => rmSync(folder, { recursive: true, force: true }));

const readAudit = `
import sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print([row[0] for row in db.execute('SELECT row FROM audit')])
`;

async function roomOf(daemon) {
  await openPlan(daemon.url, 'phantom');
  return (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
}

test('who signs in over TLS gets a cookie that a browser sends over TLS to this server alone', async () => {
  const daemon = await startDaemon({ args: [...flags, '--sign-in', 'local'] });
  const password = 'correct horse';
  const api = (path, method, body, headers) => call(`${daemon.url}/api/v1/session${path}`, method, body, headers);
  const [, token] = await until(() => /\/signin\/first#([0-9a-f]{64})/.exec(daemon.log()), Boolean);
  assert.equal((await api('/first', 'POST', { token, user: 'ann', name: 'Ann Example', password })).status, 204);
  for (const headers of [{ Origin: daemon.url }, {}]) {
    const begun = await api('', 'POST', { user: 'ann', password }, headers);
    assert.equal(begun.status, 201);
    const cookie = begun.headers.get('set-cookie');
    assert.match(cookie, /^__Host-beamroom=[0-9a-f]{64}; Path=\/; HttpOnly; SameSite=Strict; Secure$/);
    const [given] = cookie.split(';');
    assert.equal((await api('', 'GET', undefined, { Cookie: given })).json.identity.user, 'ann');
    const renamed = given.replace('__Host-', ''); // as another server of this host could set it, without TLS
    assert.equal((await api('', 'GET', undefined, { Cookie: renamed })).json.identity, null);
  }
  assert.equal(await daemon.stop(), 0, daemon.log());
});

describe('over one port of TLS', () => {
  let daemon, room;
  before(async () => {
    daemon = await startDaemon({ args: flags });
    room = await roomOf(daemon);
  });
  after(async () => assert.equal(await daemon.stop(), 0, daemon.log()));

  test('page, API and WebSocket are served', async () => {
    assert.match(daemon.url, /^https:/);
    const page = await call(`${daemon.url}/`);
    assert.equal(page.status, 200);
    assert.match(page.headers.get('content-security-policy'), /connect-src 'self' wss:;/);
    assert.equal(page.headers.get('strict-transport-security'), null, 'other services of this name may have no TLS');
    assert.equal((await call(`${daemon.url}/api/v1/rooms/${room}`)).json.id, room);
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, { Origin: daemon.url });
    assert.equal(client.status, 101);
    client.send({ type: 'hello', protocol: 2 });
    await client.message('welcome');
    client.send({ type: 'view.open', view: 1, document: { size_px: [800, 600] } });
    assert.equal((await client.frame((f) => f.isStill)).width, 800);
    client.cut();
  });

  test('large answers and large bodies come whole', async () => {
    const files = await call(`${daemon.url}/api/v1/openapi.json`);
    assert.equal(Buffer.byteLength(files.text), Number(files.headers.get('content-length')));
    const body = `{"plan":"phantom"${' '.repeat(1000000)}}`;
    assert.equal((await call(`${daemon.url}/api/v1/rooms`, 'POST', body)).status, 201);
    const tooLarge = await call(`${daemon.url}/api/v1/rooms`, 'POST', ' '.repeat(1200000));
    assert.equal(tooLarge.status, 413, 'a refused client reads its answer');
  });

  test('a connection is used for several requests, and ends when the client says so', async () => {
    const { socket } = await shakeHands(daemon.url);
    for (let i = 0; i < 3; i++) assert.deepEqual(statuses(await ask(socket, FIRST, 'ok\n')), [200]);
    const ended = new Promise((done) => socket.once('end', done));
    assert.deepEqual(statuses(await ask(socket, FIRST.replace('\r\n\r\n', '\r\nConnection: close\r\n\r\n'), 'ok\n')), [200]);
    await ended;
    socket.destroy();
  });

  test('HTTP without encryption is refused with a sentence', async () => {
    const connection = open(daemon.url, FIRST);
    assert.equal(await connection.ended, 'end');
    assert.deepEqual(statuses(connection.text), [400]);
    assert.match(connection.text, /this port speaks TLS; use an address that begins with https:/);
  });

  test('only pages of https are of this server', async () => {
    const { host } = new URL(daemon.url);
    const post = (origin) => call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' }, { Origin: origin });
    assert.equal((await post(`https://${host}`)).status, 201);
    assert.equal((await post(`http://${host}`)).status, 403);
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, { Origin: `http://${host}` });
    assert.equal(client.status, 403);
    client.cut();
  });

  test('deploy/smoke.sh finds nothing amiss', () => {
    const { status, stdout } = spawnSync('deploy/smoke.sh', [daemon.url, 'phantom'], { encoding: 'utf8', timeout: 120000 });
    assert.equal(status, 0, stdout);
    assert.match(stdout, /smoke: \d+ passed, 0 failed/);
  });

  test("the client's address is known behind it", async () => {
    const from = '127.0.7.1';
    const { socket } = await shakeHands(daemon.url, { from });
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, {}, socket);
    client.send({ type: 'hello', protocol: 2, name: 'Ada' });
    await client.message('welcome');
    const rows = () => execFileSync('python3', ['-c', readAudit, join(daemon.data, 'beamroom.db')], { encoding: 'utf8' });
    await until(rows, (text) => text.includes(`"address":"${from}"`) && text.includes('"name":"Ada"'));
    client.cut();
  });
});

describe('a handshake', () => {
  let daemon;
  before(async () => {
    use(second); // RSA: there are ciphers without forward secrecy for it
    daemon = await startDaemon({ args: flags });
  });
  after(async () => assert.equal(await daemon.stop(), 0, daemon.log()));
  const old = { ciphers: 'ALL:@SECLEVEL=0', minVersion: 'TLSv1' };

  for (const version of ['TLSv1', 'TLSv1.1'])
    test(`of ${version} is refused`, () => assert.rejects(shakeHands(daemon.url, { ...old, maxVersion: version }), /protocol version/i));
  for (const version of ['TLSv1.2', 'TLSv1.3'])
    test(`of ${version} is made, with an authenticated cipher and forward secrecy`, async () => {
      const found = await shakeHands(daemon.url, { minVersion: version, maxVersion: version, ALPNProtocols: ['h2', 'http/1.1'] });
      assert.equal(found.version, version);
      assert.match(found.cipher, version === 'TLSv1.3' ? /^TLS_(AES|CHACHA20).*(GCM|POLY1305)/ : /^TLS_ECDHE_RSA_.*(GCM|POLY1305)/);
      assert.equal(found.alpn, 'http/1.1');
      found.socket.destroy();
    });
  for (const cipher of ['AES128-GCM-SHA256', 'ECDHE-RSA-AES128-SHA', 'ECDHE-RSA-AES256-SHA384', 'DHE-RSA-AES128-GCM-SHA256', 'NULL-SHA256'])
    test(`with ${cipher} is refused`, () =>
      assert.rejects(shakeHands(daemon.url, { maxVersion: 'TLSv1.2', ciphers: `${cipher}:@SECLEVEL=0` }), /handshake failure/i));
  test('for another protocol than HTTP/1.1 is refused', () =>
    assert.rejects(shakeHands(daemon.url, { ALPNProtocols: ['h2'] }), /no application protocol/i));
  test('without a protocol is made', async () => {
    const found = await shakeHands(daemon.url);
    assert.equal(found.alpn, false);
    found.socket.destroy();
  });

  /** Opens a connection, sends bytes and nothing more; how long until it ended. */
  const timeOf = async (bytes, from) => {
    const began = performance.now();
    assert.equal(await open(daemon.url, bytes, { from }).ended, 'end');
    return performance.now() - began;
  };
  test('that is slow ends after 5 s, one that is broken at once, and neither holds others up', async () => {
    const half = Buffer.from([22, 3, 1, 2, 0, 1, 0, 1, 252, 3, 3]);
    const slow = [timeOf('', '127.0.7.2'), timeOf(half, '127.0.7.2')];
    const broken = timeOf(Buffer.concat([half, Buffer.alloc(600, 7)]), '127.0.7.2');
    for (let i = 0; i < 5; i++) {
      const began = performance.now();
      assert.equal((await call(`${daemon.url}/healthz`)).status, 200);
      assert.ok(performance.now() - began < 4500);
    }
    const first = await Promise.race([broken.then(() => 'the broken one'), ...slow.map((one) => one.then(() => 'a slow one'))]);
    assert.equal(first, 'the broken one', 'it does not wait for the limit');
    for (const ms of await Promise.all(slow)) assert.ok(ms > 4900 && ms < 30000, `${ms} ms`);
  });
  test('that is made, without a request after it, ends after 5 s', async () => {
    const began = performance.now();
    const { socket } = await shakeHands(daemon.url);
    socket.resume();
    await new Promise((done) => socket.once('close', done));
    const ms = performance.now() - began;
    assert.ok(ms > 4500 && ms < 30000, `${ms} ms`);
  });
  test('is one of 64 of one address at most; another address has its own', async () => {
    const { hostname, port } = new URL(daemon.url);
    const ended = [];
    const began = performance.now();
    const all = Array.from({ length: 80 }, (_, i) => {
      const socket = connect({ host: hostname, port: Number(port), localAddress: '127.0.7.3' });
      socket.on('error', () => {});
      socket.on('close', () => ended.push(i));
      return socket;
    });
    await until(
      () => ended.length,
      (n) => n >= 16,
    );
    const isQuick = performance.now() - began < 4000; // all end after 5 s
    assert.ok(isQuick ? ended.length === 16 : ended.length >= 16, `${ended.length} have ended`);
    const other = await shakeHands(daemon.url, { from: '127.0.7.4' });
    assert.deepEqual(statuses(await ask(other.socket, FIRST, 'ok\n')), [200]);
    for (const socket of [...all, other.socket]) socket.destroy();
  });
});

describe('a renewed certificate', () => {
  let daemon;
  before(async () => {
    use(first);
    daemon = await startDaemon({ args: flags });
  });
  after(async () => assert.equal(await daemon.stop(), 0, daemon.log()));
  const reload = async (words) => {
    const n = daemon.log().length;
    daemon.child.kill('SIGHUP');
    await until(
      () => daemon.log().slice(n),
      (log) => words.test(log),
    );
  };
  const nameNow = async () => {
    const { socket, name } = await shakeHands(daemon.url);
    socket.destroy();
    return name;
  };

  test('is what new connections get after SIGHUP; standing ones are not cut', async () => {
    const room = await roomOf(daemon);
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    await client.message('welcome');
    const standing = await shakeHands(daemon.url);
    assert.equal(standing.name, 'first.example');
    assert.deepEqual(statuses(await ask(standing.socket, FIRST, 'ok\n')), [200]);
    use(second);
    await reload(/TLS: certificate of second\.example, valid until \d{4}-\d\d-\d\d/);
    await until(nameNow, (name) => name === 'second.example');
    assert.deepEqual(statuses(await ask(standing.socket, FIRST, 'ok\n')), [200]);
    client.send({ type: 'view.open', view: 1, document: { size_px: [160, 120] } });
    await client.frame((f) => f.isStill);
    client.cut();
    standing.socket.destroy();
  });
  test('that is bad is refused with a line in the log, and the old one stays', async () => {
    const before = await nameNow();
    copyFileSync(first.cert, used.cert); // the key is still another one's
    await reload(/the certificate in use stays: --tls-key .* is not the key of the certificate/);
    writeFileSync(used.cert, 'no certificate');
    await reload(/the certificate in use stays: --tls-cert .*: no certificate can be read/);
    rmSync(used.cert);
    await reload(/the certificate in use stays: --tls-cert .*: No such file/);
    assert.equal(await nameNow(), before);
    use(first);
    await reload(/TLS: certificate of first\.example/);
    await until(nameNow, (name) => name === 'first.example');
  });
});

test('SIGHUP without TLS changes nothing', async () => {
  const daemon = await startDaemon({ args: ['--stub'] });
  daemon.child.kill('SIGHUP');
  await until(daemon.log, (log) => /nothing to read again on SIGHUP/.test(log));
  await sleep(100);
  assert.equal((await call(`${daemon.url}/healthz`)).status, 200);
  assert.equal(await daemon.stop(), 0);
});

test('Strict-Transport-Security is promised on port 443 alone', async (t) => {
  use(first);
  let daemon;
  try {
    daemon = await startDaemon({ args: [...flags, '--listen', '127.0.7.9:443'] });
  } catch (error) {
    t.skip(`port 443 is not ours: ${error.message.split('\n')[0]}`);
    return;
  }
  const answer = await call(`${daemon.url}/healthz`);
  assert.equal(answer.headers.get('strict-transport-security'), 'max-age=31536000');
  assert.equal(await daemon.stop(), 0);
});

test('SIGHUP ends a daemon whose terminal is gone', (t) => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-terminal-'));
  // A terminal of its own, which is closed once the daemon serves; a hangup is what the kernel sends then.
  const program = `
import os, pty, signal, sys, time
try: child, terminal = pty.fork()
except OSError as error: sys.exit(77)
if child == 0: os.execv(sys.argv[1], sys.argv[1:])
text = b''
while b'ready http' not in text: text += os.read(terminal, 4096)
os.close(terminal)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
`;
  const args = [join(bin, 'beamroomd'), '--stub', '--data', data, '--web', web, '--listen', '127.0.0.1:0'];
  const ended = spawnSync('python3', ['-c', program, ...args], { encoding: 'utf8', timeout: 60000 });
  rmSync(data, { recursive: true, force: true });
  if (ended.status === 77) t.skip('there are no terminals here');
  else assert.equal(ended.stdout, '0\n', ended.stderr);
});

test('a key that the user of the daemon cannot read is named', {
  skip: process.getuid() !== 0 && 'only root can become another user',
}, () => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-tls-data-'));
  const ended = spawnSync(
    join(bin, 'beamroomd'),
    [
      '--stub',
      '--user',
      'nobody',
      '--data',
      data,
      '--web',
      web,
      '--listen',
      '127.0.0.1:0',
      '--tls-cert',
      first.cert,
      '--tls-key',
      first.key,
    ],
    { encoding: 'utf8', timeout: 60000 },
  );
  rmSync(data, { recursive: true, force: true });
  assert.notEqual(ended.status, 0);
  assert.match(ended.stderr, /user nobody cannot reach --(tls-cert|tls-key|web|renderer|data) /);
});

describe('the start ends with a sentence', () => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-tls-data-'));
  after(() => rmSync(data, { recursive: true, force: true }));
  const start = (...args) =>
    spawnSync(join(bin, 'beamroomd'), ['--stub', '--data', data, '--web', web, '--listen', '127.0.0.1:0', ...args], {
      encoding: 'utf8',
      timeout: 60000,
    });
  const encrypted = join(folder, 'encrypted.key'),
    text = join(folder, 'text.pem'),
    weak = { cert: join(folder, 'weak.pem'), key: join(folder, 'weak.key') };
  before(() => {
    encryptKey(first.key, encrypted);
    writeFileSync(text, 'This is a text.\n');
    makeWeak(weak);
  });
  const cases = [
    ['a certificate without a key', ['--tls-cert', first.cert], /--tls-cert is given without --tls-key; expected both or neither/],
    ['a key without a certificate', ['--tls-key', first.key], /--tls-key is given without --tls-cert; expected both or neither/],
    [
      'a certificate that is not there',
      ['--tls-cert', join(folder, 'none.pem'), '--tls-key', first.key],
      /--tls-cert .*none\.pem: No such file or directory/,
    ],
    [
      'a key that is not there',
      ['--tls-cert', first.cert, '--tls-key', join(folder, 'none.key')],
      /--tls-key .*none\.key: No such file or directory/,
    ],
    ['a folder', ['--tls-cert', folder, '--tls-key', first.key], /--tls-cert .*: expected a file/],
    ['a text', ['--tls-cert', text, '--tls-key', first.key], /--tls-cert .*: no certificate can be read .*; expected PEM/],
    ['a text for the key', ['--tls-cert', first.cert, '--tls-key', text], /--tls-key .*: no private key can be read .*; expected PEM/],
    [
      'the key of another',
      ['--tls-cert', first.cert, '--tls-key', second.key],
      /--tls-key .* is not the key of the certificate in --tls-cert .*; expected a pair/,
    ],
    [
      'an encrypted key',
      ['--tls-cert', first.cert, '--tls-key', encrypted],
      /--tls-key .*: the key is encrypted; expected one without a passphrase/,
    ],
    ['a weak key', ['--tls-cert', weak.cert, '--tls-key', weak.key], /--tls-cert .* cannot be used: .*key too small/],
  ];
  for (const [what, args, words] of cases)
    test(`for ${what}`, () => {
      const ended = start(...args);
      assert.notEqual(ended.status, 0);
      assert.notEqual(ended.status, null, 'it ends by itself');
      assert.match(ended.stderr, words);
      assert.ok(!ended.stdout.includes('ready'));
    });
});
