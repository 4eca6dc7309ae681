// Pictures that need more memory than the renderer's limit are refused with the amount they need; the renderer goes on.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';

test('a picture too large for the memory of its renderer is refused with both sizes, and a smaller one is drawn', async () => {
  /* memory before the first picture depends on the machine: finds the lowest limit at which a small picture is drawn */
  for (let mib = 120; ; mib += 30) {
    assert.ok(mib < 2000, 'no small picture under any limit');
    const daemon = await startDaemon({ args: ['--gl', 'soft', '--max-renderer-mib', `${mib}`] });
    try {
      const api = `${daemon.url}/api/v1`;
      const render = (side) => call(`${api}/plans/phantom/render`, 'POST', { format: 'jpeg', view: { size_px: [side, side] } });
      await until(
        async () => (await call(`${api}/plans`)).json.plans,
        (plans) => plans.some((p) => p.id === 'phantom' && p.parts.length),
      );
      if ((await openPlan(daemon.url, 'phantom')).state !== 'done' || (await render(256)).status !== 200) continue;
      if (/renderer stopped|renderer ended/.test(daemon.log())) continue; /* too little for the program itself */
      const large = await render(4096); /* its image alone takes 64 MiB */
      assert.equal(large.status, 503, large.text.slice(0, 300));
      assert.equal(large.json.type, '/problems/memory');
      assert.match(large.json.detail, /4096 x 4096 pixels: no memory for \d+ bytes/);
      assert.match(large.json.detail, new RegExp(`${mib} MiB \\(max-renderer-mib\\)`));
      assert.equal((await render(256)).status, 200);
      assert.doesNotMatch(daemon.log(), /renderer stopped|renderer ended/);
      return;
    } finally {
      await daemon.stop();
    }
  }
});
