// The forms of statements: what is sent, sent again and shown when somebody closes a form, or goes to another room, meanwhile. Room, server and clock are fakes.
import assert from 'node:assert/strict';
import { beforeEach, test } from 'node:test';
import { load } from '../../page.mjs';

const { signal } = await load('../lib/signals-core.js');
const { onePersonForm, statementBar } = await load('features/patient/statement.js');

const isTemplate = (value) => Boolean(value?.strings);
const wordsOf = ({ strings, values }) =>
  strings.map((text, n) => text + (isTemplate(values[n]) ? wordsOf(values[n]) : String(values[n] ?? ''))).join(' ');
const acts = ({ values }) => values.flatMap((value) => (typeof value === 'function' ? [value] : isTemplate(value) ? acts(value) : []));
const settled = () => new Promise((done) => setImmediate(done));
const busy = Object.assign(new Error('the files are being read'), { status: 503 });

/** A planner's page in a room of its own; calls: what was sent to the server, each answered by the test. */
function makeWorld(id) {
  const calls = [];
  const timers = [];
  return {
    calls,
    timers,
    room: {
      id,
      planId: signal(`plan-${id}`),
      plan: signal({ patients: [{}, {}], statement: null }),
      seesIdentity: signal(true),
      isLeft: signal(false),
      identity: { member: 'm1', secret: 's' },
      control: { me: signal({ role: 'planner' }) },
    },
    api: {
      call: (method, path, { body } = {}) => new Promise((done, fail) => calls.push({ method, path, body, done, fail })),
    },
    clock: { setTimeout: (run) => timers.push(run) },
  };
}
const isOpen = (world) => wordsOf(onePersonForm(world)).includes('<form');
function open(world) {
  assert.ok(!isOpen(world));
  acts(onePersonForm(world))[0]();
  assert.ok(isOpen(world));
}
const reason = 'The second name is that of her marriage';
/** [submit, cancel] of the open form. */
const submit = (world) => acts(onePersonForm(world))[0]({ preventDefault() {}, target: { elements: { words: { value: reason } } } });
const cancel = (world) => acts(onePersonForm(world)).at(-1)();

let here;
beforeEach(() => {
  here = makeWorld('r1');
});

test('a statement that the server is not ready for is sent again, until it is taken', async () => {
  open(here);
  submit(here);
  here.calls[0].fail(busy);
  await settled();
  assert.equal(here.timers.length, 1);
  here.timers[0]();
  assert.deepEqual(
    here.calls.map(({ method, path, body }) => [method, path, body]),
    Array(2).fill(['POST', 'plans/plan-r1/statement?room=r1', { kind: 'one-person', words: reason }]),
  );
  here.calls[1].done();
  await settled();
  assert.ok(!isOpen(here));
});

test('a form that was closed is not sent by the timer, nor opened again by its answer', async () => {
  open(here);
  submit(here);
  here.calls[0].fail(busy);
  await settled();
  cancel(here);
  here.timers[0]();
  await settled();
  assert.equal(here.calls.length, 1);
  assert.ok(!isOpen(here));

  open(here); // closed while the server has it
  submit(here);
  cancel(here);
  open(here);
  here.calls[1].fail(busy);
  await settled();
  assert.equal(here.timers.length, 1, 'no new timer');
  assert.ok(isOpen(here));
  cancel(here);
});

test('in a room that was left nothing is sent again', async () => {
  open(here);
  submit(here);
  here.calls[0].fail(busy);
  await settled();
  here.room.isLeft.value = true;
  here.timers[0]();
  assert.equal(here.calls.length, 1);
  assert.ok(!isOpen(here));
});

for (const [name, answers] of [
  ['taken', ({ done }) => done()],
  ['refused', ({ fail }) => fail(Object.assign(new Error('no place is left'), { status: 409 }))],
  ['put off', ({ fail }) => fail(busy)],
])
  test(`an answer from another room that comes late, ${name}, changes nothing in the form of this one`, async () => {
    const there = makeWorld('r2');
    open(here);
    submit(here);
    open(there);
    answers(here.calls[0]);
    await settled();
    const words = wordsOf(onePersonForm(there));
    assert.ok(words.includes('<form') && !words.includes('role="alert"'), words);
    assert.equal(here.timers.length, 0);
    assert.ok(!isOpen(here));
    submit(there);
    assert.deepEqual([here.calls.length, there.calls.length], [1, 1]);
    there.calls[0].done();
    await settled();
    assert.ok(!isOpen(there));
  });

test('what the server says of a withdrawal stands in the bar of its own room alone', async () => {
  const there = makeWorld('r2');
  for (const { room } of [here, there])
    room.plan.value = { patients: [{}, {}], statement: { kind: 'one-person', state: 'used', by: 'Ann', time_ms: 5, words: reason } };
  acts(statementBar(here))[0]();
  assert.equal(here.calls[0].method, 'DELETE');
  here.calls[0].fail(Object.assign(new Error('the disk is full'), { status: 507 }));
  await settled();
  assert.ok(wordsOf(statementBar(here)).includes('the disk is full'));
  assert.ok(!wordsOf(statementBar(there)).includes('the disk is full'));
});
