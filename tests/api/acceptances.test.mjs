// Acceptances, from the room to the renderer: what is accepted is drawn in that room alone, for those files; nothing else carries it.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, sleep, startDaemon, until } from './daemon.mjs';
import { writeOtherFrame } from './other_frame.mjs';
import { Client } from './ws_client.mjs';

const boost = { thing: 'dose:boost', with: 'image:ct', reason: 'registered-elsewhere', words: 'CT to MR by hand, skull base checked' };
const patch = { dose: { id: 'boost', quantity: 'total', wash: { visible: true } } };
const view = { kind: 'axial', size_px: [96, 96] };
let data, plans, plan, daemon, room, ann;
const clients = [];
let input = 0;
const digest = (bytes) => createHash('sha256').update(bytes).digest('hex').slice(0, 16);
const url = (path) => `${daemon.url}/api/v1/${path}`;

async function enter(of, hello = {}) {
  const client = await Client.enter(daemon.url, of, hello);
  clients.push(client);
  await client.ready();
  return client;
}
async function give(client, message) {
  const own = ++input;
  client.send({ ...message, input: own });
  const answer = await client.until(
    () => client.messages.find((m) => ['item', 'problem', 'scene'].includes(m.type) && m.input === own),
    'an answer',
  );
  return answer.type === 'item' ? answer.item : (answer.problem ?? answer);
}
/** The item; the revision of the plan's files may not be known yet. */
const accept = (client, body = boost) =>
  until(
    () => give(client, { type: 'item.put', kind: 'acceptance', body }),
    ({ type }) => type !== '/problems/busy',
  );
const newRoom = async (body = { plan }) => (await call(url('rooms'), 'POST', body)).json.id;
const doseOf = async (of) => (await call(url(`plans/${plan}/dose?room=${of}`))).json;
const picture = async (of) => {
  const response = await fetch(url(`rooms/${of}/snapshot?view=${encodeURIComponent(JSON.stringify(view))}&annotations=false`));
  assert.equal(response.status, 200);
  return digest(Buffer.from(await response.arrayBuffer()));
};
async function render(acceptances) {
  const response = await fetch(url(`plans/${plan}/render`), {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ scene: patch, view, ...(acceptances ? { acceptances } : {}) }),
  });
  const bytes = Buffer.from(await response.arrayBuffer());
  return response.ok ? digest(bytes) : JSON.parse(bytes.toString('utf8'));
}
const counting = (client) => client.messages.filter(({ type }) => type === 'acceptances').at(-1);

before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-accept-'));
  plans = mkdtempSync(join(tmpdir(), 'beamroom-plans-'));
  plan = writeOtherFrame(plans);
  daemon = await startDaemon({ data, plans: [plans] });
  room = await newRoom();
  ann = await enter(room, { name: 'Ann' });
  await give(ann, { type: 'scene.patch', patch });
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const folder of [data, plans]) rmSync(folder, { recursive: true, force: true });
});

test('the plan lists the pair with its reason, and the dose is not drawn', async () => {
  const { json } = await call(url(`plans/${plan}`));
  const fit = json.fits.find(({ thing, with: other }) => thing === 'dose:boost' && other === 'image:ct');
  assert.deepEqual([fit.relation, fit.needs], ['frame', 'acceptance']);
  assert.match(fit.reason, /^Dose .Boost. is not used with ct: /);
  assert.equal(json.fits.find(({ thing }) => thing === 'dose:own').needs, 'nothing');
  assert.equal((await doseOf(room)).drawn, false);
});

let unaccepted, accepted, item;
test('an accepted dose is drawn, in that room alone; withdrawn, the picture is byte for byte the one before', async () => {
  unaccepted = await picture(room);
  const other = await newRoom();
  const ben = await enter(other, { name: 'Ben' });
  await give(ben, { type: 'scene.patch', patch });
  item = await accept(ann);
  assert.equal(item.author_name, 'Ann');
  assert.match(item.body.fact, /not used with ct/);
  const answer = await doseOf(room);
  assert.equal(answer.drawn, true);
  assert.deepEqual(answer.accepted, { by: 'Ann', words: boost.words });
  accepted = await picture(room);
  assert.notEqual(accepted, unaccepted);
  assert.equal(await picture(other), unaccepted);
  assert.equal((await doseOf(other)).drawn, false);
  await give(ann, { type: 'item.delete', item: item.id, version: item.version });
  assert.equal(await picture(room), unaccepted);
  assert.equal((await doseOf(room)).drawn, false);
  item = await accept(ann);
  assert.equal(await picture(room), accepted);
});

