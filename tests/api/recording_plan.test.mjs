// A recording keeps the revision of the plan's files: its replay says when one value of one file is another one since. --stub: grey pictures.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { gunzipSync, gzipSync } from 'node:zlib';
import { call, demo, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let data, plans, daemon;
const clients = new Set();
const start = async () => {
  daemon = await startDaemon({ data, plans: [plans], args: ['--stub'] });
};
async function enter(room) {
  const client = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.add(client);
  await client.ready();
  return client;
}
const revision = () =>
  until(
    () => call(`${daemon.url}/api/v1/plans/phantom/revision`),
    ({ status }) => status === 200,
  ).then(({ json }) => json.revision);

before(async () => {
  data = mkdtempSync(join(tmpdir(), 'beamroom-recording-'));
  plans = mkdtempSync(join(tmpdir(), 'beamroom-plans-'));
  cpSync(join(demo, 'phantom'), join(plans, 'phantom'), { recursive: true });
  await start();
});
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  for (const folder of [data, plans]) rmSync(folder, { recursive: true, force: true });
});

test('a changed voxel is another plan, also after a restart, and the former value the same again', async () => {
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const ann = await enter(room);
  ann.send({ type: 'recording.start' });
  const { id } = await ann.message('recording');
  const then = await revision();
  ann.send({ type: 'recording.stop' });
  await ann.message('recording', (m) => m.state === 'stopped');
  await daemon.stop();
  await start();
  const replay = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { recording: { room, id } })).json.id;
  const dee = await enter(replay);
  await dee.message('replay.at', (m) => m.state !== 'waiting');
  assert.equal(await revision(), then);
  const said = () => dee.messages.filter(({ type }) => type === 'replay').at(-1).plan_changed;
  assert.equal(said(), false, 'loading takes another time');
  const file = join(plans, 'phantom', 'ct.nii.gz');
  const bytes = readFileSync(file);
  const values = gunzipSync(bytes);
  values[values.length - 1001] ^= 1;
  for (const [content, isChanged] of [
    [gzipSync(values), true],
    [bytes, false],
  ]) {
    writeFileSync(file, content);
    await until(
      async () => {
        await call(`${daemon.url}/api/v1/plans`); // has the folders listed
        return said();
      },
      (found) => found === isChanged,
    );
    assert.equal((await revision()) === then, !isChanged);
  }
});
