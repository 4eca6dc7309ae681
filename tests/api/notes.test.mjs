// Notes and bookmarks of a room over HTTP and WebSocket.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

async function enter(url, room, name) {
  const client = await Client.enter(url, room, { name });
  return Object.assign(client, { me: client.welcome.member });
}

test('notes and bookmarks are in their lists, and in the welcome of who comes later', { timeout: 120000 }, async (t) => {
  const daemon = await startDaemon({ args: ['--stub'] });
  t.after(() => daemon.stop());
  const api = `${daemon.url}/api/v1`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 1 && plans[0].parts.length,
  );
  await openPlan(daemon.url, 'phantom');
  const room = (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const [ann, ben] = [await enter(daemon.url, room, 'Ann'), await enter(daemon.url, room, 'Ben')];
  assert.deepEqual((await call(`${api}/rooms/${room}/notes`)).json, { notes: [] });
  assert.deepEqual((await call(`${api}/rooms/${room}/bookmarks`)).json, { bookmarks: [] });
  assert.equal((await call(`${api}/rooms/none/notes`)).status, 404);

  ben.send({ type: 'item.put', kind: 'note', body: { text: 'Größe? 🧠 <b>', anchor: { point_mm: [1, 2, 3] } }, input: 5 });
  const made = await ben.message('item', ({ input }) => input === 5);
  ann.send({ type: 'item.put', kind: 'note', body: { text: 'yes', parent: made.id } });
  ann.send({ type: 'item.put', kind: 'bookmark', body: { name: 'here' } });
  await ann.message('item', ({ item }) => item.kind === 'bookmark');
  const notes = (await call(`${api}/rooms/${room}/notes`)).json.notes;
  assert.deepEqual(
    notes.map(({ author_name: who, body }) => [who, body.text, body.parent]),
    [
      ['Ben', 'Größe? 🧠 <b>', ''],
      ['Ann', 'yes', made.id],
    ],
  );
  assert.deepEqual(notes[0], made.item);
  assert.equal((await call(`${api}/rooms/${room}/bookmarks`)).json.bookmarks.length, 1);

  const cem = await enter(daemon.url, room, 'Cem');
  assert.equal((await cem.message('welcome')).items.length, 3);
  cem.send({ type: 'item.delete', item: made.id, input: 4 });
  assert.equal((await cem.message('problem', ({ input }) => input === 4)).problem.status, 403);
  ben.send({ type: 'item.put', item: made.id, version: 1, kind: 'note', body: { ...made.item.body, resolved: true } });
  ann.send({ type: 'item.put', item: made.id, version: 7, kind: 'note', body: made.item.body, input: 6 });
  assert.equal((await ann.message('problem', ({ input }) => input === 6)).problem.type, '/problems/conflict');
  await ben.message('item', ({ item }) => item?.version === 2); // until it is on disk, nobody else's change is taken
  ben.send({ type: 'item.delete', item: made.id });
  await cem.message('item', ({ id, item }) => id === made.id && item === null);
  assert.deepEqual((await call(`${api}/rooms/${room}/notes`)).json, { notes: [] });
  for (const client of [ann, ben, cem]) client.cut();
});
