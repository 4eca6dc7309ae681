// Signing in: where it leads back to, and what the page says of a wrong password.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { ownPath } = await load('features/session/return_path.js');
const { Session } = await load('features/session/session.js');
const { PasswordState, leftWords, pauseWords } = await load('features/session/password_form.js');

test('a sign-in leads back to paths of this server alone', () => {
  for (const path of ['/', '/rooms/kave-rimo', '/display/kave-rimo', '/?a=b', '/rooms/x/../y']) assert.equal(ownPath(path), path);
  const others = [
    '',
    null,
    'rooms/x',
    '//evil.example',
    '/\\evil.example',
    '\\\\evil.example',
    'https://evil.example/',
    'javascript:alert(1)',
  ];
  for (const path of [...others, '/\t/evil.example', '/\n/evil.example', '/rooms\\..\\x', ' /rooms/x', '/a\u0000b', '/\u202e'])
    assert.equal(ownPath(path), '/', path);
});

test('a pause is said in whole minutes where it is one, and counted down', () => {
  assert.deepEqual([pauseWords(60), pauseWords(900), pauseWords(45), pauseWords(1)], ['1 minute', '15 minutes', '45 seconds', '1 second']);
  assert.deepEqual([leftWords(899), leftWords(61), leftWords(60), leftWords(1)], ['14:59', '1:01', '60 seconds', '1 second']);
});

/** The words of a state after one answer of the server. */
async function after(status, body, headers = {}) {
  const { fetch } = globalThis;
  globalThis.fetch = async () => new Response(JSON.stringify(body), { status, headers });
  const state = new PasswordState();
  const answer = await state.send('POST', 'session', { user: 'ann', password: 'x' });
  globalThis.fetch = fetch;
  state.stop();
  return { answer, error: state.error.value, left: state.leftS.value };
}

test('of a wrong password it is said how many tries are left', async () => {
  const wrong = { type: '/problems/sign-in', code: 'password', title: 'Sign in', pause_s: 60 };
  const three = await after(401, { ...wrong, tries_left: 3 });
  assert.equal(three.error, 'User and password do not match. 3 tries are left, then a pause of 1 minute.');
  assert.equal(three.answer, null);
  const one = await after(401, { ...wrong, tries_left: 1 });
  assert.equal(one.error, 'User and password do not match. 1 try is left, then a pause of 1 minute.');
  const none = await after(401, { ...wrong, tries_left: 0, pause_s: 120 });
  assert.deepEqual([none.error, none.left], ['User and password do not match.', 120]);
  const paused = await after(429, { title: 'Limit', code: 'pause' }, { 'Retry-After': '90' });
  assert.deepEqual([paused.error, paused.left], ['', 90]);
  const right = await after(201, { identity: { user: 'ann' } });
  assert.deepEqual([right.answer, right.error, right.left], [{ identity: { user: 'ann' } }, '', 0]);
});

test('who signs in again comes back by the new sign-in, also on a connection that is open; another person does not', () => {
  const { addEventListener, setInterval, document } = globalThis;
  const link = { rel: '', href: '', addEventListener() {} };
  Object.assign(globalThis, {
    addEventListener: () => {},
    setInterval: () => 0,
    document: { ...document, createElement: () => link, head: { append() {} } },
  });
  let nRenewed = 0;
  const connection = { renew: () => nRenewed++ };
  const facts = (user) => ({
    sign_in: ['local'],
    open_to_everybody: false,
    identity: { user, name: '', source: 'password' },
    idle_ends_ms: null,
    ends_ms: null,
  });
  const session = new Session(facts('ann'), { api: {}, ownName: { isFixed: {} }, entered: () => ({ room: 'r', connection }), signIn() {} });
  session.isStaying.value = true;
  assert.deepEqual(session.goOn(facts('ben')), { other: 'ben', name: 'ann' });
  assert.deepEqual([nRenewed, session.isStaying.value], [0, true]);
  assert.equal(session.goOn(facts('ann')), null);
  assert.deepEqual([nRenewed, session.isStaying.value], [1, false]);
  Object.assign(globalThis, { addEventListener, setInterval, document });
});
