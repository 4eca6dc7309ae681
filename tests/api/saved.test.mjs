// Messages to members about the server's disk: saved when it is on disk and not before, and a full disk while it is full. --stub: grey pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, startDaemon } from './daemon.mjs';
import { FullDisk } from './full_disk.mjs';
import { onDisk } from './on_disk.mjs';
import { Client } from './ws_client.mjs';

const newRoom = async (daemon) => (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
const enter = (daemon, room, hello) => Client.enter(daemon.url, room, hello);
let input = 0;
async function patch(client, center) {
  client.send({ type: 'scene.patch', input: ++input, patch: { image: { window: { center } } } });
  return client.message('scene', (m) => m.input === input);
}
async function note(client, text) {
  const own = ++input;
  client.send({ type: 'item.put', input: own, kind: 'note', body: { text } });
  return (
    await client.until(() => client.messages.find((m) => m.input === own && (m.type === 'item' || m.type === 'problem')), 'an answer')
  ).item; // undefined: refused
}
/** The first message saved, after all that has come, with this state. */
const saved = (client, state = 'saved', from = client.messages.length) => client.message('saved', (m) => m.state === state, from);

test('saved is told after what is on disk, to all, once for many changes', async () => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-saved-'));
  const daemon = await startDaemon({ data, args: ['--stub'] });
  const room = await newRoom(daemon),
    ann = await enter(daemon, room);
  await ann.message('renderer', (m) => m.state === 'ready');
  await saved(ann, 'saved', 0);
  const ben = await enter(daemon, room);
  await saved(ben, 'saved', 0);
  for (const client of [ann, ben]) client.from = client.messages.length;
  const began = performance.now();
  let last;
  for (let n = 1; n <= 50; n++) last = await patch(ann, n);
  const text = await note(ben, 'here');
  const [toAnn, toBen] = await Promise.all(
    [ann, ben].map((client) => client.message('saved', (m) => m.state === 'saved' && m.revision === last.revision, client.from)),
  );
  assert.equal(toAnn.problem, null);
  const kept = onDisk(room, data);
  assert.equal(kept.revision, last.revision);
  assert.equal(kept.scene.image.window.center, 50);
  const told = ann.messages.slice(ann.from).filter(({ type }) => type === 'saved').length;
  assert.ok(told <= 2 + (performance.now() - began) / 1000, `${told} messages in ${performance.now() - began} ms`);
  if (ben.messages.indexOf(toBen) < ben.messages.findIndex((m) => m.item?.id === text.id)) await saved(ben);
  assert.deepEqual(onDisk(room, data).items, [text.id]);
  for (const client of [ann, ben]) client.cut();
  assert.equal(await daemon.stop(), 0);
  rmSync(data, { recursive: true, force: true });
});

test('a full disk is told while it is full; the old content stays whole, the room goes on, and all is written afterwards', async (t) => {
  const disk = new FullDisk();
  if (disk.missing) {
    disk.remove();
    t.skip(disk.missing);
    return;
  }
  let daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
  try {
    const room = await newRoom(daemon),
      ann = await enter(daemon, room);
    await ann.message('renderer', (m) => m.state === 'ready');
    await note(ann, 'before');
    const before = await patch(ann, 70);
    await ann.message('saved', (m) => m.state === 'saved' && m.revision === before.revision);
    disk.fill(daemon.child);
    const from = ann.messages.length;
    let last,
      n = 0,
      nNotes = 0;
    for (; n < 300 && !ann.messages.slice(from).some((m) => m.type === 'saved' && m.state === 'failing'); n++) {
      // what is left of the last block is used up
      last = await patch(ann, 100 + n);
      if (await note(ann, `meanwhile ${n} ${'x'.repeat(1900)}`)) nNotes++;
    }
    const failing = await ann.message('saved', (m) => m.state === 'failing', from);
    assert.deepEqual([failing.problem.type, failing.problem.status, failing.problem.code], ['/problems/storage', 507, disk.code]);
    last = await patch(ann, 71);
    const ben = await enter(daemon, room);
    assert.equal((await ben.message('saved')).state, 'failing', 'who comes now is told, too');
    const kept = onDisk(room, disk.data);
    assert.ok(kept.revision >= before.revision && kept.revision < last.revision, `revision ${kept.revision}`);
    assert.equal(kept.scene.image.window.center, kept.revision === before.revision ? 70 : 100 + kept.revision - before.revision - 1);
    assert.equal(kept.items.length, 1 + nNotes, 'each note that was accepted is on the disk, no other');
    assert.ok(
      !ann.messages.slice(ann.messages.indexOf(failing)).some((m) => m.type === 'saved' && m.state === 'saved'),
      'nothing is called saved',
    );

    disk.free(daemon.child);
    const fine = await ann.message('saved', (m) => m.state === 'saved' && m.revision === last.revision, ann.messages.indexOf(failing));
    assert.equal(fine.problem, null);
    const ended = new Promise((done) => {
      daemon.child.on('exit', done);
    });
    daemon.child.kill('SIGKILL');
    await ended;
    const after = onDisk(room, disk.data);
    assert.deepEqual([after.revision, after.scene.image.window.center, after.items.length], [last.revision, 71, 1 + nNotes]);
    daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
    const back = await enter(daemon, room, { member: ann.welcome.member, secret: ann.welcome.secret });
    assert.equal(back.welcome.items.length, 1 + nNotes);
    assert.equal(back.welcome.revision, last.revision);
    assert.equal((await saved(back, 'saved', 0)).revision, last.revision);
    for (const client of [ann, ben, back]) client.cut();
  } finally {
    await daemon.stop();
    disk.remove();
  }
});
