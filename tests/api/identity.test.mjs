// One answer alone tells a patient's identity, at the server's own machine; everything else has the masked form. Made-up DICOM; nobody's data.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readdirSync, readFileSync, realpathSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { bin, call, openPlan, startDaemon, until } from './daemon.mjs';
import { putDose, putStructs, putWhole } from './made_dicom.mjs';
import { Client } from './ws_client.mjs';

const quirin = { id: '77-30419', name: 'Zweifel^Quirin', birthDate: '19610412' };
const other = { id: '88-50327', name: 'Morgen^Ottilie', birthDate: '19550723', study: '1.2.32', frame: '1.2.42' };
/** None of these occurs anywhere but in /identity. */
const secrets = [
  'Zweifel',
  'Quirin',
  '77-30419',
  '30419',
  '19610412',
  '1961-04-12',
  'Morgen',
  'Ottilie',
  '88-50327',
  '50327',
  '19550723',
  '1955-07-23',
];

let plans, data, daemon, api, room, meeting;
const clients = [];

before(async () => {
  plans = mkdtempSync(join(tmpdir(), 'beamroom-identity-'));
  data = mkdtempSync(join(tmpdir(), 'beamroom-identity-data-'));
  putWhole(join(plans, 'case-1'), quirin, { approval: 'APPROVED' });
  putDose(join(plans, 'case-1'), other, { uid: '1.2.89', file: 'other.dcm' });
  daemon = await startDaemon({ plans: [plans], data });
  api = `${daemon.url}/api/v1`;
  assert.equal((await openPlan(daemon.url, 'case-1')).state, 'done', daemon.log());
  room = (await call(`${api}/rooms`, 'POST', { plan: 'case-1' })).json.id;
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const folder of [plans, data]) rmSync(folder, { recursive: true, force: true });
});

const read = `
import json, sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print(json.dumps([json.loads(row[0]) for row in db.execute('SELECT row FROM audit ORDER BY n').fetchall()]))
`;
const auditRows = () =>
  JSON.parse(execFileSync('python3', ['-c', read, join(data, 'beamroom.db')], { encoding: 'utf8' })).filter(
    (row) => row.action === 'identity',
  );

function assertMasked(what, text) {
  for (const secret of secrets)
    assert.ok(
      !text.includes(secret),
      `${what} has "${secret}": ${text.slice(Math.max(0, text.indexOf(secret) - 80), text.indexOf(secret) + 80)}`,
    );
}

/** The texts of a PNG that are packed (iTXt). */
function textsOf(bytes) {
  let texts = '';
  for (let at = 8; at + 8 < bytes.length; at += 12 + bytes.readUInt32BE(at)) {
    if (bytes.toString('latin1', at + 4, at + 8) !== 'iTXt') continue;
    const chunk = bytes.subarray(at + 8, at + 8 + bytes.readUInt32BE(at)),
      key = chunk.indexOf(0);
    const language = chunk.indexOf(0, key + 3),
      translated = chunk.indexOf(0, language + 1);
    texts += chunk[key + 1] ? inflateSync(chunk.subarray(translated + 1)) : chunk.subarray(translated + 1);
  }
  return texts;
}

test('the plan document has patients masked, and says of which of them each part is', async () => {
  const plan = (await call(`${api}/plans/case-1`)).json;
  assert.deepEqual(plan.patients, [
    { masked: 'Q. Z. …419', has_identity: true, has_conflict: false },
    { masked: 'O. M. …327', has_identity: true, has_conflict: false },
  ]);
  assert.deepEqual([plan.shown_patient, plan.shown_plan], [0, 0]);
  assert.deepEqual(
    plan.treatment_plans.map((t) => [t.label, t.date, t.approval, t.patient, t.structs, t.is_structs_absent]),
    [['BNCT-2', '2026-11-01', 'APPROVED', 0, 0, false]],
  );
  assert.deepEqual(
    plan.images.map((p) => [p.patient, p.plan, p.frame]),
    [[0, null, 0]],
  );
  assert.deepEqual(
    plan.regions.map((p) => [p.patient, p.structs, p.frame]),
    [[0, 0, 0]],
  );
  assert.deepEqual(
    plan.beams.map((p) => [p.patient, p.plan, p.frame]),
    [[0, 0, 0]],
  );
  assert.deepEqual(
    plan.doses.map((p) => [p.patient, p.plan, p.is_plan_absent, p.frame]),
    [
      [0, 0, false, 0],
      [1, null, false, 1],
    ],
  );
});

