// Records of decisions outlive their rooms and plans; a deletion that would take decisions along asks; who is thrown out is told why; a plan
// that was put into a folder is found when it is asked for. --stub: grey pictures.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { cpSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let data, folder, daemon, api;
const clients = [];
before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-records-'));
  folder = mkdtempSync(join(tmpdir(), 'beamroom-plans-'));
  await start();
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const at of [data, folder]) rmSync(at, { recursive: true, force: true });
});
async function start() {
  daemon = await startDaemon({ data, plans: [folder], args: ['--stub'] });
  api = `${daemon.url}/api/v1`;
}

async function enter(room, name) {
  const client = await Client.enter(daemon.url, room, { name });
  clients.push(client);
  return client;
}
let input = 0;
async function put(client, kind, body) {
  client.send({ type: 'item.put', kind, body, input: ++input });
  return (await client.message('item', (m) => m.input === input)).item;
}
/** A room on the plan in which Ann decides and signs. */
async function decided(plan) {
  const room = (await call(`${api}/rooms`, 'POST', { plan })).json.id,
    ann = await enter(room, 'Ann'),
    ben = await enter(room, 'Ben');
  await until(
    () => call(`${api}/rooms/${room}/record`),
    ({ status }) => status === 200,
  );
  await put(ann, 'note', { text: 'Edge?' });
  return {
    room,
    ann,
    ben,
    items: [
      await put(ann, 'decision', { decision: 'accept', text: 'As shown' }),
      await put(ann, 'signature', { name: 'A. Example', meaning: 'reviewed' }),
    ],
  };
}

test('a plan that was put into a folder is opened, and gets a room, before anybody has asked for the list', async () => {
  cpSync(join(demo, 'phantom'), join(folder, 'new-one'), { recursive: true });
  assert.equal((await openPlan(daemon.url, 'new-one')).state, 'done');
  cpSync(join(demo, 'phantom'), join(folder, 'second'), { recursive: true });
  assert.equal((await call(`${api}/rooms`, 'POST', { plan: 'second' })).status, 201);
  assert.equal((await call(`${api}/plans/third`)).status, 404);
  assert.equal((await call(`${api}/rooms`, 'POST', { plan: 'third' })).status, 404);
});

test('a room with a decision is deleted only with the word that its records stay, and they stay', async () => {
  const { room, ann, ben, items } = await decided('new-one');
  const refused = await call(`${api}/rooms/${room}`, 'DELETE', undefined, ann.headers);
  assert.deepEqual([refused.status, refused.json.type, refused.json.code], [409, '/problems/conflict', 'records']);
  assert.match(refused.json.detail, /^2 decisions and signatures were written in this room; their records stay/);
  assert.equal((await call(`${api}/rooms/${room}?records=drop`, 'DELETE', undefined, ann.headers)).status, 422);
  assert.equal((await call(`${api}/rooms/${room}`)).status, 200, 'it is there');
  assert.equal((await call(`${api}/rooms/${room}?records=keep`, 'DELETE', undefined, ann.headers)).status, 204);
  assert.equal((await ben.message('bye')).reason, 'the room was ended by Ann');

  const {
    json: { records },
  } = await call(`${api}/records`);
  assert.deepEqual(
    records.map(({ id, kind, room: of, plan, author_name: name }) => [id, kind, of, plan, name]),
    [
      [items[1].id, 'signature', room, 'new-one', 'Ann'],
      [items[0].id, 'decision', room, 'new-one', 'Ann'],
    ],
  );
  assert.deepEqual(
    (await call(`${api}/records?before=${items[1].id}`)).json.records.map(({ id }) => id),
    [items[0].id],
  );
  const list = (body) => call(`${api}/records/search`, 'POST', body),
    first = (await list({ limit: 1 })).json,
    next = (await list({ limit: 1, before: items[1].id })).json;
  assert.deepEqual([first.records.map(({ id }) => id), first.more], [[items[1].id], true]);
  assert.deepEqual([next.records.map(({ id, decision }) => [id, decision]), next.more], [[[items[0].id, 'accept']], false]);
  assert.deepEqual(
    (await list({ text: 'ann', kind: 'signature' })).json.records.map(({ id }) => id),
    [items[1].id],
  );
  assert.deepEqual((await list({ text: 'nobody' })).json, { records: [], more: false });
  for (const [body, pointer] of [
    [{ limit: 0 }, '/limit'],
    [{ limit: 201 }, '/limit'],
    [{ text: 7 }, '/text'],
    [{ text: 'x'.repeat(201) }, '/text'],
    [{ kind: 'note' }, '/kind'],
    [{ before: '../x' }, '/before'],
    [{ order: 'oldest' }, '/order'],
  ])
    assert.deepEqual(await list(body).then(({ status, json }) => [status, json.pointer]), [422, pointer]);
  const one = await call(`${api}/records/${items[1].id}`);
  assert.deepEqual(one.json.item, items[1]);
  assert.deepEqual(
    [
      one.json.body.format,
      one.json.body.record.decisions[0].id,
      one.json.body.record.notes[0].text,
      one.json.body.record.present.map(({ name }) => name),
    ],
    ['beamroom-kept-record', items[0].id, 'Edge?', ['Ann', 'Ben']],
  );
  assert.ok(one.json.body.scene.regions && Array.isArray(one.json.body.views));
  const begins = ',"body":',
    raw = one.text.trimEnd().slice(one.text.indexOf(`${begins}{"format"`) + begins.length, -1);
  assert.equal(createHash('sha256').update(raw).digest('hex'), one.json.sha256);
  assert.match(one.headers.get('audit-head'), /^\d+ [0-9a-f]{64}$/);
  assert.equal((await call(`${api}/records/i-0000000000`)).status, 404);
});

