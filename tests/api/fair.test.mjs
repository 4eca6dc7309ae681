// Sharing a renderer fairly: a member who requests many large pictures does not slow one who turns a small picture.
import assert from 'node:assert/strict';
import { after, afterEach, before, test } from 'node:test';
import { call, openPlan, sleep, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let daemon, api, home;
const clients = [];

before(async () => {
  daemon = await startDaemon({ args: ['--gl', 'soft'] });
  api = `${daemon.url}/api/v1`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.some((p) => p.id === 'phantom' && p.parts.length),
  );
  await openPlan(daemon.url, 'phantom');
  home = (await call(`${api}/plans/phantom`)).json.home['3d'];
});
afterEach(() => {
  for (const client of clients.splice(0)) client.cut();
});
after(async () => {
  if (daemon) assert.equal(await daemon.stop(), 0, daemon.log());
});

async function join(room) {
  const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
  clients.push(client);
  client.send({ type: 'hello', protocol: 2 });
  await client.message('welcome');
  await client.message('renderer', (m) => m.state === 'ready');
  return client;
}
const newRoom = async () => (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;

/** A camera on a circle around the plan. */
function at(angle) {
  const [x, y, z] = home.target_mm,
    r = Math.hypot(home.position_mm[0] - x, home.position_mm[1] - y);
  return { camera: { ...home, position_mm: [x + r * Math.sin(angle), y - r * Math.cos(angle), z] } };
}

/** Turns a view of 640 x 480 until isOver; returns the number of pictures received. */
async function orbit(room, isOver) {
  const client = await join(room);
  client.send({ type: 'view.open', view: 1, document: { size_px: [640, 480] } });
  await client.frame();
  const from = client.frames.length,
    end = Date.now() + 60000;
  for (let input = 1; !isOver() && Date.now() < end; input++) {
    client.send({ type: 'view.patch', view: 1, input, patch: at(input / 40) });
    await sleep(15);
  }
  assert.ok(Date.now() < end, 'not over within a minute');
  return client.frames.length - from;
}

/* A full large picture takes as long as about fifty small ones. With turns by time, dozens of small ones are drawn in the time of a large one; with turns
   by number, one. Large pictures that move may be reduced until they cost no more than a few small ones: then the small view keeps at least half of the
   rate that it has alone. */
const atLeast = 4;

/** Pictures a second of the small view while nobody else draws. */
async function rateAlone() {
  const began = Date.now();
  const n = await orbit(await newRoom(), () => Date.now() - began > 2000);
  return (1000 * n) / (Date.now() - began);
}

for (const where of ['the same room', 'another room']) {
  test(`a member with eight views of 4096 x 4096 in ${where} leaves others their share`, async () => {
    const alone = await rateAlone();
    const room = await newRoom(),
      greedy = await join(where === 'the same room' ? room : await newRoom());
    let isOn = true;
    for (let view = 1; view <= 8; view++) greedy.send({ type: 'view.open', view, document: { size_px: [4096, 4096] } });
    const moving = (async () => {
      for (let input = 1; isOn; input++) {
        for (let view = 1; view <= 8; view++) greedy.send({ type: 'view.patch', view, input, patch: at(input / 30 + view) });
        await sleep(60);
      }
    })();
    await greedy.frame();
    let first = -1;
    const began = Date.now();
    const n = await orbit(room, () => greedy.frames.length - (first = first < 0 ? greedy.frames.length : first) >= 6);
    const rate = (1000 * n) / (Date.now() - began),
      nLarge = greedy.frames.length - first;
    isOn = false;
    await moving;
    assert.ok(
      n >= atLeast * nLarge || rate >= alone / 2,
      `${n} small pictures in the time of ${nLarge} large ones, ${rate.toFixed(1)} a second; alone ${alone.toFixed(1)}`,
    );
    assert.ok(greedy.frames.length - first >= 6); /* and it got its share, too */
  });
}

test('of eight members of a room who turn views of their own none gets less than a third of the mean rate', async () => {
  const room = await newRoom();
  const people = [];
  for (let n = 0; n < 8; n++) {
    const client = await join(room);
    client.send({ type: 'view.open', view: 1, document: { size_px: [640, 480], ...at(n) }, follow: false });
    people.push(client);
  }
  people.slice(1).forEach((client) => client.send({ type: 'follow', follow: false })); // the first presents
  await Promise.all(people.map((client) => client.frame()));
  const from = people.map((client) => client.frames.length),
    total = () => people.reduce((sum, client, n) => sum + client.frames.length - from[n], 0);
  const end = Date.now() + 60000;
  for (let input = 1; total() < 160; input++) {
    assert.ok(Date.now() < end, `${total()} pictures within a minute`);
    people.forEach((client, n) => client.send({ type: 'view.patch', view: 1, input, patch: at(n + input / 40) }));
    await sleep(20);
  }
  const drawn = people.map((client, n) => client.frames.length - from[n]);
  assert.ok(Math.min(...drawn) * 3 >= total() / 8, `pictures of each: ${drawn.join(', ')}`);
});

test('eight scripts that ask for pictures leave a member its share', async () => {
  const alone = await rateAlone();
  const room = await newRoom();
  let isOn = true,
    n_drawn = 0,
    first = -1;
  const scripts = Array.from({ length: 8 }, async (_, i) => {
    for (let n = 0; isOn; n++) {
      const body = JSON.stringify({ format: 'jpeg', view: { size_px: [2048, 2048], ...at(i + n / 10) } });
      const answer = await fetch(`${api}/plans/phantom/render`, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body });
      await answer.arrayBuffer();
      if (answer.status === 200) n_drawn++;
      else await sleep(50); /* busy: the most pictures at once are being drawn */
    }
  });
  const began = Date.now();
  const n = await orbit(room, () => n_drawn - (first = first < 0 ? n_drawn : first) >= 10);
  const rate = (1000 * n) / (Date.now() - began);
  isOn = false;
  const n_scripts = n_drawn - first;
  await Promise.all(scripts);
  assert.ok(
    n >= atLeast * n_scripts || rate >= alone / 2,
    `${n} small pictures in the time of ${n_scripts} of scripts, ${rate.toFixed(1)} a second; alone ${alone.toFixed(1)}`,
  );
});
