// The audit: what members and calls do is a row each, chained by SHA-256, which node computes here by itself. --stub: grey pictures.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, startDaemon, until } from './daemon.mjs';
import { parseStrict } from './strict_json.mjs';
import { Client } from './ws_client.mjs';

let data, daemon, room;
const clients = [];
const database = () => join(data, 'beamroom.db');

const read = `
import json, sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print(json.dumps(db.execute('SELECT n, row, hash FROM audit ORDER BY n').fetchall()))
`;
/** [{n, ...the row, text, hash}] */
const onDisk = (file = database()) =>
  JSON.parse(execFileSync('python3', ['-c', read, file], { encoding: 'utf8' })).map(([, text, hash]) => ({
    ...parseStrict(text),
    text,
    hash,
  }));
const change = (file, sql) =>
  execFileSync('python3', [
    '-c',
    'import sqlite3, sys; db = sqlite3.connect(sys.argv[1]); db.executescript(sys.argv[2]); db.commit()',
    file,
    sql,
  ]);
const verify = (file, ...args) => spawnSync(join(bin, 'beamroomd'), ['--verify-audit', file, ...args], { encoding: 'utf8' });
const sha256 = (text) => createHash('sha256').update(text).digest('hex');
/** Rows do not name plans, whose ids may be made of a patient's name. */
const planKey = `plan-${sha256('phantom').slice(0, 16)}`;
const rowWith = (action, matches = () => true) =>
  until(
    () => onDisk().find((row) => row.action === action && matches(row)),
    (row) => row,
  );

async function enter(hello = {}) {
  const client = await Client.enter(daemon.url, room, hello);
  clients.push(client);
  return client;
}

before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-audit-'));
  daemon = await startDaemon({ data, args: ['--stub'] });
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  rmSync(data, { recursive: true, force: true });
});

test('what members and calls do is on the disk, who did it, and at which revision', async () => {
  const api = `${daemon.url}/api/v1/rooms/${room}`;
  const ann = await enter({ name: 'Ann' });
  await ann.message('renderer', (m) => m.state === 'ready');
  const opened = await rowWith('open');
  assert.deepEqual(
    [opened.room, opened.plan, opened.member, opened.name, opened.role, opened.result, opened.detail],
    [room, planKey, 'm1', 'Ann', 'presenter', 'done', { as: 'new' }],
  );
  assert.ok(Math.abs(opened.time_ms - Date.now()) < 120000);

  const link = (await call(`${api}/links`, 'POST', { role: 'observer', one_use: true }, ann.headers)).json;
  const made = await rowWith('link-made');
  assert.match(made.detail.link, /^[0-9a-f]{8}$/);
  assert.deepEqual(
    [made.member, made.address, made.detail],
    ['m1', '127.0.0.1', { link: made.detail.link, role: 'observer', expires_s: 86400, one_use: true }],
  );
  const eve = await enter({ name: 'Eve', link: link.token });
  const used = await rowWith('link');
  assert.deepEqual([used.name, used.address, used.detail.link], ['Eve', '127.0.0.1', made.detail.link]);
  assert.ok(!JSON.stringify(onDisk()).includes(link.token));

  eve.send({ type: 'scene.patch', input: 1, patch: {} });
  const refused = await rowWith('refused');
  assert.deepEqual([refused.member, refused.role, refused.result, refused.detail.what], ['m2', 'observer', 'refused', 'scene.patch']);
  await call(`${api}/links`, 'POST', { role: 'presenter' }, eve.headers);
  assert.equal((await rowWith('refused', ({ detail }) => /^POST /.test(detail.what))).member, 'm2');

  ann.send({ type: 'recording.start' });
  const running = await rowWith('recording');
  assert.deepEqual([running.member, running.detail.state], ['m1', 'running']);
  ann.send({ type: 'recording.stop' });
  assert.equal((await rowWith('recording', ({ detail }) => detail.state === 'stopped')).member, 'm1');
  assert.equal((await call(`${api}/recordings/${running.detail.id}`, 'DELETE', undefined, ann.headers)).status, 204);
  assert.equal((await rowWith('recording', ({ detail }) => detail.state === 'deleted' && detail.id === running.detail.id)).member, 'm1');

  ann.send({ type: 'scene.patch', input: 7, patch: { dose: { blood_ppm: 33 } } });
  const { revision } = await ann.message('scene', (m) => m.input === 7);
  const weighed = await rowWith('weights');
  assert.deepEqual([weighed.detail, weighed.revision_before, weighed.revision_after], [{ blood_ppm: 33 }, revision - 1, revision]);
  ann.send({ type: 'scene.patch', input: 8, patch: { beam: { draft: { enabled: true, line: { target_mm: [0, 0, 20] } } } } });
  assert.deepEqual((await rowWith('draft-made')).detail.target_mm, [0, 0, 20]);

  assert.equal((await call(`${api}/snapshot?view=${encodeURIComponent('{"kind":"axial"}')}`, 'GET', undefined, eve.headers)).status, 200);
  const picture = await rowWith('export');
  const [n, hash] = (await call(`${api}/snapshot?view=${encodeURIComponent('{"kind":"axial"}')}`, 'GET', undefined, eve.headers)).headers
    .get('audit-head')
    .split(' ');
  assert.equal(onDisk()[Number(n) - 1].hash, hash, 'what is exported carries the newest row on the disk');
  assert.deepEqual([picture.member, picture.room, picture.detail.what], ['m2', room, 'snapshot']);
  assert.equal((await call(`${daemon.url}/api/v1/plans/phantom/render`, 'POST', {})).status, 200);
  const outside = await rowWith('export', (row) => row.room === '');
  assert.deepEqual([outside.plan, outside.member, outside.detail.what], [planKey, '', 'picture']);
});

