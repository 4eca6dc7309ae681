// Flags and settings of the daemon.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';

test('the daemon says what is wrong with its flags and its settings, and stops at once when asked to', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-conf-'));
  const settings = join(folder, 'beamroomd.conf');
  const ends = async (args) => {
    try {
      const d = await startDaemon({ args });
      await d.stop();
      return 'started';
    } catch (error) {
      return error.message;
    }
  };
  assert.match(await ends(['--lisen', 'x']), /there is no flag --lisen/);
  assert.match(await ends(['--max-rooms', '0']), /max-rooms is "0", expected a whole number from 1/);
  assert.match(await ends(['--gl', 'vulkan']), /--gl is "vulkan"/);
  assert.match(await ends(['--listen', 'localhost']), /expected ADDRESS:PORT/);
  writeFileSync(settings, '# ours\nmax-rooms = 3\nport = 80\n');
  assert.match(await ends(['--config', settings]), /line 3: there is no setting "port"/);
  writeFileSync(settings, 'max-rooms = 1\nlog-level = debug\n');
  const limited = await startDaemon({ args: ['--config', settings] });
  await until(
    async () => (await call(`${limited.url}/api/v1/plans`)).json.plans,
    (plans) => plans[0]?.parts.length,
  );
  assert.equal((await call(`${limited.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).status, 201);
  const refused = await call(`${limited.url}/api/v1/rooms`, 'POST', { plan: 'phantom' });
  assert.deepEqual([refused.status, refused.type, refused.json.type], [429, 'application/problem+json', '/problems/limit']);
  assert.equal(await limited.stop(), 0, limited.log());
  rmSync(folder, { recursive: true });
});
