// Recordings of a plan whose folder is gone: that is said, and no room is made. --stub: grey pictures.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, renameSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, demo, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

test('a recording whose plan is gone is not played, and leaves no room behind; with the plan it plays', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-gone-')),
    plans = join(folder, 'plans'),
    data = join(folder, 'data');
  cpSync(join(demo, 'phantom'), join(plans, 'head'), { recursive: true });
  const start = () => startDaemon({ plans: [plans], data, args: ['--stub', '--plan-idle-close', '1'] });
  let daemon = await start(),
    client;
  const enter = async (room) => {
    client?.cut();
    client = await Client.enter(daemon.url, room);
    await client.ready();
    return client;
  };
  const rooms = async () => (await call(`${daemon.url}/api/v1/rooms`)).json.rooms.map(({ id }) => id);
  const planIs = (n) =>
    until(
      () => call(`${daemon.url}/api/v1/plans`),
      (answer) => answer.json.plans.length === n,
    ); // the list is made anew when asked for
  const restart = async () => {
    client.cut();
    assert.equal(await daemon.stop(), 0, daemon.log());
    daemon = await start();
  };
  try {
    const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'head' })).json.id,
      ann = await enter(room);
    ann.send({ type: 'recording.start' });
    const { id } = await ann.message('recording', (m) => m.state === 'running');
    ann.send({ type: 'scene.patch', input: 1, patch: { image: { window: { center: 77 } } } });
    await ann.message('scene', (m) => m.input === 1);
    ann.send({ type: 'recording.stop' });
    const { length_ms } = await ann.message('recording', (m) => m.state === 'stopped');
    const play = () => call(`${daemon.url}/api/v1/rooms`, 'POST', { recording: { room, id } });
    const isRefused = async (when) => {
      const refused = await play();
      assert.deepEqual([refused.status, refused.json.type], [404, '/problems/not-found'], `${when}: ${refused.text}`);
      assert.match(refused.json.detail, /plan "head"/, when);
      assert.deepEqual(await rooms(), [room], when);
    };

    ann.cut();
    await until(
      () => call(`${daemon.url}/api/v1/plans/head`),
      (plan) => plan.json.state === 'not-loaded',
    ); // what is loaded stays
    renameSync(join(plans, 'head'), join(folder, 'away'));
    await planIs(0);
    await isRefused('while the room is open');
    assert.equal((await call(`${daemon.url}/api/v1/rooms/${room}/recordings`)).json.recordings[0].id, id, 'it is kept');
    await restart();
    await planIs(0);
    await isRefused('after a restart');

    renameSync(join(folder, 'away'), join(plans, 'head'));
    await planIs(1);
    const made = await play();
    assert.equal(made.status, 201, made.text);
    const dee = await enter(made.json.id);
    dee.send({ type: 'replay.seek', t_ms: length_ms });
    await until(
      () => call(`${daemon.url}/api/v1/rooms/${made.json.id}/scene`),
      (scene) => scene.json.image?.window.center === 77,
    );
  } finally {
    client?.cut();
    await daemon.stop();
    rmSync(folder, { recursive: true, force: true });
  }
});