test('identity is told in full, is never stored, and each time is a row of the audit', async () => {
  assert.deepEqual(auditRows(), []);
  const answer = await call(`${api}/plans/case-1/identity`);
  assert.equal(answer.status, 200);
  assert.equal(answer.headers.get('cache-control'), 'no-store');
  assert.deepEqual(answer.json.patients[0], {
    id: '77-30419',
    issuer: '',
    name: 'Zweifel^Quirin',
    birth_date: '1961-04-12',
    sex: '',
    has_conflict: false,
    masked: 'Q. Z. …419',
  });
  assert.equal(answer.json.patients[1].name, 'Morgen^Ottilie');
  const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.push(ann);
  assert.equal((await call(`${api}/plans/case-1/identity?room=${room}`, 'GET', undefined, ann.headers)).status, 200);
  const key = `plan-${createHash('sha256').update('case-1').digest('hex').slice(0, 16)}`; /* rows do not name plans */
  const [first, second] = await until(auditRows, (rows) => rows.length === 2);
  assert.deepEqual([first.plan, first.address, first.room ?? ''], [key, '127.0.0.1', '']);
  assert.deepEqual([second.plan, second.address, second.room, second.name], [key, '127.0.0.1', room, 'Ann']);
  assert.equal((await call(`${api}/plans/nowhere/identity`)).status, 404);
  assert.equal(
    (await call(`${api}/plans/case-1/identity`, 'GET', undefined, { 'Sec-Fetch-Site': 'cross-site', Origin: 'http://elsewhere.example' }))
      .status,
    403,
  );
  assert.equal(auditRows().length, 2); /* what was refused gave nothing away */
});

test('a wall names the patient when somebody with the right has it so, alone, until its connection ends', async () => {
  const [ann] = clients;
  const base = `${api}/rooms/${room}`;
  assert.equal(ann.welcome.sees_identity, true);
  const link = (await call(`${base}/links`, 'POST', { role: 'wall', expires_s: 600 }, ann.headers)).json.token;
  const enter = async () => {
    const client = await Client.enter(daemon.url, room, { link });
    clients.push(client);
    return client;
  };
  const [wall, hall] = [await enter(), await enter()];
  assert.equal(wall.welcome.sees_identity, false);
  const read = (client) => call(`${base}/identity`, 'GET', undefined, client.headers);
  const name = (of, shown, headers = ann.headers) => call(`${base}/members/${of.welcome.member}/identity`, 'POST', { shown }, headers);
  const naming = async () => (await call(`${base}/members`)).json.members.filter(({ is_naming: is }) => is).map(({ id }) => id);
  assert.deepEqual([(await read(wall)).status, (await read(ann)).json.code], [403, 'identity']);
  assert.equal((await name(wall, 'yes')).json.pointer, '/shown');
  assert.equal((await name(ann, true)).status, 404); /* no wall */
  assert.deepEqual(await naming(), []);
  assert.equal((await name(wall, true)).status, 204);
  assert.deepEqual(await naming(), [wall.welcome.member]);
  const told = await read(wall);
  assert.deepEqual([told.status, told.headers.get('cache-control'), told.json.patients[0].name], [200, 'no-store', 'Zweifel^Quirin']);
  for (const client of [hall, ann]) assert.equal((await read(client)).status, 403);
  assert.equal((await call(`${base}/identity`)).status, 403);
  assert.equal((await name(wall, false)).status, 204);
  assert.equal((await read(wall)).status, 403);
  assert.equal((await name(wall, true)).status, 204);
  wall.cut();
  await until(naming, (ids) => ids.length === 0);
  assert.equal((await name(wall, true)).status, 404); /* it has no seat that waits */
  for (const { member, headers } of [hall.welcome].map((welcome) => ({ ...welcome, headers: ann.headers }))) {
    assert.equal((await call(`${base}/members/${member}/identity`, 'POST', { shown: true }, headers)).status, 204);
    await call(`${api}/plans/case-1/close`, 'POST', {});
    await openPlan(daemon.url, 'case-1'); /* read anew: it might be another's */
    await until(naming, (ids) => ids.length === 0);
  }
});

