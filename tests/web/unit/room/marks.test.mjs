// Marks of several people in one scene: whose ids they have, what goes to the room, what stays one's own, and who takes what back. Three pages over one fake
// server that keeps the rules of the room: the presenter changes everything, others only ids that end with "-" and their own.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld, scene, welcome } from '../fake_room.mjs';
import { load } from '../page.mjs';

const marks = await load('room/marks.js');
const { freeId } = await load('features/measures/measures.js');
const { Undo } = await load('room/undo.js');
const { mergePatch } = await load('wire/merge.js');

const line = (x) => ({ kind: 'distance', name: '', visible: true, image: '', points: [{ at_mm: [0, 0, 0] }, { at_mm: [x, 0, 0] }] });
const whole = { ...scene, measures: {}, probes: {}, constraints: {} };
const roles = { m1: { role: 'presenter' }, m2: { role: 'reviewer' }, m3: { role: 'reviewer' } };

/** A page that is this member of a room in which m1 presents. */
function pageOf(id, role = roles[id].role) {
  const world = roomWorld(members('m1', ['m2', 'm3'], { ...roles, [id]: { role } }));
  world.connection.receive(welcome({ member: id, name: { m1: 'Ann', m2: 'Ben', m3: 'Cem' }[id], scene: whole }));
  world.connection.receive(members('m1', ['m2', 'm3'], { ...roles, [id]: { role } }));
  world.room.showView(2, [400, 400]);
  world.flush();
  world.connection.sent.length = 0;
  return { ...world, undo: new Undo(world.room, { clock: { now: () => 0 }, notify: (...words) => world.told.push(words) }) };
}

/** Three pages and their server. */
function meeting() {
  const pages = { m1: pageOf('m1'), m2: pageOf('m2'), m3: pageOf('m3') };
  let [truth, revision] = [whole, 1];
  const deliver = () => {
    for (const [id, page] of Object.entries(pages)) {
      page.flush();
      for (const { type, patch, input } of page.connection.sent.splice(0)) {
        if (type !== 'scene.patch') continue;
        assert.ok(id === 'm1' || marks.isOwn(patch, id), `${id} may not: ${JSON.stringify(patch)}`);
        truth = mergePatch(truth, patch);
        revision += 1;
        for (const [other, { connection }] of Object.entries(pages))
          connection.receive({ type: 'scene', patch, revision, by: id, ...(other === id && { input }) });
      }
    }
    for (const { room } of Object.values(pages)) if (room.following.isFollowing.value) assert.deepEqual(room.scene.value, truth);
  };
  const draw = (id, x) => {
    const { room } = pages[id];
    const mark = freeId(room.scene.value.measures, room.sharesMarks, room.markSuffix);
    room.patchScene({ measures: { [mark]: line(x) } });
    return mark;
  };
  return { pages, deliver, draw, measures: () => truth.measures, isVisible: () => truth.regions.brain.visible };
}

test('three who draw at the same moment keep all three, each with its author, and nobody leaves', () => {
  const { pages, deliver, draw, measures } = meeting();
  assert.deepEqual(
    ['m1', 'm2', 'm3'].map((id) => draw(id, 10)),
    ['m1', 'm1-m2', 'm1-m3'],
  );
  deliver();
  assert.deepEqual(Object.fromEntries(Object.entries(measures()).map(([id, { author }]) => [id, author])), {
    m1: 'Ann',
    'm1-m2': 'Ben',
    'm1-m3': 'Cem',
  });
  assert.equal(draw('m3', 20), 'm2-m3', 'the next number, whoever has the others');
  for (const { room } of Object.values(pages)) assert.equal(room.following.isFollowing.value, true);
});

test('each takes back what they changed, whatever the others did in between, and nothing of theirs', () => {
  const { pages, deliver, draw, measures, isVisible } = meeting();
  const names = () => Object.keys(measures()).sort();
  const step = (run) => {
    run();
    deliver();
  };
  step(() => draw('m2', 1));
  step(() => pages.m1.room.patchScene({ regions: { brain: { visible: false } } }));
  step(() => draw('m3', 2));
  step(() => draw('m1', 3));
  step(() => draw('m2', 4));
  assert.deepEqual(names(), ['m1-m2', 'm2-m3', 'm3', 'm4-m2']);
  step(() => pages.m3.undo.undo());
  assert.deepEqual(names(), ['m1-m2', 'm3', 'm4-m2']);
  step(() => pages.m1.undo.undo());
  assert.deepEqual(names(), ['m1-m2', 'm4-m2']);
  step(() => pages.m2.undo.undo());
  assert.deepEqual(names(), ['m1-m2']);
  assert.equal(isVisible(), false);
  step(() => pages.m1.undo.undo());
  assert.equal(isVisible(), true);
  step(() => pages.m3.undo.redo());
  step(() => pages.m2.undo.redo());
  assert.deepEqual(names(), ['m1-m2', 'm2-m3', 'm4-m2']);
  step(() => pages.m3.undo.undo());
  step(() => pages.m2.undo.undo());
  step(() => pages.m2.undo.undo());
  assert.deepEqual([names(), pages.m2.undo.next.value, pages.m3.undo.next.value], [[], null, null]);
  assert.deepEqual(
    [...pages.m2.told, ...pages.m3.told].filter(([, , topic]) => topic === 'undo'),
    [],
  );
});

test('what the presenter has changed of a mark meanwhile is not undone, and that is said', () => {
  const { pages, deliver, draw, measures } = meeting();
  const mark = draw('m2', 1);
  deliver();
  pages.m1.room.patchScene({ measures: { [mark]: { name: 'Margin' } } });
  deliver();
  pages.m2.undo.undo();
  deliver();
  assert.equal(measures()[mark].name, 'Margin');
  assert.match(pages.m2.told.at(-1)[1], /changed by somebody else since/);
});

