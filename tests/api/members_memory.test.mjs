// Memory that a member of a room takes of the daemon.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const n_members = 60;

test('a member with four views takes at most 1 MiB of the daemon', async (t) => {
  const daemon = await startDaemon({ args: ['--stub', '--max-members', `${n_members + 1}`] });
  const clients = [];
  try {
    const api = `${daemon.url}/api/v1`;
    const residentKib = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${daemon.child.pid}/status`, 'utf8'))[1]);
    await until(
      async () => (await call(`${api}/plans`)).json.plans,
      (plans) => plans.some((p) => p.id === 'phantom'),
    );
    await openPlan(daemon.url, 'phantom');
    const room = (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
    const enter = async () => {
      const client = await Client.enter(daemon.url, room);
      clients.push(client);
      for (const [at, kind] of ['3d', 'axial', 'sagittal', 'coronal'].entries())
        client.send({ type: 'view.open', view: at + 1, document: { kind, size_px: [800, 600] }, follow: true });
      await until(
        () => new Set(client.frames.map(({ view }) => view)).size,
        (n) => n === 4,
      );
    };
    await enter();
    const before = residentKib();
    for (let n = 0; n < n_members; n++) await enter();
    clients[0].send({ type: 'view.patch', view: 1, patch: { camera: { height_mm: 250 } } }); // one picture for all of them
    const n_before = clients.map(({ frames }) => frames.length);
    await until(() => clients.every(({ frames }, n) => frames.length > n_before[n]), Boolean);
    const each = (residentKib() - before) / n_members;
    t.diagnostic(`${each.toFixed(0)} KiB each`);
    assert.ok(each <= 1024, `${each} KiB each`);
  } finally {
    for (const client of clients) client.cut();
    await daemon.stop();
  }
});
