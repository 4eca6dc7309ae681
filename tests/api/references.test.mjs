// Names of a plan's parts in a scene: a name that the plan does not have is refused wherever a scene can be written, before anything of it counts.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const proto = JSON.parse(readFileSync(new URL('../../proto/scene.json', import.meta.url), 'utf8'));
let daemon, url, api, plan;

/** Every field of the scene that names something of the plan: the patch that puts an unknown id there, and where it stands. */
function references(fields = proto.documents.scene.fields, path = []) {
  return fields.flatMap((field) => {
    const at = [...path, field.name];
    const patch = (value) => at.reduceRight((inner, name) => ({ [name]: inner }), value);
    if (field.names && field.type === 'id') return [{ pointer: `/${at.join('/')}`, patch: patch('nowhere') }];
    if (field.names && field.type === 'map') return [{ pointer: `/${at.join('/')}/nowhere`, patch: patch({ nowhere: {} }) }];
    return field.type === 'object' ? references(proto.objects[field.object].fields, at) : [];
  });
}

function assertRefused({ status, json }, pointer) {
  assert.equal(status, 422, JSON.stringify(json));
  assert.equal(json.type, '/problems/validation');
  assert.equal(json.pointer, pointer);
  assert.equal(json.code, 'unknown-id');
  assert.match(json.detail, /the plan has no (region|image|dose|beam) "nowhere"/);
}

before(async () => {
  daemon = await startDaemon();
  url = daemon.url;
  api = `${url}/api/v1`;
  plan = `${api}/plans/phantom`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 1 && plans[0].parts.length,
  );
  await openPlan(url, 'phantom');
});
after(() => daemon?.stop());

async function newRoom() {
  const { json } = await call(`${api}/rooms`, 'POST', { plan: 'phantom' });
  await until(
    () => call(`${api}/rooms/${json.id}/scene`),
    (a) => a.status === 200,
  );
  return json.id;
}

describe('a name the plan does not have', () => {
  test('can stand in these fields', () => {
    assert.deepEqual(
      references()
        .map(({ pointer }) => pointer)
        .sort(),
      [
        '/beam/id',
        '/beam/looks/nowhere',
        '/check/region',
        '/clip/beam/id',
        '/dose/compare/id',
        '/dose/coverage/region',
        '/dose/coverage/tissue',
        '/dose/id',
        '/dose/reference/region',
        '/dose/sum/nowhere',
        '/dose/tissue',
        '/dose/weights/nowhere',
        '/image/blend/id',
        '/image/id',
        '/image/looks/nowhere',
        '/irradiation/fields/nowhere',
        '/regions/nowhere',
      ],
    );
  });

  test("is refused in a picture over HTTP, in the scene and in the view's override", async () => {
    for (const { pointer, patch } of references()) {
      assertRefused(await call(`${plan}/render`, 'POST', { scene: patch, view: { size_px: [32, 32] } }), `/scene${pointer}`);
      assertRefused(await call(`${plan}/render`, 'POST', { view: { size_px: [32, 32], override: patch } }), `/view/override${pointer}`);
      const view = encodeURIComponent(JSON.stringify({ size_px: [32, 32], override: patch }));
      assertRefused(await call(`${plan}/pick?px=3&py=3&view=${view}`), `/view/override${pointer}`);
    }
  });

  test('is refused in a room over HTTP: the scene and its ETag stay, and snapshots are drawn', async () => {
    const room = `${api}/rooms/${await newRoom()}`;
    const first = await call(`${room}/scene`);
    for (const { pointer, patch } of references()) {
      assertRefused(await call(`${room}/scene`, 'PATCH', { surface: { normals: 'face' }, ...patch }, { 'If-Match': '*' }), pointer);
      const now = await call(`${room}/scene`);
      assert.deepEqual(now.json, first.json);
      assert.equal(now.headers.get('etag'), first.headers.get('etag'));
      const view = encodeURIComponent(JSON.stringify({ size_px: [32, 32], override: patch }));
      assertRefused(await call(`${room}/snapshot?view=${view}`), `/view/override${pointer}`);
      const picture = await fetch(`${room}/snapshot?view=${encodeURIComponent('{"size_px":[32,32]}')}`);
      assert.equal(picture.status, 200);
      await picture.arrayBuffer();
    }
  });

  test('is refused in a message, and pictures go on', async () => {
    const client = await Client.open(url, `/api/v1/rooms/${await newRoom()}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    const { revision } = await client.message('welcome');
    client.send({ type: 'view.open', view: 1, document: { size_px: [64, 48] } });
    await client.frame((f) => f.isStill);
    let input = 10;
    for (const { pointer, patch } of references()) {
      const refused = async (message, where) => {
        client.send({ ...message, input: ++input });
        const { problem } = await client.message('problem', (m) => m.input === input);
        assertRefused({ status: problem.status, json: problem }, where);
      };
      await refused({ type: 'scene.patch', patch }, pointer);
      await refused({ type: 'view.patch', view: 1, patch: { override: patch } }, `/override${pointer}`);
      await refused({ type: 'view.open', view: 2, document: { override: patch } }, `/override${pointer}`);
    }
    client.send({ type: 'scene.patch', input: ++input, patch: { regions: { brain: { opacity: 0.5 } } } });
    assert.equal((await client.message('scene')).revision, revision + 1, 'what was refused did not count');
    await client.frame((f) => f.isStill && f.input === input);
    client.cut();
  });
});
