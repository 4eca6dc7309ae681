// Every JSON answer of the API is what the API's own description says (proto/answers.json): no field more, none missing, each of its type.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { call, openPlan, startDaemon, until } from './daemon.mjs';
import { misfit, schemaOfAnswer } from './schema.mjs';
import { Client } from './ws_client.mjs';

let daemon, description, room, ann;
const met = new Set();

/** Calls, waits while the answer is that it is busy, and holds the answer to its schema. */
async function ask(path, method = 'GET', body, headers) {
  const answer = await until(
    () => call(`${daemon.url}${path}`, method, body, headers),
    ({ status }) => status !== 503,
  );
  assert.ok(answer.status < 300, `${method} ${path}: ${answer.text}`);
  const schema = schemaOfAnswer(description, method, path.split('?')[0], answer.status);
  assert.ok(schema?.$ref, `${method} ${path} has no schema`);
  assert.equal(misfit(schema, answer.json, description.components.schemas), '', `${method} ${path}`);
  met.add(schema.$ref.split('/').at(-1));
  return answer.json;
}

before(async () => {
  daemon = await startDaemon();
  description = (await call(`${daemon.url}/api/v1/openapi.json`)).json;
  await openPlan(daemon.url, 'phantom');
  room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
  ann = await Client.enter(daemon.url, room, { name: 'Ann' });
});
after(async () => {
  ann?.cut();
  await daemon?.stop();
});

test('each JSON answer but the description itself has a schema', () => {
  const without = Object.entries(description.paths).flatMap(([path, operations]) =>
    Object.entries(operations)
      .filter(([, { responses }]) =>
        Object.values(responses).some(({ content }) => content?.['application/json']?.schema.type === 'object'),
      )
      .map(([method]) => `${method} ${path}`),
  );
  assert.deepEqual(without, ['get /api/v1/openapi.json']);
});

test('an answer that is not as described is seen', () => {
  const { schemas } = description.components;
  const job = { id: 'open-1', kind: 'open', plan: null, state: 'done', phase: '', percent: 100, created_ms: 1, problem: null };
  const found = (changed) => misfit(schemas['answer.job'], { ...job, ...changed }, schemas);
  assert.equal(found({}), '');
  for (const wrong of [{ state: 'gone' }, { percent: null }, { more: 1 }, { plan: 3 }, { problem: { type: 'x' } }])
    assert.notEqual(found(wrong), '', JSON.stringify(wrong));
});

test('plans and jobs', async () => {
  for (const path of [
    '/readyz',
    '/api/v1/version',
    '/api/v1/plans',
    '/api/v1/plans/phantom',
    '/api/v1/plans/phantom/revision',
    '/api/v1/plans/phantom/identity',
  ])
    await ask(path);
  assert.equal((await ask('/api/v1/plans/search', 'POST', { text: 'SNYDER' })).total, 1);
  assert.equal((await ask('/api/v1/plans/search', 'POST', { text: 'nobody' })).total, 0);
  const { id } = await ask('/api/v1/plans/phantom/open', 'POST');
  await ask(`/api/v1/jobs/${id}`);
  await ask(`/api/v1/jobs/${id}`, 'DELETE');
  const upload = await ask('/api/v1/plans?name=nothing', 'POST', 'no archive', { 'Content-Type': 'application/zip' });
  const failed = await until(
    () => ask(`/api/v1/jobs/${upload.id}`),
    ({ state }) => state === 'failed',
  );
  assert.ok(failed.problem);
});

test('questions about the plan and its dose', async () => {
  const view = `view=${encodeURIComponent('{"kind":"3d","size_px":[320,240]}')}`;
  const slice = `view=${encodeURIComponent('{"kind":"axial","size_px":[320,240]}')}`;
  const questions = [
    'probe?x=0&y=0&z=0',
    'probe?x=900&y=0&z=0',
    `pick?${view}&px=160&py=120`,
    'fits',
    'dose',
    'dose/probe?x=0&y=0&z=0',
    'dose/probe?x=900&y=0&z=0',
    `dose/isolines?${slice}`,
    'dvh?regions=brain,target',
    'coverage?region=target&low=1',
    'constraints',
    'irradiation',
    'profile?beam=beam-1',
    'gamma',
    'beam?beam=beam-1',
    'beam/place?beam=beam-1&mode=gap&gap_mm=10',
    'tracks?lost=5',
    `track?${view}&px=160&py=120`,
    'images/ct/histogram',
    'images/ct/ellipse?center=0,0,0&a=10,0,0&b=0,10,0',
    'regions/tumour/surface',
    'regions/tumour/surface?representation=outline&frames=1',
    'regions/tumour/surface?representation=nurbs',
  ];
  for (const question of questions) await ask(`/api/v1/plans/phantom/${question}`);
  const { levels } = await ask('/api/v1/plans/phantom/dose');
  await ask(`/api/v1/plans/phantom/dose/levels/${levels[0].id}/surface`);
});

