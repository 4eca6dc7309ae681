// Members who come late, or back after the daemon was killed, have everything within 2 s: measured with as many items as a room takes. --stub: grey pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, startDaemon } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const nItems = 1000,
  nBookmarks = 20;
const limitMs = 16000; // eight times the 2 s that a quiet machine is held to: tests run many at once, and on slow machines

async function enter(daemon, room, hello = {}) {
  const began = performance.now();
  const client = await Client.enter(daemon.url, room, hello);
  await client.until(() => client.welcome.scene || client.messages.some(({ type }) => type === 'plan'), 'the plan');
  return Object.assign(client, { tookMs: performance.now() - began });
}

test('a room with 1,000 items is restored to who comes late and to who comes back after a kill', { timeout: 180000 }, async (t) => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-late-'));
  let daemon = await startDaemon({ data, args: ['--stub'] });
  t.after(async () => {
    await daemon.stop();
    rmSync(data, { recursive: true, force: true });
  });
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id,
    ann = await enter(daemon, room);
  for (let n = 1; n <= nItems; n++) {
    // not faster than a connection may send
    const isBookmark = n <= nBookmarks;
    ann.send({
      type: 'item.put',
      kind: isBookmark ? 'bookmark' : 'note',
      input: n,
      body: isBookmark
        ? {
            name: `View ${n}`,
            order: n,
            views: [{ view: 1, document: { kind: '3d', camera: { position_mm: [300, n, 0], target_mm: [0, 0, 0], up: [0, 0, 1] } } }],
            layout: { layout: '2x1', cells: [1, 2], active: 1 },
          }
        : { text: `${n} ${'word '.repeat(240)}`.trim(), anchor: { point_mm: [n % 100, 2, 3] } },
    });
    if (n % 100 === 0) await ann.message('item', (message) => message.input === n);
  }
  ann.send({ type: 'scene.patch', input: nItems + 1, patch: { image: { window: { center: 77 } } } });
  const { revision } = await ann.message('scene', ({ input }) => input === nItems + 1);
  await ann.message('saved', (saved) => saved.state === 'saved' && saved.revision === revision);
  const rows = ann.messages
    .filter(({ type, item }) => type === 'item' && item)
    .map(({ item }) => item)
    .sort((a, b) => (a.id < b.id ? -1 : 1));
  assert.equal(rows.length, nItems);
  const holds = ({ welcome, tookMs }, who) => {
    assert.equal(welcome.revision, revision);
    assert.deepEqual(
      welcome.items.sort((a, b) => (a.id < b.id ? -1 : 1)),
      rows,
    );
    assert.ok(tookMs < limitMs, `${who} had everything after ${tookMs} ms`);
  };
  const late = await enter(daemon, room);
  const ended = new Promise((done) => {
    daemon.child.on('exit', done);
  });
  daemon.child.kill('SIGKILL');
  await ended;
  const killedAt = performance.now();
  daemon = await startDaemon({ data, args: ['--stub'] });
  const back = await enter(daemon, room, { member: ann.welcome.member, secret: ann.welcome.secret });
  const fromKillMs = performance.now() - killedAt;
  holds(late, 'who came late');
  holds(back, 'who came back');
  assert.equal(back.welcome.member, ann.welcome.member);
  t.diagnostic(
    `late: ${late.tookMs.toFixed(0)} ms; back after a kill: ${back.tookMs.toFixed(0)} ms, with the daemon's start ${fromKillMs.toFixed(0)} ms; ${JSON.stringify(back.welcome.items).length} bytes of items`,
  );
  for (const client of [ann, late, back]) client.cut();
});
