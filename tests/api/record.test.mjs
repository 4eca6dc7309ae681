// The record of a review: revision of the plan's files, checklist, decisions, signatures, who was there, export. --stub: grey pictures.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { cpSync, mkdtempSync, readFileSync, readdirSync, rmSync, utimesSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, relative } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let data, plans, daemon, room, ann, ben, eve;
const clients = [];
const api = (path, method, body, headers) => call(`${daemon.url}/api/v1/rooms/${room}${path}`, method, body, headers);
let input = 0;

async function enter(hello) {
  const client = await Client.enter(daemon.url, room, hello);
  clients.push(client);
  return client;
}
/** Sends a command; resolves with the item, or the problem. */
async function give(client, message) {
  const own = ++input;
  client.send({ ...message, input: own });
  return client
    .until(() => client.messages.find((m) => (m.type === 'item' || m.type === 'problem') && m.input === own), 'an answer')
    .then((m) => m.item ?? m.problem);
}
const put = (client, kind, body, of = {}) => give(client, { type: 'item.put', kind, body, ...of });

/** The revision by its definition in proto/http.json, with node's own SHA-256. */
const filesOf = (at) =>
  readdirSync(at, { withFileTypes: true })
    .filter(({ name }) => !name.startsWith('.'))
    .flatMap((entry) => (entry.isDirectory() ? filesOf(join(at, entry.name)) : [join(at, entry.name)]));
function revisionOf(folder) {
  const sha = (bytes) => createHash('sha256').update(bytes).digest('hex');
  const lines = filesOf(folder)
    .map((file) => [Buffer.from(relative(folder, file)), file])
    .sort(([a], [b]) => Buffer.compare(a, b));
  return sha(lines.map(([name, file]) => `${sha(readFileSync(file))}  ${name}\n`).join(''));
}
const revision = () =>
  until(
    () => call(`${daemon.url}/api/v1/plans/phantom/revision`),
    ({ status }) => status === 200,
  ).then(({ json }) => json);
const record = async (query = '') =>
  (
    await until(
      () => api(`/record${query}`),
      ({ status }) => status !== 503,
    )
  ).json;

before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-record-'));
  plans = mkdtempSync(join(tmpdir(), 'beamroom-plans-'));
  cpSync(join(demo, 'phantom'), join(plans, 'phantom'), { recursive: true });
  daemon = await startDaemon({ data, plans: [plans], args: ['--stub'] });
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  ann = await enter({ name: 'Ann' });
  ben = await enter({ name: 'Ben' });
  const link = (await api('/links', 'POST', { role: 'observer' }, ann.headers)).json;
  eve = await enter({ name: 'Eve', link: link.token });
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const folder of [data, plans]) rmSync(folder, { recursive: true, force: true });
});

test('the revision is a digest of names and contents, whatever the times of the files', async () => {
  const folder = join(plans, 'phantom');
  assert.equal((await put(ann, 'check', { entry: 'registration', text: 'x', state: 'ok' })).type, '/problems/busy');
  const found = await revision();
  assert.equal(found.revision, revisionOf(folder));
  assert.equal(found.n_files, filesOf(folder).length);
  utimesSync(join(folder, 'plan.json'), new Date(0), new Date(0));
  assert.equal((await revision()).revision, found.revision);
  assert.equal((await call(`${daemon.url}/api/v1/plans/nowhere/revision`)).status, 404);
});