test('frames of a member are drawn anew when it is accepted and when it is withdrawn', async () => {
  ann.send({ type: 'view.open', view: 2, document: view, follow: true });
  await ann.frame(({ isStill }) => isStill); // now it is at rest
  const before = ann.frames.length;
  await give(ann, { type: 'item.delete', item: item.id, version: item.version });
  await ann.frame(({ isStill }) => isStill, before);
  const next = ann.frames.length;
  item = await accept(ann);
  await ann.frame(({ isStill }) => isStill, next);
});

test('a saved view, its permalink, a room that begins with it, and a replay hold no acceptance', async () => {
  ann.send({ type: 'recording.start', input: ++input });
  await ann.message('recording', ({ state }) => state === 'running');
  const saved = await give(ann, { type: 'item.put', kind: 'bookmark', body: { name: 'as accepted' } });
  assert.ok(!JSON.stringify(saved.body).includes('accept'.concat('ance')));
  await sleep(300);
  ann.send({ type: 'recording.stop', input: ++input });
  const { id } = await ann.message('recording', ({ state }) => state === 'stopped');
  for (const body of [{ saved: saved.body.token }, { recording: { room, id } }]) {
    const fork = await newRoom(body);
    const cem = await enter(fork, { name: 'Cem' });
    await until(
      () => doseOf(fork),
      ({ id: shown }) => shown === 'boost',
    );
    assert.equal((await doseOf(fork)).drawn, false, JSON.stringify(body));
    assert.deepEqual(counting(cem).items, []);
    assert.ok(!cem.welcome.items.some(({ kind }) => kind === 'acceptance'));
    assert.equal(await picture(fork), unaccepted);
  }
  assert.equal(await picture(room), accepted, 'the room itself keeps its own');
});

test('/render takes acceptances in its body, checked as those of a room, each a row of the audit', async () => {
  assert.equal(await render(), unaccepted);
  assert.equal(await render([boost]), accepted);
  assert.equal(await render(), unaccepted, 'no call carries them to another');
  assert.equal((await render([{ ...boost, words: 'short' }])).pointer, '/acceptances/0/words');
  assert.equal((await render([{ ...boost, by: 'Dr Keller' }])).pointer, '/acceptances/0/by', 'who says so is never taken from the body');
  for (const wrong of [7, [1], null]) assert.equal((await render([wrong])).pointer, '/acceptances/0');
  assert.equal((await render([{ ...boost, thing: 'dose:own' }])).pointer, '/acceptances/0/thing');
});

test('the command line draws the same by --accept, and nothing of the dose without', () => {
  const drawn = (...options) => {
    const out = join(data, 'picture.png');
    execFileSync(
      join(bin, 'beamroom'),
      ['render', join(plans, plan), '-o', out, '--scene', JSON.stringify(patch), '--view', JSON.stringify(view), ...options],
      { stdio: 'pipe' },
    );
    return digest(readFileSync(out));
  };
  assert.notEqual(drawn('--accept', 'dose:boost=image:ct'), drawn());
  assert.equal(drawn('--accept', 'dose:own=image:ct'), drawn(), 'of another pair');
});

test('a member who does not present accepts nothing', async () => {
  const ben = await enter(room, { name: 'Ben' });
  assert.equal((await give(ben, { type: 'item.put', kind: 'acceptance', body: boost })).type, '/problems/not-presenter');
  assert.equal((await give(ben, { type: 'item.delete', item: item.id, version: item.version })).type, '/problems/not-presenter');
});

test('it is there after a restart, and void once a file of the plan is another', async () => {
  for (const client of clients.splice(0)) client.cut();
  assert.equal(await daemon.stop(), 0);
  daemon = await startDaemon({ data, plans: [plans] });
  ann = await enter(room, { name: 'Ann' });
  await ann.until(() => counting(ann)?.items.length === 1, 'the acceptance to count');
  assert.equal(await picture(room), accepted);
  ann.cut();
  assert.equal(await daemon.stop(), 0);
  const file = join(plans, plan, 'plan.json');
  writeFileSync(file, readFileSync(file, 'utf8').replace('Other frame', 'Another frame'));
  daemon = await startDaemon({ data, plans: [plans] });
  ann = await enter(room, { name: 'Ann' });
  await ann.until(() => counting(ann)?.known, 'the revision of the files');
  assert.deepEqual(counting(ann).items, []);
  assert.ok(
    ann.welcome.items.some(({ kind, id }) => kind === 'acceptance' && id === item.id),
    'shown as void',
  );
  assert.equal(await picture(room), unaccepted);
});
