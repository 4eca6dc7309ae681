// Thousands of connections at once. It is measured alone: beside other tests the daemon has no time to serve that many.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { call, openPlan, until } from './daemon.mjs';
import { HOST, open, startWithPlan, statuses } from './plain_connection.mjs';
import { Client } from './ws_client.mjs';

describe('a burst of connections', () => {
  let daemon,
    room,
    client,
    input = 0,
    moving;
  const camera = (x) => ({ camera: { position_mm: [x, -900, 0], target_mm: [0, 0, 0], up: [0, 0, 1] } });
  before(async () => {
    daemon = await startWithPlan();
    await openPlan(daemon.url, 'phantom');
    room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
    client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
    client.send({ type: 'hello', protocol: 2 });
    await client.message('welcome');
    client.send({ type: 'view.open', view: 1, document: { size_px: [64, 64] } });
    await client.frame();
    moving = setInterval(() => client.send({ type: 'view.patch', view: 1, input: ++input, patch: camera(input) }), 20);
  });
  after(async () => {
    clearInterval(moving);
    client?.cut();
    await daemon?.stop();
  });

  test('of 2,000 from four addresses is served or refused, each of them; frames go on, and so do requests afterwards', {
    timeout: 180000,
  }, async () => {
    const rounds = Number(process.env.BEAMROOM_BURSTS ?? 3);
    for (let round = 0; round < rounds; round++) {
      const n_frames = client.frames.length;
      const all = Array.from({ length: 2000 }, (_, i) =>
        open(daemon.url, `GET /healthz HTTP/1.1\r\n${HOST}\r\n`, { from: `127.0.1.${2 + (i % 4)}`, ms: 60000 }),
      );
      const answered = (c) => /^HTTP\/1\.1 (200|429) [\s\S]*\r\n\r\n/.test(c.text);
      await Promise.all(all.map((c) => until(() => answered(c) || c.socket.destroyed, Boolean, 60000)));
      const silent = all.filter((c) => !answered(c));
      const n_ok = all.filter((c) => statuses(c.text)[0] === 200).length;
      /* a connection that was closed before its head arrived gets no answer: the system's own queue is limited */
      assert.ok(
        silent.every((c) => c.socket.destroyed),
        `round ${round}: ${silent.length} of 2,000 were neither answered nor closed`,
      );
      assert.ok(n_ok >= 200, `round ${round}: ${n_ok} were served`); /* 64 of each address may wait for their heads at once */
      for (const c of all.filter((one) => statuses(one.text)[0] === 429))
        assert.match(c.text, /application\/problem\+json[\s\S]*Retry-After: \d/);
      for (const c of all) c.socket.destroy();
      await client.frame((f) => f.input > 0, n_frames + 1, 30000);
      const healthy = await until(
        async () => (await call(`${daemon.url}/healthz`).catch(() => ({}))).status,
        (status) => status === 200,
        30000,
      );
      assert.equal(healthy, 200, `after round ${round}`);
    }
    const after_ = client.frames.length;
    await client.frame(() => true, after_ + 5, 30000);
    assert.equal((await call(`${daemon.url}/api/v1/rooms/${room}`)).status, 200);
  });
});
