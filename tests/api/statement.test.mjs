// A statement of whom a plan is of kept, for every room, over a restart, until it is withdrawn or the files change. Made-up DICOM; nobody's data.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { chmodSync, mkdtempSync, readdirSync, readFileSync, realpathSync, rmSync, writeFileSync } from 'node:fs';
import { request } from 'node:http';
import { tmpdir, userInfo } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { FullDisk } from './full_disk.mjs';
import { holdThread, threadNamed } from './hold.mjs';
import { putDose, putWhole } from './made_dicom.mjs';
import { Client } from './ws_client.mjs';

const quirin = { id: '77-30419', name: 'Zweifel^Quirin', birthDate: '19610412' };
const asWritten = { ...quirin, birthDate: '19610421' }; // the same ID, another birth date: files of two patients
const nobody = { id: '', name: '', birthDate: '' };
const ottilie = { name: 'Morgen^Ottilie', id: '88-50327', birth_date: '1955-07-23' };
const secrets = ['Morgen', 'Ottilie', '88-50327', '50327', '19550723', '1955-07-23'];

let plans, data, daemon, api;
const clients = [];
const start = async () => {
  daemon = await startDaemon({ plans: [plans], data });
  api = `${daemon.url}/api/v1`;
};
before(async () => {
  plans = mkdtempSync(join(tmpdir(), 'beamroom-statement-'));
  data = mkdtempSync(join(tmpdir(), 'beamroom-statement-data-'));
  putWhole(join(plans, 'case-1'), quirin);
  putDose(join(plans, 'case-1'), asWritten, { uid: '1.2.89', file: 'other.dcm', plan: '1.2.71' });
  putWhole(join(plans, 'nameless'), nobody);
  await start();
  for (const plan of ['case-1', 'nameless']) assert.equal((await openPlan(daemon.url, plan)).state, 'done', daemon.log());
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const folder of [plans, data]) rmSync(folder, { recursive: true, force: true });
});

const document = async (plan) => (await call(`${api}/plans/${plan}`)).json;
const loaded = (plan, suits) =>
  until(
    () => document(plan),
    (now) => now.state === 'ready' && suits(now),
  ); // prettier-ignore
/** Until the revision of the files is known. */
const state = (plan, body, query = '', headers = {}) =>
  until(
    () => call(`${api}/plans/${plan}/statement${query}`, 'POST', body, headers),
    ({ status }) => status !== 503,
  );
const audit = async (what) =>
  until(
    async () =>
      (await call(`${api}/audit?action=statement`)).json.rows.filter(
        (row) => JSON.stringify(row).includes(`"${what}\\`) || row.detail?.what === what,
      ),
    (rows) => rows.length > 0,
  );
const otherDose = ({ doses }) => doses.find(({ name, id }) => /other/i.test(name + id)) ?? doses[1];
/** Whether the dose of the other patient counts: its pair with the image in fits. */
const relation = (plan) => plan.fits.find((fit) => fit.thing === `dose:${otherDose(plan).id}` && fit.with.startsWith('image:')).relation;
const one = { kind: 'one-person', words: 'The birth date was typed wrong at the scanner' };

test('files of two patients are used together once a person has stated that they are one, in every room, and over a restart', async () => {
  const before = await document('case-1');
  assert.equal(before.statement, null);
  assert.equal(relation(before), 'patient');
  const [room, second] = await Promise.all([0, 1].map(async () => (await call(`${api}/rooms`, 'POST', { plan: 'case-1' })).json.id));
  const [ann, ben] = [await Client.enter(daemon.url, room, { name: 'Ann' }), await Client.enter(daemon.url, second, { name: 'Ben' })];
  clients.push(ann, ben);
  const told = await state('case-1', one, `?room=${room}`, ann.headers);
  assert.equal(told.status, 204, told.text);
  for (const client of [ann, ben]) await client.message('plan', ({ plan }) => plan.statement?.state === 'used');
  const now = await loaded('case-1', ({ statement }) => statement);
  assert.deepEqual(
    [now.statement.kind, now.statement.state, now.statement.by, now.statement.words],
    ['one-person', 'used', 'Ann', one.words],
  );
  assert.equal(relation(now), 'same');
  assert.equal(now.patients.length, 2); // who compares them still sees both
  assert.equal(otherDose(now).patient, now.shown_patient);
  assert.match(JSON.stringify(now.report), /Ann has stated that they are of one person/);
  const [row] = await audit('made');
  assert.deepEqual(
    [row.action, row.name, row.detail.kind, /^[0-9a-f]{64}$/.test(row.detail.revision)],
    ['statement', 'Ann', 'one-person', true],
  );
  for (const client of clients.splice(0)) client.cut();
  await daemon.stop();
  await start();
  assert.equal((await openPlan(daemon.url, 'case-1')).state, 'done', daemon.log());
  const again = await loaded('case-1', ({ statement }) => statement);
  assert.deepEqual([again.statement, relation(again)], [now.statement, 'same']);
});

