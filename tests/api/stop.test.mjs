// Messages of a daemon that is being stopped to clients that are connected, or connect meanwhile.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { call, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let daemon, room;
const clients = [];

before(async () => {
  daemon = await startDaemon({ args: ['--stub'] });
  await until(
    async () => (await call(`${daemon.url}/api/v1/plans`)).json.plans,
    (plans) => plans.some((p) => p.id === 'phantom' && p.parts.length),
  );
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
});

test('members and who has not said hello yet are told to come back in 2 s, with code 1001, and the daemon ends with 0', async () => {
  for (const says of [true, true, false]) {
    const client = await Client.open(daemon.url, `/api/v1/rooms/${room}/ws`);
    clients.push(client);
    if (!says) continue;
    client.send({ type: 'hello', protocol: 2 });
    await client.message('welcome');
  }
  const ended = new Promise((done) => daemon.child.on('exit', done));
  daemon.child.kill('SIGTERM');
  for (const client of clients) {
    const bye = await client.message('bye');
    assert.match(bye.reason, /being stopped/);
    assert.equal(bye.retry_ms, 2000);
    assert.equal(await client.until(() => client.closeCode), 1001);
    assert.equal(client.messages.filter((m) => m.type === 'bye').length, 1);
  }
  assert.equal(await ended, 0, daemon.log());
});
