// A file that changes while the plan is open is noticed, also with its size and time kept: members are told, and nothing is decided until it is
// read anew. --stub: grey pictures.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, statSync, symlinkSync, utimesSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { call, demo, openPlan, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let input = 0;
async function put(client, kind, body) {
  const own = ++input;
  client.send({ type: 'item.put', kind, body, input: own });
  return client
    .until(() => client.messages.find((m) => (m.type === 'item' || m.type === 'problem') && m.input === own), 'an answer')
    .then((m) => m.item ?? m.problem);
}

test('a changed file is said to all, refuses decisions, and counts as read when the plan was opened again', async (t) => {
  const plans = mkdtempSync(join(tmpdir(), 'beamroom-stale-'));
  cpSync(join(demo, 'phantom'), join(plans, 'phantom'), { recursive: true });
  const daemon = await startDaemon({ plans: [plans], args: ['--stub'] });
  const clients = [];
  t.after(async () => {
    for (const client of clients) client.cut();
    await daemon.stop();
    rmSync(plans, { recursive: true, force: true });
  });
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  const ann = await Client.enter(daemon.url, room, { name: 'Ann' });
  clients.push(ann);
  await ann.ready();
  await until(
    () => call(`${daemon.url}/api/v1/rooms/${room}/record`),
    ({ status }) => status === 200,
  );
  assert.equal((await put(ann, 'decision', { decision: 'accept', text: 'As shown' })).kind, 'decision');

  const file = join(plans, 'phantom', 'README.txt'),
    text = readFileSync(file, 'utf8'),
    { atime, mtime } = statSync(file);
  writeFileSync(file, `${text.slice(0, -1)}!`); // one letter is another
  utimesSync(file, atime, mtime);
  const refused = await put(ann, 'decision', { decision: 'accept', text: 'Still' });
  assert.deepEqual([refused.type, refused.code], ['/problems/conflict', 'files'], 'it was looked at before');
  const told = await ann.message('files', (m) => m.changed_ms > 0);
  assert.ok(told.changed_ms >= told.read_ms && Math.abs(told.changed_ms - Date.now()) < 120000);
  const ben = await Client.enter(daemon.url, room, { name: 'Ben' });
  clients.push(ben);
  await ben.message('files', (m) => m.changed_ms === told.changed_ms);
  assert.equal((await put(ann, 'signature', { name: 'A', meaning: 'seen' })).code, 'files');
  assert.equal((await put(ann, 'note', { text: 'Who changed it?' })).kind, 'note');

  const from = ann.messages.length;
  assert.equal((await call(`${daemon.url}/api/v1/plans/phantom/close`, 'POST')).status, 204);
  assert.equal((await openPlan(daemon.url, 'phantom')).state, 'done');
  await ann.message('files', (m) => m.changed_ms === 0, from);
  await until(
    () => put(ann, 'decision', { decision: 'defer', text: 'Read anew' }),
    ({ kind }) => kind === 'decision',
  );
});

test('links that lead out of the folder, or nowhere, keep no decision back', async (t) => {
  const plans = mkdtempSync(join(tmpdir(), 'beamroom-links-'));
  cpSync(join(demo, 'phantom'), join(plans, 'phantom'), { recursive: true });
  for (const [target, name] of [
    ['/root', 'folder'],
    ['/etc/shadow', 'file'],
    ['/nowhere/at/all', 'nothing'],
  ])
    symlinkSync(target, join(plans, 'phantom', name));
  const daemon = await startDaemon({ plans: [plans], args: ['--stub'] });
  t.after(async () => {
    await daemon.stop();
    rmSync(plans, { recursive: true, force: true });
  });
  await openPlan(daemon.url, 'phantom');
  const { status, json } = await until(
    () => call(`${daemon.url}/api/v1/plans/phantom/revision`),
    (answer) => answer.status !== 202 && answer.json?.type !== '/problems/busy',
  );
  assert.deepEqual([status, json.revision?.length], [200, 64], JSON.stringify(json));
});