test('rooms, and what their members write down', async () => {
  const at = `/api/v1/rooms/${room}`;
  let input = 0;
  const give = async (message) => {
    const own = ++input;
    ann.send({ ...message, input: own });
    const told = await ann.until(
      () => ann.messages.find((m) => (m.type === 'item' || m.type === 'problem') && m.input === own),
      'an answer',
    );
    assert.ok(told.item, JSON.stringify(told));
    return told.item;
  };
  await ask('/api/v1/rooms', 'POST', { plan: 'phantom' });
  await ask('/api/v1/rooms');
  await ask(at);
  const scene = await call(`${daemon.url}${at}/scene`);
  assert.equal(misfit(schemaOfAnswer(description, 'GET', `${at}/scene`, 200), scene.json, description.components.schemas), '');
  await ask(`${at}/members`);
  await give({ type: 'item.put', kind: 'note', body: { text: 'here', anchor: { point_mm: [1, 2, 3] } } });
  const bookmark = await give({ type: 'item.put', kind: 'bookmark', body: { name: 'One' } });
  const { id: note } = await ask(`${at}/notes`, 'POST', { body: { text: 'by a script' }, name: 'Script' });
  await ask(`${at}/notes/${note}`, 'PATCH', { version: 1, body: { text: 'changed' }, name: 'Script' });
  await ask(`${at}/notes`);
  await ask(`${at}/acceptances`);
  await ask(`${at}/control`);
  await ask(`${at}/links`, 'GET', undefined, ann.headers);
  await ask(`${at}/people`, 'PATCH', { people: [{ who: '@physics', role: 'reviewer' }] });
  await ask(`${at}/people`);
  await ask(`${at}/bookmarks`);
  await ask(`${at}/bookmarks/${bookmark.id}`);
  const { revision } = await ask('/api/v1/plans/phantom/revision');
  await give({ type: 'item.put', kind: 'decision', body: { decision: 'accept', text: 'as planned', plan_revision: revision } });
  await ask(`${at}/record`);
  const { records } = await until(
    () => ask('/api/v1/records'),
    (answer) => answer.records.length > 0,
  );
  assert.equal((await ask('/api/v1/records/search', 'POST', { text: 'SNYDER', limit: 1 })).records.length, 1);
  await ask(`/api/v1/records/${records[0].id}`);
  await ask(`/api/v1/records/${records[0].id}/paper`);
  await ask('/api/v1/audit');
  ann.send({ type: 'recording.start' });
  const { recordings } = await until(
    () => ask(`${at}/recordings`),
    (answer) => answer.recordings.length > 0,
  );
  const recorded = `${at}/recordings/${recordings[0].id}/state?t_ms=0`;
  await until(
    () => call(`${daemon.url}${recorded}`),
    ({ status }) => status === 200, // its first second is written after it
  );
  await ask(recorded);
  await ask(`${at}/links`, 'POST', { role: 'reviewer' });
});

test('a meeting of many cases', async () => {
  const { id } = await ask('/api/v1/meetings', 'POST', { name: 'Board', cases: [{ plan: 'phantom' }, { plan: 'phantom' }] });
  await ask('/api/v1/meetings');
  await ask(`/api/v1/meetings/${id}/case`, 'POST', { case: 'next', from: null });
  const { url, token } = await ask(`/api/v1/meetings/${id}/links`, 'POST', { role: 'observer' });
  assert.ok(url.endsWith(token));
  await ask(`/api/v1/meetings/${id}/links`);
  const { room: now } = await ask(`/api/v1/meetings/${id}/enter`, 'POST', { link: token });
  const bea = await Client.enter(daemon.url, now, { name: 'Bea' });
  const { people } = await ask(`/api/v1/meetings/${id}/minutes`);
  assert.deepEqual(
    people.map(({ name }) => name),
    ['Bea'],
  );
  bea.cut();
  await ask(`/api/v1/meetings/${id}/end`, 'POST', {});
});

test('the state of a sign-in, on a server on which nobody signs in', async () => {
  const session = await ask('/api/v1/session');
  assert.deepEqual([session.sign_in, session.identity, session.open_to_everybody], [[], null, false]);
});

/** Met by tests/api/sign_in.test.mjs, as nobody signs in here. */
const elsewhere = ['answer.users', 'answer.tokens', 'answer.token_made', 'answer.erased'];

test('every schema of an answer was met', () => {
  const answers = new Set(
    Object.values(description.paths)
      .flatMap(Object.values)
      .flatMap(({ responses }) => Object.values(responses))
      .map(({ content }) => content?.['application/json']?.schema.$ref?.split('/').at(-1))
      .filter((name) => name && name !== 'scene'),
  );
  assert.deepEqual(
    [...answers].filter((name) => !met.has(name) && !elsewhere.includes(name)),
    [],
  );
});
