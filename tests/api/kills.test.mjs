// A daemon is killed at random moments while a room is edited: what was told to be saved is there after the restart, everything else is
// there as it was or as it was to be, and nothing is torn. KILLS: how often (docs/testing.md). --stub: grey pictures.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, sleep, startDaemon } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const nKills = Number(process.env.KILLS ?? (process.env.LONG_TESTS ? 25 : 3));
const mostMs = 1300; // of edits before a kill: rooms are written every 200 ms
const mostItems = 40;

/** Model of the room, from all that was sent and all that the server has told. */
class Model {
  sent = new Map(); // text of a note: its version; each text is sent once
  items = new Map(); // id: {version, text, isBusy}, as the server told them last
  saved = { n: 0, items: new Map(), gone: new Set(), tokens: new Map() }; // told to be on disk; tokens: link -> person who has used it, '' nobody
  fresh = { items: new Map(), gone: new Set(), tokens: new Map() }; // told, and not yet told to be on disk
  n = 0; // of the newest patch: the scene's window is [n, n + 1]
  offset = null; // revision - n
  isReady = false; // the plan is loaded, so that the scene can be changed
  counts = { kills: 0, saved: 0, edits: 0, kept: 0, scenes: 0, old: 0, later: 0, links: 0 };

  /** Each message of the server, in its order. */
  heard(message) {
    if (message.type === 'scene') {
      this.offset ??= message.revision - message.patch.image.window.center;
    } else if (message.type === 'item' && message.item) {
      const { id, version, body } = message.item;
      this.items.set(id, { version, text: body.text, isBusy: false });
      this.fresh.items.set(id, version);
    } else if (message.type === 'item') {
      this.items.delete(message.id);
      this.fresh.items.delete(message.id);
      this.fresh.gone.add(message.id);
    } else if (message.type === 'saved') {
      if (this.offset !== null) this.saved.n = Math.max(this.saved.n, message.revision - this.offset); // also while more is being saved
      if (message.state !== 'saved') return;
      this.counts.saved++;
      this.#settle();
    } else if (message.type === 'plan') {
      this.isReady = true;
      this.#checkScene(message);
    }
  }

  #checkScene({
    revision,
    scene: {
      image: {
        window: { center, width },
      },
    },
  }) {
    if (this.offset === null) return;
    assert.deepEqual([center, width], [revision - this.offset, center + 1], 'the scene is whole and that of its revision');
    this.counts.scenes++;
  }

  #settle() {
    for (const [id, version] of this.fresh.items) this.saved.items.set(id, version);
    for (const id of this.fresh.gone) {
      this.saved.items.delete(id);
      this.saved.gone.add(id);
    }
    for (const [token, person] of this.fresh.tokens) this.saved.tokens.set(token, person);
    this.fresh = { items: new Map(), gone: new Set(), tokens: new Map() };
  }

  /** After a restart: revision and rows of the welcome. They are on disk, so they are what is saved from now on. */
  check({ revision, items }) {
    const n = this.offset === null ? 0 : revision - this.offset;
    assert.ok(n >= this.saved.n && n <= this.n, `scene ${n}, saved ${this.saved.n}, sent ${this.n}`);
    const there = new Map(items.map((item) => [item.id, item]));
    for (const [id, version] of this.saved.items)
      if (!this.fresh.gone.has(id) && !this.items.get(id)?.isBusy)
        assert.ok(there.get(id)?.version >= version, `${id} was saved as version ${version}: ${JSON.stringify(there.get(id))}`);
      else if (there.has(id)) assert.ok(there.get(id).version >= version);
    for (const id of this.saved.gone) assert.ok(!there.has(id), `${id} was deleted`);
    for (const { id, version, body } of items) assert.equal(this.sent.get(body.text), version, `${id} is whole: ${JSON.stringify(body)}`);
    this.counts.kept += items.length;
    this.counts.old += Number(n < this.n);
    this.n = n;
    this.isReady = false;
    this.items = new Map(items.map(({ id, version, body }) => [id, { version, text: body.text, isBusy: false }]));
    this.saved.items = new Map(items.map(({ id, version }) => [id, version]));
    this.saved.n = n;
    this.fresh = { items: new Map(), gone: new Set(), tokens: new Map() };
  }
}

const model = new Model();
let nTexts = 0;

async function enter(daemon, room, hello, heard) {
  const client = await Client.hello(daemon.url, room, hello);
  const first = await client.until(
    () => client.messages.find(({ type }) => type === 'welcome' || type === 'bye') ?? client.closeCode,
    'welcome or bye',
  );
  if (typeof first === 'number') throw new Error('the daemon was killed before it could answer');
  let n = client.messages.indexOf(first) + 1;
  client.drain = () => {
    while (n < client.messages.length) heard?.(client.messages[n++]);
  };
  return Object.assign(client, { first });
}

/** Enters again as the page does: it tries again while the server has no time. */
async function comeBack(daemon, { room, identity }) {
  for (let n = 1; ; n++) {
    const client = await enter(daemon, room, identity, (message) => model.heard(message));
    const { type, reason, retry_ms: retryMs } = client.first;
    if (type === 'welcome') return client;
    client.cut();
    assert.ok(retryMs !== null && n < 20, `not let in: ${reason}`);
    model.counts.later++;
    await sleep(retryMs);
  }
}