test('whom the plan is of is OK by the word of who has read it in this room', async () => {
  const [ann] = clients;
  const checks = `${api}/rooms/${room}/checks`;
  await until(
    () => call(`${api}/plans/case-1/revision`),
    ({ status }) => status === 200,
  );
  const check = (body, headers) => call(checks, 'POST', { body: { text: 'Whom the plan is of', comment: '', ...body } }, headers);
  const refused = await check({ entry: 'identity', state: 'ok' }, ann.headers);
  assert.deepEqual([refused.status, refused.json.code, refused.json.pointer], [403, 'identity', '/body/state']);
  assert.equal((await call(`${api}/plans/case-1/identity?room=${room}`, 'GET', undefined, ann.headers)).status, 200);
  const done = await check({ entry: 'identity', state: 'ok' }, ann.headers);
  assert.deepEqual([done.status, done.json.body?.seen], [201, 'Q. Z. …419'], done.text);
  const ben = await Client.enter(daemon.url, room, { name: 'Ben' });
  clients.push(ben);
  const change = (version, body) =>
    call(`${checks}/${done.json.id}`, 'PATCH', { version, body: { entry: 'identity', text: 'Whom the plan is of', ...body } }, ben.headers);
  const said = await change(1, { state: 'ok', comment: 'a word more' }); /* it was OK, and stays so by the first one's word */
  assert.deepEqual([said.status, said.json.body?.seen], [200, 'Q. Z. …419'], said.text);
  const doubted = await change(2, { state: 'issue', comment: 'another birth date' });
  assert.deepEqual([doubted.status, doubted.json.body?.seen], [200, undefined], doubted.text);
  assert.equal((await change(3, { state: 'ok', comment: '' })).status, 403); /* Ben has not read it */
});

test('a snapshot has the patient masked in its caption, and in full for who asks for it and may', async () => {
  const [ann] = clients;
  const snapshot = (query, headers = ann.headers) => fetch(`${api}/rooms/${room}/snapshot?annotations=true${query}`, { headers });
  const [masked, named] = [await snapshot(''), await snapshot('&identity=true')];
  const [a, b] = [masked, named].map(async (answer) => Buffer.from(await answer.arrayBuffer()));
  assert.deepEqual([masked.status, named.status], [200, 200]);
  assert.notDeepEqual(await a, await b);
  for (const bytes of [await a, await b]) assertMasked('the texts of a snapshot', textsOf(bytes)); /* the name is in the pixels alone */
  assert.equal((await (await fetch(`${api}/rooms/${room}/snapshot?identity=true`)).json()).pointer, '/identity');
  assert.equal((await (await snapshot('&identity=yes')).json()).pointer, '/identity');
});

test('a server that others may reach tells nobody', async () => {
  for (const args of [[], ['--public-name', 'beamroom.example'], ['--listen', '0.0.0.0:0'], ['--trusted-proxy', '127.0.0.1']]) {
    const open = await startDaemon({ plans: [plans], args: ['--stub', '--open-to-everybody', ...args] });
    const url = open.url.replace('0.0.0.0', '127.0.0.1');
    const answer = await call(`${url}/api/v1/plans/case-1/identity`, 'GET', undefined, { 'X-Forwarded-For': '192.0.2.7' });
    await open.stop();
    assert.deepEqual([answer.status, answer.json.code, answer.headers.get('cache-control')], [403, 'identity', 'no-store'], args.join(' '));
    assertMasked(args.join(' '), answer.text);
  }
});

