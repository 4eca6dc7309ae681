// Notes outlive the daemon: written, changed, answered, deleted, then the daemon is killed at once and started again.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const script = `
import json, sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print(json.dumps([json.loads(body) for body, in db.execute('SELECT body FROM items WHERE room = ?', (sys.argv[2],))]))
`;
const onDisk = (room, data) => JSON.parse(execFileSync('python3', ['-c', script, join(data, 'beamroom.db'), room], { encoding: 'utf8' }));

const enter = (daemon, room, hello) => Client.enter(daemon.url, room, hello);

let nInputs = 0;
async function put(client, body, more = {}) {
  const input = ++nInputs;
  client.send({ type: 'item.put', kind: 'note', body, input, ...more });
  return (await client.message('item', (message) => message.input === input)).item;
}

test('notes and replies are there after the daemon was killed, deleted ones are not, and their author still changes them', {
  timeout: 120000,
}, async (t) => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-notes-'));
  let daemon = await startDaemon({ data, args: ['--stub'] });
  t.after(async () => {
    await daemon.stop();
    rmSync(data, { recursive: true, force: true });
  });
  await until(
    async () => (await call(`${daemon.url}/api/v1/plans`)).json.plans,
    (plans) => plans.length === 1 && plans[0].parts.length,
  );
  await openPlan(daemon.url, 'phantom');
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const [ann, ben] = [await enter(daemon, room, { name: 'Ann' }), await enter(daemon, room, { name: 'Ben' })];
  const note = await put(ben, { text: 'Edge? 🧠', anchor: { point_mm: [1, 2, 3], region: 'brain' } });
  const changed = await put(ben, { ...note.body, text: 'Rim?' }, { item: note.id, version: 1 });
  await put(ann, { text: 'yes', parent: note.id });
  const gone = await put(ann, { text: 'gone' });
  ann.send({ type: 'item.delete', item: gone.id });
  await ben.message('item', ({ id, item }) => id === gone.id && item === null);
  const before = (await call(`${daemon.url}/api/v1/rooms/${room}/notes`)).json;
  assert.equal(before.notes.length, 2);
  await until(
    () => onDisk(room, data),
    (rows) => rows.length === 2 && rows.some(({ version }) => version === 2) && rows.some(({ body }) => body.text === 'yes'),
  );
  const killed = new Promise((done) => {
    daemon.child.on('exit', done);
  });
  daemon.child.kill('SIGKILL');
  await killed;

  daemon = await startDaemon({ data, args: ['--stub'] });
  const again = await enter(daemon, room, { member: ben.welcome.member, secret: ben.welcome.secret });
  assert.equal(again.welcome.member, ben.welcome.member);
  assert.deepEqual(again.welcome.items, before.notes);
  assert.deepEqual((await call(`${daemon.url}/api/v1/rooms/${room}/notes`)).json, before);
  assert.equal((await put(again, { ...changed.body, resolved: true }, { item: note.id, version: 2 })).version, 3);
  const late = await enter(daemon, room, { name: 'Cem' });
  assert.ok(![ann.welcome.member, ben.welcome.member].includes(late.welcome.member), 'nobody else becomes the author of what is kept');
  for (const client of [ann, ben, again, late]) client.cut();
});
