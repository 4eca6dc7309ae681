// The WebSocket of the real daemon with one and several clients. --stub: grey pictures, everything else is real.
import assert from 'node:assert/strict';
import { after, afterEach, before, describe, test } from 'node:test';
import { call, renderersOf, sleep, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let daemon, api;
const clients = [];

before(async () => {
  daemon = await startDaemon({ args: ['--stub'] });
  api = `${daemon.url}/api/v1`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.some((p) => p.id === 'phantom' && p.parts.length),
  );
});
afterEach(() => {
  for (const client of clients.splice(0)) client.cut();
}); // a view without a client is not drawn again
after(async () => {
  if (daemon) assert.equal(await daemon.stop(), 0, daemon.log());
});

async function newRoom() {
  const answer = await call(`${api}/rooms`, 'POST', { plan: 'phantom' });
  assert.equal(answer.status, 201, answer.text);
  return answer.json.id;
}
async function connectTo(room, headers) {
  const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`, headers);
  clients.push(client);
  return client;
}
/** Sends hello and waits until the plan is ready. */
async function join(room, hello = {}) {
  const client = await connectTo(room);
  assert.equal(client.status, 101);
  client.send({ type: 'hello', protocol: 2, ...hello });
  client.welcome = await client.message('welcome');
  if (!client.welcome.plan) await client.message('plan', () => true, 0, 60000);
  await client.message('renderer', (m) => m.state === 'ready', 0, 60000);
  return client;
}
const openView = (client, more = {}) => client.send({ type: 'view.open', view: 1, document: { size_px: [320, 240] }, ...more });
const camera = (x) => ({ camera: { position_mm: [x, -900, 0], target_mm: [0, 0, 0], up: [0, 0, 1] } });
/** Waits until the last picture is a still and no other follows. */
const settled = async (client) => {
  for (let n = -1; n !== client.frames.length; ) {
    await client.until(() => client.frames.at(-1)?.isStill, 'a still');
    n = client.frames.length;
    await sleep(600);
  }
};
/** Moves the camera at least 40 times, until ten pictures after `from` have arrived; returns the last input. */
async function move(client, from, input = 0) {
  const end = Date.now() + 60000;
  for (let n = 0; n < 40 || (client.frames.length - from < 10 && Date.now() < end); n++) {
    client.send({ type: 'view.patch', view: 1, input: ++input, patch: camera(input) });
    await sleep(15);
  }
  assert.ok(client.frames.length - from >= 10, `${client.frames.length - from} pictures of ${input} inputs`);
  return input;
}
const rendered = async () => Number(/^beamroom_renders_total (\d+)/m.exec((await call(`${daemon.url}/metrics`)).text)?.[1]);

describe('the handshake', () => {
  test('is refused for a room that does not exist', async () => assert.equal((await connectTo('aaaa-aaaa')).status, 404));
  test('is refused for a page of another site', async () => {
    const room = await newRoom();
    assert.equal((await connectTo(room, { Origin: 'http://elsewhere.example' })).status, 403);
    assert.equal((await connectTo(room, { Origin: 'null' })).status, 403);
  });
  test('is taken from its own page and from programs', async () => {
    const room = await newRoom();
    assert.equal((await connectTo(room, { Origin: daemon.url })).status, 101);
    assert.equal((await connectTo(room)).status, 101);
  });
  test('without hello the connection ends after 5 s, with a reason', async () => {
    const client = await connectTo(await newRoom());
    assert.match((await client.message('bye')).reason, /hello/);
    await client.until(() => client.closeCode);
  });
  test('anything before hello is refused and ends it', async () => {
    const client = await connectTo(await newRoom());
    client.send({ type: 'ping', time_ms: 1 });
    assert.equal((await client.message('problem')).to, 'ping');
    await client.message('bye');
    await client.until(() => client.closeCode);
  });
  test('a page of an earlier protocol version is told to reload', async () => {
    const client = await connectTo(await newRoom());
    client.send({ type: 'hello', protocol: 1 });
    assert.match((await client.message('bye')).reason, /reload/);
  });
});

describe('messages', () => {
  test('in many fragments count as one', async () => {
    const client = await join(await newRoom());
    client.sendInPieces({ type: 'ping', time_ms: 123.5 }, 7);
    assert.equal((await client.message('pong')).time_ms, 123.5);
  });
  test('that are too large end the connection', async () => {
    const client = await join(await newRoom());
    client.send(JSON.stringify({ type: 'ping', time_ms: 1, filling: 'x'.repeat(65536) }));
    assert.equal(await client.until(() => client.closeCode), 1009);
  });
  test('that are too large in small fragments end it as well', async () => {
    const client = await join(await newRoom());
    client.sendInPieces({ type: 'ping', time_ms: 1, filling: 'x'.repeat(70000) }, 100);
    assert.equal(await client.until(() => client.closeCode), 1009);
    assert.ok(!client.messages.some((m) => m.type === 'pong'));
  });
  test('that are binary end the connection', async () => {
    const client = await join(await newRoom());
    client.sendBinary(Buffer.alloc(10));
    assert.equal(await client.until(() => client.closeCode), 1003);
  });
  test('that are not UTF-8 end the connection', async () => {
    const client = await join(await newRoom());
    client.write(1, Buffer.from([0x22, 0xc3, 0x28, 0x22]));
    assert.equal(await client.until(() => client.closeCode), 1007);
  });
  test('that are wrong are answered with a problem and change nothing', async () => {
    const client = await join(await newRoom());
    client.send({ type: 'scene.patch', input: 5, patch: { regions: { 'no-such-region': { visible: false } } } });
    const said = await client.message('problem', (m) => m.input === 5);
    assert.equal(said.to, 'scene.patch');
    assert.equal(said.problem.status, 422);
    assert.equal(said.problem.pointer, '/regions/no-such-region');
    client.send({ type: 'scene.patch', input: 6, patch: { image: { window: { width: -1, center: 10 } } } });
    assert.equal((await client.message('problem', (m) => m.input === 6)).problem.pointer, '/image/window/width');
    client.send('{"type":"view.op');
    assert.equal((await client.message('problem', (m) => m.to === '')).problem.type, '/problems/json');
    client.send({ type: 'frame.shown', view: 1, sequence: 3 });
    await client.message('problem', (m) => m.to === 'frame.shown');
    assert.ok(!client.messages.some((m) => m.type === 'scene'));
  });
});

describe('pictures', () => {
  test('come when a view is opened, moving at once and then still', async () => {
    const client = await join(await newRoom());
    openView(client, { input: 7 });
    const first = await client.frame();
    assert.equal(first.magic, 0x524d5242);
    assert.equal(first.version, 1);
    assert.equal(first.headerBytes, 112);
    assert.equal(first.payloadBytes, first.picture.length);
    assert.deepEqual([...first.picture.subarray(0, 2)], [0xff, 0xd8]); // JPEG
    assert.equal(first.isStill, false);
    assert.equal(first.input, 7);
    assert.equal(first.view, 1);
    assert.ok(first.matrix.every(Number.isFinite));
    const still = await client.frame((f) => f.isStill);
    assert.deepEqual([still.width, still.height, still.scale, still.isFullColor, still.isCoarse], [320, 240, 100, true, false]);
    assert.ok(still.sequence > first.sequence);
  });
  test('stop after two that are not acknowledged, and go on with the newest state', async () => {
    const client = await join(await newRoom());
    client.shows = false;
    openView(client);
    let input = 0;
    const move = async () => {
      client.send({ type: 'view.patch', view: 1, input: ++input, patch: camera(input) });
      await sleep(10);
    };
    for (const end = Date.now() + 60000; client.frames.length < 2 && Date.now() < end; ) await move();
    for (let i = 0; i < 60; i++) await move(); // what is not acknowledged by now holds all of these back
    await sleep(500);
    assert.equal(client.frames.length, 2);
    client.shows = true;
    client.send({ type: 'frame.shown', view: 1, sequence: client.frames.at(-1).sequence });
    const next = await client.frame(() => true, 2);
    assert.equal(next.input, input);
    await settled(client);
  });
  test('carry the input they show, in order, and end with the last one as a still', async () => {
    const client = await join(await newRoom());
    openView(client);
    await settled(client);
    const from = client.frames.length;
    const newest = await move(client, from);
    const last = await client.frame((f) => f.isStill && f.input === newest, from);
    const inputs = client.frames.slice(from).map((f) => f.input);
    assert.ok(
      inputs.every((input, i) => i === 0 || input >= inputs[i - 1]),
      inputs.join(),
    );
    assert.ok(client.frames.slice(from).every((f, i, all) => i === 0 || f.sequence > all[i - 1].sequence)); // a picture may be replaced before it is sent
    assert.equal(client.frames.at(-1), last);
  });
  test('are not made while nothing changes', async () => {
    const client = await join(await newRoom());
    openView(client);
    await settled(client);
    const before_ = await rendered(),
      frames = client.frames.length;
    assert.ok(before_ > 0, 'the metrics count renders');
    await sleep(1500);
    assert.equal(await rendered(), before_);
    assert.equal(client.frames.length, frames);
  });
});

describe('a room', () => {
  test('shows a change of the scene to everybody, in words and pictures', async () => {
    const room = await newRoom(),
      ann = await join(room, { name: 'Ann' }),
      ben = await join(room);
    openView(ann);
    openView(ben);
    await settled(ann);
    await settled(ben);
    ann.send({ type: 'scene.patch', input: 31, patch: { image: { window: { center: 77, width: 300 } } } });
    const heard = await ben.message('scene');
    assert.deepEqual(heard.patch, { image: { window: { center: 77, width: 300 } } });
    assert.equal(heard.by, ann.welcome.member);
    assert.equal(heard.input, 0);
    assert.equal((await ann.message('scene')).input, 31);
    await ben.frame((f) => f.revision === heard.revision && f.isStill);
    await ann.frame((f) => f.revision === heard.revision && f.input === 31);
    const scene = await call(`${api}/rooms/${room}/scene`);
    assert.equal(scene.json.image.window.center, 77);
  });
  test('gives followers the very same pictures, from one render', async () => {
    const room = await newRoom(),
      ann = await join(room),
      ben = await join(room);
    openView(ann, { follow: true });
    openView(ben, { follow: true });
    await settled(ann);
    await settled(ben);
    const before_ = await rendered(),
      from = ben.frames.length;
    ann.send({ type: 'view.patch', view: 1, input: 1, patch: camera(50) });
    const still = await ben.frame((f) => f.isStill, from),
      own = await ann.frame((f) => f.isStill && f.input === 1);
    assert.ok(still.picture.equals(own.picture));
    assert.ok(still.isShared);
    assert.equal(await rendered(), before_ + 2); // one moving, one still
    const moved = await ben.message('view', (m) => m.by === ann.welcome.member && m.document.camera.position_mm?.[0] === 50);
    assert.equal(moved.follow, true);
  });
  test('has one presenter: a follower moves nobody, looks elsewhere alone, and is called back', async () => {
    const room = await newRoom(),
      ann = await join(room),
      ben = await join(room);
    const members = async () => (await call(`${api}/rooms/${room}/members`)).json.members;
    const said = async (client, act) => {
      const from = client.messages.length;
      client.send(act);
      return (await client.message('problem', () => true, from)).problem.type;
    };
    openView(ann, { follow: true });
    openView(ben, { follow: true });
    await settled(ann);
    await settled(ben);
    const list = await members();
    assert.deepEqual(
      list.map((m) => [m.presenting, m.following]),
      [
        [true, false],
        [false, true],
      ],
    );
    assert.deepEqual((await call(`${api}/rooms/${room}`)).json.members, list);
    const frames = ann.frames.length;
    assert.equal(await said(ben, { type: 'view.patch', view: 1, patch: camera(9) }), '/problems/not-presenter');
    assert.equal(await said(ben, { type: 'scene.patch', patch: { image: { window: { center: 1 } } } }), '/problems/not-presenter');
    assert.equal(await said(ben, { type: 'present' }), '/problems/not-presenter');
    assert.equal(await said(ann, { type: 'follow', follow: false }), '/problems/not-presenter');
    ben.send({ type: 'follow', follow: false, input: 3 });
    const { axial } = (await call(`${api}/rooms/${room}/scene`)).json.image.slices;
    assert.equal((await ben.message('view', (m) => !m.follow)).document.override.image.slices.axial.position_mm, axial.position_mm);
    ben.send({ type: 'view.patch', view: 1, input: 4, patch: { size_px: [200, 100], ...camera(9) } });
    const own = await ben.frame((f) => f.isStill && f.input === 4);
    assert.deepEqual([own.width, own.height, own.isShared], [200, 100, false]);
    assert.equal(ann.frames.length, frames, 'no other picture for who presents');
    ann.send({ type: 'show.everyone' });
    await ben.message('view', (m) => m.follow && m.document.size_px[0] === 320, ben.messages.length - 1);
    await ben.frame((f) => f.isShared && f.isStill && f.picture.equals(ann.frames.at(-1).picture), frames);
    assert.equal(
      (await call(`${api}/rooms/${room}/scene`, 'PATCH', { image: { window: { center: 60 } } }, { 'If-Match': '*' })).status,
      200,
    ); // scripts may, as ever
  });
  test('is not slowed by a member who does not read', async () => {
    const room = await newRoom(),
      ann = await join(room),
      ben = await join(room);
    openView(ann, { follow: true });
    openView(ben, { follow: true });
    await settled(ann);
    await settled(ben);
    ben.pause();
    const from = ann.frames.length;
    const newest = await move(ann, from);
    await ann.frame((f) => f.isStill && f.input === newest, from);
    const seen = ben.frames.length;
    ben.resume();
    await settled(ben);
    assert.ok(ben.frames.at(-1).picture.equals(ann.frames.at(-1).picture)); // the newest picture, not forty one after the other
    assert.ok(ben.frames.length - seen <= 5, `${ben.frames.length - seen} frames`);
  });
  test('knows a member who comes back', async () => {
    const room = await newRoom(),
      ann = await join(room, { name: 'Ann' });
    ann.cut();
    const again = await join(room, { member: ann.welcome.member, secret: ann.welcome.secret });
    assert.equal(again.welcome.member, ann.welcome.member);
    assert.equal(again.welcome.name, 'Ann');
    const stranger = await join(room, { member: ann.welcome.member, secret: '0'.repeat(32) });
    assert.notEqual(stranger.welcome.member, ann.welcome.member);
    const list = (await stranger.message('members')).members;
    assert.deepEqual(
      list.map((m) => m.connected),
      [true, true],
    );
  });
  test('says bye when it is closed', async () => {
    const room = await newRoom(),
      ann = await join(room);
    assert.equal((await call(`${api}/rooms/${room}`, 'DELETE')).status, 204);
    await ann.message('bye');
    await ann.until(() => ann.closeCode);
    assert.equal((await connectTo(room)).status, 404);
  });
  test('outlives its renderer: killed in the middle of a drag, it is back with the newest state', async () => {
    const room = await newRoom(),
      ann = await join(room);
    openView(ann);
    await settled(ann);
    const victim = renderersOf(daemon.child.pid)[0];
    assert.ok(victim, 'a renderer runs');
    const from = ann.frames.length;
    for (let i = 1; i <= 10; i++) {
      ann.send({ type: 'view.patch', view: 1, input: i, patch: camera(i) });
      await sleep(15);
    }
    process.kill(victim, 'SIGKILL');
    for (let i = 11; i <= 30; i++) {
      ann.send({ type: 'view.patch', view: 1, input: i, patch: camera(i) });
      await sleep(15);
    }
    await ann.message('renderer', (m) => m.state === 'restarting');
    const since = ann.messages.findIndex((m) => m.type === 'renderer' && m.state === 'restarting');
    await ann.message('renderer', (m) => m.state === 'ready', since);
    await ann.frame((f) => f.isStill && f.input === 30, from);
  });
});
