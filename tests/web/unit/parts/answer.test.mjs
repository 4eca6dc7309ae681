// A live answer: when it is asked for, which answer is shown, and how old it is.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../page.mjs';

const { Answer } = await load('parts/answer.js');
const { effect, signal } = await load('../lib/signals-core.js');
const restMs = 200;
const settle = () => new Promise((done) => setImmediate(done));

/** A clock whose timers run when they are told to, and a server that answers when it is told to. */
function world() {
  const timers = new Map();
  const asked = [];
  let n = 0;
  return {
    asked,
    clock: { setTimeout: (run) => timers.set(++n, run) && n, clearTimeout: (id) => timers.delete(id) },
    ask: (key, aborted) => new Promise((tell, fail) => asked.push({ key, aborted, tell, fail })),
    async rest() {
      for (const [id, run] of [...timers]) {
        timers.delete(id);
        run();
      }
      await settle();
    },
  };
}

test('a question is asked once its parameters rest; the newest answer wins, and an older one is marked', async () => {
  const timers = new Map();
  let n = 0;
  const clock = {
    setTimeout: (run, ms) => {
      assert.equal(ms, restMs);
      timers.set(++n, run);
      return n;
    },
    clearTimeout: (id) => timers.delete(id),
  };
  const rest = async () => {
    for (const [id, run] of [...timers]) {
      timers.delete(id);
      run();
    }
    await new Promise((done) => {
      setTimeout(done);
    });
  };
  const key = signal('a');
  const answers = [];
  const asked = new Answer({
    key: () => key.value,
    ask: (of) =>
      new Promise((resolve, reject) => {
        answers.push({ resolve, reject, key: of });
      }),
    clock,
    restMs,
  });
  asked.start();
  assert.deepEqual(asked.state.value, { result: null, error: '', isOld: true });
  key.value = 'b';
  await rest();
  assert.deepEqual(
    answers.map((answer) => answer.key),
    ['b'],
    'a was never asked',
  );
  answers[0].resolve({ of: 'b' });
  await rest();
  assert.deepEqual(asked.state.value, { result: { of: 'b' }, error: '', isOld: false });
  key.value = 'c';
  assert.deepEqual(asked.state.value, { result: { of: 'b' }, error: '', isOld: true });
  await rest();
  key.value = 'd';
  await rest();
  answers[2].resolve({ of: 'd' });
  answers[1].resolve({ of: 'c' });
  await rest();
  assert.deepEqual(asked.state.value.result, { of: 'd' });
  key.value = '';
  await rest();
  assert.deepEqual(
    [asked.state.value.result, asked.state.value.isOld, answers.length],
    [{ of: 'd' }, false, 3],
    'nobody looks: nothing is asked',
  );
  key.value = 'e';
  await rest();
  answers[3].reject(new Error('The server does not answer.'));
  await rest();
  assert.deepEqual(asked.state.value, { result: null, error: 'The server does not answer.', isOld: false });
});

test('one that follows asks one question at a time, and what changed meanwhile is one more', async () => {
  const { asked, ask, clock, rest } = world();
  const key = signal('a');
  const answer = new Answer({ key: () => key.value, ask, clock });
  answer.start();
  for (const of of ['b', 'c']) key.value = of;
  await rest();
  assert.deepEqual(
    asked.map((question) => question.key),
    ['c'],
  );
  for (const of of ['d', 'e']) key.value = of;
  await rest();
  assert.equal(asked.length, 1);
  asked[0].tell('of c');
  await settle();
  assert.deepEqual(answer.state.value, { result: 'of c', error: '', isOld: true }, 'an older answer is shown as one');
  await rest();
  assert.deepEqual([asked.length, asked[1].key, asked[1].aborted.aborted], [2, 'e', false]);
  asked[1].tell('of e');
  await rest();
  assert.deepEqual([answer.state.value, answer.of, asked.length], [{ result: 'of e', error: '', isOld: false }, 'e', 2]);
});

test('an answer to a change that the server may not have had is old, and asked for again', async () => {
  const { asked, ask, clock, rest } = world();
  const isSettled = signal(false);
  const answer = new Answer({ key: () => 'a', ask, clock, isSettled: () => isSettled.value });
  answer.start();
  await rest();
  asked[0].tell(1);
  await settle();
  assert.deepEqual(answer.state.value, { result: 1, error: '', isOld: true });
  isSettled.value = true;
  await rest();
  asked[1].tell(2);
  await rest();
  assert.deepEqual([answer.state.value, asked.length], [{ result: 2, error: '', isOld: false }, 2]);
});

test('without a key the last answer stays, or is forgotten, or asked for anew when the key is back', async () => {
  const { asked, ask, clock, rest } = world();
  const key = signal('a');
  const one = (more) => {
    const answer = new Answer({ key: () => key.value, ask, clock, restMs, ...more });
    answer.start();
    return answer;
  };
  const [keeps, clears, renews] = [one({}), one({ clears: true }), one({ renews: true })];
  await rest();
  for (const question of asked) question.tell('here');
  await settle();
  key.value = '';
  await rest();
  assert.deepEqual(
    [keeps, clears, renews].map(({ state }) => [state.value.result, state.value.isOld]),
    [
      ['here', false],
      [null, false],
      ['here', false],
    ],
  );
  key.value = 'a';
  await rest();
  assert.deepEqual([asked.length, keeps.state.value.isOld, renews.state.value.isOld], [5, false, true]);
});

test('state changes only where something of it does; after the end no answer comes', async () => {
  const { asked, ask, clock, rest } = world();
  const key = signal('a');
  const answer = new Answer({ key: () => key.value, ask, clock });
  let n = 0;
  const stop = answer.start();
  effect(() => {
    n += 1;
    return void answer.state.value;
  });
  for (let i = 0; i < 50; i++) key.value = `drag ${i}`;
  assert.equal(n, 1);
  await rest();
  stop();
  asked[0].tell('too late');
  await rest();
  assert.deepEqual([answer.state.value.result, asked.length], [null, 1]);
});
