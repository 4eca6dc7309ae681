// Plans without use: they are closed, and loaded again when somebody enters their room. --stub: grey pictures, everything else is real.
import assert from 'node:assert/strict';
import { chmodSync, cpSync, existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { bin, call, demo, sleep, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const ids = ['head-1', 'head-2', 'head-3'];
let folder;

before(() => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-idle-'));
  for (const id of ids) cpSync(join(demo, 'phantom'), join(folder, 'plans', id), { recursive: true });
});
after(() => rmSync(folder, { recursive: true, force: true }));

async function withDaemon(args, run) {
  const daemon = await startDaemon({ plans: [join(folder, 'plans')], args: ['--stub', ...args] });
  const clients = [];
  const api = `${daemon.url}/api/v1`;
  const enter = async (room) => {
    const client = await Client.enter(daemon.url, room);
    clients.push(client);
    return client;
  };
  const ready = (client) => client.message('renderer', (m) => m.state === 'ready');
  const newRoom = async (plan) => {
    const answer = await call(`${api}/rooms`, 'POST', { plan });
    assert.equal(answer.status, 201, answer.text);
    return answer.json.id;
  };
  try {
    await run({ daemon, api, enter, ready, newRoom });
  } finally {
    for (const client of clients) client.cut();
    assert.equal(await daemon.stop(), 0, daemon.log());
  }
}
const stateOf = async (api, plan) => (await call(`${api}/plans/${plan}`)).json.state;
const picture = async (client) => {
  client.send({ type: 'view.open', view: 1, document: { size_px: [160, 120] } });
  return client.frame((f) => f.isStill);
};

describe('a plan with nobody in its rooms', () => {
  test('is let go after a while; the room keeps its scene and shows it again to whoever enters', () =>
    withDaemon(['--plan-idle-close', '1'], async ({ api, enter, ready, newRoom }) => {
      const room = await newRoom('head-1');
      const ann = await enter(room);
      await ready(ann);
      await picture(ann);
      ann.send({ type: 'scene.patch', input: 1, patch: { image: { window: { center: 77 } } } });
      const changed = await ann.message('scene');
      await sleep(2500); // longer than the limit, but somebody is in the room
      assert.equal(await stateOf(api, 'head-1'), 'ready');
      ann.cut();
      assert.equal(
        await until(
          () => stateOf(api, 'head-1'),
          (state) => state === 'not-loaded',
        ),
        'not-loaded',
      );
      assert.equal((await call(`${api}/rooms/${room}`)).json.renderer, 'closed');

      const scene = await call(`${api}/rooms/${room}/scene`);
      assert.equal(scene.json.image.window.center, 77);
      const patched = await call(
        `${api}/rooms/${room}/scene`,
        'PATCH',
        { check: { visible: true } },
        { 'If-Match': scene.headers.get('etag') },
      );
      assert.equal(patched.status, 200, patched.text);

      const ben = await enter(room);
      assert.equal((await ben.message('renderer')).state, 'starting', 'not what was before');
      await ready(ben);
      const plan = await ben.message('plan');
      assert.equal(plan.scene.image.window.center, 77);
      assert.equal(plan.scene.check.visible, true);
      assert.equal(plan.revision, changed.revision + 1);
      assert.ok((await picture(ben)).picture.length > 100);
    }));

  test('is loaded for a snapshot of its room', () =>
    withDaemon(['--plan-idle-close', '1'], async ({ api, newRoom }) => {
      const room = await newRoom('head-1');
      await until(
        () => call(`${api}/rooms/${room}`),
        (answer) => answer.json.renderer === 'ready',
      );
      assert.equal(
        await until(
          () => stateOf(api, 'head-1'),
          (state) => state === 'not-loaded',
        ),
        'not-loaded',
      );
      const snapshot = await fetch(`${api}/rooms/${room}/snapshot?view=${encodeURIComponent('{"size_px":[64,48]}')}`);
      assert.equal(snapshot.status, 200);
      assert.equal(snapshot.headers.get('content-type'), 'image/png');
      assert.ok((await snapshot.arrayBuffer()).byteLength > 50);
    }));

  test('makes place for another, the longest unused first; one that people look at does not', () =>
    withDaemon(['--max-renderers', '2'], async ({ api, enter, ready, newRoom }) => {
      const rooms = [await newRoom('head-1')];
      const ann = await enter(rooms[0]);
      await ready(ann);
      rooms.push(await newRoom('head-2'));
      await until(
        () => stateOf(api, 'head-2'),
        (state) => state === 'ready',
      );
      rooms.push(await newRoom('head-3')); // head-2 is closed, though it has a room
      assert.equal(await stateOf(api, 'head-2'), 'not-loaded');
      assert.equal(await stateOf(api, 'head-1'), 'ready');
      const cas = await enter(rooms[2]);
      await ready(cas);

      const ben = await enter(rooms[1]); // both are in use
      const told = await ben.message('renderer', (m) => m.state === 'failed');
      assert.equal(told.problem.type, '/problems/busy');
      ann.cut();
      await ready(ben); // once somebody has left
      assert.equal(await stateOf(api, 'head-1'), 'not-loaded');
    }));
});

describe('a job that opens a plan', () => {
  test('stays done when nobody asked before the plan was closed again', () =>
    withDaemon(['--plan-idle-close', '1'], async ({ daemon, api }) => {
      const opened = await call(`${api}/plans/head-1/open`, 'POST');
      assert.equal(opened.status, 202);
      await until(
        () => daemon.log(),
        (log) => /head-1: closed/.test(log),
      ); // without a request in between
      assert.match(daemon.log(), /head-1: closed: nobody used it/);
      const job = await call(`${api}/jobs/${opened.json.id}`);
      assert.equal(job.json.state, 'done');
      assert.equal(job.json.percent, 100);
    }));

  test('stays failed when the plan was opened again since', () =>
    withDaemon([], async ({ daemon, api }) => {
      await until(
        () => call(`${api}/plans/head-2`),
        (plan) => plan.json.parts.length,
      ); // else its scan may refuse it before it is opened
      const head = join(folder, 'plans', 'head-2');
      writeFileSync(
        join(head, 'plan.json'),
        JSON.stringify({ format: 'beamroom-plan', version: 1, images: [{ id: 'ct', path: 'ct.nii.gz' }] }),
      ); // of several parts one would be left out
      rmSync(join(head, 'ct.nii.gz'));
      try {
        const first = await call(`${api}/plans/head-2/open`, 'POST');
        await until(
          () => daemon.log(),
          (log) => /warning: plan head-2/.test(log),
        );
        cpSync(join(demo, 'phantom'), head, { recursive: true });
        const second = await call(`${api}/plans/head-2/open`, 'POST');
        assert.equal(
          (
            await until(
              () => call(`${api}/jobs/${second.json.id}`),
              (job) => job.json.state !== 'running',
            )
          ).json.state,
          'done',
        );
        const job = (await call(`${api}/jobs/${first.json.id}`)).json;
        assert.equal(job.state, 'failed');
        assert.match(job.problem.detail, /ct\.nii\.gz/);
      } finally {
        cpSync(join(demo, 'phantom'), head, { recursive: true });
      }
    }));
});

test('the plans are known when the daemon says that it is ready', () =>
  withDaemon([], async ({ api }) => {
    for (const id of ids) assert.equal((await call(`${api}/plans/${id}`)).status, 200);
  }));

test('a renderer that stops before every picture is tried again after pauses that the room is told of, and works again once it can', async () => {
  const broken = join(folder, 'broken'),
    renderer = join(folder, 'renderer.sh');
  writeFileSync(
    renderer,
    `#!/bin/sh\ncase "$*" in *--socket-fd*) [ -e ${broken} ] && kill -9 $$;; esac\nexec ${resolve(bin, 'beamroom-render')} "$@"\n`,
  );
  chmodSync(renderer, 0o755);
  await withDaemon(['--renderer', renderer], async ({ enter, ready, newRoom }) => {
    writeFileSync(broken, '');
    const ann = await enter(await newRoom('head-1'));
    const told = await ann.message('renderer', (m) => m.state === 'restarting' && m.problem?.retry_after_ms === 2000);
    assert.match(told.phase, /^the renderer stopped \(signal 9\); it is started again in 2 s$/);
    assert.equal(told.problem.detail, 'the renderer stopped (signal 9)');
    assert.ok(existsSync(broken));
    rmSync(broken);
    await ready(ann);
    await picture(ann);
  });
});
