// A proxy in front, on a Unix socket: only its processes are answered there, and the socket's file comes and goes with the daemon. --stub: grey pictures.
import assert from 'node:assert/strict';
import { chmodSync, existsSync, mkdtempSync, rmSync, statSync } from 'node:fs';
import { request } from 'node:http';
import { connect } from 'node:net';
import { tmpdir, userInfo } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const me = userInfo().username,
  somebodyElse = me === 'nobody' ? 'daemon' : 'nobody';

/** One request by a Unix socket. @returns {Promise<{status: number, text: string}>} */
const ask = (socketPath, path, headers = {}) =>
  new Promise((done, failed) => {
    request({ socketPath, path, headers: { Host: 'beamroom.example', ...headers } }, (answer) => {
      let text = '';
      answer.on('data', (part) => (text += part));
      answer.on('end', () => done({ status: answer.statusCode, text }));
    })
      .on('error', failed)
      .end();
  });

describe('A Unix socket for a proxy', () => {
  let folder, path;
  before(() => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-socket-'));
    chmodSync(folder, 0o777); // the daemon may give root up
    path = join(folder, 'http.sock');
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  const start = (proxy, ...args) =>
    startDaemon({
      args: [
        '--stub',
        '--open-to-everybody',
        '--public-name',
        'beamroom.example',
        '--listen',
        `unix:${path}`,
        '--proxy-user',
        proxy,
        ...args,
      ],
    });

  test('carries pages, calls and WebSockets of the proxy, beside the port, and is replaced after a kill', async () => {
    const killed = await start(me);
    assert.equal(statSync(path).mode & 0o777, 0o660);
    await assert.rejects(start(me), /http\.sock: another process listens there/);
    killed.child.kill('SIGKILL');
    await until(
      () => killed.child.signalCode,
      (signal) => signal === 'SIGKILL',
    );
    await killed.stop();
    assert.ok(existsSync(path));

    const daemon = await start(me);
    try {
      assert.equal((await ask(path, '/healthz')).status, 200);
      assert.match((await ask(path, '/')).text, /<!doctype html>/i);
      assert.equal((await ask(path, '/healthz', { Host: 'elsewhere.example' })).status, 421);
      assert.equal((await call(`${daemon.url}/healthz`)).status, 200);
      const plan = (
        await until(
          async () => JSON.parse((await ask(path, '/api/v1/plans')).text),
          ({ plans }) => plans.length > 0,
        )
      ).plans[0];
      const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: plan.id })).json;
      const headers = { Host: 'beamroom.example', Origin: 'https://beamroom.example' };
      const client = await Client.open(daemon.url, `/api/v1/rooms/${room.id}/ws`, headers, connect(path));
      assert.equal(client.status, 101);
      client.send({ type: 'hello', protocol: 2 });
      await client.message('welcome');
      const other = { ...headers, Origin: 'https://elsewhere.example' };
      assert.equal((await Client.open(daemon.url, `/api/v1/rooms/${room.id}/ws`, other, connect(path))).status, 403);
    } finally {
      assert.equal(await daemon.stop(), 0);
    }
    assert.ok(!existsSync(path));
  });

  test('answers no other process than those of the proxy', async () => {
    const daemon = await start(somebodyElse);
    try {
      for (const at of ['/healthz', '/', '/api/v1/plans']) {
        const { status, text } = await ask(path, at);
        assert.equal(status, 403, at);
        assert.match(JSON.parse(text).detail, /the proxy of --proxy-user alone; this process runs as user \d+ and group \d+/);
      }
      assert.equal((await Client.open(daemon.url, '/api/v1/rooms/a/ws', {}, connect(path))).status, 403);
    } finally {
      await daemon.stop();
    }
  });

  test('is not opened by mistake', async () => {
    const open = '--open-to-everybody',
      socket = ['--listen', `unix:${path}`];
    for (const [args, words] of [
      [[...socket, '--proxy-user', me], /nobody signs in here.*--open-to-everybody/],
      [[...socket, open], /--listen unix: is given without --proxy-user/],
      [['--proxy-user', me, open], /--proxy-user is given without --listen unix:/],
      [[...socket, '--proxy-user', 'no-such-user-here', open], /no-such-user-here: there is neither such a user nor such a group/],
      [['--listen', 'unix:http.sock', '--proxy-user', me, open], /expected unix:\/PATH/],
      [['--listen', `unix:${path},group=no-such-group-here`, '--proxy-user', me, open], /there is no group no-such-group-here/],
      [['--listen', `unix:${folder}/none/http.sock`, '--proxy-user', me, open], /--listen (unix:)?\S*\/none/],
    ])
      await assert.rejects(startDaemon({ args: ['--stub', ...args] }), words, args.join(' '));
    assert.ok(!existsSync(path));
  });
});

test('Who says by a header who they are is refused on the port', async () => {
  const daemon = await startDaemon({ args: ['--stub'] });
  try {
    for (const name of [
      'X-Beamroom-User',
      'X-Beamroom-Name',
      'X-Beamroom-Groups',
      'X-Beamroom-Auth-Time',
      'x-beamroom-user',
      'X_Beamroom_User',
      'X-Beamroom_User',
    ])
      for (const value of ['anna', ''])
        for (const at of ['/', '/healthz', '/api/v1/plans']) {
          const answer = await call(`${daemon.url}${at}`, 'GET', undefined, { [name]: value });
          assert.equal(answer.status, 400, `${name}: "${value}" ${at}`);
          assert.match(answer.json.detail, new RegExp(name, 'i'));
        }
    assert.equal((await Client.open(daemon.url, '/api/v1/rooms/a/ws', { 'X-Beamroom-User': 'anna' })).status, 400);
    assert.equal((await call(`${daemon.url}/healthz`)).status, 200);
  } finally {
    await daemon.stop();
  }
});