test('a plan with a decision is deleted only so, its rooms are told by whom, and a room that sleeps counts as well', async () => {
  const archive = join(data, 'plan.tar');
  execFileSync('tar', ['-cf', archive, '-C', join(demo, 'phantom'), '.']);
  const sent = await fetch(`${api}/plans?name=sent`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/octet-stream' },
    body: readFileSync(archive),
  }).then((answer) => answer.json());
  const { plan } = await until(
    async () => (await call(`${api}/jobs/${sent.id}`)).json,
    ({ state }) => state === 'done',
  );
  const { room, items } = await decided(plan);
  await until(
    async () => (await call(`${api}/rooms/${room}/record`)).json.saved.state,
    (state) => state === 'saved',
  );
  for (const client of clients.splice(0)) client.cut();
  await daemon.stop();
  await start(); // the room sleeps
  const other = (await call(`${api}/rooms`, 'POST', { plan })).json.id,
    cem = await enter(other, 'Cem');
  const refused = await call(`${api}/plans/${plan}`, 'DELETE');
  assert.deepEqual([refused.status, refused.json.code], [409, 'records']);
  assert.match(refused.json.detail, /^2 decisions and signatures were written in rooms of this plan/);
  assert.equal((await call(`${api}/rooms/${other}`)).status, 200);
  assert.equal((await call(`${api}/plans/${plan}?records=keep&by=Dr%20Ann`, 'DELETE')).status, 204);
  assert.equal((await cem.message('bye')).reason, 'the plan was deleted by “Dr Ann”');
  assert.equal((await call(`${api}/rooms/${room}`)).status, 404);
  assert.deepEqual((await call(`${api}/records/${items[0].id}`)).json.item, items[0]);
  assert.equal((await call(`${api}/plans/new-one?by=${'x'.repeat(161)}`, 'DELETE')).json.pointer, '/by');
});

test('a search goes on to the oldest record, however many lie between, and says whether there are more', async () => {
  const many = mkdtempSync(join(tmpdir(), 'beamroom-many-'));
  let one = await startDaemon({ data: many, plans: [folder], args: ['--stub'] });
  assert.equal(await one.stop(), 0);
  const sql = `
import sqlite3, sys
db = sqlite3.connect(sys.argv[1])
row = "INSERT INTO records(id, room, plan, kind, author, author_name, time_ms, item, body, hash) "
db.execute(row + """WITH RECURSIVE all_of(n) AS (SELECT 0 UNION ALL SELECT n + 1 FROM all_of WHERE n < 100999)
  SELECT printf('i-%010d', n), 'aaaa-aaaa', 'phantom', 'decision', '', iif(n = 0, 'Oldest Needle', 'Hay'), n, '{}', '{}', '' FROM all_of""")
db.execute("INSERT OR REPLACE INTO record_facts(record, facts) SELECT n, json_object('decision', 'accept', 'label', iif(time_ms = 7, 'a \\\\ b', 'plain')) FROM records")
db.commit()`;
  execFileSync('python3', ['-c', sql, join(many, 'beamroom.db')]);
  one = await startDaemon({ data: many, plans: [folder], args: ['--stub'] });
  const found = async (body) => {
    const { status, json, text } = await call(`${one.url}/api/v1/records/search`, 'POST', body);
    assert.equal(status, 200, text);
    return [json.records.map(({ id }) => Number(id.slice(2))), json.more];
  };
  assert.deepEqual(await found({ text: 'NEEDLE' }), [[0], false]);
  assert.deepEqual(await found({ text: 'a \\ b' }), [[7], false], 'written otherwise in JSON');
  assert.deepEqual(await found({ text: 'hay', limit: 2 }), [[100999, 100998], true]);
  assert.deepEqual(await found({ text: 'hay', limit: 2, before: 'i-0000000003' }), [[2, 1], false]);
  assert.deepEqual(await found({ text: 'no such', kind: 'signature' }), [[], false]);
  const all = await Promise.all(Array.from({ length: 6 }, () => call(`${one.url}/api/v1/records/search`, 'POST', { text: 'needle' })));
  assert.ok(all.some(({ status }) => status === 200));
  for (const { status, json, headers } of all.filter((answer) => answer.status !== 200))
    assert.deepEqual([status, json.type, headers.get('retry-after')], [503, '/problems/busy', '1']);
  assert.equal(await one.stop(), 0);
  rmSync(many, { recursive: true, force: true });
});
