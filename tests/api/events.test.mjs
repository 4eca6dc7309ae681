// The events of a room: what changes, for programs, as server-sent events; against the messages of a member. --stub: grey pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const told = ['plan', 'renderer', 'scene', 'members', 'item', 'acceptances', 'control', 'files', 'recording'];
let data, daemon, room, api, ann;
const open = [];

/** Reads text/event-stream as the standard says: fields line by line, an empty line ends an event. */
async function listen(at = api, headers = {}) {
  const abort = new AbortController();
  const response = await fetch(`${at}/events`, { headers, signal: abort.signal });
  const feed = { status: response.status, type: response.headers.get('content-type'), events: [], comments: 0, isEnded: false };
  feed.stop = () => abort.abort();
  open.push(feed);
  const read = async () => {
    let text = '',
      event = {};
    for await (const bytes of response.body) {
      text += Buffer.from(bytes).toString();
      for (let end; (end = text.indexOf('\n')) >= 0; text = text.slice(end + 1)) {
        const line = text.slice(0, end),
          [, field, value] = /^([^:]*)(?:: ?(.*))?$/.exec(line);
        if (!line) {
          if (event.event) feed.events.push({ ...event, json: JSON.parse(event.data) });
          event = {};
        } else if (!field) feed.comments++;
        else event[field] = value;
      }
    }
    feed.isEnded = true;
  };
  feed.done = read().catch(() => {});
  return feed;
}
const seen = (feed, matches) => until(() => feed.events.find(matches), Boolean, 20000);

before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-events-'));
  daemon = await startDaemon({ data, args: ['--stub'] });
  await openPlan(daemon.url, 'phantom');
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  api = `${daemon.url}/api/v1/rooms/${room}`;
});
after(async () => {
  ann?.cut();
  for (const feed of open) feed.stop();
  await daemon?.stop();
  rmSync(data, { recursive: true, force: true });
});

test('each change is told once, in the order of the messages of a member', async () => {
  ann = await Client.enter(daemon.url, room, { name: 'Ann' });
  const feed = await listen();
  assert.deepEqual([feed.status, feed.type], [200, 'text/event-stream']);
  await seen(feed, ({ event }) => event === 'reset');
  const { json: state } = feed.events[0],
    before = ann.messages.length;
  assert.equal(feed.events[0].retry, '2000');
  assert.deepEqual(state.scene, (await call(`${api}/scene`)).json);
  assert.deepEqual(state.room.members, (await call(`${api}/members`)).json.members);
  assert.deepEqual(state.control, (await call(`${api}/control`)).json);
  assert.deepEqual([state.items, state.recordings, state.room.id], [[], [], room]);

  const done = async (path, method, body, headers = {}) => {
    const { status, json, text } = await call(`${api}/${path}`, method, body, {
      'Beamroom-Member': ann.headers['Beamroom-Member'],
      ...headers,
    });
    assert.ok(status < 300, text);
    return json;
  };
  await done('scene', 'PATCH', { regions: { brain: { opacity: 0.4 } } }, { 'If-Match': '*' });
  const note = await done('notes', 'POST', { body: { text: 'Too close?' } });
  await done(`notes/${note.id}`, 'PATCH', { version: note.version, body: { text: 'Too close to the eye?' } });
  await done('bookmarks', 'POST', { body: { name: 'From above' } });
  const ben = await Client.enter(daemon.url, room, { name: 'Ben' });
  ann.send({ type: 'control.give', member: ben.welcome.member });
  await seen(feed, ({ event, json }) => event === 'control' && json.presenter === ben.welcome.member);
  ben.send({ type: 'recording.start' });
  await seen(feed, ({ event, json }) => event === 'recording' && json.state === 'running');
  ben.send({ type: 'scene.patch', patch: { regions: { brain: { opacity: 0.6 } } } });
  await done(`notes/${note.id}`, 'DELETE');
  ben.send({ type: 'control.give', member: ann.welcome.member });
  ben.cut();
  await seen(feed, ({ event, json }) => event === 'members' && json.members.some(({ connected }) => !connected));

  const plain = ({ input: _, unchanged: __, ...message }) => message;
  const got = () => feed.events.slice(1).map(({ event, json }) => (assert.equal(event, json.type), plain(json)));
  const messages = () =>
    ann.messages
      .slice(before)
      .filter(({ type }) => told.includes(type))
      .map(plain);
  await until(
    () => [got().length, messages().length],
    ([a, b]) => a === b && a > 8,
  );
  assert.deepEqual(got(), messages());
  const numbers = feed.events.map(({ id }) => Number(id.split('-')[1]));
  assert.deepEqual(
    numbers,
    numbers.map((_, i) => numbers[0] + i),
  );

  const middle = feed.events[4];
  const again = await listen(api, { 'Last-Event-ID': middle.id });
  await until(
    () => again.events.length,
    (n) => n >= feed.events.length - 5,
  );
  assert.deepEqual(
    again.events.map(({ id, data }) => [id, data]),
    feed.events.slice(5).map(({ id, data }) => [id, data]),
  );
  for (const id of ['0123456789abcdef-3', `${middle.id.split('-')[0]}-99999`, 'x', `${middle.id} `.repeat(20)]) {
    const other = await listen(api, { 'Last-Event-ID': id });
    await seen(other, ({ event }) => event === 'reset');
    assert.equal(other.events[0].event, 'reset', id);
    other.stop();
  }
});