test('calls that differ are rows of their own: a link for presenters between two for observers', async () => {
  const api = `${daemon.url}/api/v1/rooms/${room}`;
  const ann = await enter({ name: 'Ada', member: clients[0].welcome.member, secret: clients[0].welcome.secret });
  const before = onDisk().filter(({ action }) => action === 'link-made').length;
  const roles = ['observer', 'presenter', 'observer'];
  for (const role of roles) assert.equal((await call(`${api}/links`, 'POST', { role }, ann.headers)).status, 201);
  const rows = await until(
    () =>
      onDisk()
        .filter(({ action }) => action === 'link-made')
        .slice(before),
    ({ length }) => length >= roles.length,
  );
  assert.deepEqual(
    rows.map(({ detail }) => detail.role),
    roles,
  );
  assert.equal(new Set(rows.map(({ detail }) => detail.link)).size, roles.length);
});

test('what was put, decided and signed is compared with its rows', async () => {
  const ann = await enter({ name: 'Ada', member: clients[0].welcome.member, secret: clients[0].welcome.secret });
  await until(
    () => call(`${daemon.url}/api/v1/plans/phantom/revision`),
    ({ status }) => status === 200,
  );
  await until(
    () => call(`${daemon.url}/api/v1/rooms/${room}/record`),
    ({ status }) => status === 200,
  );
  let input = 100;
  const put = async (kind, body) => {
    ann.send({ type: 'item.put', kind, body, input: ++input });
    return (await ann.message('item', (m) => m.input === input)).item;
  };
  const note = await put('note', { text: 'Edge?' }),
    gone = await put('note', { text: 'Wrong' });
  const decision = await put('decision', { decision: 'accept', text: 'As shown' });
  await put('signature', { name: 'A. Example', meaning: 'reviewed' });
  ann.send({ type: 'item.delete', item: gone.id, input: ++input });
  await ann.message('item', (m) => m.input === input);
  await rowWith('note', ({ detail }) => detail.deleted);
  assert.equal(verify(database()).status, 0, 'while the daemon runs');
  const row = await rowWith('decision');
  assert.equal(row.detail.sha256, createHash('sha256').update(JSON.stringify(decision)).digest('hex'));
  const copy = join(data, 'items.db');
  const said = (sql) => {
    spawnSync(join(bin, 'beamroomd'), ['--backup', copy, '--data', data]);
    change(copy, sql);
    return verify(copy).stderr;
  };
  assert.match(
    said("UPDATE items SET body = replace(body, 'As shown', 'Not so') WHERE kind = 'decision'"),
    new RegExp(`decision ${decision.id} of room ${room} is not what row ${row.n} says`),
  );
  assert.match(
    said("UPDATE items SET body = replace(body, 'Edge', 'Side')"),
    new RegExp(`note ${note.id} of room ${room} is not what row \\d+ says`),
  );
  assert.match(
    said("DELETE FROM items WHERE kind = 'note'"),
    new RegExp(`note ${note.id} of room ${room}, which row \\d+ put, is not in the database any more`),
  );
  assert.match(
    said(
      "INSERT INTO items SELECT room, 'i-0123456789', kind, version, author, author_name, created_ms, changed_ms, body FROM items WHERE kind = 'signature'",
    ),
    /signature i-0123456789 of room .* stands in no row/,
  );
  assert.match(
    said(
      `INSERT INTO items SELECT room, '${gone.id}', kind, version, author, author_name, created_ms, changed_ms, body FROM items WHERE kind = 'note'`,
    ),
    new RegExp(`note ${gone.id} of room .* is there, and row \\d+ deleted it`),
  );
  assert.match(said("DROP TRIGGER records_update; UPDATE records SET body = '{}'"), /the record of decision .* is not what row \d+ says/);
  assert.match(
    said("DROP TRIGGER records_delete; DELETE FROM records WHERE kind = 'decision'"),
    new RegExp(`decision ${decision.id} of room ${room}, which row ${row.n} put, is not in the database any more`),
  );
});