/** Some edits, none of which is waited for. */
function edit(client) {
  const { items, sent } = model;
  for (let i = 0; i < 3 && model.isReady; i++)
    client.send({ type: 'scene.patch', input: ++nTexts, patch: { image: { window: { center: ++model.n, width: model.n + 1 } } } });
  const put = (version, more) => {
    const text = `note ${++nTexts}`;
    sent.set(text, version);
    client.send({ type: 'item.put', kind: 'note', body: { text }, input: nTexts, ...more });
  };
  if (items.size < mostItems) put(1, {});
  const [oldest, ...others] = [...items].filter(([, { isBusy }]) => !isBusy);
  const changed = others[Math.floor(Math.random() * others.length)];
  if (changed) {
    changed[1].isBusy = true;
    put(changed[1].version + 1, { item: changed[0], version: changed[1].version });
  }
  if (oldest && items.size >= mostItems) {
    oldest[1].isBusy = true;
    client.send({ type: 'item.delete', item: oldest[0], input: ++nTexts });
  }
  model.counts.edits += 5;
}

/** Links for one person: made in one life of the daemon, used in a later one, refused to others in all after that. */
async function links(daemon, room, client, by) {
  const { saved, fresh } = model;
  const fact = async (token, person) => {
    // saved only by what the server says after it has answered this
    const time = performance.now();
    client.send({ type: 'ping', time_ms: time });
    const found = () => client.messages.some((pong) => pong.type === 'pong' && pong.time_ms === time);
    await client.until(() => found() || client.closeCode, 'pong');
    if (!found()) throw new Error('the daemon was killed before it could answer');
    client.drain();
    fresh.tokens.set(token, person);
  };
  const [token, person] = [...saved.tokens].at(-1) ?? [];
  if (token) {
    const other = await enter(daemon, room, { link: token, person: person ? 'somebody else' : 'the first' });
    assert.equal(other.first.type, person ? 'bye' : 'welcome', `link ${token}, used by "${person}": ${other.first.reason}`);
    other.cut();
    model.counts.links++;
    saved.tokens.delete(token); // used: a room of 32 links forgets such ones first
    if (!person) await fact(token, 'the first');
  }
  const { status, json } = await call(`${daemon.url}/api/v1/rooms/${room}/links`, 'POST', { role: 'observer', one_use: true }, by);
  if (status === 201) await fact(json.token, '');
}

/** The room has a scene of the model's and is on disk, so that it is there after the first kill. */
async function first(client) {
  await client.message('renderer', ({ state }) => state === 'ready');
  client.send({ type: 'scene.patch', input: ++nTexts, patch: { image: { window: { center: ++model.n, width: model.n + 1 } } } });
  const { revision } = await client.message('scene');
  await client.message('saved', (saved) => saved.state === 'saved' && saved.revision === revision);
  client.drain();
}

async function life(data, world) {
  const daemon = await startDaemon({ data, args: ['--stub'] });
  const ended = new Promise((done) => {
    daemon.child.on('exit', done);
  });
  world.daemon = daemon;
  world.room ??= (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const client = await comeBack(daemon, world);
  const { member, secret } = client.first;
  if (world.identity) assert.equal(member, world.identity.member);
  world.identity = { member, secret };
  let failure = null;
  if (model.counts.kills) model.check(client.first);
  else await first(client);
  let nTicks = 0;
  const edits = setInterval(() => {
    try {
      client.drain();
    } catch (error) {
      failure = error;
    }
    if (nTicks++ % 20 < 3) edit(client); // at rest in between: nothing is called saved while it is edited on
  }, 30);
  const linked = links(daemon, world.room, client, { 'Beamroom-Member': `${member} ${secret}` }).catch((error) => {
    if (error.code === 'ERR_ASSERTION') failure = error; // else the daemon was killed before it could answer
  });
  await sleep(Math.random() * mostMs);
  daemon.child.kill('SIGKILL');
  clearInterval(edits);
  await ended;
  await client.until(() => client.closeCode, 'the end of the connection'); // what it had told before counts
  client.drain();
  await Promise.race([linked, sleep(200)]);
  if (failure) throw failure;
  model.counts.kills++;
}

test('what was told to be saved outlives a daemon that is killed at any moment', { timeout: 60000 + nKills * 30000 }, async (t) => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-kills-'));
  const world = {};
  t.after(async () => {
    world.daemon?.child.kill('SIGKILL');
    rmSync(data, { recursive: true, force: true });
  });
  for (let n = 0; n < nKills; n++) await life(data, world);
  const daemon = await startDaemon({ data, args: ['--stub'] });
  world.daemon = daemon;
  const client = await comeBack(daemon, world);
  model.check(client.first);
  await client.message('plan');
  client.drain();
  client.cut();
  assert.equal(await daemon.stop(), 0);
  assert.doesNotMatch(daemon.log(), /damaged/);
  const { kills, saved, edits, kept, scenes, old, links: used, later } = model.counts;
  assert.ok(nKills < 3 || saved > 0, 'something was told to be saved');
  t.diagnostic(
    `${kills} kills, ${edits} edits, ${saved} times told saved, ${kept} items and ${scenes} scenes found again, ${used} links tried, ${later} times let in later; ${old} times edits were lost that nobody was told to be saved`,
  );
});
