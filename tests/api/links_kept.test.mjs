// Links of a room outlive the daemon and the room's sleep, with their role, their time and who has used them. --stub: grey pictures.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { onDisk } from './on_disk.mjs';
import { Client } from './ws_client.mjs';

let data, daemon;
const clients = [];
const start = async (args = []) => {
  daemon = await startDaemon({ data, args: ['--stub', ...args] });
};
async function end(signal) {
  const ended = new Promise((done) => {
    daemon.child.on('exit', done);
  });
  daemon.child.kill(signal);
  await ended;
}
before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-links-'));
  await start();
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon.stop();
  rmSync(data, { recursive: true, force: true });
});

const api = (path, method, body, { member, secret } = {}) =>
  call(`${daemon.url}/api/v1/rooms${path}`, method, body, member && { 'Beamroom-Member': `${member} ${secret}` });
const newRoom = async () => (await api('', 'POST', { plan: 'phantom' })).json.id;
const newLink = async (room, wanted, by) => (await api(`/${room}/links`, 'POST', wanted, by)).json.token;
/** Enters and gives the welcome with the member's role, or the bye. */
async function enter(room, hello = {}) {
  const client = await Client.hello(daemon.url, room, hello);
  clients.push(client);
  const first = await client.until(() => client.messages.find(({ type }) => type === 'welcome' || type === 'bye'), 'welcome or bye');
  if (first.type === 'welcome') first.role = (await client.message('members')).members.find(({ id }) => id === first.member).role;
  return Object.assign(first, { client });
}
/** Lets every link of this role expire while no daemon runs, as time would. */
const expire = (role) =>
  execFileSync('python3', [
    '-c',
    `import sqlite3, sys
db = sqlite3.connect(sys.argv[1])
assert db.execute('UPDATE links SET expires_ms = 1000 WHERE role = ?', (sys.argv[2],)).rowcount > 0
db.commit()`,
    join(data, 'beamroom.db'),
    role,
  ]);

test('after the daemon was killed a link lets people in with its role; a used and an expired one do not', async () => {
  const room = await newRoom(),
    ann = await enter(room);
  assert.equal(ann.role, 'presenter');
  const [many, one, late] = [
    await newLink(room, { role: 'observer' }, ann),
    await newLink(room, { role: 'reviewer', one_use: true }, ann),
    await newLink(room, { role: 'presenter' }, ann),
  ];
  assert.equal((await enter(room, { link: one, person: 'ben-browser' })).role, 'reviewer');
  const kept = await until(
    () => onDisk(room, data),
    (row) => row?.links.length === 3 && row.links.some(({ used }) => used),
  );
  for (const token of [many, one, late]) assert.ok(!JSON.stringify(kept).includes(token), 'a token is kept as a hash alone');
  await end('SIGKILL');
  expire('presenter');

  await start();
  const refused = await api(`/${room}/links`, 'POST', { role: 'presenter' });
  assert.deepEqual([refused.status, refused.json.code], [403, 'role'], 'nobody has become a presenter by the restart');
  assert.equal((await api(`/${room}/scene`, 'PATCH', { axes: { visible: false } })).status, 403);
  const stranger = await enter(room);
  assert.equal(stranger.role, 'reviewer', 'the first stranger in a woken room');
  assert.equal((await enter(room, { link: many })).role, 'observer');
  assert.match((await enter(room, { link: one, person: 'another' })).reason, /has been used/);
  assert.equal((await enter(room, { link: one, person: 'ben-browser' })).role, 'reviewer');
  assert.match((await enter(room, { link: late })).reason, /has expired/);
  assert.match((await enter(room, { link: 'f'.repeat(32) })).reason, /not one of this room/);
  const back = await enter(room, { member: ann.member, secret: ann.secret });
  assert.equal(back.role, 'presenter');
  assert.match(await newLink(room, { role: 'observer' }, back), /^[0-9a-f]{32}$/);
});

test('a room that nobody has entered yet sleeps with its links and is there for who comes by one', async () => {
  await end('SIGTERM');
  await start(['--room-idle-close', '1']);
  const room = await newRoom(),
    token = await newLink(room, { role: 'reviewer' });
  await until(
    () => api(''),
    ({ json }) => json.rooms.find(({ id }) => id === room)?.asleep,
  );
  assert.equal((await enter(room, { link: token })).role, 'reviewer');
});
