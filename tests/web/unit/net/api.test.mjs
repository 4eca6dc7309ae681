// Calls of the API: a call that came too often is made again when the server says so.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { makeApi, Problem } from '../../../../web/js/net/api.js';

const answer = (status, body) => ({
  ok: status < 300,
  status,
  headers: new Headers({ 'Content-Type': 'application/json' }),
  json: async () => body,
});
const tooOften = (retry_after_ms) =>
  answer(429, { type: '/problems/limit', status: 429, detail: 'too many', code: 'rate', retry_after_ms });

test('a call that came too often waits as long as it is told and is made again', async () => {
  const times = [];
  const answers = [tooOften(60), tooOften(20), answer(200, { plans: [] })];
  const api = makeApi(async () => {
    times.push(performance.now());
    return answers[times.length - 1];
  });
  assert.deepEqual(await api.plans(), { plans: [] });
  assert.equal(times.length, 3);
  assert.ok(times[1] - times[0] >= 55 && times[2] - times[1] >= 15, times.join(' ')); // timers may fire a little early
});

test('after three waits the person is told', async () => {
  let n = 0;
  const api = makeApi(async () => (n++, tooOften(1)));
  await assert.rejects(api.plans(), (error) => error instanceof Problem && error.status === 429 && error.code === 'rate');
  assert.equal(n, 4);
});

test('another limit is told at once', async () => {
  let n = 0;
  const api = makeApi(async () => (n++, answer(429, { type: '/problems/limit', status: 429, detail: 'full' })));
  await assert.rejects(api.plans(), (error) => error.status === 429);
  assert.equal(n, 1);
});
