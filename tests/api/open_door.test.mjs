// Nobody signs in: the daemon answers its own machine alone, starts in no other way by mistake, and says it when it is open to everybody.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

describe('A daemon on which nobody signs in', () => {
  let daemon;
  before(async () => {
    daemon = await startDaemon({ args: ['--stub'] });
  });
  after(() => daemon?.stop());

  test('does not start where others would reach it', async () => {
    for (const [args, named] of [
      [['--listen', '0.0.0.0:0'], '--listen 0.0.0.0:0'],
      [['--listen', '[::]:0'], '--listen [::]:0'],
      [['--listen', '192.0.2.10:9111'], '--listen 192.0.2.10:9111'],
      [['--listen', '[::ffff:192.0.2.10]:9111'], '--listen [::ffff:192.0.2.10]:9111'],
      [['--listen', '::1:0'], '--listen ::1:0'],
      [['--public-name', 'beamroom.example'], '--public-name'],
      [['--trusted-proxy', '127.0.0.1'], '--trusted-proxy'],
    ]) {
      const failed = await startDaemon({ args: ['--stub', ...args] }).then(
        async (started) => {
          await started.stop();
          return { message: 'it started' };
        },
        (error) => error,
      );
      assert.ok(failed.message.includes(named), `${args.join(' ')}: ${failed.message}`);
      assert.match(failed.message, /nobody signs in here.*--open-to-everybody/, args.join(' '));
    }
  });

  test('does not take for its own machine what it cannot read as an address', async () => {
    for (const listen of ['0:0', '0x7f.1:0', '127.1:0', 'localhost:0', '[::1%lo]:0', '127.0.0.1'])
      await assert.rejects(startDaemon({ args: ['--stub', '--listen', listen] }), /expected ADDRESS:PORT/, listen);
  });

  test('answers nobody for whom a proxy asks, and no other name, page and WebSocket alike', async () => {
    await openPlan(daemon.url, 'phantom');
    const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json;
    const socket = `/api/v1/rooms/${room.id}/ws`;
    for (const headers of [
      { 'X-Forwarded-For': '127.0.0.1' },
      { 'X-Forwarded-Proto': 'https' },
      { 'x-forwarded-host': 'localhost' },
      { Forwarded: 'for=127.0.0.1' },
      { Via: '1.1 proxy' },
      { 'X-Real-IP': '127.0.0.1' },
    ]) {
      const [name] = Object.keys(headers);
      for (const path of ['/', '/healthz', '/api/v1/plans', `/api/v1/rooms/${room.id}`]) {
        const answer = await call(`${daemon.url}${path}`, 'GET', undefined, headers);
        assert.deepEqual([answer.status, answer.json.type], [403, '/problems/this-machine'], `${name} ${path}`);
        assert.match(answer.json.detail, new RegExp(name, 'i'));
      }
      const client = await Client.open(daemon.url, socket, headers);
      assert.equal(client.status, 403, name);
    }
    assert.equal((await Client.open(daemon.url, socket, { Host: 'beamroom.example' })).status, 403);
    const client = await Client.open(daemon.url, socket);
    assert.equal(client.status, 101);
    client.cut();
    const other = daemon.url.replace('127.0.0.1', 'localhost');
    assert.equal((await call(`${other}/healthz`)).status, 200);
    assert.equal((await call(`${daemon.url}/api/v1/version`)).json.open_to_everybody, false);
  });

  test('says that it is open to everybody, where somebody has it so', async () => {
    const open = await startDaemon({
      args: ['--stub', '--open-to-everybody', '--listen', '0.0.0.0:0', '--public-name', 'beamroom.example'],
    });
    try {
      const url = open.url.replace('0.0.0.0', '127.0.0.1');
      assert.equal((await call(`${url}/api/v1/version`, 'GET', undefined, { Via: '1.1 proxy' })).json.open_to_everybody, true);
      await until(open.log, (log) => /warn.*open to everybody/i.test(log)); // said after "ready"
    } finally {
      await open.stop();
    }
  });
});