/** Nine people as files may write them, in one folder: what is told of each in full occurs in /identity alone. */
const nine = [
  { id: '41-7731926', name: 'Abendrot^Friedgund^Maria', birthDate: '19380117' },
  { id: 'k7', name: 'Brennecke^Ole', birthDate: '19770304' }, // an id of two characters
  { id: '', name: 'Czibulka^Veit', birthDate: '' }, // no id, no birth date
  { id: '52-8842035', name: 'Ünterhölzer^Éva', birthDate: '19690928' },
  { id: '63-9951146', name: 'Yamagami^Tarou=山上^太郎=やまがみ^たろう', birthDate: '19510611' },
  { id: '74-1060257', name: 'Dornbusch\u202e^Kunibert', birthDate: '19820219' }, // a mark of writing direction
  { id: '85-2171368', name: 'Eichinger Walburga', birthDate: '19440730' }, // no ^
  { id: '41-7731926', name: 'Abendrot^Friedgund^Maria', birthDate: '19380118' }, // the first one's id, another birth date
  { id: '96-3282479', name: `Feuerbacher-${'x'.repeat(30)}^Notburga`, birthDate: '20010405' },
].map((owner, n) => ({ ...owner, study: `1.2.33.${n}`, frame: `1.2.43.${n}` }));
const ofNine = nine.flatMap(({ id, name, birthDate }) => [
  ...name.split(/[\^= \u202e]/).filter((part) => part.length > 2 || /[^\x20-\x7f]{2}/.test(part)),
  ...(id.length > 5 ? [id, id.split('-').at(-1)] : []),
  ...(birthDate ? [birthDate, `${birthDate.slice(0, 4)}-${birthDate.slice(4, 6)}-${birthDate.slice(6)}`] : []),
]);

/** A value for each parameter that a route may need. */
const values = {
  x: 14,
  y: 14,
  z: 9,
  from: '4,14,9',
  to: '24,14,9',
  image: 'ct',
  region: 'box',
  level: 'level-1',
  view: JSON.stringify({ kind: 'axial', size_px: [320, 320] }),
  t_ms: 0,
  center: '14,14,9',
  radius: 5,
  segment: 0,
  annotations: 'true',
  representation: 'surface',
};

test('a meeting names the patient of a case masked, in its agenda, on the way there and in its minutes', async () => {
  const made = await call(`${api}/meetings`, 'POST', { name: 'Board', cases: [{ plan: 'case-1', room }, { plan: 'case-1' }] });
  assert.equal(made.status, 201, made.text);
  meeting = made.json.id;
  const shown = { patient: 'Q. Z. …419', approval: 'APPROVED' };
  const [{ patient, approval }] = made.json.cases;
  assert.deepEqual({ patient, approval }, shown);
  const client = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.push(client);
  const go = (from) => call(`${api}/meetings/${meeting}/case`, 'POST', { case: 'next', from });
  assert.equal((await go(null)).status, 200);
  assert.equal((await go('c1')).status, 200);
  const told = await client.message('meeting.case');
  assert.deepEqual([told.patient, told.approval, told.n], [shown.patient, shown.approval, 2]);
  const minutes = await call(`${api}/meetings/${meeting}/minutes`);
  assert.deepEqual(
    minutes.json.cases.map((one) => one.patient),
    [shown.patient, shown.patient],
  );
  for (const text of [made.text, minutes.text, JSON.stringify(client.messages)]) assertMasked('a meeting', text);
});

test('no other answer, and nothing on the disk or in the log, says who the patients are', async () => {
  await assertNobodyIsNamed('case-1', room);
});