test('it is withdrawn by a person, and by itself when the files change', async () => {
  assert.equal((await call(`${api}/plans/case-1/statement`, 'DELETE')).status, 204);
  assert.equal(relation(await loaded('case-1', ({ statement }) => statement === null)), 'patient');
  assert.equal((await call(`${api}/plans/case-1/statement`, 'DELETE')).status, 404);
  assert.equal((await state('case-1', one)).status, 204);
  await loaded('case-1', ({ statement }) => statement?.state === 'used');
  putDose(join(plans, 'case-1'), asWritten, { uid: '1.2.90', file: 'third.dcm', plan: '1.2.71' });
  assert.equal((await call(`${api}/plans/case-1/close`, 'POST', {})).status, 204);
  assert.equal((await openPlan(daemon.url, 'case-1')).state, 'done');
  const changed = await loaded('case-1', ({ statement }) => statement);
  assert.deepEqual([changed.statement.state, relation(changed)], ['outdated', 'patient']);
  await audit('outdated');
  rmSync(join(plans, 'case-1', 'third.dcm')); // the files of then: what was withdrawn stays so
  assert.equal((await call(`${api}/plans/case-1/close`, 'POST', {})).status, 204);
  assert.equal((await openPlan(daemon.url, 'case-1')).state, 'done');
  assert.equal((await loaded('case-1', ({ statement }) => statement)).statement.state, 'outdated');
});

test('who the patient is that the files do not name is stated, told in full by /identity alone, and the files win', async () => {
  await openPlan(daemon.url, 'nameless');
  const before = await document('nameless');
  assert.deepEqual([before.patients, before.is_phantom], [[], false]);
  const told = await state('nameless', { kind: 'identity', ...ottilie });
  assert.equal(told.status, 204, told.text);
  const now = await loaded('nameless', ({ statement }) => statement);
  assert.deepEqual(
    [now.statement.kind, now.statement.state, now.patients[0].masked, now.shown_patient],
    ['identity', 'used', 'O. M. …327', 0],
  );
  const full = (await call(`${api}/plans/nameless/identity`)).json.patients;
  assert.deepEqual(
    full.map(({ name, id, birth_date }) => ({ name, id, birth_date })),
    [ottilie],
  ); // prettier-ignore
  const { by, time_ms } = now.statement;
  const listed = async () => {
    const { patient, stated } = (await call(`${api}/plans`)).json.plans.find(({ id }) => id === 'nameless');
    return [patient, stated];
  };
  const asStated = ['O. M. …327', { by, time_ms }];
  assert.deepEqual(await listed(), asStated);
  assert.equal((await call(`${api}/plans/nameless/close`, 'POST', {})).status, 204);
  assert.deepEqual(await listed(), asStated); // as it was read last
  assert.deepEqual(
    (await call(`${api}/plans/search`, 'POST', { text: 'o. m.' })).json.plans.map(({ id, stated }) => [id, stated]),
    [['nameless', { by, time_ms }]],
  );
  assert.equal((await call(`${api}/plans/nameless/statement`, 'DELETE')).status, 204); // while nobody has it open
  assert.deepEqual(await listed(), ['', null]);
  assert.equal((await openPlan(daemon.url, 'nameless')).state, 'done');
  assert.equal((await state('nameless', { kind: 'identity', ...ottilie })).status, 204);
  await loaded('nameless', ({ statement }) => statement?.state === 'used');
  assert.equal((await listed())[0], 'O. M. …327');
  const rows = await audit('made');
  for (const text of [JSON.stringify(now), JSON.stringify(rows), daemon.log(), JSON.stringify((await call(`${api}/plans`)).json)])
    for (const secret of secrets) assert.ok(!text.includes(secret), secret);
  putWhole(join(plans, 'nameless'), quirin);
  assert.equal((await call(`${api}/plans/nameless/close`, 'POST', {})).status, 204);
  assert.equal((await openPlan(daemon.url, 'nameless')).state, 'done');
  const named = await loaded('nameless', ({ statement }) => statement);
  assert.equal(named.statement.state, 'contradicted');
  await until(listed, ([patient, stated]) => patient === 'Q. Z. …419' && stated === null);
  assert.deepEqual(
    named.patients.map(({ masked }) => masked),
    ['Q. Z. …419'],
  ); // prettier-ignore
  assert.ok(named.report.lines.some(({ severity, code }) => severity === 'error' && code === 'patient.stated-differs'));
});

