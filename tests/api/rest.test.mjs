// Wake-ups of a daemon at rest, also with TLS at its port. --stub: grey pictures. The long run has more rooms, and members in them.
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import assert from 'node:assert/strict';
import { makeCertificate } from './certificates.mjs';
import { call, sleep, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const isLong = !!process.env.LONG_TESTS,
  nRooms = isLong ? 80 : 20,
  nMembers = 20,
  quietMs = isLong ? 3000 : 1500;
/** How often each thread of a process has gone to sleep: once for each time that it was woken up, however busy the machine is. */
function sleeps(pid) {
  const of = {};
  for (const task of readdirSync(`/proc/${pid}/task`)) {
    const status = readFileSync(`/proc/${pid}/task/${task}/status`, 'utf8');
    of[task] = Number(/^voluntary_ctxt_switches:\s+(\d+)/m.exec(status)[1]);
  }
  return of;
}

/** Wake-ups of each thread within so many milliseconds, the most first. */
async function wakeUps(pid, ms) {
  const before = sleeps(pid);
  await sleep(ms);
  const after = sleeps(pid);
  return Object.keys(after)
    .map((task) => after[task] - (before[task] ?? 0))
    .sort((a, b) => b - a);
}

for (const isSecure of [false, true])
  describe(isSecure ? 'with TLS' : 'without TLS', () => {
    const rooms = [],
      clients = [];
    let daemon, folder;
    before(async () => {
      if (isSecure) folder = mkdtempSync(join(tmpdir(), 'beamroom-rest-'));
      const { cert, key } = isSecure ? makeCertificate(folder, 'rest.example') : {};
      daemon = await startDaemon({ args: ['--stub', ...(isSecure ? ['--tls-cert', cert, '--tls-key', key] : [])] });
    });
    after(async () => {
      for (const client of clients) client.cut();
      assert.equal(await daemon.stop(), 0, daemon.log());
      if (folder) rmSync(folder, { recursive: true });
    });

    test('rooms at rest wake nothing up, however many there are', async () => {
      for (let n = 0; n < nRooms; n++) rooms.push((await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id);
      // Once nothing was asked for 5 s, all threads sleep but the one that measures the cache of a running renderer, once a second.
      await sleep(4000);
      await until(
        () => wakeUps(daemon.child.pid, quietMs),
        ([quota, ...others]) => quota <= quietMs / 1000 + 1 && others.every((n) => n === 0),
      );
    });

    if (isLong)
      test('members that keep still wake one thread up, with TLS two, for their pongs', async () => {
        for (const room of rooms.slice(0, nMembers)) {
          const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
          clients.push(client);
          client.send({ type: 'hello', protocol: 2 });
          await client.message('welcome');
          client.send({ type: 'view.open', view: 1, document: { size_px: [160, 120] } });
          await client.frame((f) => f.isStill);
        }
        // Within 6 s there are at most two rounds of pings, each one wake-up and one for each member's pong.
        // With TLS its thread passes each ping and each pong on.
        const most = [2 * (2 * nMembers + 2), 2 * (nMembers + 2)].slice(isSecure ? 0 : 1);
        await until(
          () => wakeUps(daemon.child.pid, 6000),
          (found) => most.every((n, i) => found[i] <= n) && found[most.length] <= 7 && found.slice(most.length + 1).every((n) => n === 0),
        );
      });
  });
