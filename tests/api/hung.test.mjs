// A daemon of which a thread hangs, or which was stopped for a while. Each test waits for many seconds: they are for make test-deep. --stub: grey pictures.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';
import { call, openPlan, sleep, startDaemon, until } from './daemon.mjs';
import { holdThread, threadNamed } from './hold.mjs';
import { FIRST, HOST, open, statuses } from './plain_connection.mjs';
import { startManager } from './service_manager.mjs';
import { Client } from './ws_client.mjs';

describe('connections that are gone while their requests wait', () => {
  test('count until the requests are over', async (t) => {
    const daemon = await startDaemon({ args: ['--stub'] });
    t.after(() => daemon.stop());
    const held = await holdThread(await threadNamed(daemon.child.pid, 'net')); /* the API answers no request */
    if (!held) return void t.skip('a thread of another program may not be stopped here');
    const page = async (from) => {
      const connection = open(daemon.url, `GET /index.html HTTP/1.1\r\n${HOST}Connection: close\r\n\r\n`, { from });
      await connection.answered;
      connection.socket.destroy();
      return statuses(connection.text)[0];
    };
    try {
      const askAndGo = async () => {
        const some = Array.from({ length: 20 }, () => open(daemon.url, FIRST, { from: '127.0.6.1', ms: 60000 }));
        await sleep(100); /* a request that has not arrived by then is not counted; others follow */
        for (const c of some) c.socket.resetAndDestroy();
        return page('127.0.6.1');
      };
      assert.equal(await until(askAndGo, (status) => status === 429), 429);
      assert.equal(await page('127.0.6.2'), 200, 'another address is served');
    } finally {
      await daemon.stop();
    }
  });
});

describe('the process', { concurrency: 4 }, () => {
  for (const thread of ['net', 'front'])
    test(`whose ${thread} thread hangs no longer says that it lives, and ends within 10 s of SIGTERM all the same`, async (t) => {
      const manager = await startManager();
      const daemon = await startDaemon({
        args: ['--stub'],
        env: { NOTIFY_SOCKET: manager.path, WATCHDOG_USEC: '800000' },
      });
      try {
        const held = await holdThread(await threadNamed(daemon.child.pid, thread));
        if (!held) return void t.skip('a thread of another program may not be stopped here');
        await until(daemon.log, (log) => log.includes(`the ${thread} thread has not moved`));
        assert.match(daemon.log(), new RegExp(`the ${thread} thread has not moved`));
        await until(manager.lines, (lines) => lines.includes('READY=1'));
        let n = -1; // datagrams sent before may still arrive
        for (let tries = 0; tries < 8 && n !== manager.lines().length; tries++) {
          n = manager.lines().length;
          await sleep(1600); /* twice the watchdog's time */
        }
        assert.equal(manager.lines().length, n, 'nothing is told any more');
        const began = performance.now();
        assert.equal(await daemon.stop(), 1, 'ended by itself');
        assert.ok(performance.now() - began < 30000, `after ${performance.now() - began} ms`);
        assert.match(daemon.log(), /the process ends without it/);
      } finally {
        await daemon.stop();
        manager.stop();
      }
    });
});

test('a daemon that was stopped for a while finds its renderers alive', async () => {
  const daemon = await startDaemon({ args: ['--stub'] });
  await openPlan(daemon.url, 'phantom');
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const ann = await Client.enter(daemon.url, room);
  try {
    await ann.ready();
    ann.send({ type: 'view.open', view: 1, document: { size_px: [160, 120] } });
    await ann.frame((f) => f.isStill);
    daemon.child.kill('SIGSTOP');
    await sleep(12000); // longer than a renderer may be silent
    daemon.child.kill('SIGCONT');
    ann.send({
      type: 'view.patch',
      view: 1,
      input: 7,
      patch: { camera: { position_mm: [9, -900, 0], target_mm: [0, 0, 0], up: [0, 0, 1] } },
    });
    await ann.frame((f) => f.isStill && f.input === 7);
    assert.doesNotMatch(daemon.log(), /did not|starting it again/);
  } finally {
    ann.cut();
    assert.equal(await daemon.stop(), 0, daemon.log());
  }
});
