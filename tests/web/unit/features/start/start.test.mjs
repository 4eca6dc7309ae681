// The state behind the start page: plans and folders that are none, rooms, the server being full, thumbnails, the own name.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { Problem } = await load('net/api.js');
const { AfterRoom } = await load('room/after_room.js');
const { OwnName, maxName } = await load('room/own_name.js');
const { PlansState } = await load('room/plans.js');
const { Thumbnails } = await load('features/start/thumbnails.js');

const later = () =>
  new Promise((done) => {
    setTimeout(done, 5);
  });
const clock = { now: () => 0, setTimeout: (run) => setTimeout(run, 1), clearTimeout };
const facts = { patient: '', label: '', date: '', approval: '', n_patients: 0, n_plans: 0, rooms: [], n_rooms: 0 };
const plans = [
  { ...facts, id: 'head', name: 'Head', state: 'ready', parts: ['CT'], n_bytes: 9, n_warnings: 1, has_plan_file: true },
  { ...facts, id: 'broken', name: 'Broken', state: 'unreadable', parts: [], n_bytes: 0, reason: 'no ct.nii', has_plan_file: true },
  { ...facts, id: 'sent', name: 'sent', state: 'unreadable', parts: [], n_bytes: 0, reason: 'nothing in it', uploaded: true },
];
const counts = { total: 3, of: 3, next: null, folders: [], n_all: 3, n_uploads: 1, n_no_plans: 1 };
const rooms = [
  {
    id: 'r-1',
    plan: 'head',
    members: [
      { id: 'a', name: 'Dr A', connected: true },
      { id: 'b', name: 'Gone', connected: false },
    ],
  },
  { id: 'r-2', plan: 'other', members: [] },
];
const busy = new Problem({ type: '/problems/busy', status: 503, detail: '4 plans are open and in use, which is as many as may be' });

function start(api = {}) {
  const [entered, asked] = [[], []];
  const state = new PlansState({
    clock,
    enter: (...where) => entered.push(where),
    api: {
      call: async (_method, path, { body }) => {
        assert.equal(path, 'plans/search');
        asked.push(body);
        return { plans, ...counts };
      },
      rooms: async () => ({ rooms }),
      version: async () => ({}),
      plan: async () => ({ report: null }),
      ...api,
    },
  });
  return { state, entered, asked };
}

test('the server is asked for one page of the place, text and order that are shown; a late answer to an older question is dropped', async () => {
  const answers = [];
  const asked = [];
  const { state } = start({
    call: (_method, _path, { body }) => {
      asked.push(body);
      return new Promise((done) => {
        answers.push((id) => done({ plans: [{ ...plans[0], id }], ...counts, next: 'head' }));
      });
    },
  });
  state.start();
  assert.deepEqual(asked, [{ text: '', folder: '', sort: 'used', kind: 'plan', limit: 50, cursor: '' }]);
  state.show({ search: ' 419 ' });
  await later();
  assert.equal(asked[1].text, '419');
  answers[1]('new');
  await later();
  answers[0]('old');
  await later();
  assert.equal(state.plans.value[0].id, 'new');
  state.turn(true);
  assert.equal(asked.at(-1).cursor, 'head');
  state.show({ place: { kind: 'folder', id: '0123456789abcdef' } });
  await later();
  assert.deepEqual([asked.at(-1).folder, asked.at(-1).cursor], ['0123456789abcdef', ''], 'another place begins at its first page');
  state.show({ place: { kind: 'no-plans', id: '' } });
  await later();
  assert.deepEqual([asked.at(-1).folder, asked.at(-1).kind], ['', 'no-plan']);
  state.stop();
});

test('going on enters the last room and makes none', async () => {
  const { state, entered } = start({ makeRoom: () => assert.fail('a room was made') });
  state.goOn({ id: 'r-9', plan: 'head' });
  state.stop();
  assert.deepEqual(entered, [['r-9', 'head']]);
});

test('a server that is full says so for itself, and the plan is not refused', async () => {
  for (const fail of [
    { openPlan: () => Promise.reject(busy) },
    { openPlan: async () => ({ id: 'j', state: 'failed', problem: { type: '/problems/busy', detail: busy.message } }) },
    {
      openPlan: async () => ({ id: 'j', state: 'done' }),
      makeRoom: () => Promise.reject(new Problem({ type: '/problems/limit', detail: busy.message })),
    },
  ]) {
    const { state, entered } = start(fail);
    await state.open('head');
    state.stop();
    assert.equal(state.notice.value, busy.message);
    assert.deepEqual(state.refusals.value, {});
    assert.deepEqual(entered, []);
  }
});

test('a plan that is refused for its own reasons says why in its row', async () => {
  const { state } = start({
    openPlan: async () => ({ id: 'j', state: 'failed', problem: { type: '/problems/plan-unreadable', detail: 'no dose' } }),
  });
  await state.open('head');
  state.stop();
  assert.equal(state.notice.value, '');
  assert.deepEqual(state.refusals.value, { head: 'no dose' });
});

