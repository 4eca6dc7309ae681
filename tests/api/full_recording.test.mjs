// A meeting is recorded while the disk fills up: the recording has no hole once there is space again, and what was written before plays if
// there never is. --stub: grey pictures.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { FullDisk } from './full_disk.mjs';
import { Client } from './ws_client.mjs';

async function enter(daemon, room, hello = {}) {
  const client = await Client.enter(daemon.url, room, hello);
  await client.ready();
  return client;
}
let input = 0;
async function patch(client, center) {
  client.send({ type: 'scene.patch', input: ++input, patch: { image: { window: { center } } } });
  return client.message('scene', (m) => m.input === input);
}
async function note(client, text) {
  const own = ++input;
  client.send({ type: 'item.put', input: own, kind: 'note', body: { text } });
  return client.until(() => client.messages.find((m) => m.input === own && (m.type === 'item' || m.type === 'problem')), 'an answer'); // a note is refused while the disk is full
}
const saved = (client, { revision }, from = 0) => client.message('saved', (m) => m.state === 'saved' && m.revision === revision, from);
const list = async (daemon, room) => (await call(`${daemon.url}/api/v1/rooms/${room}/recordings`)).json.recordings;
async function record(client) {
  client.send({ type: 'recording.start' });
  return (await client.message('recording', (m) => m.state === 'running', client.messages.length)).id;
}

/** Writes until the room is told that the disk is full. Returns the place of that message. */
async function fill(disk, daemon, client) {
  disk.fill(daemon.child);
  const from = client.messages.length,
    told = () => client.messages.findIndex((m, at) => at >= from && m.type === 'saved' && m.state === 'failing');
  for (let n = 0; n < 300 && told() < 0; n++) {
    // what is left of the last block is used up
    await patch(client, 1000 + n);
    await note(client, `${n} ${'x'.repeat(1900)}`);
  }
  await client.message('saved', (m) => m.state === 'failing', from);
  return told();
}

/** The center of the window that the replay shows at this time. */
async function shownAt(daemon, client, room, t_ms, center) {
  client.send({ type: 'replay.seek', t_ms });
  return until(
    async () => (await call(`${daemon.url}/api/v1/rooms/${room}/scene`)).json.image.window.center,
    (shown) => shown === center,
  );
}

test('the disk fills up while a meeting is recorded', async (t) => {
  const disk = new FullDisk();
  if (disk.missing) {
    disk.remove();
    t.skip(disk.missing);
    return;
  }
  let daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
  const kill = async () => {
    const ended = new Promise((done) => {
      daemon.child.on('exit', done);
    });
    daemon.child.kill('SIGKILL');
    await ended;
  };
  const clients = [];
  const stateAt = async (room, id, t_ms) => (await call(`${daemon.url}/api/v1/rooms/${room}/recordings/${id}/state?t_ms=${t_ms}`)).json;
  const lengthOf = async (room, id) => (await list(daemon, room)).find((one) => one.id === id).length_ms;
  try {
    const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id,
      ann = await enter(daemon, room);
    clients.push(ann);
    const moments = [],
      later = async (id, center) => {
        // a moment at which what was done is recorded, as it is four times a second
        const done_ms = await lengthOf(room, id);
        moments.push({
          center,
          t_ms: await until(
            () => lengthOf(room, id),
            (length) => length > done_ms + 600,
          ),
        });
      };
    const whole = await record(ann);
    await note(ann, 'before');
    await saved(ann, await patch(ann, 70));
    await later(whole, 70);

    const failing = await fill(disk, daemon, ann);
    assert.deepEqual([ann.messages[failing].problem.type, ann.messages[failing].problem.code], ['/problems/storage', disk.code]);
    await note(ann, 'meanwhile');
    const last = await patch(ann, 71);
    await later(whole, 71);
    assert.ok(!ann.messages.slice(failing).some((m) => m.type === 'saved' && m.state === 'saved'), 'nothing is called saved');
    assert.equal((await list(daemon, room))[0].state, 'running', 'and the recording goes on');

    disk.free(daemon.child);
    await saved(ann, last, failing);
    await patch(ann, 72);
    await later(whole, 72);
    ann.send({ type: 'recording.stop' });
    await ann.message('recording', (m) => m.state === 'stopped');
    const cut = await record(ann);
    const before = await patch(ann, 80);
    await saved(ann, before, ann.messages.length - 1);
    await until(
      () => stateAt(room, cut, 1e6),
      (state) => state.scene?.image.window.center === 80,
    );
    await fill(disk, daemon, ann);
    await patch(ann, 81);
    await kill();

    disk.free(daemon.child);
    daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
    const facts = await list(daemon, room);
    assert.deepEqual(
      facts.map(({ id, state }) => [id, state]),
      [
        [whole, 'stopped'],
        [cut, 'cut'],
      ],
    );
    for (const { t_ms, center } of moments)
      assert.equal((await stateAt(room, whole, t_ms)).scene.image.window.center, center, `${t_ms} ms`);
    const texts = (await stateAt(room, whole, moments[1].t_ms)).items.map(({ body }) => body.text);
    assert.ok(texts.includes('before') && !texts.includes('meanwhile'), 'what was refused while the disk was full is not in the recording');
    assert.notEqual((await stateAt(room, cut, facts[1].length_ms)).scene.image.window.center, 81, 'what was never on disk');

    const made = await call(`${daemon.url}/api/v1/rooms`, 'POST', { recording: { room, id: whole } });
    assert.equal(made.status, 201, made.text);
    const dee = await enter(daemon, made.json.id);
    clients.push(dee);
    for (const { t_ms, center } of moments) assert.equal(await shownAt(daemon, dee, made.json.id, t_ms, center), center);
    const rest = await call(`${daemon.url}/api/v1/rooms`, 'POST', { recording: { room, id: cut } });
    const eva = await enter(daemon, rest.json.id);
    clients.push(eva);
    eva.send({ type: 'replay.play', rate: 16 });
    assert.equal((await eva.message('replay.at', (m) => m.state === 'ended')).t_ms, facts[1].length_ms, 'what there is plays to its end');
  } finally {
    for (const client of clients) client.cut();
    await daemon.stop();
    disk.remove();
  }
});