test('who takes the events too slowly is told so, and holds up nobody', async () => {
  const quiet = `${daemon.url}/api/v1/rooms/${(await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id}`; // nobody is in it
  const { hostname, port, host } = new URL(daemon.url),
    slow = connect({ host: hostname, port: Number(port) });
  slow.pause();
  slow.write(`GET ${new URL(quiet).pathname}/events HTTP/1.1\r\nHost: ${host}\r\n\r\n`);
  const other = await listen(quiet);
  await seen(other, ({ event }) => event === 'reset');
  const points = (z) => Array.from({ length: 64 }, (_, i) => ({ at_mm: [i + 1 / 3, i + 2 / 7, z + 1 / 9] }));
  const measures = (z) => Object.fromEntries(Array.from({ length: 32 }, (_, i) => [`m${i}`, { kind: 'polyline', points: points(z + i) }]));
  const n = 90;
  for (let i = 0; i < n; i++) {
    const { status, text } = await call(`${quiet}/scene`, 'PATCH', { measures: measures(i) }, { 'If-Match': '*' });
    assert.equal(status, 200, text);
  }
  await until(
    () => other.events.filter(({ event }) => event === 'scene').length,
    (found) => found >= n,
  );
  let text = '';
  slow.on('data', (bytes) => {
    text += bytes;
  });
  const ended = new Promise((done) => slow.on('close', done));
  slow.resume();
  await until(
    () => text,
    () => /event: behind\ndata: \{"reason":"[^"]+"\}\n\n\r\n0\r\n\r\n$/.test(text),
  );
  slow.destroy();
  await ended;
});

test('not too many listen to a room, a room that is not there has none, and a restart begins anew', async () => {
  for (const feed of open.splice(0)) feed.stop();
  const feeds = [];
  await until(
    async () => {
      const feed = await listen();
      if (feed.status === 200) feeds.push(feed);
      return feed.status;
    },
    (status) => status === 429,
  );
  assert.ok(feeds.length <= 16 && feeds.length > 0, `${feeds.length}`);
  assert.equal((await listen(`${daemon.url}/api/v1/rooms/none`)).status, 404);
  const [{ id }] = feeds[0].events;

  await daemon.stop();
  await Promise.all(feeds.map(({ done }) => done));
  for (const feed of feeds) assert.deepEqual(feed.events.at(-1).event, 'bye');
  daemon = await startDaemon({ data, args: ['--stub'] });
  api = `${daemon.url}/api/v1/rooms/${room}`;
  const asleep = await listen();
  assert.equal(asleep.status, 503);
  assert.equal((await call(api)).status, 200); /* wakes it */
  const feed = await listen(api, { 'Last-Event-ID': id });
  await seen(feed, ({ event }) => event === 'reset');

  await call(`${api}?records=keep`, 'DELETE');
  await feed.done;
  assert.deepEqual([feed.events.at(-1).event, feed.isEnded], ['bye', true]);
  assert.match(feed.events.at(-1).json.reason, /\w/);
});
