// Rooms outlive the daemon: killed at once and started again, put to sleep and woken, deleted, backed up. --stub: grey pictures.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import {
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  renameSync,
  rmdirSync,
  rmSync,
  statSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, startDaemon, until } from './daemon.mjs';
import { onDisk } from './on_disk.mjs';
import { Client } from './ws_client.mjs';

let data;
const running = new Set(),
  clients = new Set();
before(() => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-kept-'));
});
after(async () => {
  for (const client of clients) client.cut();
  for (const daemon of running) await daemon.stop();
  rmSync(data, { recursive: true, force: true });
});

async function start(args = [], folder = data) {
  const daemon = await startDaemon({ data: folder, args: ['--stub', ...args] });
  daemon.api = `${daemon.url}/api/v1`;
  running.add(daemon);
  return daemon;
}
async function end(daemon, signal) {
  running.delete(daemon);
  if (!signal) return assert.equal(await daemon.stop(), 0, daemon.log());
  const ended = new Promise((done) => daemon.child.on('exit', done));
  daemon.child.kill(signal);
  await ended;
}
async function enter(daemon, room, hello = {}) {
  const client = await Client.enter(daemon.url, room, hello);
  clients.add(client);
  return client;
}
const ready = (client) => client.message('renderer', (m) => m.state === 'ready');
const newRoom = async (daemon) => (await call(`${daemon.api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
const rooms = async (daemon) => (await call(`${daemon.api}/rooms`)).json;
async function patch(client, center) {
  client.send({ type: 'scene.patch', input: center, patch: { image: { window: { center } } } });
  return client.message('scene', (m) => m.input === center);
}
test('rooms, scenes, revisions, shared views and members are back after the daemon was killed', async () => {
  let daemon = await start();
  const [one, two] = [await newRoom(daemon), await newRoom(daemon)];
  const ann = await enter(daemon, one, { name: 'Ann' });
  await ready(ann);
  const ben = await enter(daemon, one, { name: 'Ben' });
  const before = (await call(`${daemon.api}/rooms/${one}/members`)).json.members;
  assert.deepEqual(
    before.map((member) => [member.name, member.role]),
    [
      ['Ann', 'presenter'],
      ['Ben', 'reviewer'],
    ],
  );
  const cem = await enter(daemon, two);
  await ready(cem);
  ann.send({ type: 'view.open', view: 1, document: { kind: 'axial', size_px: [320, 240], camera: { height_mm: 123 } }, follow: true });
  await ann.frame(() => true);
  await patch(ann, 70);
  const last = await patch(ann, 71);
  const other = await patch(cem, 33);
  await until(
    () => onDisk(one, data),
    (room) => room?.revision === last.revision && room.members.length === 2 && room.views.length === 1,
  );
  await until(
    () => onDisk(two, data),
    (room) => room?.revision === other.revision,
  );
  const kept = JSON.stringify(onDisk(one, data));
  for (const secret of [ann.welcome.secret, ben.welcome.secret]) assert.ok(!kept.includes(secret), 'a secret is kept as a hash alone');
  await end(daemon, 'SIGKILL');

  daemon = await start();
  const list = await rooms(daemon);
  assert.deepEqual(list.rooms.map((room) => room.id).sort(), [one, two].sort());
  assert.ok(
    list.rooms.every((room) => room.asleep && room.plan === 'phantom'),
    JSON.stringify(list),
  );
  assert.equal(list.n_asleep, 2);

  const again = await enter(daemon, one, { member: ann.welcome.member, secret: ann.welcome.secret });
  assert.equal(again.welcome.member, ann.welcome.member);
  assert.equal(again.welcome.secret, ann.welcome.secret);
  assert.equal(again.welcome.name, 'Ann');
  const members = (await again.message('members')).members;
  assert.deepEqual(
    members.map(({ id, name, role, color, connected, presenting }) => ({ id, name, role, color, connected, presenting })),
    before.map(({ id, name, role, color, presenting }) => ({ id, name, role, color, presenting, connected: id === ann.welcome.member })),
  );
  await ready(again);
  const scene = await call(`${daemon.api}/rooms/${one}/scene`);
  assert.equal(scene.json.image.window.center, 71);
  assert.equal(scene.headers.get('etag'), `"${last.revision}"`);

  const stranger = await enter(daemon, one, { member: ben.welcome.member, secret: 'f'.repeat(32), name: 'Not Ben' });
  assert.notEqual(stranger.welcome.member, ben.welcome.member, 'a wrong secret makes a new member');
  stranger.send({ type: 'view.open', view: 1, document: { kind: 'axial', size_px: [200, 200] }, follow: true });
  const view = await stranger.message('view');
  assert.equal(view.document.camera.height_mm, 123, 'the shared view is what it was');

  const woken = await call(`${daemon.api}/rooms/${two}`);
  assert.equal(woken.json.revision, other.revision);
  assert.equal(woken.json.asleep, false);
  assert.equal(
    (
      await until(
        () => call(`${daemon.api}/rooms/${two}/scene`),
        ({ status }) => status !== 503,
      )
    ).json.image.window.center,
    33,
    'it wakes for who asks, too',
  );
  await end(daemon);
});

test('while the database cannot be opened at the start no room is said to be gone; it is there as soon as it can', async () => {
  const folder = join(data, 'later'),
    database = join(folder, 'beamroom.db');
  let daemon = await start([], folder);
  const room = await newRoom(daemon);
  const ann = await enter(daemon, room);
  await ready(ann);
  const { revision } = await patch(ann, 12);
  ann.send({ type: 'item.put', kind: 'bookmark', body: { name: 'One' }, input: 5 });
  const { token } = (await ann.message('item', (m) => m.input === 5)).item.body;
  await end(daemon);
  renameSync(database, `${database}.away`);
  mkdirSync(database);
  daemon = await start([], folder);
  for (const [path, method, body] of [
    [`/rooms/${room}`],
    [`/rooms/${room}/scene`],
    [`/rooms/${room}`, 'DELETE'],
    ['/rooms', 'POST', { saved: token }],
  ]) {
    const { status, json, headers } = await call(`${daemon.api}${path}`, method, body);
    assert.deepEqual([status, json.type, headers.get('retry-after')], [503, '/problems/busy', '1'], `${method ?? 'GET'} ${path}`);
  }
  assert.equal((await fetch(`${daemon.url}/p/${token}`, { redirect: 'manual' })).status, 503);
  const early = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
  const bye = await early.message('bye');
  assert.deepEqual([bye.reason, bye.retry_ms], ["the rooms on the server's disk cannot be read yet", 1000]);
  early.cut();
  rmdirSync(database);
  renameSync(`${database}.away`, database);
  assert.equal(
    (
      await until(
        () => call(`${daemon.api}/rooms/${room}`),
        ({ status }) => status === 200,
      )
    ).json.revision,
    revision,
  );
  assert.equal((await enter(daemon, room, { member: ann.welcome.member, secret: ann.welcome.secret })).welcome.member, ann.welcome.member);
  assert.equal((await call(`${daemon.api}/rooms/none`)).status, 404);
  await end(daemon);
});

test('an orderly stop keeps the last change, too', async () => {
  const folder = join(data, 'stop');
  let daemon = await start([], folder);
  const room = await newRoom(daemon);
  const ann = await enter(daemon, room);
  await ready(ann);
  let last;
  for (let n = 1; n <= 20; n++) last = await patch(ann, n);
  await end(daemon);
  assert.equal(onDisk(room, folder).revision, last.revision);
  daemon = await start([], folder);
  const back = await enter(daemon, room);
  await ready(back);
  assert.equal((await call(`${daemon.api}/rooms/${room}/scene`)).json.image.window.center, 20);
  await end(daemon);
});

test('an idle room that people changed sleeps and wakes; one that nobody entered or changed is closed; a deleted one is gone', async () => {
  const folder = join(data, 'idle');
  const daemon = await start(['--room-idle-close', '2'], folder);
  const used = await newRoom(daemon),
    ann = await enter(daemon, used);
  const deleted = await newRoom(daemon),
    ben = await enter(daemon, deleted);
  const unused = await newRoom(daemon);
  const lookedAt = await newRoom(daemon),
    cia = await enter(daemon, lookedAt);
  for (const client of [ann, ben, cia]) await ready(client);
  const { revision } = await patch(ann, 44);
  await patch(ben, 45);
  cia.send({ type: 'view.open', view: 1, document: { size_px: [64, 48] } });
  await cia.frame(() => true);
  cia.send({ type: 'view.patch', view: 1, input: 1, patch: { eye: [0, -500, 0] } }); // looking is no change
  assert.ok((await rooms(daemon)).rooms.some(({ id }) => id === lookedAt));
  for (const client of [ann, ben, cia]) client.cut();
  await until(
    () => rooms(daemon),
    (list) => !list.rooms.some(({ id }) => id === lookedAt),
  );
  await until(
    () => rooms(daemon),
    (list) => list.n_asleep === 2 && list.rooms.length === 2,
  );
  for (const id of [unused, lookedAt])
    await until(
      () => onDisk(id, folder),
      (row) => row === null,
    );
  assert.equal((await call(`${daemon.api}/rooms/${deleted}`, 'DELETE')).status, 204);
  assert.equal((await call(`${daemon.api}/rooms/${deleted}`)).status, 404);
  assert.equal((await call(`${daemon.api}/rooms/${unused}`)).status, 404);
  const back = await enter(daemon, used, { member: ann.welcome.member, secret: ann.welcome.secret });
  assert.equal(back.welcome.member, ann.welcome.member);
  assert.equal(back.welcome.revision, revision);
  await until(
    () => onDisk(deleted, folder),
    (row) => row === null,
  );
  await end(daemon);
});

test('a name is kept, told to members, listed awake and asleep, and in the audit; a room without a change outlives a restart until it is idle', async () => {
  const folder = join(data, 'named');
  let daemon = await start([], folder);
  const [named, other] = [await newRoom(daemon), await newRoom(daemon)];
  const ann = await enter(daemon, named, { name: 'Ann' }),
    ben = await enter(daemon, other, { name: 'Ben' });
  const give = (name, id = named) => call(`${daemon.api}/rooms/${id}`, 'PATCH', { name });
  assert.equal((await call(`${daemon.api}/rooms/${named}`)).json.name, '');
  const given = await give('Second look · 2 Ω');
  assert.equal(given.json.name, 'Second look · 2 Ω', given.text);
  assert.equal((await ann.message('room')).name, 'Second look · 2 Ω');
  for (const [body, code, pointer] of [
    [{}, 'required', '/name'],
    [{ name: '' }, 'length', '/name'],
    [{ name: 'x'.repeat(81) }, 'length', '/name'],
    [{ name: 'two\nlines' }, 'pattern', '/name'],
    [{ name: 7 }, 'type', '/name'],
    [{ plan: 'phantom' }, 'unknown-field', '/'],
  ]) {
    const { status, json } = await call(`${daemon.api}/rooms/${named}`, 'PATCH', body);
    assert.deepEqual([status, json.code, json.pointer], [422, code, pointer], JSON.stringify(json));
  }
  assert.equal((await give('No', 'no-such-room')).status, 404);
  ann.send({ type: 'item.put', input: 1, kind: 'note', body: { text: 'look' } });
  await ann.message('item');
  await until(
    () => onDisk(named, folder),
    (row) => row?.name === 'Second look · 2 Ω',
  );
  await until(
    () => onDisk(other, folder),
    (row) => row !== null,
  );
  for (const client of [ann, ben]) client.cut();
  await end(daemon);
  daemon = await start([], folder);
  const [row, ...rest] = (await rooms(daemon)).rooms;
  assert.deepEqual(rest, [], 'a room without a change is not listed while nobody is in it');
  assert.deepEqual(
    [row.id, row.name, row.asleep, row.n_notes, row.were_in, row.is_mine],
    [named, 'Second look · 2 Ω', true, 1, ['Ann'], true],
  );
  assert.ok(Math.abs(Date.now() - row.used_ms) < 60_000);
  const back = await enter(daemon, other, { member: ben.welcome.member, secret: ben.welcome.secret });
  assert.equal(back.welcome.member, ben.welcome.member, 'who was there comes back');
  const again = await enter(daemon, named);
  assert.equal((await again.message('room')).name, 'Second look · 2 Ω');
  assert.equal((await give(null)).json.name, '');
  assert.equal((await again.message('room', ({ name }) => name === '')).name, '');
  const audit = await until(
    () => call(`${daemon.api}/audit?action=renamed`),
    ({ json }) => json.rows.length === 2,
  );
  assert.deepEqual(audit.json.rows.map(({ room, detail }) => [room, detail]).reverse(), [
    [named, { from: '', to: 'Second look · 2 Ω' }],
    [named, { from: 'Second look · 2 Ω', to: '' }],
  ]);
  for (const client of [back, again]) client.cut();
  await end(daemon);
  daemon = await start(['--room-idle-close', '1'], folder);
  await until(
    () => onDisk(other, folder),
    (gone) => gone === null,
  );
  assert.notEqual(onDisk(named, folder), null);
  await end(daemon);
});

test('while all rooms are in use no other wakes; an empty one makes place', async () => {
  const folder = join(data, 'most');
  let daemon = await start([], folder);
  const ids = [await newRoom(daemon), await newRoom(daemon)];
  for (const id of ids) {
    await call(`${daemon.api}/rooms/${id}`, 'PATCH', { name: 'kept' });
    (await enter(daemon, id)).cut();
  }
  await until(
    () => ids.map((id) => onDisk(id, folder)?.members.length),
    (n) => n.every((members) => members === 1),
  );
  await end(daemon);
  daemon = await start(['--max-rooms', '1'], folder);
  const ann = await enter(daemon, ids[0]);
  const refused = await call(`${daemon.api}/rooms/${ids[1]}`);
  assert.equal(refused.status, 429, refused.text);
  assert.match(refused.json.detail, /1 rooms in use, at most 1/);
  ann.cut();
  assert.equal(
    (
      await until(
        () => call(`${daemon.api}/rooms/${ids[1]}`),
        ({ status }) => status !== 429,
      )
    ).status,
    200,
  );
  assert.equal((await rooms(daemon)).rooms.find((room) => room.id === ids[0]).asleep, true);
  await end(daemon);
});

test('a backup is made while the daemon writes, and a daemon starts from it', async () => {
  const folder = join(data, 'backup'),
    other = mkdtempSync(join(data, 'restored-'));
  let daemon = await start([], folder);
  const room = await newRoom(daemon),
    ann = await enter(daemon, room);
  await ready(ann);
  const { revision } = await patch(ann, 12);
  await until(
    () => onDisk(room, folder),
    (row) => row?.revision === revision,
  );
  const run = (file, from = folder) => spawnSync(join(bin, 'beamroomd'), ['--backup', file, '--data', from], { encoding: 'utf8' });
  const made = run(join(other, 'beamroom.db'));
  assert.equal(made.status, 0, made.stderr);
  assert.equal(statSync(join(other, 'beamroom.db')).mode & 0o077, 0, 'nobody else reads it');
  assert.deepEqual(readdirSync(other), ['beamroom.db']);
  await patch(ann, 13);
  await end(daemon);
  daemon = await start([], other);
  const back = await enter(daemon, room);
  assert.equal(back.welcome.revision, revision);
  await end(daemon);
  const nothing = run(join(other, 'none'), join(data, 'nowhere'));
  assert.equal(nothing.status, 1);
  assert.match(nothing.stderr, /--backup .*none: .*nowhere\/beamroom\.db: No such file/);
  assert.ok(!existsSync(join(other, 'none')));
});

test('a second daemon on the same folder is refused by name, and a killed one leaves no lock', async () => {
  const folder = mkdtempSync(join(data, 'twice-'));
  let daemon = await start([], folder);
  const room = await newRoom(daemon),
    ann = await enter(daemon, room);
  await ready(ann);
  await assert.rejects(
    start([], folder),
    (error) =>
      error.message.includes('beamroomd ended with 1') && error.message.includes(`--data ${folder}: another beamroomd uses this folder`),
  );
  symlinkSync(folder, `${folder}-too`);
  await assert.rejects(start([], `${folder}-too`), /another beamroomd uses this folder/);
  const { revision } = await patch(ann, 55);
  await until(
    () => onDisk(room, folder),
    (row) => row?.revision === revision,
  );
  await end(daemon, 'SIGKILL');
  daemon = await start([], folder);
  assert.equal((await enter(daemon, room)).welcome.revision, revision);
  await end(daemon);
});

test('a damaged database is moved aside, and the daemon starts', async () => {
  const folder = mkdtempSync(join(data, 'damaged-'));
  writeFileSync(join(folder, 'beamroom.db'), 'this is no database'.repeat(1000));
  const daemon = await start([], folder);
  assert.deepEqual((await rooms(daemon)).rooms, []);
  assert.match(daemon.log(), /beamroom\.db was damaged; it lies aside as .*beamroom\.db\.damaged-\d{8}-\d{6}, and a new one was begun/);
  assert.equal(readdirSync(folder).filter((name) => /^beamroom\.db\.damaged-/.test(name)).length, 1);
  const ann = await enter(daemon, await newRoom(daemon));
  assert.equal(ann.welcome.plan_id, 'phantom');
  await end(daemon);
});
