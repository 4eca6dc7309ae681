// A disk that gives nothing for a while: who comes back into a room that sleeps waits, and is let in. One thread of the daemon, that of the store, is
// stopped as a debugger does it; skipped where that is not allowed. --stub: grey pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, sleep, startDaemon } from './daemon.mjs';
import { holdThread } from './hold.mjs';
import { Client } from './ws_client.mjs';

const helloMs = 5000; // WS_HELLO_WITHIN_S: the daemon does not wait longer for a hello

/** Bytes that each thread has written. */
const written = (pid) =>
  new Map(
    readdirSync(`/proc/${pid}/task`).map((tid) => [
      tid,
      Number(/^wchar: (\d+)/m.exec(readFileSync(`/proc/${pid}/task/${tid}/io`, 'utf8'))[1]),
    ]),
  );

const enter = (daemon, room, hello) => Client.hello(daemon.url, room, hello);

test('who comes back while the disk is slow to give the room is let in, and is not told to say hello', { timeout: 180000 }, async (t) => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-slow-'));
  let daemon = await startDaemon({ data, args: ['--stub'] });
  t.after(async () => {
    await daemon.stop();
    rmSync(data, { recursive: true, force: true });
  });
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const ann = await enter(daemon, room, { name: 'Ann' });
  const { member, secret } = await ann.message('welcome');
  await ann.message('saved', ({ state }) => state === 'saved');
  ann.cut();
  await daemon.stop();
  daemon = await startDaemon({ data, args: ['--stub'] });
  const before = written(daemon.child.pid);
  const other = await enter(daemon, (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id, { name: 'Ben' });
  await other.message('saved', ({ state }) => state === 'saved');
  const database = ([tid, bytes]) => bytes - (before.get(tid) ?? 0);
  const [[tid]] = [...written(daemon.child.pid)].sort((a, b) => database(b) - database(a)); // rooms are larger than what is said about them
  const held = await holdThread(tid);
  if (!held) return void t.skip('a thread of another program may not be stopped here');
  const back = await enter(daemon, room, { member, secret });
  await sleep(helloMs + 1500);
  assert.deepEqual(back.messages, []);
  held.release();
  assert.equal((await back.until(() => back.messages[0], 'an answer')).type, 'welcome');
  assert.equal(back.messages[0].member, member);
  back.cut();
  other.cut();
});