test('a deletion is asked about with the rooms as they are now', async () => {
  const { state } = start();
  state.start();
  await later();
  const asked = state.askToRemove('head');
  assert.equal(state.deleting.value.rooms, null, 'nothing is said before it is known');
  await asked;
  state.stop();
  assert.deepEqual(
    state.deleting.value.rooms.map(({ id }) => id),
    ['r-1'],
  );
});

test('a deletion that would leave records behind is asked about once more, with what was decided', async () => {
  const said = [];
  const detail =
    '2 decisions and signatures were written in rooms of this plan; their records stay when it is deleted, at /api/v1/records: say records=keep';
  const { state } = start({
    removePlan: async (id, how) => {
      said.push([id, how.keepsRecords, how.by]);
      if (!how.keepsRecords) throw new Problem({ status: 409, code: 'records', detail });
    },
  });
  state.start();
  await later();
  await state.askToRemove('head');
  await state.remove('head', { by: 'Ann' });
  assert.equal(state.deleting.value.records, detail);
  await state.remove('head', { keepsRecords: true, by: 'Ann' });
  state.stop();
  assert.equal(state.deleting.value, null);
  assert.deepEqual(said, [
    ['head', false, 'Ann'],
    ['head', true, 'Ann'],
  ]);
});

test('thumbnails are made of loaded plans alone, one at a time and once', async () => {
  let running = 0;
  const calls = [];
  const thumbnails = new Thumbnails(
    {
      thumbnail: async (id) => {
        calls.push(id);
        assert.equal(++running, 1);
        await later();
        running -= 1;
        if (id === 'shy') throw busy;
        return `picture of ${id}`;
      },
    },
    { createObjectURL: (blob) => `blob:${blob}`, revokeObjectURL: () => {} },
  );
  const list = [
    plans[0],
    { id: 'shy', state: 'ready', n_bytes: 1 },
    { id: 'closed', state: 'not-loaded', n_bytes: 1 },
    { id: 'two', state: 'ready', n_bytes: 2 },
  ];
  await Promise.all([thumbnails.update(list), thumbnails.update(list)]);
  await thumbnails.update(list);
  assert.deepEqual(calls, ['head', 'shy', 'two']);
  assert.equal(thumbnails.of(plans[0]), 'blob:picture of head');
  assert.equal(thumbnails.of({ ...plans[0], state: 'not-loaded' }), 'blob:picture of head', 'kept when the plan is closed');
  assert.equal(thumbnails.of({ ...plans[0], n_bytes: 10 }), '', 'not of other files with the same name');
  assert.equal(thumbnails.of(list[1]), '');
});

test('the own name is asked for once, kept, tidied, and does without a browser that keeps things', () => {
  const kept = new Map();
  const storage = { getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value) };
  const first = new OwnName(storage);
  assert.equal(first.isAsked.value, true);
  first.set('  Dr\t Alvarez\u0000 ');
  assert.deepEqual([first.value.value, first.isAsked.value], ['Dr Alvarez', false]);
  const again = new OwnName(storage);
  assert.deepEqual([again.value.value, again.isAsked.value], ['Dr Alvarez', false]);
  again.set('x'.repeat(99));
  assert.equal(again.value.value.length, maxName);
  again.set('');
  assert.equal(new OwnName(storage).isAsked.value, false, 'no name is an answer too');
  const shut = {
    getItem() {
      throw new Error('forbidden');
    },
    setItem() {
      throw new Error('forbidden');
    },
  };
  for (const other of [null, shut]) {
    const name = new OwnName(other);
    name.set('Chen');
    assert.equal(name.value.value, 'Chen');
  }
});

test('after a room, its plan is offered with the rooms that somebody is in, or said to be gone', async () => {
  const entered = [];
  const api = { plans: async () => ({ plans }), rooms: async () => ({ rooms }), makeRoom: async (plan) => ({ id: `new-${plan}` }) };
  const make = (own = {}) => new AfterRoom({ api: { ...api, ...own }, clock, enter: (...where) => entered.push(where) });
  const after = make();
  await after.look('');
  assert.deepEqual([after.plan.value, after.isPlanGone.value], [null, false], 'nothing is known');
  await after.look('head');
  assert.deepEqual([after.plan.value.id, after.rooms.value.map(({ id }) => id)], ['head', ['r-1']]);
  await after.reopen();
  after.join(rooms[0]);
  assert.deepEqual(entered, [
    ['new-head', 'head'],
    ['r-1', 'head'],
  ]);
  const gone = make();
  await gone.look('broken');
  assert.deepEqual([gone.plan.value, gone.isPlanGone.value], [null, true]);
  let n = 0;
  const early = make({ plans: async () => ({ plans: ++n < 3 ? [] : plans }) });
  await early.look('head');
  assert.deepEqual(
    [early.plan.value?.id, early.isPlanGone.value],
    ['head', false],
    'a server that has just started lists its plans a little later',
  );
  const away = make({ plans: () => Promise.reject(new Error('The server does not answer.')) });
  await away.look('head');
  assert.deepEqual([away.error.value, away.isPlanGone.value], ['The server does not answer.', false]);
});
