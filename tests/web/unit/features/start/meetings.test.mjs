// The meetings of the start page: plans for a new case are those of the text that stands in the field.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { MeetingsState } = await load('features/start/meetings.js');

/** A server that answers a search when it is told to, and timers that run at once when they are told to. */
function world() {
  const searches = [];
  const added = [];
  let timer = null;
  const clock = {
    setTimeout(run) {
      timer = run;
      return 1;
    },
    clearTimeout() {
      timer = null;
    },
  };
  const call = (method, path, { body }) => {
    if (path !== 'plans/search') return void added.push([method, path, body]);
    return new Promise((answer, fail) => {
      searches.push({ text: body.text, answer: (...ids) => answer({ plans: ids.map((id) => ({ id })), total: ids.length }), fail });
    });
  };
  const meetings = new MeetingsState({ api: { call: async (...args) => call(...args) }, clock, enter: assert.fail });
  const type = (text) => {
    meetings.find(text, true);
    return () => timer();
  };
  const settled = () => new Promise((done) => setImmediate(done));
  return { meetings, searches, added, type, settled };
}

test('a plan of an older text cannot be added, nor does its late answer come back', async () => {
  const { meetings, searches, added, type, settled } = world();
  type('a')();
  const ask = type('ab');
  searches[0].answer('of-a');
  await settled();
  assert.equal(meetings.plans.value.list, null, 'the answer to "a" came while "ab" stood in the field');
  await meetings.add('m-1', 'of-a');
  assert.deepEqual(added, []);
  ask();
  const askLast = type('abc');
  askLast();
  searches[2].answer('of-abc');
  await settled();
  searches[1].answer('of-ab');
  await settled();
  assert.deepEqual(meetings.plans.value.list, [{ id: 'of-abc' }]);
  await meetings.add('m-1', 'of-abc');
  assert.deepEqual(added, [['POST', 'meetings/m-1/cases', { plan: 'of-abc' }]]);
});

test('after an error there is nothing to choose from', async () => {
  const { meetings, searches, type, settled } = world();
  type('a')();
  searches[0].answer('of-a');
  await settled();
  type('ab')();
  searches[1].fail(new Error('no answer'));
  await settled();
  assert.deepEqual(meetings.plans.value.list, []);
  assert.equal(meetings.error.value, 'no answer');
});
