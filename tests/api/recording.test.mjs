// A meeting is recorded, the daemon is killed, and the recording plays in a room of its own: the same scene, and byte for byte the same pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { webm } from './webm.mjs';
import { Client } from './ws_client.mjs';

let data, daemon, api;
const clients = new Set();
before(() => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-recording-'));
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  rmSync(data, { recursive: true, force: true });
});

async function start() {
  daemon = await startDaemon({ data });
  api = `${daemon.url}/api/v1`;
}
async function kill() {
  const ended = new Promise((done) => daemon.child.on('exit', done));
  daemon.child.kill('SIGKILL');
  await ended;
}
async function enter(room, hello = {}) {
  const client = await Client.enter(daemon.url, room, hello);
  clients.add(client);
  await client.ready();
  return client;
}
const opens = (client) => client.send({ type: 'view.open', view: 1, document: { kind: '3d', size_px: [320, 240] }, follow: true });
const list = async (room) => (await call(`${api}/rooms/${room}/recordings`)).json.recordings;
const stateAt = async (room, id, t) => (await call(`${api}/rooms/${room}/recordings/${id}/state?t_ms=${t}`)).json;

let room, id;
const moments = [];
test('a meeting is recorded, and what it was can be read at each time, also after the daemon was killed', async () => {
  await start();
  room = (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const ann = await enter(room, { name: 'Ann' });
  const ben = await enter(room, { name: 'Ben' });
  opens(ann);
  ben.send({ type: 'recording.start' });
  assert.match((await ben.message('problem')).problem.type, /not-presenter$/);
  ann.send({ type: 'recording.start' });
  const begun = await ben.message('recording');
  assert.equal(begun.state, 'running');
  assert.equal(begun.by_name, 'Ann');
  id = begun.id;
  const early = await call(`${api}/rooms/${room}/recordings/${id}/video`, 'POST', {});
  assert.deepEqual([early.status, early.json.type], [409, '/problems/conflict'], 'its film waits for its end');
  const cem = await enter(room, { name: 'Cem' });
  assert.equal((await cem.message('recording')).id, id, 'who enters is told');
  for (const [n, position_mm] of [
    [1, 12.5],
    [2, -30],
    [3, 41.25],
  ]) {
    ann.send({ type: 'scene.patch', patch: { image: { slices: { axial: { visible: true, position_mm } } } }, input: 10 * n });
    ann.send({
      type: 'view.patch',
      view: 1,
      patch: { camera: { position_mm: [300 * n, -500, 200], target_mm: [0, 0, 0], up: [0, 0, 1] } },
      input: 10 * n + 1,
    });
    ben.send({ type: 'pointer', view: 1, point_mm: [n, 2, 3] });
    ann.send({ type: 'item.put', kind: 'note', body: { text: `note ${n}` } });
    const still = await ann.frame((frame) => frame.isStill && frame.input >= 10 * n + 1);
    const scene = (await call(`${api}/rooms/${room}/scene`)).json;
    const found = await until(
      async () => {
        const t_ms = (await list(room)).find((one) => one.id === id).length_ms;
        return { t_ms, state: await stateAt(room, id, t_ms) };
      },
      ({ state }) =>
        state.items?.length === n &&
        state.scene.image.slices.axial.position_mm === position_mm &&
        state.pointers[0]?.point_mm[0] === n &&
        state.views[0]?.document.camera.position_mm[0] === 300 * n,
    );
    assert.deepEqual(found.state.scene, scene);
    moments.push({ t_ms: found.t_ms, scene, bytes: Buffer.from(still.picture), items: n });
  }
  await kill();
  await start();
  const [kept] = await list(room);
  assert.equal(kept.id, id);
  assert.equal(kept.state, 'cut', 'it is said that the recording was cut off');
  for (const moment of moments) assert.deepEqual((await stateAt(room, id, moment.t_ms)).scene, moment.scene);
  assert.equal((await call(`${api}/rooms/${room}/recordings/${id}/state`)).status, 422);
  assert.equal((await call(`${api}/rooms/${room}/recordings/none/state?t_ms=1`)).status, 404);
});

const goesOn = ({ state }) => ['queued', 'running'].includes(state);
/** The film of an order, as it says of itself. */
async function filmOf(order) {
  const made = await call(`${api}/rooms/${room}/recordings/${id}/video`, 'POST', { size_px: [320, 240], ...order });
  assert.equal(made.status, 202, made.text);
  assert.deepEqual([made.json.kind, made.json.plan], ['film', 'phantom']);
  const job = await until(
    async () => (await call(`${api}/jobs/${made.json.id}`)).json,
    (one) => !goesOn(one),
  );
  assert.deepEqual([job.state, job.percent, job.problem], ['done', 100, null]);
  const film = await fetch(`${api}/jobs/${made.json.id}/video`);
  assert.deepEqual([film.status, film.headers.get('content-type')], [200, 'video/webm']);
  return webm(Buffer.from(await film.arrayBuffer()));
}

test('a film of it is as long as the part that was ordered, or shorter by its pauses', async () => {
  const [{ length_ms }] = await list(room);
  const whole = await filmOf({ fps: 2 });
  assert.equal(whole.nFrames, Math.ceil((length_ms * 2) / 1000));
  assert.equal(whole.ms, whole.nFrames * 500);
  assert.equal(whole.width, 320);
  assert.ok(whole.height > 240, 'the caption stands below');
  const part = await filmOf({ fps: 10, from_ms: moments[0].t_ms, to_ms: moments[0].t_ms + 450 });
  assert.equal(part.nFrames, 5);
});

test('an order for a film of it outside its limits is refused, and says which field', async () => {
  const wrong = [
    [{ fps: 16 }, '/fps'],
    [{ fps: 1.5 }, '/fps'],
    [{ from_ms: -1 }, '/from_ms'],
    [{ from_ms: 40000000 }, '/from_ms'],
    [{ to_ms: 'end' }, '/to_ms'],
    [{ from_ms: 5, to_ms: 5 }, '/from_ms'],
    [{ pauses_s: 61 }, '/pauses_s'],
    [{ quality: 0 }, '/quality'],
    [{ size_px: [100, 100] }, '/size_px'],
    [{ size_px: [1920, 1200] }, '/size_px'],
    [{ size_px: [640.5, 480] }, '/size_px'],
    [{ size_px: [640] }, '/size_px'],
    [{ identity: 1 }, '/identity'],
    [{ seconds: 3 }, '/seconds'],
  ];
  for (const [order, pointer] of wrong) {
    const answer = await call(`${api}/rooms/${room}/recordings/${id}/video`, 'POST', order);
    assert.deepEqual([answer.status, answer.json.pointer], [422, pointer], JSON.stringify(order));
  }
  assert.equal((await call(`${api}/rooms/${room}/recordings/none/video`, 'POST', {})).status, 404);
});

test('a room that plays it draws byte for byte the same pictures, and changes nothing before it is left', async () => {
  const made = await call(`${api}/rooms`, 'POST', { plan: 'phantom', recording: { room, id } });
  assert.equal(made.status, 201, made.text);
  assert.notEqual(made.json.id, room);
  const dee = await enter(made.json.id, { name: 'Dee' });
  const what = await dee.message('replay');
  assert.equal(what.recording, id);
  assert.equal(what.plan_changed, false, 'the plan is the same after a restart');
  assert.deepEqual(
    what.marks.filter(([, kind]) => kind === 'note').map(([, , name]) => name),
    ['Ann', 'Ann', 'Ann'],
  );
  opens(dee);
  for (const moment of [moments[2], moments[0], moments[1]]) {
    dee.send({ type: 'replay.seek', t_ms: moment.t_ms });
    const frame = await dee.frame((one) => one.isStill && Buffer.from(one.picture).equals(moment.bytes));
    assert.ok(frame, 'the picture of the meeting');
    assert.deepEqual((await call(`${api}/rooms/${made.json.id}/scene`)).json, moment.scene);
    assert.equal((await call(`${api}/rooms/${made.json.id}/notes`)).json.notes.length, moment.items);
  }
  const pointer = await dee.message('pointer.at', (m) => m.point_mm?.[0] === 2);
  const names = await dee.message('replay.members', (m) => m.members.some((one) => one.id === pointer.member && one.name === 'Ben'));
  assert.ok(names);
  dee.send({ type: 'scene.patch', patch: { axes: { visible: false } }, input: 5 });
  assert.equal((await dee.message('problem', (m) => m.input === 5)).problem.status, 409);
  dee.send({ type: 'replay.seek', t_ms: 0 });
  dee.send({ type: 'replay.play', rate: 16 });
  await dee.message('replay.at', (m) => m.state === 'playing' && m.rate === 16);
  await dee.message('replay.at', (m) => m.state === 'ended');
  dee.send({ type: 'replay.leave' });
  await dee.message('replay.at', (m) => m.state === 'left');
  dee.send({ type: 'scene.patch', patch: { axes: { visible: false } }, input: 6 });
  assert.equal((await dee.message('scene', (m) => m.input === 6)).patch.axes.visible, false);
  assert.equal((await call(`${api}/rooms/${room}/recordings/${id}`, 'DELETE')).status, 204);
  assert.deepEqual(await list(room), []);
  assert.equal((await call(`${api}/rooms`, 'POST', { recording: { room, id } })).status, 404);
});