test('entries are marked by reviewers, each once, in their newest version', async () => {
  const entry = { entry: 'registration', text: 'Plan and side', state: 'ok', comment: '' };
  const first = await put(ben, 'check', entry);
  assert.deepEqual([first.body.state, first.body.role, first.body.plan_revision], ['ok', 'reviewer', revisionOf(join(plans, 'phantom'))]);
  assert.equal((await put(ann, 'check', entry)).type, '/problems/conflict');
  const changed = await put(ann, 'check', { ...entry, state: 'issue', comment: 'Left, not right' }, { item: first.id, version: 1 });
  assert.deepEqual([changed.version, changed.changed_name, changed.body.role], [2, 'Ann', 'presenter']);
  assert.equal((await put(ben, 'check', entry, { item: first.id, version: 1 })).type, '/problems/conflict');
  assert.equal((await put(ben, 'check', { ...entry, entry: 'beam' }, { item: first.id, version: 2 })).pointer, '/body/entry');
  assert.equal((await put(ben, 'check', { ...entry, entry: 'beam', state: 'fine' })).pointer, '/body/state');
  assert.equal((await put(ben, 'check', { ...entry, entry: 'beam', text: 'x'.repeat(201) })).pointer, '/body/text');
  assert.equal((await put(ben, 'check', { ...entry, entry: 'beam', comment: 'x'.repeat(2001) })).pointer, '/body/comment');
  assert.equal((await put(eve, 'check', { ...entry, entry: 'beam' })).code, 'role');
  assert.equal((await put(ben, 'check', { entry: '', text: 'Own entry', state: 'open' })).body.text, 'Own entry');
});

test('decisions and signatures are only added to, and corrected by new ones', async () => {
  assert.equal((await put(ben, 'decision', { decision: 'accept' })).code, 'role');
  assert.equal((await put(ann, 'decision', { decision: 'maybe' })).pointer, '/body/decision');
  const first = await put(ann, 'decision', { decision: 'accept', text: 'As shown' });
  assert.equal(first.body.decision, 'accept');
  for (const refused of [
    await put(ann, 'decision', { decision: 'reject' }, { item: first.id, version: 1 }),
    await give(ann, { type: 'item.delete', item: first.id }),
  ])
    assert.deepEqual([refused.type, refused.code], ['/problems/forbidden', 'append-only']);
  assert.equal((await put(ann, 'decision', { decision: 'defer', corrects: 'i-0000000000' })).pointer, '/body/corrects');
  assert.equal(
    (await put(ann, 'decision', { decision: 'defer', text: 'Wait for the blood sample', corrects: first.id })).body.corrects,
    first.id,
  );

  const line = await put(ben, 'signature', { name: 'B. Example', meaning: 'reviewed' });
  assert.deepEqual([line.body.name, line.body.role, line.author_name], ['B. Example', 'reviewer', 'Ben']);
  assert.equal((await put(eve, 'signature', { name: 'Eve', meaning: 'seen' })).code, 'role');
  assert.equal((await put(ben, 'signature', { name: '', meaning: 'seen' })).pointer, '/body/name');
  for (const client of [ann, ben]) assert.equal((await give(client, { type: 'item.delete', item: line.id })).code, 'append-only');
});

test('the record holds it all as its schema says, and its export is in the audit', async () => {
  await put(ben, 'note', { text: 'Edge?', anchor: { point_mm: [1, -2.5, 3] } });
  const found = await record('?export=true');
  const schema = JSON.parse(readFileSync(new URL('../../proto/record.json', import.meta.url), 'utf8'));
  assert.deepEqual(faults(schema, found), []);
  assert.deepEqual(faults(schema, { ...found, extra: 1 }), ['/extra is not in the schema']);
  assert.deepEqual(faults(schema, { ...found, plan_revision: 'x' }), ['/plan_revision: x']);
  assert.equal(found.plan_revision, revisionOf(join(plans, 'phantom')));
  assert.deepEqual(
    found.present.map(({ name, role, here, left_ms: left }) => [name, role, here, left]),
    [
      ['Ann', 'presenter', true, null],
      ['Ben', 'reviewer', true, null],
      ['Eve', 'observer', true, null],
    ],
  );
  assert.deepEqual(
    found.checklist.map(({ entry, state }) => [entry, state]),
    [
      ['registration', 'issue'],
      ['', 'open'],
    ],
  );
  assert.deepEqual(
    found.decisions.map(({ decision }) => decision),
    ['accept', 'defer'],
  );
  assert.deepEqual(
    found.signatures.map(({ name, meaning }) => [name, meaning]),
    [['B. Example', 'reviewed']],
  );
  assert.deepEqual(
    found.notes.map(({ text, anchor }) => [text, anchor.point_mm]),
    [['Edge?', [1, -2.5, 3]]],
  );
  const later = await until(
    () => record(),
    ({ audit }) => audit.rows > found.audit.rows && audit.n_waiting === 0,
  );
  assert.notEqual(later.audit.head, found.audit.head);
  assert.equal((await api('/record?export=perhaps')).json.pointer, '/export');
});