test('an own mark is taken back in the room also by who is on their own meanwhile', () => {
  const { pages, deliver, draw, measures } = meeting();
  draw('m2', 1);
  deliver();
  pages.m2.room.following.leave();
  pages.m2.undo.undo();
  deliver();
  assert.deepEqual(measures(), {});
});

test('who follows and changes a mark of somebody else leaves, as with any other change; an observer does so with any mark', () => {
  const { pages, deliver, draw, measures } = meeting();
  const mark = draw('m1', 1);
  deliver();
  pages.m2.room.patchScene({ measures: { [mark]: { visible: false } } });
  deliver();
  assert.equal(pages.m2.room.following.isFollowing.value, false);
  assert.equal(measures()[mark].visible, true);
  const { room, connection, flush } = pageOf('m3', 'observer');
  assert.equal(room.sharesMarks, false);
  room.patchScene({ measures: { [freeId({}, room.sharesMarks, room.markSuffix)]: line(1) } });
  flush();
  assert.deepEqual(
    connection.sent.map(({ type }) => type),
    ['follow', 'view.patch'],
  );
});

test("what was marked on one's own stays behind with the return, and can be given to the room", () => {
  const { pages, deliver, draw, measures } = meeting();
  draw('m1', 1);
  deliver();
  const { room, told } = pages.m2;
  room.following.leave();
  assert.equal(draw('m2', 2), 'own1');
  room.patchScene({ probes: { 'pin-1-m2': { at_mm: [1, 2, 3], name: '' } } });
  deliver();
  assert.deepEqual(Object.keys(measures()), ['m1']);
  room.following.return();
  const [, words, , action] = told.at(-1);
  assert.match(words, /What you marked for yourself stays behind/);
  assert.equal(action.word, 'Give 2 marks to the room');
  action.act();
  deliver();
  assert.deepEqual(Object.keys(measures()), ['m1', 'm2-m2']);
  assert.equal(measures()['m2-m2'].author, 'Ben');
  assert.deepEqual(pages.m3.room.scene.value.probes['pin-1-m2'].at_mm, [1, 2, 3]);
});

test('a mark that was made while the connection was lost is sent when it is back; nobody is told of a loss', () => {
  const { room, connection, lose, back, told } = pageOf('m2');
  lose();
  room.patchScene({ measures: { 'm1-m2': line(1) } });
  back(members('m1', ['m2', 'm3'], roles), { member: 'm2', name: 'Ben', scene: whole });
  assert.deepEqual(
    connection.sent.filter(({ type }) => type === 'scene.patch').map(({ patch }) => Object.keys(patch.measures)),
    [['m1-m2']],
  );
  assert.ok(room.scene.value.measures['m1-m2']);
  assert.deepEqual(
    told.filter(([kind]) => kind === 'err'),
    [],
  );
});

test('a room that ends refuses what it has not answered, and says that changes are lost', async () => {
  const { room, connection, lose } = pageOf('m1');
  lose();
  const note = room.items.put('note', { text: 'Kept?', anchor: null });
  room.patchScene({ axes: { visible: true } });
  connection.tell('ended', { reason: 'the plan was deleted', isRefused: true });
  assert.equal(room.lostAtEnd.value, true);
  assert.equal(room.items.nPending.value, 0);
  await assert.rejects(note, ({ detail }) => /not saved/.test(detail));
  const quiet = pageOf('m2');
  quiet.connection.tell('ended', { reason: 'the plan was deleted', isRefused: true });
  assert.equal(quiet.room.lostAtEnd.value, false);
});

test('which patches are of marks, and whose', () => {
  const own = { measures: { 'm1-m2': null } };
  for (const [patch, is] of [
    [own, true],
    [{ measures: { m1: null } }, false],
    [{ measures: { '-m2': {} } }, false],
    [{ ...own, probes: { 'pin-1': {} } }, false],
    [{ ...own, axes: { visible: true } }, false],
    [{}, false],
    [{ measures: {} }, false],
    [{ measures: null }, false],
  ])
    assert.equal(marks.isOwn(patch, 'm2'), is, JSON.stringify(patch));
  assert.deepEqual(marks.ownPart({ ...own, axes: {}, probes: { 'pin-1': {} } }, 'm2'), own);
  assert.equal(marks.freeNumber(['m1', 'm2-m3', 'm4', 'own3'], 'm'), 3);
  assert.equal(marks.shortId('pin-3-m12', /^pin-/), '3');
});

test('marks that a picture brings from another room come under ids of who shows it, once; numbers there are other people’s', () => {
  const scene = { ...whole, measures: { 'm1-m2': line(1) }, probes: { 'pin-1': { at_mm: [0, 0, 0] } } };
  const patch = () => ({
    regions: { brain: { visible: false } },
    measures: { 'm1-m2': { name: 'here, too' }, 'm4-m2': line(4), 'm2-m7': line(7), m3: line(3), 'm5-m1': line(5) },
    probes: { 'pin-1-m3': { at_mm: [1, 1, 1] } },
  });
  const adopted = marks.adopted(patch(), scene, 'm1');
  assert.deepEqual(adopted, {
    regions: { brain: { visible: false } },
    measures: { 'm1-m2': { name: 'here, too' }, m3: line(3), 'm5-m1': line(5), 'm4-m1': line(4), 'm2-m1': line(7) },
    probes: { 'pin-2-m1': { at_mm: [1, 1, 1] } },
  });
  const again = marks.adopted(patch(), mergePatch(scene, adopted), 'm1');
  assert.deepEqual([Object.keys(again.measures), again.probes], [['m1-m2', 'm3', 'm5-m1'], undefined]);
});