test('what the page makes by itself is recorded before it is made: who, what, its name, and the revision of the files', async () => {
  const api = `${daemon.url}/api/v1/rooms/${room}`;
  const eve = await enter({ name: 'Eva' });
  const told = (body, headers = eve.headers, of = api) => call(`${of}/exports`, 'POST', body, headers);
  const {
    json: { revision },
  } = await until(
    () => call(`${daemon.url}/api/v1/plans/phantom/revision`),
    ({ status }) => status === 200,
  );
  const kinds = ['dvh', 'profile', 'limits', 'probes', 'methods', 'beam', 'beam-card', 'notes', 'printed-report', 'printed-record'];
  for (const what of kinds) assert.equal((await told({ what, name: `phantom-${what}.csv` })).status, 204, what);
  assert.equal((await told({ what: 'dvh', name: 'phantom-dvh.json' })).status, 204);
  assert.equal((await told({ what: 'dvh', name: `${'Ä'.repeat(99)}.c` }, {})).status, 204); // 200 bytes, of nobody in the room
  const rows = await until(
    () => onDisk().filter(({ action, detail }) => action === 'export' && detail.name_sha256),
    (list) => list.length >= kinds.length + 2,
  );
  assert.deepEqual(
    rows.map(({ detail }) => detail),
    [
      ...kinds.map((what) => ({ what, name_sha256: sha256(`phantom-${what}.csv`), plan_revision: revision })),
      { what: 'dvh', name_sha256: sha256('phantom-dvh.json'), plan_revision: revision },
      { what: 'dvh', name_sha256: sha256(`${'Ä'.repeat(99)}.c`), plan_revision: revision },
    ],
  );
  for (const row of rows.slice(0, -1))
    assert.deepEqual([row.room, row.plan, row.member, row.name, row.result], [room, planKey, eve.welcome.member, 'Eva', 'done']);
  assert.equal(rows.at(-1).member, '');

  for (const [body, pointer] of [
    [{ name: 'a.csv' }, '/what'],
    [{ what: 'plan', name: 'a.csv' }, '/what'],
    [{ what: 7, name: 'a.csv' }, '/what'],
    [{ what: 'dvh' }, '/name'],
    [{ what: 'dvh', name: '' }, '/name'],
    [{ what: 'dvh', name: 'Ä'.repeat(101) }, '/name'],
    [{ what: 'dvh', name: 'a\nb' }, '/name'],
    [{ what: 'dvh', name: 'a.csv', member: 'm1' }, '/member'],
  ]) {
    const { status, json } = await told(body);
    assert.deepEqual([status, json.pointer], [422, pointer], JSON.stringify(body));
  }
  const gone = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  assert.equal((await call(`${daemon.url}/api/v1/rooms/${gone}`, 'DELETE')).status, 204);
  const ofGone = `${daemon.url}/api/v1/rooms/${gone}`;
  assert.equal((await told({ what: 'dvh', name: 'a.csv' }, {}, ofGone)).status, 404);
  assert.equal((await told({ what: 'notes', name: 'notes.txt' }, {}, ofGone)).status, 204);
  assert.deepEqual((await rowWith('export', (row) => row.room === gone)).detail, { what: 'notes', name_sha256: sha256('notes.txt') });
});