test('a decision keeps who stated whom the plan is of, its paper says so, and erasing the plan takes the statement, not the record', async () => {
  putWhole(join(plans, 'stated'), nobody);
  await openPlan(daemon.url, 'stated');
  const room = (await call(`${api}/rooms`, 'POST', { plan: 'stated' })).json.id;
  const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.push(ann);
  assert.equal((await state('stated', { kind: 'identity', ...ottilie }, `?room=${room}`, ann.headers)).status, 204);
  await loaded('stated', ({ statement }) => statement?.state === 'used');
  await until(
    () => call(`${api}/rooms/${room}/record`),
    ({ status }) => status === 200,
  );
  ann.send({ type: 'item.put', kind: 'decision', body: { decision: 'accept', text: '' }, input: 1 });
  const { item } = await ann.message('item', (m) => m.input === 1, 0, 60000);
  const at = `${api}/records/${item.id}`;
  const kept = (
    await until(
      () => call(at),
      ({ status, json }) => status === 200 && json.body?.kept,
    )
  ).json.body.kept;
  assert.deepEqual([kept.plan.statement.kind, kept.plan.statement.by], ['identity', 'Ann']);
  const captions = kept.figures.map(({ caption }) => caption.map(({ text }) => text));
  assert.ok(captions.length > 0);
  for (const texts of captions) {
    const at = texts.indexOf('O. M. …327');
    assert.match(texts[at + 1], /^stated by Ann, \d+ \w+ 20\d\d UTC$/, texts.join());
  }
  const says = /^stated by Ann, \d+ \w+ 20\d\d, \d\d:\d\d$/;
  const [masked] = (await call(`${at}/paper`)).json.identity.fields;
  assert.equal(masked.text, 'O. M. …327');
  assert.match(masked.more, says);
  const named = await call(`${at}/paper?identity=true`);
  assert.equal(named.json.identity.fields[0].text, ottilie.name, named.text);
  assert.match(named.json.identity.fields[0].more, says);
  const gone = await call(`${api}/plans/stated/erase`, 'POST', { reason: 'asked for by the patient' });
  assert.ok([200, 202, 204].includes(gone.status), gone.text);
  assert.equal((await call(`${api}/plans/stated/statement`, 'DELETE')).status, 404);
  const left = await call(at);
  assert.equal(left.json.body.erased, true, left.text);
  for (const secret of [...secrets, 'O. M.']) assert.ok(!left.text.includes(secret), secret);
});

const reopen = async (plan) => {
  assert.equal((await call(`${api}/plans/${plan}/close`, 'POST', {})).status, 204);
  assert.equal((await openPlan(daemon.url, plan)).state, 'done', daemon.log());
};

test('it counts for the patients alone that its author had before them', async () => {
  putWhole(join(plans, 'swapped'), quirin);
  putDose(join(plans, 'swapped'), asWritten, { uid: '1.2.89', file: 'other.dcm', plan: '1.2.71' });
  await openPlan(daemon.url, 'swapped'); // in no room: nobody looks at the files
  const stranger = { id: ottilie.id, name: ottilie.name, birthDate: '19550723' };
  putDose(join(plans, 'swapped'), stranger, { uid: '1.2.89', file: 'other.dcm', plan: '1.2.71' });
  assert.equal((await state('swapped', one)).status, 204);
  const read = await loaded('swapped', ({ statement }) => statement);
  assert.deepEqual([read.patients.map(({ masked }) => masked), read.statement.state], [['Q. Z. …419', 'O. M. …327'], 'outdated']);
  assert.equal((await state('swapped', one)).status, 204); // now that they are seen
  await loaded('swapped', ({ statement }) => statement.state === 'used');
});

