// Questions about a beam that is dragged: one at a time, the newest scene next, and no older answer over a newer one.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { BeamFacts } = await load('features/beams/beam_facts.js');
const { effect, signal } = await load('../lib/signals-core.js');

const line = (x) => ({ name: '', entry_mm: [0, -100, 0], target_mm: [x, 0, 0] });
const scene = (x) => ({ beam: { id: '', draft: { enabled: true, line: line(x) } } });
const settle = () =>
  new Promise((done) => {
    setImmediate(done);
  });

function world() {
  const asked = []; // {parameters, view, tell, fail}
  const timers = [];
  const clock = { setTimeout: (run) => timers.push(run), clearTimeout: () => {} };
  const room = {
    id: 'r',
    planId: signal('p'),
    plan: signal({ beams: [] }),
    scene: signal(scene(0)),
    isScenePending: signal(false),
    renderer: signal({ state: 'ready' }),
    views: [],
    following: { override: signal(null) },
  };
  const api = {
    ofScene: (plan, question, of, view, parameters) =>
      new Promise((tell, fail) => {
        asked.push({ plan, question, view, parameters, tell, fail });
      }),
  };
  const rest = async () => {
    for (const run of timers.splice(0)) run();
    await settle();
  };
  return { asked, room, rest, facts: new BeamFacts(room, api, clock, '') };
}

test('nothing is asked before somebody reads the answer, and nothing any more afterwards', async () => {
  const { asked, facts, rest, room } = world();
  await rest();
  assert.equal(asked.length, 0);
  const stop = effect(() => facts.answer.value);
  await rest();
  assert.deepEqual([asked.length, asked[0].plan, asked[0].question], [1, 'p', 'beam']);
  asked[0].tell({ gap_mm: 1 });
  await settle();
  stop();
  room.scene.value = scene(5);
  await rest();
  assert.equal(asked.length, 1);
});

test('while it is dragged an answer is shown as an older one, then the newest place alone is asked about', async () => {
  const { asked, facts, rest, room } = world();
  const seen = [];
  effect(() => seen.push([facts.answer.value.result?.of ?? null, facts.answer.value.isOld]));
  await rest();
  for (const x of [1, 2, 3]) room.scene.value = scene(x);
  await rest();
  assert.equal(asked.length, 1, 'one question at a time');
  asked[0].tell({ of: 0 });
  await settle();
  assert.deepEqual(seen.at(-1), [0, true], 'of what was before');
  assert.equal(asked.length, 1, 'pictures come first');
  await rest();
  assert.equal(asked.length, 2, 'not one for each place on the way');
  asked[1].tell({ of: 3 });
  await settle();
  assert.deepEqual(seen.at(-1), [3, false]);
  await rest();
  assert.equal(asked.length, 2);
});

test('an answer to a change that the server may not have had yet is asked for again', async () => {
  const { asked, facts, rest, room } = world();
  effect(() => facts.answer.value);
  room.isScenePending.value = true;
  room.scene.value = scene(4);
  await rest();
  asked[0].tell({ of: 'before the change' });
  await settle();
  assert.equal(facts.answer.value.isOld, true);
  room.isScenePending.value = false;
  await rest();
  assert.equal(asked.length, 2);
  asked[1].tell({ of: 4 });
  await settle();
  assert.deepEqual([facts.answer.value.result.of, facts.answer.value.isOld], [4, false]);
});

test('why a question is not answered is said; a member on their own asks about what they see', async () => {
  const { asked, facts, rest, room } = world();
  room.following.override.value = { beam: { draft: { enabled: true } } };
  effect(() => facts.answer.value);
  await rest();
  assert.deepEqual(asked[0].view, { override: { beam: { draft: { enabled: true } } } });
  asked[0].fail(new Error('the plan has no beam'));
  await settle();
  assert.deepEqual([facts.answer.value.result, facts.answer.value.error], [null, 'the plan has no beam']);
});

test("the ring of a beam's-eye view on the screen is the diameter asked about", async () => {
  const { asked, facts, rest, room } = world();
  room.views = [
    { kind: '3d', isOpen: signal(true), document: signal({}) },
    { kind: 'beam', isOpen: signal(true), document: signal({ beam: { aperture_mm: 80 } }) },
  ];
  effect(() => facts.answer.value);
  await rest();
  assert.equal(asked[0].parameters.aperture_mm, 80);
  room.views[1].isOpen.value = false;
  asked[0].tell({});
  await settle();
  await rest();
  assert.equal('aperture_mm' in asked[1].parameters, false);
});
