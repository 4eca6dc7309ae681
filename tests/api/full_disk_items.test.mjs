// While the disk is full nothing that must last is accepted: each kind of item and links are refused in words, and nobody else hears of
// them; what is only looked at goes on, and the record says that it is not kept. --stub: grey pictures.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { FullDisk } from './full_disk.mjs';
import { Client } from './ws_client.mjs';

const read = `
import json, sqlite3, sys
db = sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30)
print(json.dumps({'items': [list(row) for row in db.execute('SELECT id, kind FROM items ORDER BY rowid')], 'records': [list(row) for row in db.execute('SELECT id, kind FROM records ORDER BY n')],
  'audit': [json.loads(row) for row, in db.execute('SELECT row FROM audit ORDER BY n')]}))
`;
const onDisk = (data) =>
  JSON.parse(execFileSync('python3', ['-c', read, join(data, 'beamroom.db')], { encoding: 'utf8', maxBuffer: 1 << 26 }));

let input = 0;
async function give(client, message) {
  const own = ++input;
  client.send({ ...message, input: own });
  return client.until(() => client.messages.find((m) => (m.type === 'item' || m.type === 'problem') && m.input === own), 'an answer');
}
const put = (client, kind, body, of = {}) => give(client, { type: 'item.put', kind, body, ...of });
const view = { name: 'Here', scene: {}, views: [], layout: { mode: '1', panes: ['3d'] } };
const items = [
  ['note', { text: 'Edge?' }],
  ['check', { entry: 'registration', text: 'Plan', state: 'ok' }],
  ['decision', { decision: 'accept', text: 'As shown' }],
  ['signature', { name: 'A. Example', meaning: 'reviewed' }],
];

test('on a full disk no item, decision, signature, saved view or link is accepted; afterwards each is', async (t) => {
  const disk = new FullDisk();
  if (disk.missing) {
    disk.remove();
    t.skip(disk.missing);
    return;
  }
  const daemon = await startDaemon({ data: disk.data, args: ['--stub'] });
  const clients = [];
  try {
    const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id,
      api = `${daemon.url}/api/v1/rooms/${room}`;
    const ann = await Client.enter(daemon.url, room, { name: 'Ann' }),
      ben = await Client.enter(daemon.url, room, { name: 'Ben' });
    clients.push(ann, ben);
    await ann.ready();
    await until(
      () => call(`${api}/record`),
      ({ status }) => status === 200,
    );
    const first = (await put(ann, 'note', { text: 'before' })).item;
    await ann.message('saved', (m) => m.state === 'saved');
    disk.fill(daemon.child);
    const from = ann.messages.length,
      isFailing = () => ann.messages.slice(from).some((m) => m.type === 'saved' && m.state === 'failing');
    const accepted = [first.id];
    for (let n = 0; n < 300 && !isFailing(); n++) {
      // what is left of the last block is used up
      const { item } = await put(ann, 'decision', { decision: 'accept', text: `${n} ${'x'.repeat(1900)}` });
      if (item) accepted.push(item.id);
      else await ann.message('saved', (m) => m.state === 'failing', from);
    }
    const heard = ben.messages.length;
    const refused = (answer, what) =>
      assert.deepEqual(
        [answer.type, answer.problem?.type, answer.problem?.status, answer.problem?.code],
        ['problem', '/problems/storage', 507, disk.code],
        what,
      );
    for (const [kind, body] of items) refused(await put(ann, kind, body), kind);
    refused(await put(ann, 'note', { text: 'a reply', parent: first.id }), 'a reply');
    refused(await put(ann, 'note', { text: 'changed' }, { item: first.id, version: 1 }), 'a change');
    refused(await give(ann, { type: 'item.delete', item: first.id }), 'a deletion');
    refused(await put(ann, 'bookmark', view), 'a saved view');
    const link = await call(`${api}/links`, 'POST', { role: 'observer' }, ann.headers);
    assert.deepEqual([link.status, link.json.type], [507, '/problems/storage']);
    assert.ok(!ben.messages.slice(heard).some(({ type }) => type === 'item'), 'nobody hears of what was refused');

    ann.send({ type: 'scene.patch', input: ++input, patch: { dose: { blood_ppm: 33 } } }); // weights, measures and the camera are shown on
    const { revision } = await ann.message('scene', (m) => m.input === input);
    const { json: record } = await until(
      () => call(`${api}/record?export=true`),
      ({ status }) => status === 200,
    );
    assert.equal(record.saved.state, 'failing');
    assert.ok(record.saved.revision < revision, 'the record says which scene is on the disk');
    const kept = onDisk(disk.data);
    assert.deepEqual(
      kept.items.map(([id]) => id),
      accepted,
    );
    assert.deepEqual(
      [...record.notes, ...record.decisions].map(({ id }) => id),
      accepted,
      'what is exported is on the disk',
    );
    assert.deepEqual([record.signatures, record.checklist, record.saved_views], [[], [], []]);

    disk.free(daemon.child);
    await ann.message('saved', (m) => m.state === 'saved' && m.revision >= revision, from);
    for (const [kind, body] of items) {
      const { item } = await put(ann, kind, body);
      const now = onDisk(disk.data); // it was answered when it was there
      assert.deepEqual(now.items.at(-1), [item.id, kind]);
      if (kind === 'decision' || kind === 'signature') assert.deepEqual(now.records.at(-1), [item.id, kind]);
      const row = now.audit.findLast(({ action }) => action === kind);
      assert.deepEqual([row.detail.item, row.name, row.address, row.detail.sha256.length], [item.id, 'Ann', '127.0.0.1', 64]);
    }
    assert.equal(onDisk(disk.data).records.length, accepted.length - 1 + 2);
    assert.equal((await call(`${api}/links`, 'POST', { role: 'observer' }, ann.headers)).status, 201);
  } finally {
    for (const client of clients) client.cut();
    await daemon.stop();
    disk.remove();
  }
});