test('equal pictures and openings are a row at once and one a minute, or at the end', async () => {
  const n = onDisk().filter(({ action, detail }) => action === 'open' && detail.what === 'plan').length;
  for (let i = 0; i < 5; i++) assert.equal((await call(`${daemon.url}/api/v1/plans/phantom/open`, 'POST')).status, 202);
  const opened = await rowWith('open', ({ detail, room }) => detail.what === 'plan' && !room);
  assert.deepEqual([opened.plan, opened.source, opened.detail], [planKey, 'machine', { what: 'plan' }]);
  assert.equal(n, 0);
  assert.equal(onDisk().filter(({ action, detail }) => action === 'open' && detail.what === 'plan').length, 1);
});

test('the rows of a room outlive it, and a killed daemon', async () => {
  const other = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  assert.equal((await call(`${daemon.url}/api/v1/rooms/${other}`, 'DELETE')).status, 204);
  await rowWith('deleted', (row) => row.room === other);
  const before = onDisk().length;
  const ended = new Promise((done) => daemon.child.on('exit', done));
  daemon.child.kill('SIGKILL');
  await ended;
  assert.equal(onDisk().length, before);
  daemon = await startDaemon({ data, args: ['--stub'] });
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  await enter({ name: 'Ben' });
  await rowWith('open', (row) => row.name === 'Ben');
  for (let i = 0; i < 3; i++) assert.equal((await call(`${daemon.url}/api/v1/plans/phantom/open`, 'POST')).status, 202);
  await daemon.stop();
  const last = onDisk().filter(({ action, detail }) => action === 'open' && detail.what === 'plan');
  assert.deepEqual([last.length, last.at(-1).detail.times], [3, 2], 'what was gathered is written at the end');
  const [, n, hash] = daemon.log().match(/audit: (\d+) rows, head ([0-9a-f]{64})(?![\s\S]*audit: )/);
  assert.deepEqual([Number(n), hash], [onDisk().length, onDisk().at(-1).hash], 'the log has the newest row');
  daemon = null;
});

test('the chain is what SHA-256 gives, and beamroomd verifies it', () => {
  const rows = onDisk();
  let hash = '0'.repeat(64);
  for (const [i, row] of rows.entries()) {
    assert.equal(row.n, i + 1);
    hash = createHash('sha256')
      .update(hash + row.text)
      .digest('hex');
    assert.equal(row.hash, hash);
  }
  const { status, stdout } = verify(database(), '--audit-head', rows[2].hash);
  assert.equal(status, 0);
  const time = (row) => new Date(row.time_ms).toISOString().replace(/\.\d+Z/, 'Z');
  assert.equal(stdout, `rows ${rows.length}\nfirst ${time(rows[0])}\nlast ${time(rows.at(-1))}\nitems 5\nhead ${hash}\n`);
});