test('files that cannot be read for a while withdraw nothing', async () => {
  const noise = join(plans, 'swapped', 'noise.txt');
  writeFileSync(noise, 'x');
  chmodSync(noise, 0); // no part of the plan: it opens all the same
  await reopen('swapped');
  const unread = await loaded('swapped', ({ statement }) => statement);
  assert.deepEqual([unread.statement.state, relation(unread)], ['unread', 'patient']);
  assert.match(JSON.stringify(unread.report), /could not be read a second time/);
  const refused = await state('swapped', one);
  assert.deepEqual([refused.status, refused.json.type], [409, '/problems/plan-unreadable'], refused.text);
  rmSync(noise);
  await reopen('swapped');
  assert.equal((await loaded('swapped', ({ statement }) => statement)).statement.state, 'used');
  assert.ok(!(await audit('made')).some(({ detail }) => detail.what === 'outdated' && detail.plan === 'swapped'));
});

test('what is written in the record stands under the statement of then', async () => {
  const room = (await call(`${api}/rooms`, 'POST', { plan: 'swapped' })).json.id;
  const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.push(ann);
  const record = async () =>
    (
      await until(
        () => call(`${api}/rooms/${room}/record`),
        ({ status }) => status === 200,
      )
    ).json;
  const first = (await document('swapped')).statement.time_ms;
  assert.equal((await record()).statement_ms, first);
  const body = { entry: 'regions', text: 'Regions as drawn', state: 'ok', comment: '' };
  const mark = () => call(`${api}/rooms/${room}/checks`, 'POST', { body }, ann.headers);
  const before = await mark();
  assert.deepEqual([before.status, before.json.body.statement_ms], [201, first], before.text);
  assert.equal((await mark()).status, 409); // the entry has its check
  assert.equal((await state('swapped', { ...one, words: 'They are one person after all' })).status, 204);
  const second = (await loaded('swapped', ({ statement }) => statement.time_ms > first && statement.state === 'used')).statement.time_ms;
  await ann.message('plan', ({ plan }) => plan.statement?.time_ms === second && plan.statement.state === 'used');
  const change = (item, version) =>
    call(`${api}/rooms/${room}/checks/${item.id}`, 'PATCH', { version, body: { ...body, comment: 'twice' } }, ann.headers);
  const late = await change(before.json, 1);
  assert.deepEqual([late.status, late.json.code], [403, 'append-only'], late.text);
  const again = await mark();
  assert.deepEqual([again.status, again.json.body.statement_ms], [201, second], again.text);
  assert.equal((await change(again.json, 1)).status, 200);
  const forged = await call(
    `${api}/rooms/${room}/checks`,
    'POST',
    { body: { ...body, entry: 'dose', text: 'Dose', statement_ms: 5 } },
    ann.headers,
  );
  assert.equal(forged.json.body?.statement_ms ?? 0, forged.status === 201 ? second : 0, forged.text);
  const decided = await call(`${api}/rooms/${room}/decisions`, 'POST', { body: { decision: 'accept', text: '' } }, ann.headers);
  assert.deepEqual([decided.status, decided.json.body.statement_ms], [201, second], decided.text);
  assert.deepEqual(
    (await record()).checklist.filter(({ entry }) => entry === 'regions').map(({ statement_ms: ms }) => ms),
    [first, second],
  ); // prettier-ignore
  const paper = await until(
    () => call(`${api}/records/${decided.json.id}/paper`),
    ({ status, text }) => status === 200 && /"Checklist"/.test(text),
  );
  assert.equal(paper.text.match(/twice/g)?.length, 1, paper.text); // that of now
  const table = JSON.stringify(paper.json).split('"Checklist"')[1];
  assert.equal(table.match(/Regions as drawn/g)?.length, 1, table); // not that of before
});

/** Whether a file below the folder has the word. */
const has = (folder, word) =>
  readdirSync(folder, { withFileTypes: true }).some((entry) => {
    const path = join(folder, entry.name);
    return entry.isDirectory() ? has(path, word) : entry.isFile() && readFileSync(path).includes(word);
  });

