// Erasing what is kept of one patient's plan: nothing below the data folder has the name or the id any more, also after kills; the audit stays
// a chain. Made-up DICOM; nobody's data.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { cpSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync } from 'node:fs';
import { request } from 'node:http';
import { tmpdir, userInfo } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, openPlan, sleep, startDaemon, until } from './daemon.mjs';
import { putWhole } from './made_dicom.mjs';
import { Client } from './ws_client.mjs';

const patient = { id: '77-30419', name: 'Zweifel^Quirin', birthDate: '19610412' };
const secrets = ['zweifel', 'quirin', '77-30419'];
let home, archive, given;

before(() => {
  home = mkdtempSync(join(tmpdir(), 'beamroom-erase-'));
  given = join(home, 'given');
  putWhole(join(given, 'quirin-zweifel'), patient, { approval: 'APPROVED' });
  archive = join(home, 'case.tar');
  execFileSync('tar', ['-cf', archive, '-C', given, 'quirin-zweifel']);
});
after(() => rmSync(home, { recursive: true, force: true }));

/** Names of all that is below the folder. Node 18's own recursive list takes a socket for a folder. */
const namesBelow = (folder, below = '') =>
  readdirSync(join(folder, below), { withFileTypes: true }).flatMap((entry) => {
    const name = join(below, entry.name);
    return entry.isDirectory() ? [name, ...namesBelow(folder, name)] : [name];
  });

/** Files below the data folder that have one of the words, in their names or bytes. */
function found(folder) {
  const list = [];
  for (const name of namesBelow(folder)) {
    const path = join(folder, name);
    let text = name;
    if (statSync(path, { throwIfNoEntry: false })?.isFile()) text += readFileSync(path).toString('latin1');
    const bare = text.toLowerCase();
    for (const secret of secrets) if (bare.includes(secret)) list.push(`${name}: ${secret}`);
  }
  return list;
}
const verify = (data) => spawnSync(join(bin, 'beamroomd'), ['--verify-audit', join(data, 'beamroom.db')], { encoding: 'utf8' });

/** The arguments for people who sign in, all of them administrators, at a proxy in front of the socket. */
const signsIn = (socketPath) => [
  ...['--sign-in', 'proxy', '--listen', `unix:${socketPath}`, '--proxy-user', userInfo().username],
  ...['--public-name', 'beamroom.example', '--grant', '* admin admin'],
];
/** A call of such an administrator. */
const asAdmin = (socketPath, path, method = 'GET', body) =>
  new Promise((done, failed) => {
    const text = body === undefined ? '' : JSON.stringify(body);
    const headers = {
      Host: 'beamroom.example',
      'X-Forwarded-For': '192.0.2.7',
      'X-Beamroom-User': 'admin',
      ...(text && { 'Content-Type': 'application/json', 'Content-Length': Buffer.byteLength(text) }),
    };
    const sent = request({ socketPath, path: `/api/v1${path}`, method, agent: false, headers }, (answer) => {
      let got = '';
      answer.setEncoding('utf8');
      answer.on('data', (part) => (got += part));
      answer.on('end', () => done({ status: answer.statusCode, text: got, json: got ? JSON.parse(got) : undefined }));
    });
    sent.on('error', failed);
    sent.end(text);
  });

/** A daemon with the plan uploaded, or given, and a room on it in which everything says who it is about. */
async function begin({ isGiven = false, folder = given } = {}) {
  const data = mkdtempSync(join(home, 'data-'));
  const plans = isGiven ? [folder] : [mkdtempSync(join(home, 'none-'))];
  const start = (more = []) => startDaemon({ data, plans, args: ['--stub', ...more] });
  const daemon = await start();
  const api = `${daemon.url}/api/v1`;
  let plan = 'quirin-zweifel';
  if (!isGiven) {
    const response = await fetch(`${api}/plans?name=quirin-zweifel`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/x-tar' },
      body: readFileSync(archive),
    });
    const job = await response.json();
    const done = await until(
      async () => (await call(`${api}/jobs/${job.id}`)).json,
      ({ state }) => state === 'done' || state === 'failed',
    );
    plan = done.plan;
  }
  await openPlan(daemon.url, plan);
  const room = (await call(`${api}/rooms`, 'POST', { plan })).json.id;
  const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
  const of = `${api}/rooms/${room}`;
  const written = async (kind, body) => {
    const { status, text, json } = await call(`${of}/${kind}`, 'POST', { body }, ann.headers);
    assert.equal(status, 201, text);
    return json;
  };
  const {
    json: { revision },
  } = await until(
    () => call(`${api}/plans/${plan}/revision`),
    ({ status }) => status === 200,
  );
  await written('notes', { text: 'Zweifel, 77-30419: too close' });
  await written('bookmarks', { name: 'Quirin from above' });
  const decision = await written('decisions', { decision: 'accept', text: 'Quirin Zweifel may be treated', plan_revision: revision });
  await call(`${of}/recording/start`, 'POST', {}, ann.headers);
  await call(`${of}/exports`, 'POST', { what: 'notes', name: 'quirin-zweifel-notes.txt' }, ann.headers);
  return { data, daemon, api, plan, room, ann, decision, revision, start };
}

