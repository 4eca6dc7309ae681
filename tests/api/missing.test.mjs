// A region that cannot be drawn is left out and named; the others are drawn.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { promisify } from 'node:util';
import { bin, call, openPlan, sleep, startDaemon, until } from './daemon.mjs';
import { writeFoamPlan } from './foam_plan.mjs';
import { centreOf, readPng } from './png.mjs';
import { Client } from './ws_client.mjs';

const green = { visible: true, opacity: 1, color: '#00ff00' };
const asUnivels = { foam: { ...green, color: '#ff0000', representation: 'univels' }, block: { ...green, representation: 'univels' } };
const isGreen = ([r, g, b]) => g > 60 && g > 1.5 * r && g > 1.5 * b;
let folder, daemon, api;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-missing-'));
  writeFoamPlan(folder);
  daemon = await startDaemon({ plans: [folder], args: ['--gl', 'soft'] });
  api = `${daemon.url}/api/v1`;
  assert.equal((await openPlan(daemon.url, 'foam')).state, 'done');
});
after(async () => {
  await daemon?.stop();
  rmSync(folder, { recursive: true });
});

describe('a region that would take more triangles than the limit', { timeout: 240000 }, () => {
  test('is named with the picture of a script, which shows the others', async () => {
    const answer = await fetch(`${api}/plans/foam/render`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ scene: { regions: asUnivels }, view: { size_px: [200, 200] } }),
    });
    assert.equal(answer.status, 200);
    assert.equal(answer.headers.get('beamroom-missing'), 'foam');
    assert.ok(centreOf(readPng(await answer.arrayBuffer()), isGreen).n > 50, 'the block is seen');
    const whole = await fetch(`${api}/plans/foam/render`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ scene: { regions: { ...asUnivels, foam: { visible: false } } }, view: { size_px: [200, 200] } }),
    });
    assert.equal(whole.headers.get('beamroom-missing'), null);
    await whole.arrayBuffer();
  });

  test('is said to be missing in the caption of an annotated picture, not listed among the regions shown', async () => {
    const annotated = async (regions) => {
      const answer = await fetch(`${api}/plans/foam/render`, {
        method: 'POST',
        headers: { 'Content-Type': 'application/json' },
        body: JSON.stringify({ scene: { regions }, view: { size_px: [400, 200] }, annotations: true }),
      });
      const picture = readPng(await answer.arrayBuffer());
      const caption = { ...picture, height: picture.height - 200, at: (x, y) => picture.at(x, y + 200) };
      const n = (colour) => centreOf(caption, (rgb) => String(rgb) === colour).n;
      return { height: picture.height, red: n('255,0,0'), green: n('0,255,0') };
    };
    const missing = await annotated(asUnivels);
    const hidden = await annotated({ ...asUnivels, foam: { visible: false } });
    assert.ok(missing.height - hidden.height >= 12, 'one more line of text');
    assert.ok(missing.green > 20 && missing.green === hidden.green, `${missing.green} pixels of the chip of the block`);
    assert.deepEqual([missing.red, hidden.red], [0, 0], 'no chip of the foam');
  });

  test('is named by the command that draws it', async () => {
    const scene = join(folder, 'foam', 'scene.json');
    writeFileSync(scene, JSON.stringify({ regions: asUnivels }));
    const { stderr } = await promisify(execFile)(join(bin, 'beamroom'), [
      'render',
      join(folder, 'foam'),
      '--gl',
      'soft',
      '--scene',
      scene,
      '--size',
      '64x64',
      '-o',
      join(folder, 'picture.png'),
    ]);
    assert.match(stderr, /not in the picture: region "foam": .*40000000/);
  });

  test('is told in a room with its reason, once, and no picture is requested again while nothing changes', async () => {
    const room = (await call(`${api}/rooms`, 'POST', { plan: 'foam' })).json.id;
    const join_ = async () => {
      const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
      client.send({ type: 'hello', protocol: 2 });
      await client.message('welcome');
      client.send({ type: 'view.open', view: 1, document: { size_px: [160, 120] }, follow: true, input: 1 });
      return client;
    };
    // hidden at first: its smooth surface can be made, but slowly
    assert.equal(
      (
        await until(
          () => call(`${api}/rooms/${room}/scene`, 'PATCH', { regions: { foam: { visible: false } } }, { 'If-Match': '*' }),
          (a) => a.status === 200,
        )
      ).status,
      200,
    );
    const ann = await join_();
    await ann.frame((f) => f.isStill);
    assert.ok(!ann.messages.some((m) => m.type === 'missing'));
    ann.send({ type: 'scene.patch', patch: { regions: asUnivels }, input: 2 });
    await ann.frame((f) => f.isStill && f.input === 2);
    const said = ann.messages.filter((m) => m.type === 'missing');
    assert.equal(said.length, 1);
    assert.deepEqual([said[0].view, said[0].n, said[0].regions.length, said[0].regions[0].region], [1, 1, 1, 'foam']);
    assert.match(said[0].regions[0].reason, /region "foam": .*40000000/);
    assert.ok(!ann.messages.some((m) => m.type === 'problem'));
    const nRequested = async () => Number(/^beamroom_renders_total (\d+)/m.exec((await call(`${daemon.url}/metrics`)).text)[1]);
    const before = await nRequested();
    await sleep(5000); // it must not be requested again periodically
    assert.equal(await nRequested(), before);
    const ben = await join_(); // a later member is told, too
    assert.equal((await ben.message('missing')).n, 1);
    ann.send({ type: 'scene.patch', patch: { regions: { foam: { visible: false } } }, input: 3 });
    await ann.frame((f) => f.isStill && f.input === 3);
    assert.deepEqual(
      ann.messages.filter((m) => m.type === 'missing').map((m) => m.n),
      [1, 0],
    );
    ann.cut();
    ben.cut();
  });
});