test('a statement that is being written when its plan is deleted does not stay', async (t) => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-statement-deleted-'));
  const own = await startDaemon({ plans: [join(folder)], data: join(folder, 'data'), args: ['--stub'] });
  try {
    putWhole(join(folder, 'packed', 'gone'), nobody);
    execFileSync('tar', ['-cf', join(folder, 'gone.tar'), '-C', join(folder, 'packed'), 'gone']);
    const at = `${own.url}/api/v1`;
    const job = await (
      await fetch(`${at}/plans?name=gone`, {
        method: 'POST',
        headers: { 'Content-Type': 'application/x-tar' },
        body: readFileSync(join(folder, 'gone.tar')),
      })
    ).json();
    const { plan } = await until(
      async () => (await call(`${at}/jobs/${job.id}`)).json,
      ({ state: now }) => now === 'done' || now === 'failed',
    );
    await openPlan(own.url, plan);
    await until(
      () => call(`${at}/plans/${plan}/revision`),
      ({ status }) => status === 200,
    ); // prettier-ignore
    const held = await holdThread(await threadNamed(own.child.pid, 'store'));
    if (!held) return void t.skip('a thread of another program may not be stopped here');
    const said = call(`${at}/plans/${plan}/statement`, 'POST', { kind: 'identity', ...ottilie });
    const second = await until(
      () => call(`${at}/plans/${plan}/statement`, 'POST', { kind: 'identity', ...ottilie }),
      ({ json }) => /another statement/.test(json?.detail),
    );
    assert.equal(second.status, 503); // the first one is under way
    assert.equal((await call(`${at}/plans/${plan}`, 'DELETE')).status, 204);
    held.release();
    const answer = await said;
    assert.deepEqual([answer.status, answer.json?.type], [404, '/problems/not-found']);
    await own.stop();
    assert.ok(!has(join(folder, 'data'), 'Ottilie'), 'the name is on the disk');
  } finally {
    await own.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});

test('what cannot be stated says why, and changes nothing', async () => {
  for (const [plan, body, status, pointer, code] of [
    ['case-1', { kind: 'sure' }, 422, '/kind', 'enum'],
    ['case-1', { kind: 'one-person' }, 422, '/words', 'required'],
    ['case-1', { kind: 'one-person', words: 'one' }, 422, '/words', 'length'],
    ['case-1', { ...one, id: '1' }, 422, '/id', 'unknown-field'],
    ['case-1', { kind: 'identity', ...ottilie }, 409, '/kind', 'patients'],
    ['nameless', one, 409, '/kind', 'patients'],
    ['nameless', { kind: 'identity', ...ottilie, birth_date: '1955-02-30' }, 422, '/birth_date', 'pattern'],
    ['nameless', { kind: 'identity', ...ottilie, name: 'a\nb' }, 422, '/name', 'pattern'],
    ['none', one, 404, '', ''],
  ]) {
    const { json, ...answer } = await state(plan, body);
    assert.deepEqual([answer.status, json.pointer ?? '', json.code ?? ''], [status, pointer, code], JSON.stringify(body));
  }
});

/** A call of somebody who has signed in at a proxy. */
const askAs = (socketPath, user, path, method = 'GET', body) =>
  new Promise((done, failed) => {
    const text = body === undefined ? '' : JSON.stringify(body);
    const headers = {
      Host: 'beamroom.example',
      'X-Forwarded-For': '192.0.2.7',
      'X-Beamroom-User': user,
      ...(text && { 'Content-Type': 'application/json', 'Content-Length': Buffer.byteLength(text) }),
    };
    const sent = request({ socketPath, path: `/api/v1/plans/${path}`, method, agent: false, headers }, (answer) => {
      let got = '';
      answer.setEncoding('utf8');
      answer.on('data', (part) => (got += part));
      answer.on('end', () => done({ status: answer.statusCode, text: got, json: got ? JSON.parse(got) : undefined }));
    });
    sent.on('error', failed);
    sent.end(text);
  });

test('it is found by the id that the plan has where people sign in, and is of planners who may read the identity', async () => {
  await openPlan(daemon.url, 'swapped');
  assert.equal((await document('swapped')).statement.state, 'used');
  for (const client of clients.splice(0)) client.cut();
  await daemon.stop();
  const socket = join(data, 'http.sock');
  const roles = { ann: 'reviewer+identity', ben: 'planner', cora: 'planner+identity' };
  const grants = Object.entries(roles).flatMap(([who, role]) => ['--grant', `${plans} ${who} ${role}`]);
  const own = await startDaemon({
    plans: [plans],
    data,
    args: [
      ...['--stub', '--sign-in', 'proxy', '--listen', `unix:${socket}`, '--proxy-user', userInfo().username],
      ...['--public-name', 'beamroom.example', ...grants],
    ],
  });
  try {
    const plan = createHash('sha256')
      .update(realpathSync(join(plans, 'swapped')))
      .digest('hex')
      .slice(0, 16); // prettier-ignore
    const as = (user, ...rest) => askAs(socket, user, ...rest);
    const read = (suits) =>
      until(
        async () => (await as('cora', plan)).json,
        (now) => now.state === 'ready' && suits(now),
      );
    await until(
      () => as('cora', `${plan}/open`, 'POST', {}),
      ({ status }) => status < 300,
    ); // prettier-ignore
    assert.equal((await read(() => true)).statement.state, 'used');
    const put = (user) =>
      until(
        () => as(user, `${plan}/statement`, 'POST', one),
        ({ status }) => status !== 503,
      ); // prettier-ignore
    for (const user of ['ann', 'ben'])
      for (const answer of [await put(user), await as(user, `${plan}/statement`, 'DELETE')])
        assert.deepEqual([answer.status, answer.json.code], [403, 'role'], user);
    assert.equal((await put('cora')).status, 204);
    const replaced = await read(({ statement }) => statement.by === 'cora');
    assert.equal(replaced.statement.state, 'used');
    assert.equal((await as('cora', `${plan}/statement`, 'DELETE')).status, 204);
    await read(({ statement }) => statement === null); // nor does that of before come back
    assert.equal((await as('cora', `${plan}/statement`, 'DELETE')).status, 404);
  } finally {
    await own.stop();
    await start();
  }
});