async function assertNobodyIsNamed(planId, room) {
  const spec = (await call(`${api}/openapi.json`)).json;
  const client = clients[0];
  client.send({ type: 'note.add', id: 'n-1', body: { text: 'A note', point_lps_mm: [14, 14, 9] } });
  assertMasked('welcome', JSON.stringify(client.welcome));
  let nGood = 0;
  for (const [path, routes] of Object.entries(spec.paths)) {
    const { get } = routes;
    if (!get || path === '/api/v1/plans/{plan}/identity' || /\/(ws|stream|events)$/.test(path)) continue;
    const address = path.replace(
      /\{(\w+)\}/g,
      (_, name) => ({ plan: planId, room, meeting, image: 'ct', region: 'box', level: 'level-1' })[name] ?? 'none',
    );
    const query = new URLSearchParams();
    for (const parameter of get.parameters ?? [])
      if (parameter.in === 'query' && parameter.name in values) query.set(parameter.name, values[parameter.name]);
    const answer = await fetch(`${daemon.url}${address}?${query}`, { redirect: 'manual' });
    const bytes = Buffer.from(await answer.arrayBuffer());
    nGood += answer.status === 200;
    assertMasked(path, `${JSON.stringify([...answer.headers])} ${bytes.toString('latin1')} ${bytes.toString('utf8')}`);
    if (answer.headers.get('content-type') === 'image/png') assertMasked(`${path}, texts`, textsOf(bytes));
  }
  assert.ok(nGood >= 20, `${nGood} routes answered`);
  const picture = await fetch(`${api}/plans/${planId}/render`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ annotations: true, view: { kind: 'axial' } }),
  });
  assert.equal(picture.status, 200);
  assertMasked('picture', textsOf(Buffer.from(await picture.arrayBuffer())));
  assertMasked('log', daemon.log());
  for (const entry of readdirSync(data, { recursive: true })) assertMasked('a name on the disk', String(entry));
  for (const file of ['beamroom.db', 'beamroom.db-wal']) {
    let bytes;
    try {
      bytes = readFileSync(join(data, file));
    } catch {
      continue;
    } /* the log of the database comes and goes */
    assertMasked(file, bytes.toString('latin1'));
  }
}

test('the command line tells who the patient is only when asked, and converts without it', () => {
  const run = (...args) => spawnSync(join(bin, 'beamroom'), args, { encoding: 'utf8' });
  const folder = join(plans, 'case-1');
  for (const args of [
    ['info', folder],
    ['info', '--json', folder],
  ]) {
    const { status, stdout, stderr } = run(...args);
    assert.equal(status, 0, stderr);
    assert.match(stdout, /Q\. Z\. …419/);
    assertMasked(args.join(' '), stdout + stderr);
  }
  const told = run('info', '--identity', folder);
  assert.equal(told.status, 0, told.stderr);
  assert.match(told.stdout, /Zweifel\^Quirin.*77-30419.*1961-04-12/);
  const out = mkdtempSync(join(tmpdir(), 'beamroom-converted-'));
  const converted = run('convert', folder, join(out, 'plan'));
  assert.equal(converted.status, 0, converted.stderr);
  assertMasked('convert', converted.stdout + converted.stderr);
  for (const { name, path, isFile } of readdirSync(join(out, 'plan'), { recursive: true, withFileTypes: true }).map((e) => ({
    name: e.name,
    path: join(e.parentPath ?? e.path, e.name),
    isFile: e.isFile(),
  }))) {
    assertMasked('a converted file', name);
    if (!isFile) continue;
    assertMasked(
      name,
      execFileSync('sh', ['-c', name.endsWith('.gz') ? 'gzip -dc "$1"' : 'cat "$1"', 'sh', path], {
        encoding: 'latin1',
        maxBuffer: 1 << 26,
      }),
    );
  }
  rmSync(out, { recursive: true, force: true });
});