test('GET /audit gives the rows of the disk, page by page, filtered, and as lines that are checked', async () => {
  daemon = await startDaemon({ data, args: ['--stub'] });
  const get = async (query = '') => (await call(`${daemon.url}/api/v1/audit${query}`)).json;
  const rows = onDisk().reverse(),
    bare = ({ text: _, hash, ...row }) => ({ ...row, sha256: hash });
  assert.deepEqual(await get('?limit=1000'), { rows: rows.map(bare), next: null });

  const paged = [];
  for (let page = { next: '' }; page.next !== null; paged.push(...page.rows))
    page = await get(`?limit=7${page.next && `&cursor=${page.next}`}`);
  assert.deepEqual(paged, rows.map(bare));

  const from = rows[9].time_ms,
    to = rows[4].time_ms,
    kept = (keep) => rows.filter(keep).map(bare);
  assert.deepEqual(
    (await get(`?from=${from}&to=${to}`)).rows,
    kept(({ time_ms }) => time_ms >= from && time_ms <= to),
  );
  assert.deepEqual(
    (await get(`?action=link&plan=phantom&room=${rows.at(-1).room}`)).rows,
    kept((row) => row.action === 'link' && row.room === rows.at(-1).room),
  );
  assert.deepEqual((await get('?plan=phantom')).rows, (await get(`?plan=${planKey}`)).rows);
  assert.deepEqual((await get('?plan=other')).rows, []);
  for (const [query, pointer] of [
    ['limit=0', '/limit'],
    ['limit=1001', '/limit'],
    ['limit=1.5', '/limit'],
    ['from=x', '/from'],
    ['cursor=0', '/cursor'],
    ['format=csv', '/format'],
    [`plan=${'a'.repeat(64)}`, '/plan'],
  ]) {
    const { status, json } = await call(`${daemon.url}/api/v1/audit?${query}`);
    assert.deepEqual([status, json.pointer], [422, pointer], query);
  }

  const file = join(data, 'rows.ndjson');
  let lines = '';
  for (let cursor = ''; cursor !== null; ) {
    const response = await fetch(`${daemon.url}/api/v1/audit?format=ndjson&limit=9${cursor && `&cursor=${cursor}`}`);
    cursor = response.headers.get('audit-next');
    lines += await response.text();
  }
  writeFileSync(file, lines);
  const { stdout, stderr } = verify(file, '--audit-head', rows[0].hash);
  assert.equal(stderr, '');
  assert.match(stdout, new RegExp(`^rows ${rows.length}\n.*\n.*\ngaps 0\nhead ${rows[0].hash}\n$`));
  await rowWith('export', (row) => row.detail.what === 'audit');

  const said = (text) => {
    writeFileSync(file, text);
    const { status, stdout, stderr } = verify(file);
    assert.deepEqual([status, stdout], [1, '']);
    return stderr;
  };
  const list = lines.trimEnd().split('\n');
  assert.match(said(lines.replace('"Ann"', '"Eve"')), /line \d+: row \d+ does not fit: its hash is/);
  assert.match(said(`${lines}{"n":1}\n`), new RegExp(`line ${list.length + 1} is no row of the audit`));
  const forged = JSON.parse(list[3]);
  forged.before = 'a'.repeat(64);
  const text = list[3].slice(list[3].indexOf('"row":') + 6, -1);
  const hash = createHash('sha256')
    .update(forged.before + text)
    .digest('hex');
  const line = `{"before":"${forged.before}","sha256":"${hash}","row":${text}}`;
  assert.match(said([...list.slice(0, 3), line, ...list.slice(4)].join('\n')), /line 4: row \d+ and row \d+ are no chain/);
  writeFileSync(file, [...list.slice(0, 2), ...list.slice(5)].join('\n'));
  assert.match(verify(file).stdout, /gaps 1\n/);
  await daemon.stop();
  daemon = null;
});

test('a row that was changed, a cut tail and a wrong hash are named', () => {
  const rows = onDisk(),
    copy = join(data, 'copy.db');
  const copied = (sql) => {
    copyFileSync(database(), copy);
    change(copy, `DROP TRIGGER audit_update; DROP TRIGGER audit_delete; ${sql}`);
    return copy;
  };
  const said = (...args) => {
    const { status, stdout, stderr } = verify(...args);
    assert.deepEqual([status, stdout], [1, '']);
    return stderr;
  };
  assert.match(
    said(copied("UPDATE audit SET row = replace(row, 'Ann', 'Eve') WHERE n = 1")),
    /--verify-audit .*copy\.db: row 1 does not fit/,
  );
  assert.match(said(copied('DELETE FROM audit WHERE n = 3')), /row 3 is missing: row 4 follows row 2/);
  const cut = copied('DELETE FROM audit WHERE n > 3');
  assert.match(said(cut), new RegExp(`rows 4 to ${rows.length} were removed at the end`));
  assert.match(said(copied('DELETE FROM audit')), new RegExp(`rows 1 to ${rows.length} were removed at the end`));
  assert.match(said(copied('DROP TABLE audit')), /the table of the audit was removed/);
  assert.match(said(cut, '--audit-head', 'abc'), /expected 64 digits/);
  assert.match(said(join(data, 'nowhere.db')), /No such file/);
});