test('nothing on the disk names the patient after an uploaded plan was erased, and its decision stays', async (t) => {
  const { data, daemon, api, plan, room, ann, decision, revision } = await begin();
  t.after(() => daemon.stop());
  assert.ok(found(data).length > 3, 'it was there');
  const other = (await call(`${api}/rooms`, 'POST', { plan })).json.id;
  for (const [body, pointer] of [
    [{}, '/reason'],
    [{ reason: '' }, '/reason'],
    [{ reason: 'x'.repeat(201) }, '/reason'],
    [{ reason: `of ${plan.toUpperCase()}` }, '/reason'],
    [{ reason: 'asked', plan }, '/plan'],
  ]) {
    const { status, json } = await call(`${api}/plans/${plan}/erase`, 'POST', body);
    assert.deepEqual([status, json.pointer], [422, pointer]);
  }
  const { status, json } = await call(`${api}/plans/${plan}/erase`, 'POST', { reason: 'asked by letter of 2 November' });
  assert.deepEqual([status, json], [200, { rooms: 2, records: 1 }], daemon.log());
  assert.deepEqual(found(data), []);
  const bye = await ann.message('bye');
  assert.match(bye.reason, /erased/);
  for (const gone of [`plans/${plan}`, `rooms/${room}`, `rooms/${other}`]) assert.equal((await call(`${api}/${gone}`)).status, 404);

  const { json: kept } = await call(`${api}/records/${decision.id}`);
  assert.deepEqual(
    [kept.kind, kept.plan, kept.author_name, kept.item.body, kept.item.erased],
    ['decision', '', 'Ann', { decision: 'accept', plan_revision: revision }, true],
  );
  assert.deepEqual([kept.body.erased, kept.body.sha256.length], [true, 64]);
  const [row] = (await call(`${api}/records`)).json.records;
  assert.deepEqual([row.id, row.decision, row.plan_name, row.patient, row.label], [decision.id, 'accept', '', '', '']);
  const { rows } = (await call(`${api}/audit?action=erase`)).json;
  assert.equal(rows.length, 1);
  assert.deepEqual(
    [rows[0].detail.reason, rows[0].detail.rooms, rows[0].detail.records, rows[0].source],
    ['asked by letter of 2 November', 2, 1, 'machine'],
  );
  await daemon.stop();
  assert.equal(verify(data).stderr, '');
  assert.deepEqual(found(data), []);
});

test('a folder that was given stays, and everything that was made of it goes', async (t) => {
  const { data, daemon, api, plan } = await begin({ isGiven: true });
  t.after(() => daemon.stop());
  const order = { seconds: 1, fps: 1, view: { kind: '3d', size_px: [240, 240] } };
  const film = `${api}/jobs/${(await call(`${api}/plans/${plan}/video`, 'POST', order)).json.id}`;
  await until(
    () => call(film),
    ({ json }) => json.state === 'done',
  );
  assert.equal((await call(`${film}/video`)).status, 200);
  const { status, json } = await call(`${api}/plans/${plan}/erase`, 'POST', { reason: 'asked' });
  assert.deepEqual([status, json], [200, { rooms: 1, records: 1 }], daemon.log());
  assert.deepEqual(found(data), []);
  assert.ok(readdirSync(join(given, 'quirin-zweifel')).length > 2);
  assert.equal((await call(`${api}/plans/${plan}`)).status, 200);
  assert.equal((await call(`${film}/video`)).status, 404, 'a film that was made of it is in memory no more');
});