test('a search finds a plan by what is shown of its patient, and by the whole id only for who may read it; by its rooms; and counts', async () => {
  const find = async (body, at = api) => {
    const answer = await call(`${at}/plans/search`, 'POST', { kind: 'plan', ...body });
    assert.equal(answer.status, 200, answer.text);
    assertMasked(`search for ${JSON.stringify(body)}`, answer.text);
    return answer.json;
  };
  const {
    plans: [row],
    ...counts
  } = await find({});
  assert.deepEqual(
    [row.patient, row.label, row.date, row.approval, row.n_patients, row.n_plans],
    ['Q. Z. …419', 'BNCT-2', '20261101', 'APPROVED', 2, 1],
  );
  const folder = plans.split('/').at(-1);
  const id = createHash('sha256').update(realpathSync(plans)).digest('hex').slice(0, 16);
  assert.deepEqual(counts, { total: 1, of: 1, next: null, folders: [{ id, name: folder, n: 1 }], n_all: 1, n_uploads: 0, n_no_plans: 0 });
  const named = (await call(`${api}/rooms`, 'POST', { plan: 'case-1' })).json.id;
  await call(`${api}/rooms/${named}`, 'PATCH', { name: 'Second look' });
  const client = await Client.enter(daemon.url, named, { name: 'Dr Ojala' });
  clients.push(client);
  for (const [text, total] of [
    ['…419', 1],
    ['q. z.', 1],
    ['bnct-2', 1],
    ['SECOND LOOK', 1],
    ['ojala', 1],
    ['77-30419', 1],
    ['7-304', 1], // a part of the id, for who may read it
    ['99-99419', 0], // another's, who ends alike
    ['Zweifel', 0],
    ['nothing of it', 0],
  ])
    assert.equal((await find({ text })).total, total, text);
  const rooms = (await find({ sort: 'used', folder })).plans[0].rooms;
  const its = rooms.find(({ id }) => id === named);
  assert.deepEqual([its.name, its.were_in, its.is_mine], ['Second look', ['Dr Ojala'], true]);
  assert.equal((await find({ folder: 'elsewhere' })).of, 0);
  for (const [field, value, code] of [
    ['sort', 'age', 'enum'],
    ['kind', 7, 'type'],
    ['order', 'up', 'unknown-field'],
  ]) {
    const { status, json } = await call(`${api}/plans/search`, 'POST', { [field]: value });
    assert.deepEqual([status, json.pointer, json.code], [422, `/${field}`, code]);
  }
  const open = await startDaemon({ plans: [plans], args: ['--stub', '--open-to-everybody', '--public-name', 'beamroom.example'] });
  try {
    const at = `${open.url}/api/v1`;
    await until(
      () => find({}, at),
      ({ plans: [known] }) => known?.patient,
    );
    for (const [text, total] of [
      ['…419', 1],
      ['77-30419', 1], // by its end
      ['99-99419', 1], // which tells nothing more
      ['7-304', 0],
    ])
      assert.equal((await find({ text }, at)).total, total, text);
  } finally {
    await open.stop();
  }
});

test('regions of one name say which structure set is theirs, by its label or else its file', async () => {
  const sets = async (plan) => (await call(`${api}/plans/${plan}`)).json.regions.map(({ name, set }) => [name, set]);
  const folder = join(plans, 'case-3');
  putWhole(folder, quirin);
  assert.deepEqual(await sets('case-1'), [['Box', undefined]]);
  putStructs(folder, quirin, { uid: '1.2.64', file: 'second.dcm', label: 'After', left: 2 });
  await openPlan(daemon.url, 'case-3');
  assert.deepEqual((await sets('case-3')).map(([, set]) => set).sort(), ['After', 'Set']);
  putStructs(folder, quirin, { uid: '1.2.65', file: 'third.dcm', label: 'After', left: 4 });
  await call(`${api}/plans/case-3/close`, 'POST', {});
  await openPlan(daemon.url, 'case-3');
  assert.deepEqual((await sets('case-3')).map(([, set]) => set).sort(), ['second.dcm', 'structs.dcm', 'third.dcm']);
});

test('so it is with nine people in a folder, however their names are written', async () => {
  const folder = join(plans, 'case-9');
  putWhole(folder, nine[0]);
  for (const [n, owner] of nine.entries()) if (n) putDose(folder, owner, { uid: `1.2.90.${n}`, file: `dose-${n}.dcm` });
  assert.equal((await openPlan(daemon.url, 'case-9')).state, 'done', daemon.log());
  const told = (await call(`${api}/plans/case-9/identity`)).json.patients;
  assert.deepEqual(
    told.map(({ id, name, birth_date: birth }) => `${id} ${name} ${birth.replaceAll('-', '')}`).sort(),
    nine.map(({ id, name, birthDate }) => `${id} ${name} ${birthDate}`).sort(),
  );
  assert.deepEqual(
    told.map(({ masked }) => masked).sort(),
    ['F. M. A. …926', 'F. M. A. …926', 'K. D. …257', 'N. F. …479', 'O. B. …7', 'T. Y. …146', 'V. C.', 'E. W. …368']
      .concat('É. Ü. …035')
      .sort(),
  );
  secrets.push(...ofNine);
  const made = (await call(`${api}/rooms`, 'POST', { plan: 'case-9' })).json.id;
  clients.unshift(await Client.enter(daemon.url, made, { name: 'Ann' }));
  await assertNobodyIsNamed('case-9', made);
});
