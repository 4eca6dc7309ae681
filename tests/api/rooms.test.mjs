// The most rooms on one plan that the daemon allows.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

test('every room that the daemon allows has a scene of its own and is drawn, the last one too', { timeout: 240000 }, async (t) => {
  const most = 260;
  const daemon = await startDaemon({ args: ['--max-rooms', String(most), '--stub'] });
  t.after(() => daemon.stop());
  const api = `${daemon.url}/api/v1`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 1 && plans[0].parts.length,
  );
  await openPlan(daemon.url, 'phantom');
  const rooms = [];
  for (let i = 0; i < most; i++) {
    const made = await call(`${api}/rooms`, 'POST', { plan: 'phantom' });
    assert.equal(made.status, 201, made.text);
    rooms.push(made.json.id);
  }
  assert.equal((await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).status, 429);
  const last = rooms.at(-1);
  assert.equal(
    (await call(`${api}/rooms/${last}/scene`, 'PATCH', { regions: { brain: { opacity: 0.2 } } }, { 'If-Match': '*' })).status,
    200,
  );
  for (const room of [last, rooms[0], rooms[256]]) {
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    client.send({ type: 'view.open', view: 1, document: { size_px: [64, 48] } });
    const frame = await client.frame((f) => f.isStill, 0, 20000);
    assert.equal(frame.revision, room === last ? 2 : 1);
    client.cut();
  }
});