test('when the files change, earlier lines stand under the earlier revision, and stay', async () => {
  const before = (await record()).checklist.find(({ entry }) => entry === 'registration');
  const file = join(plans, 'phantom', 'README.txt');
  writeFileSync(file, `${readFileSync(file, 'utf8')}\nchanged`);
  await call(`${daemon.url}/api/v1/plans`); // has the folders listed
  const now = revisionOf(join(plans, 'phantom'));
  await until(revision, ({ revision: found }) => found === now);
  const again = await put(ben, 'check', { entry: 'registration', text: 'Plan and side', state: 'ok' });
  assert.equal(again.body.plan_revision, now);
  const old = await put(
    ben,
    'check',
    { entry: 'registration', text: 'Plan and side', state: 'ok' },
    { item: before.id, version: before.version },
  );
  assert.deepEqual([old.type, old.code], ['/problems/forbidden', 'append-only']);
  const both = (await record()).checklist.filter(({ entry }) => entry === 'registration').map(({ plan_revision: of }) => of);
  assert.deepEqual(both, [before.plan_revision, now]);
});

test('it is there after the daemon was killed, with who was there', async () => {
  const before = await record();
  ben.cut();
  await until(record, ({ present }) => !present.find(({ name }) => name === 'Ben').here);
  await until(
    () => record(),
    ({ audit }) => audit.n_waiting === 0,
  );
  await until(
    () => call(`${daemon.url}/api/v1/rooms/${room}/record`),
    ({ json }) => json.present[1].left_ms > 0,
  );
  await daemon.stop();
  daemon = await startDaemon({ data, plans: [plans], args: ['--stub'] });
  const after = await record();
  for (const part of ['checklist', 'decisions', 'signatures', 'notes']) assert.deepEqual(after[part], before[part]);
  assert.deepEqual(
    after.present.map(({ name, here }) => [name, here]),
    [
      ['Ann', false],
      ['Ben', false],
      ['Eve', false],
    ],
  );
  assert.ok(after.present[1].left_ms >= after.present[1].entered_ms);
});

/** Faults of a value against a JSON schema with the words that proto/record.json uses. */
function faults(schema, value, at = '') {
  const types = [schema.type ?? []].flat();
  const type = value === null ? 'null' : Array.isArray(value) ? 'array' : Number.isInteger(value) ? 'integer' : typeof value;
  if (types.length && !types.includes(type) && !(type === 'integer' && types.includes('number'))) return [`${at} is ${type}`];
  if ('const' in schema && value !== schema.const) return [`${at}: ${value}`];
  if (schema.enum && !schema.enum.includes(value)) return [`${at}: ${value}`];
  if (schema.pattern && !new RegExp(schema.pattern).test(value)) return [`${at}: ${value}`];
  if (schema.minimum !== undefined && value < schema.minimum) return [`${at}: ${value}`];
  if (type === 'array') return value.flatMap((entry, i) => faults(schema.items ?? {}, entry, `${at}/${i}`));
  if (type !== 'object') return [];
  const missing = (schema.required ?? []).filter((name) => !(name in value)).map((name) => `${at}/${name} is missing`);
  return [
    ...missing,
    ...Object.entries(value).flatMap(([name, part]) =>
      schema.properties?.[name]
        ? faults(schema.properties[name], part, `${at}/${name}`)
        : schema.additionalProperties === false
          ? [`${at}/${name} is not in the schema`]
          : [],
    ),
  ];
}
