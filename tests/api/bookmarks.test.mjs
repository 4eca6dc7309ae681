// Bookmarks over HTTP and WebSocket: what one shows, its picture, and permalinks, which begin rooms of their own.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, openPlan, renderersOf, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let daemon;
let api;
before(async () => {
  daemon = await startDaemon({ args: ['--stub'] });
  api = `${daemon.url}/api/v1`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 1 && plans[0].parts.length,
  );
  await openPlan(daemon.url, 'phantom');
});
after(() => daemon?.stop());

const fixture = (name) => JSON.parse(readFileSync(new URL(`../data/bookmarks/${name}.json`, import.meta.url), 'utf8'));
const newRoom = async () => (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
const sceneOf = async (room) =>
  (
    await until(
      () => call(`${api}/rooms/${room}/scene`),
      ({ status }) => status === 200,
    )
  ).json;

const enter = (room, name, url = daemon.url) => Client.enter(url, room, { name });

let input = 100;
async function put(client, body, row = null) {
  input += 1;
  const mine = input;
  client.send({ type: 'item.put', kind: 'bookmark', body, input: mine, ...(row && { item: row.id, version: row.version }) });
  return (await client.message('item', (message) => message.input === mine)).item;
}

test('a permalink begins a room of its own with scene and camera, and the room that it is of is not touched', {
  timeout: 120000,
}, async () => {
  const room = await newRoom();
  const ann = await enter(room, 'Ann');
  ann.send({
    type: 'view.open',
    view: 1,
    follow: true,
    document: { kind: '3d', size_px: [200, 150], camera: { position_mm: [300, 0, 0], target_mm: [0, 0, 0], up: [0, 0, 1] } },
  });
  ann.send({ type: 'scene.patch', patch: { regions: { scalp: { visible: false } }, image: { window: { width: 77 } } }, input: 1 });
  await ann.message('scene', (message) => message.input === 1);
  const views = [{ view: 1, document: { kind: '3d', camera: { position_mm: [300, 0, 0], target_mm: [0, 0, 0], up: [0, 0, 1] } } }];
  const row = await put(ann, { name: 'Side', order: 1, views, layout: { layout: '2x1', cells: [1, 2], active: 1 } });
  assert.deepEqual(row.body.scene, { regions: { scalp: { visible: false } }, image: { window: { width: 77 } } });
  const etag = (await call(`${api}/rooms/${room}/scene`)).headers.get('etag');
  const scene = await sceneOf(room);

  // two at once, and each is alone
  const made = await Promise.all([1, 2].map(() => call(`${api}/rooms`, 'POST', { saved: row.body.token })));
  assert.deepEqual(
    made.map(({ status }) => status),
    [201, 201],
  );
  const [one, two] = made.map(({ json }) => json.id);
  assert.equal(new Set([one, two, room]).size, 3);
  assert.deepEqual([made[0].json.saved.name, made[0].json.saved.layout.cells, made[0].json.plan], ['Side', [1, 2], 'phantom']);
  assert.deepEqual(await sceneOf(one), scene);
  const { saved } = (await call(`${api}/rooms/${one}`)).json;
  assert.deepEqual([saved.report, saved.n_report], [[], 0]);
  const ben = await enter(one, 'Ben');
  ben.send({ type: 'view.open', view: 1, follow: true, document: { kind: '3d', size_px: [200, 150] } });
  const view = await ben.message('view');
  assert.deepEqual(view.document.camera.position_mm, [300, 0, 0]);
  await ben.frame((frame) => frame.isStill);
  ben.send({ type: 'scene.patch', patch: { regions: { scalp: { visible: true } } }, input: 2 });
  await ben.message('scene', (message) => message.input === 2);
  assert.deepEqual(await sceneOf(two), scene);
  assert.equal((await call(`${api}/rooms/${room}/scene`)).headers.get('etag'), etag);
  assert.deepEqual((await call(`${api}/rooms/${one}/bookmarks`)).json.bookmarks, []);
  assert.equal((await call(`${api}/rooms/${room}/members`)).json.members.length, 1);

  // the address for people
  const link = await fetch(`${daemon.url}/p/${row.body.token}`, { redirect: 'manual' });
  assert.deepEqual([link.status, link.headers.get('location')], [303, `/#/p/${row.body.token}`]);

  // a deleted bookmark opens nothing; rooms made from it stay
  ann.send({ type: 'item.delete', item: row.id });
  await ann.message('item', ({ id, item }) => id === row.id && item === null);
  const gone = await call(`${api}/rooms`, 'POST', { saved: row.body.token });
  assert.deepEqual([gone.status, gone.json.type, gone.json.pointer], [404, '/problems/not-found', '/saved']);
  const page = await fetch(`${daemon.url}/p/${row.body.token}`, { redirect: 'manual' });
  assert.equal(page.status, 404);
  assert.match(page.headers.get('content-type'), /^text\/html/);
  assert.match(await page.text(), /Nothing is saved under this link/);
  assert.equal((await call(`${api}/rooms/${two}`)).status, 200);
  ann.cut();
  ben.cut();
});

test('what makes no room says why', async () => {
  for (const [body, status, pointer] of [
    [{}, 422, '/plan'],
    [{ plan: 'phantom', saved: 'abc' }, 422, '/plan'],
    [{ saved: 7 }, 422, '/saved'],
    [{ saved: '../x' }, 422, '/saved'],
    [{ saved: 'qwe2rty3u4p5asd6fgh7' }, 404, '/saved'],
    [{ saved: 'a' }, 404, '/saved'],
    [{ plan: 'phantom', scene: {} }, 422, '/scene'],
  ]) {
    const { json, ...answer } = await call(`${api}/rooms`, 'POST', body);
    assert.deepEqual([answer.status, json.pointer], [status, pointer], JSON.stringify(body));
  }
  assert.equal((await fetch(`${daemon.url}/p/none`, { redirect: 'manual' })).status, 404);
  assert.equal((await fetch(`${daemon.url}/p/..%2f`, { redirect: 'manual' })).status, 404);
});

test('who asks for the picture of a bookmark while it is drawn for somebody else shares the drawing', { timeout: 120000 }, async () => {
  const room = await newRoom();
  const ann = await enter(room, 'Ann');
  await sceneOf(room);
  const row = await put(ann, { name: 'One' });
  const other = await put(ann, { name: 'Two' });
  const metric = async (name) =>
    Number(new RegExp(`^beamroom_http_pictures_${name} (\\d+)$`, 'm').exec(await (await fetch(`${daemon.url}/metrics`)).text())[1]);
  let before, pictures;
  for (let n = 1; n <= 5; n++) {
    // a renderer that stands for some seconds, as on a busy machine, is replaced
    before = await metric('total');
    const [renderer] = renderersOf(daemon.child.pid);
    process.kill(renderer, 'SIGSTOP'); // the pictures are under way until all have asked
    const asked = [row, row, row, other].map(({ id }) => fetch(`${api}/rooms/${room}/bookmarks/${id}/picture`));
    await until(
      async () => [(await metric('total')) - before, await metric('waiting')],
      ([drawn, waiting]) => drawn === 2 && (waiting === asked.length || waiting === 0),
      20000,
    ).catch(() => {});
    try {
      process.kill(renderer, 'SIGCONT');
    } catch {
      /* it was replaced */
    }
    pictures = await Promise.all(
      asked.map(async (one) => [(await one).status, Buffer.from(await (await one).arrayBuffer()).toString('base64')]),
    );
    if (pictures.every(([status]) => status === 200)) break;
    await openPlan(daemon.url, 'phantom');
  }
  assert.deepEqual(
    pictures.map(([status]) => status),
    [200, 200, 200, 200],
  );
  assert.equal(new Set(pictures.slice(0, 3).map(([, bytes]) => bytes)).size, 1);
  assert.deepEqual([(await metric('total')) - before, await metric('waiting')], [2, 0]);
  assert.equal((await fetch(`${api}/rooms/${room}/bookmarks/${row.id}/picture`)).status, 200);
  assert.equal((await metric('total')) - before, 3, 'one that comes later is drawn anew');
  ann.cut();
});

test('bookmarks of each version open, and what cannot be shown is named', { timeout: 120000 }, async () => {
  const room = await newRoom();
  const ann = await enter(room, 'Ann');
  await sceneOf(room);
  const revision = (await call(`${api}/rooms/${room}`)).json.revision;
  const { token: _, ...first } = fixture('version-1');
  const one = await put(ann, first);
  const opened = (await call(`${api}/rooms/${room}/bookmarks/${one.id}`)).json;
  assert.deepEqual([opened.id, opened.item_version, opened.name, opened.report], [one.id, 1, 'Tumour behind the beam', []]);
  assert.equal(opened.scene.regions.scalp.visible, false);
  assert.equal(opened.scene.regions.tumour.visible, true);
  assert.deepEqual(
    opened.views.map(({ view, document }) => [view, document.kind, document.camera.height_mm ?? 0]),
    [
      [1, '3d', 0],
      [2, 'axial', 150],
    ],
  );

  const two = await put(ann, fixture('version-2'));
  assert.equal(two.body.mood, 'calm');
  assert.equal(two.body.scene.regions.brain.glow, 0.7); // kept for the version that knows it
  const later = (await call(`${api}/rooms/${room}/bookmarks/${two.id}`)).json;
  assert.deepEqual(
    later.report.map(({ pointer, code }) => `${pointer} ${code}`),
    [
      '/version version',
      '/mood unknown-field',
      '/scene/regions/brain/glow unknown-field',
      '/scene/regions/liver unknown-id',
      '/scene/weather unknown-field',
      '/scene/image/window/curve unknown-field',
      '/scene/image/id unknown-id',
      '/scene/axes/visible type',
      '/views/0/document/camera/lens unknown-field',
      '/views/1/document/kind enum',
      '/views/1/document type',
    ],
  );
  assert.equal(later.scene.regions.brain.opacity, 0.5);
  const made = await call(`${api}/rooms`, 'POST', { saved: two.body.token });
  assert.deepEqual(await sceneOf(made.json.id), later.scene);
  assert.equal((await call(`${api}/rooms/${made.json.id}`)).json.saved.n_report, later.n_report);

  for (const id of [one.id, two.id]) {
    const picture = await fetch(`${api}/rooms/${room}/bookmarks/${id}/picture`);
    assert.deepEqual([picture.status, picture.headers.get('content-type')], [200, 'image/jpeg']);
    assert.ok((await picture.arrayBuffer()).byteLength < 40000);
  }
  assert.equal((await call(`${api}/rooms/${room}/bookmarks/none`)).status, 404);
  assert.equal((await call(`${api}/rooms/none/bookmarks/${one.id}/picture`)).status, 404);
  assert.equal((await call(`${api}/rooms/${room}`)).json.revision, revision);
  ann.cut();
});

test('a permalink opens after a restart, when its room sleeps', { timeout: 120000 }, async (t) => {
  const data = mkdtempSync(join(tmpdir(), 'beamroom-saved-'));
  t.after(() => rmSync(data, { recursive: true, force: true }));
  const start = async () => {
    const one = await startDaemon({ args: ['--stub'], data });
    await until(
      async () => (await call(`${one.url}/api/v1/plans`)).json.plans,
      (plans) => plans.length === 1 && plans[0].parts.length,
    );
    await openPlan(one.url, 'phantom');
    return one;
  };
  const first = await start();
  const room = (await call(`${first.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const ann = await enter(room, 'Ann', first.url);
  ann.send({ type: 'scene.patch', patch: { regions: { scalp: { visible: false } } }, input: 1 });
  await ann.message('scene', (message) => message.input === 1);
  const { body } = await put(ann, { name: 'Kept' });
  ann.cut();
  await first.stop();
  const second = await start();
  t.after(() => second.stop());
  assert.equal((await fetch(`${second.url}/p/qwe2rty3u4p5asd6fgh7`, { redirect: 'manual' })).status, 404);
  assert.equal((await fetch(`${second.url}/p/${body.token}`, { redirect: 'manual' })).status, 303);
  const made = await call(`${second.url}/api/v1/rooms`, 'POST', { saved: body.token });
  assert.equal(made.status, 201, made.text);
  assert.notEqual(made.json.id, room);
  const scene = await until(
    () => call(`${second.url}/api/v1/rooms/${made.json.id}/scene`),
    ({ status }) => status === 200,
  );
  assert.equal(scene.json.regions.scalp.visible, false);
});
