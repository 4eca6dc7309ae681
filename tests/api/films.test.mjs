// Films where it matters what the renderer says and gets: a made-up renderer (film_renderer.mjs), no pictures. What films show: snapshot.test.mjs.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, demo, startDaemon, until } from './daemon.mjs';
import { holdThread, threadNamed } from './hold.mjs';
import { putWhole } from './made_dicom.mjs';
import { Client } from './ws_client.mjs';

let folder, daemon, api;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-films-'));
  copyFileSync(new URL('film_renderer.mjs', import.meta.url), join(folder, 'film_renderer.mjs'));
  const renderer = join(folder, 'renderer');
  const [node, real] = [process.execPath, join(bin, 'beamroom-render')];
  writeFileSync(
    renderer,
    `#!/bin/sh\ncase " $* " in *" --plan-id "*) exec ${node} ${folder}/film_renderer.mjs "$@";; esac\nexec ${real} "$@"\n`,
    {
      mode: 0o755,
    },
  );
  daemon = await startDaemon({ plans: [demo], args: ['--renderer', renderer, '--max-renderer-mib', '0'] });
  api = `${daemon.url}/api/v1`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 1,
  );
});
after(async () => {
  await daemon?.stop();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

const packets = () => {
  const log = join(folder, 'packets.jsonl');
  return existsSync(log)
    ? readFileSync(log, 'utf8')
        .trim()
        .split('\n')
        .map((line) => JSON.parse(line))
    : [];
};
const order = async (quality, seconds = 1, plan = 'phantom') => {
  const body = { seconds, fps: 4, quality, view: { kind: '3d', size_px: [240, 240] } };
  const { status, json, text } = await call(`${api}/plans/${plan}/video`, 'POST', body);
  assert.equal(status, 202, text);
  return json.id;
};
const job = async (id) => (await call(`${api}/jobs/${id}`)).json;
const ended = (id) =>
  until(
    () => job(id),
    ({ state }) => !['queued', 'running'].includes(state),
  );
/** The packets about the newest film of this quality. */
const about = (quality) => {
  const all = packets();
  const { film } = all.filter((packet) => packet.quality === quality).at(-1) ?? {};
  return all.filter((packet) => packet.film === film);
};

test('a film goes on where its renderer was busy for a moment, when that said', async () => {
  const id = await order(4);
  assert.equal((await ended(id)).state, 'done');
  const renders = about(4);
  assert.deepEqual(
    renders.map(({ film_at: at = 0 }) => at),
    [0, 1, 2, 2, 3],
    'the one film, not from its beginning',
  );
  assert.ok(renders[3].ms - renders[2].ms >= 890, 'after retry_after_ms');
});

test('each of two films that wait for their renderer goes on by itself, without a call', async () => {
  const before = new Set(packets().map(({ film }) => film));
  const pictures = (n) => {
    const own = packets().filter(({ film, type }) => type === 'render' && !before.has(film));
    const films = [...new Set(own.map(({ film }) => film))];
    return own.filter(({ film }) => film === films[n]).length;
  };
  await order(4);
  await until(
    () => pictures(0),
    (n) => n >= 3, // the third was refused
  );
  await order(4);
  await until(
    () => [pictures(0), pictures(1)],
    (all) => all.every((n) => n === 5),
  );
});

test('a film names the patient where that is ordered, and in no other; the audit has both words', async () => {
  for (const isNamed of [false, true]) {
    const body = { seconds: 1, fps: 2, quality: isNamed ? 71 : 70, view: { kind: '3d', size_px: [240, 240] }, identity: isNamed };
    const { status, json } = await call(`${api}/plans/phantom/video`, 'POST', body);
    assert.equal(status, 202);
    assert.equal((await ended(json.id)).state, 'done');
    assert.deepEqual(
      about(body.quality).map(({ named = false }) => named),
      [isNamed, isNamed],
    );
    assert.equal((await call(`${api}/jobs/${json.id}/video`)).status, 200);
    const what = isNamed ? 'film-named' : 'film';
    await until(
      async () => (await call(`${api}/audit?action=export`)).json.rows.map(({ detail }) => [detail.what, detail.media_type]),
      (rows) => rows.some(([word, type]) => word === what && type === 'video/webm'),
    );
  }
});

test('a film that is cancelled or fails is forgotten by its renderer', async () => {
  const id = await order(2);
  await until(
    () => about(2),
    ({ length }) => length === 1,
  );
  assert.equal((await call(`${api}/jobs/${id}`, 'DELETE')).json.state, 'cancelled');
  await until(
    () => about(2),
    (all) => all.at(-1).type === 'drop',
  );
  const failed = await ended(await order(5));
  assert.deepEqual([failed.state, failed.problem.type], ['failed', '/problems/timeout']);
  await until(
    () => about(5),
    (all) => all.at(-1).type === 'drop',
  );
});

test('128 MiB of films are kept, then the oldest goes; one that is being sent is sent whole', async () => {
  const ids = [];
  for (let i = 0; i < 4; i++) ids.push(await order(3));
  for (const id of ids) assert.equal((await ended(id)).state, 'done');
  const whole = 31 << 20;
  const slow = await fetch(`${api}/jobs/${ids[0]}/video`); // its body is read after the film is forgotten
  ids.push(await order(3));
  assert.equal((await ended(ids[4])).state, 'done');
  const sizes = await Promise.all(
    ids.map(async (id) => {
      const answer = await fetch(`${api}/jobs/${id}/video`);
      return answer.status === 200 ? (await answer.arrayBuffer()).byteLength : answer.status;
    }),
  );
  assert.deepEqual(sizes, [404, whole, whole, whole, whole]);
  assert.match((await call(`${api}/jobs/${ids[0]}/video`)).json.detail, /not kept any more/);
  assert.equal((await slow.arrayBuffer()).byteLength, whole);
});

test('jobs that open plans do not push out a film, neither one that is made nor one that is done', async () => {
  const [done, running] = [await order(80), await order(2)];
  assert.equal((await ended(done)).state, 'done');
  const open = async () => assert.equal((await call(`${api}/plans/phantom/open`, 'POST')).status, 202);
  for (let i = 0; i < 17; i++) await Promise.all(Array.from({ length: 30 }, open)); // more than are kept
  const opened = (await call(`${api}/plans/phantom/open`, 'POST')).json;
  assert.ok(Math.abs(opened.created_ms - Date.now()) < 60000);
  assert.equal((await job(running)).state, 'running');
  assert.equal((await call(`${api}/jobs/${done}/video`)).status, 200);
  assert.equal((await job(opened.id)).state, 'done', 'jobs after the 500th are kept as others');
  assert.equal((await call(`${api}/jobs/${running}`, 'DELETE')).json.state, 'cancelled');
});

test('a film of a recorded meeting is named, refused as busy, cancelled and begun anew as any other', async () => {
  const room = `${api}/rooms/${(await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id}`;
  const ann = await Client.enter(daemon.url, room.split('/').at(-1), { name: 'Ann' });
  await ann.message('renderer', ({ state }) => state === 'ready');
  ann.send({ type: 'recording.start' });
  const recordings = async () => (await call(`${room}/recordings`)).json.recordings;
  await until(recordings, (all) => all.length === 1 && all[0].length_ms > 2200);
  ann.send({ type: 'recording.stop' });
  const [{ id: recording, length_ms: lengthMs }] = await until(recordings, ([{ state }]) => state !== 'running');
  ann.cut();
  const fps = 5;
  const made = async (quality, more = {}) => {
    const { status, json, text } = await call(`${room}/recordings/${recording}/video`, 'POST', { quality, fps, ...more });
    assert.equal(status, 202, text);
    return json.id;
  };
  const nFrames = Math.ceil((lengthMs * fps) / 1000);
  /** The places, words and frames of the pictures of the newest film of this quality. */
  const pictures = (quality) =>
    about(quality).map(({ film_at: at = 0, words, times, named = false, type }) => ({ at, words, times, named, type }));
  const frames = (list) => list.reduce((sum, { times }) => sum + times, 0);

  assert.equal((await ended(await made(90, { identity: true }))).state, 'done');
  const named = pictures(90);
  assert.deepEqual([frames(named), named.every((one) => one.named)], [nFrames, true]);
  assert.match(named[0].words, /^Recorded meeting, [\d-]+ [\d:]+ UTC, 0:00:00 of 0:00:0\d; presenting: Ann$/);

  assert.equal((await ended(await made(4))).state, 'done');
  const busy = pictures(4);
  assert.deepEqual(busy.map(({ at }) => at).slice(0, 4), [0, 1, 2, 2]);
  assert.deepEqual(busy[2], busy[3], 'the same picture again');
  assert.equal(frames(busy.filter((_, n) => n !== 3)), nFrames);
  assert.ok(busy.every((one) => !one.named));

  const long = await made(2);
  await until(
    () => about(2),
    ({ length }) => length === 1,
  );
  assert.equal((await call(`${api}/jobs/${long}`, 'DELETE')).json.state, 'cancelled');
  await until(
    () => about(2),
    (all) => all.at(-1).type === 'drop',
  );
  assert.equal((await call(`${api}/jobs/${long}/video`)).status, 409);

  const again = await made(6);
  assert.equal((await ended(again)).state, 'done');
  assert.equal(frames(pictures(6)), nFrames, 'from its beginning');
  const { headers } = await call(`${api}/jobs/${again}/video`);
  assert.match(headers.get('content-disposition'), /filename="phantom-meeting-\d{8}T\d{6}Z\.webm"/);
});

test('with an uploaded plan its films go, those that are made and those that were', async () => {
  putWhole(join(folder, 'case'), { id: 'A-1001', name: 'Alpha^Anna', birthDate: '19610412' });
  execFileSync('tar', ['-cf', join(folder, 'case.tar'), '-C', folder, 'case']);
  const sent = await fetch(`${api}/plans?name=case`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/x-tar' },
    body: readFileSync(join(folder, 'case.tar')),
  });
  const { id: upload } = await sent.json();
  await ended(upload);
  const { plan } = await job(upload);
  const [done, running, other] = [await order(90, 1, plan), await order(2, 1, plan), await order(91)];
  for (const id of [done, other]) assert.equal((await ended(id)).state, 'done');
  assert.equal((await call(`${api}/jobs/${done}/video`)).status, 200);
  assert.equal((await call(`${api}/plans/${plan}`, 'DELETE')).status, 204);
  assert.equal((await ended(running)).state, 'cancelled');
  const copy = async (id) => (await call(`${api}/jobs/${id}/video`)).status;
  assert.deepEqual([await copy(done), await copy(running), await copy(other)], [404, 409, 200]);
});

test('a film that is made while its plan is being erased is not kept', async (t) => {
  const before = await order(92);
  assert.equal((await ended(before)).state, 'done');
  const held = await holdThread(await threadNamed(daemon.child.pid, 'store'));
  if (!held) return void t.skip('a thread of another program may not be stopped here');
  const erased = call(`${api}/plans/phantom/erase`, 'POST', { reason: 'asked for by the patient' });
  await until(
    () => call(`${api}/jobs/${before}/video`),
    ({ status }) => status === 404, // the call has come
  );
  const late = await order(93);
  assert.equal((await ended(late)).state, 'done');
  held.release();
  assert.equal((await erased).status, 200);
  assert.equal((await call(`${api}/jobs/${late}/video`)).status, 404);
});