test('a kill leaves all of it, or nothing: what was begun is finished by the next start', async () => {
  const ends = [];
  for (const pause of [2, 12, 40]) {
    const { data, daemon, api, plan, room, start } = await begin();
    const answer = call(`${api}/plans/${plan}/erase`, 'POST', { reason: 'asked' }).catch(() => null);
    await sleep(pause);
    const ended = new Promise((done) => daemon.child.on('exit', done));
    daemon.child.kill('SIGKILL');
    await ended;
    await answer;
    const again = await start();
    const { rows } = (await call(`${again.url}/api/v1/audit?action=erase`)).json;
    await until(
      () => readdirSync(join(data, 'uploads')).length,
      (n) => n === 0,
    );
    if (rows.length) assert.deepEqual(found(data), [], `killed after ${pause} ms`);
    else assert.equal((await call(`${again.url}/api/v1/rooms/${room}`)).status, 200, 'it was not begun');
    ends.push(rows.length);
    assert.ok(rows.length <= 1);
    assert.ok(!readdirSync(data).some((name) => name.includes('-erase-')));
    await again.stop();
    assert.equal(verify(data).stderr, '');
  }
  assert.ok(ends.includes(1), `${ends}`);
});

test('what was written where nobody signed in is erased where people sign in, by the id of now and by the one before', async (t) => {
  for (const [isGiven, isByOld] of [
    [false, false],
    [true, true],
  ]) {
    const { data, daemon, plan: old, ann, start } = await begin({ isGiven });
    ann.cut();
    await daemon.stop();
    assert.ok(found(data).some((name) => name.startsWith('cache')) && found(data).some((name) => name.startsWith('beamroom.db')));
    const socketPath = join(home, `${isGiven}.sock`);
    const again = await start(signsIn(socketPath));
    t.after(() => again.stop());
    const { json } = await until(
      () => asAdmin(socketPath, '/plans'),
      ({ json: list }) => list.plans?.length === 1,
    );
    const [{ id }] = json.plans;
    assert.notEqual(id, old);
    const erase = (plan, reason) => asAdmin(socketPath, `/plans/${plan}/erase`, 'POST', { reason });
    assert.deepEqual([(await erase(id, `of ${old}`)).status, (await erase(old, `of ${id}`)).status], [422, 422], 'neither id is a reason');
    const answer = await erase(isByOld ? old : id, 'asked');
    assert.deepEqual([answer.status, answer.json], [200, { rooms: 1, records: 1 }], answer.text);
    assert.deepEqual(found(data), []);
    await again.stop();
    assert.equal(verify(data).stderr, '');
    assert.deepEqual(found(data), []);
  }
});

test('what was written where people sign in is erased where nobody does', async (t) => {
  const socketPath = join(home, 'back.sock');
  const { data, daemon, plan: old, ann, start } = await begin();
  ann.cut();
  await daemon.stop();
  const signed = await start(signsIn(socketPath));
  t.after(() => signed.stop());
  const { json } = await until(
    () => asAdmin(socketPath, '/plans'),
    ({ json: list }) => list.plans?.length === 1,
  );
  const [{ id }] = json.plans;
  assert.equal((await asAdmin(socketPath, '/rooms', 'POST', { plan: id })).status, 201);
  assert.equal((await asAdmin(socketPath, `/plans/${id}/open`, 'POST')).status, 202);
  await until(
    () => asAdmin(socketPath, `/plans/${id}`),
    ({ json: plan }) => plan.state === 'ready',
  );
  await signed.stop();
  const again = await start();
  t.after(() => again.stop());
  const answer = await call(`${again.url}/api/v1/plans/${id}/erase`, 'POST', { reason: 'asked' });
  assert.deepEqual([answer.status, answer.json], [200, { rooms: 2, records: 1 }], answer.text);
  assert.deepEqual(readdirSync(join(data, 'cache')), []);
  assert.equal((await call(`${again.url}/api/v1/plans/${old}`)).status, 404);
  await again.stop();
});

test('what is kept of a plan whose folder is gone is erased by its id, also where people sign in', async (t) => {
  const folder = mkdtempSync(join(home, 'gone-'));
  cpSync(given, folder, { recursive: true });
  const { data, daemon, plan, ann, start } = await begin({ isGiven: true, folder });
  ann.cut();
  await daemon.stop();
  rmSync(join(folder, 'quirin-zweifel'), { recursive: true });
  const socketPath = join(home, 'gone.sock');
  const again = await start(signsIn(socketPath));
  t.after(() => again.stop());
  const answer = await until(
    () => asAdmin(socketPath, `/plans/${plan}/erase`, 'POST', { reason: 'asked' }),
    ({ status }) => status !== 503,
  );
  assert.deepEqual([answer.status, answer.json], [200, { rooms: 1, records: 1 }], answer.text);
  assert.deepEqual(found(data), []);
  await again.stop();
});