const fill = `
import json, sqlite3, sys
db = sqlite3.connect(sys.argv[1])
n = 4000 - db.execute('SELECT count(*) FROM statements').fetchone()[0]
body = lambda i: json.dumps({'kind': 'one-person', 'words': 'one of many', 'revision': '', 'by': 'Ann', 'time_ms': 5, 'withdrawn_ms': 5 + i})
db.executemany('INSERT INTO statements (plan, body) VALUES (?, ?)', [('gone-%d' % i, body(i)) for i in range(n)])
db.commit()
`;

test('what was withdrawn makes place when as many are kept as may be', async () => {
  await daemon.stop();
  execFileSync('python3', ['-c', fill, join(data, 'beamroom.db')]);
  await start();
  await openPlan(daemon.url, 'swapped');
  assert.equal((await state('swapped', one)).status, 204);
  await loaded('swapped', ({ statement }) => statement?.state === 'used');
  const left = `
import sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print([row[0] for row in db.execute("SELECT plan FROM statements WHERE plan IN ('gone-0', 'gone-1', 'swapped') ORDER BY plan")])
`;
  const rows = () => execFileSync('python3', ['-c', left, join(data, 'beamroom.db')], { encoding: 'utf8' }).trim();
  assert.equal(rows(), "['gone-1', 'swapped']");
});

test('a server that others may reach takes no statement', async () => {
  const open = await startDaemon({ plans: [plans], args: ['--stub', '--open-to-everybody'] });
  try {
    await openPlan(open.url, 'case-1');
    const answer = await call(`${open.url}/api/v1/plans/case-1/statement`, 'POST', one);
    assert.deepEqual([answer.status, answer.json.code], [403, 'identity']);
  } finally {
    await open.stop();
  }
});

test('on a full disk nothing is stated, and the plan stays as it was', async (t) => {
  const disk = new FullDisk();
  if (disk.missing) {
    disk.remove();
    t.skip(disk.missing);
    return;
  }
  const own = await startDaemon({ plans: [plans], data: disk.data, args: ['--stub', '--disk-reserve-mib', '0'] });
  try {
    const opened = await openPlan(own.url, 'case-1');
    assert.equal(opened.state, 'done', JSON.stringify(opened) + own.log());
    const path = `${own.url}/api/v1/plans/case-1`;
    const made = await until(
      () => call(`${path}/statement`, 'POST', one),
      ({ status }) => status !== 503,
    ); // prettier-ignore
    assert.equal(made.status, 204, made.text + own.log());
    await until(
      () => call(path),
      ({ json }) => json.state === 'ready' && json.statement?.state === 'used',
    ); // prettier-ignore
    disk.fill(own.child);
    const words = 'x'.repeat(290); // what is left of the last block is used up
    const answer = await until(
      () => call(`${path}/statement`, 'POST', { ...one, words }),
      ({ status }) => status === 507,
    );
    assert.equal(answer.json.type, '/problems/storage');
    const { json: now } = await until(
      () => call(path),
      ({ json }) => json.state === 'ready',
    ); // prettier-ignore
    assert.equal(now.statement.state, 'used');
    assert.equal((await call(`${path}/statement`, 'DELETE')).status, 507);
    assert.equal((await call(path)).json.statement.state, 'used');
  } finally {
    await own.stop();
    disk.remove();
  }
});
