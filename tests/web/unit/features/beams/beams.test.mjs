// Beams of a scene, their drafts, and points moved in pictures, against figures worked out by hand.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { members, roomWorld, scene as fakeScene, welcome } from '../../fake_room.mjs';
import { load } from '../../page.mjs';

const beams = await load('features/beams/beams.js');
const beamUi = await load('features/beams/beam_ui.js');
const { stepName } = await load('shell/undo_words.js');
const { draftDocument } = await load('features/beams/beam_file.js');
const { mergePatch } = await load('wire/merge.js');
const { keptName, movedWords } = await load('features/beams/beam_words.js');

const plan = {
  name: 'Head',
  beams: [
    { id: 'b1', name: '', entry_mm: [0, -100, 0], target_mm: [0, 0, 0], aperture_mm: 120 },
    { id: 'b2', name: 'Lateral', entry_mm: [90, 0, 0], target_mm: [10, 0, 0], aperture_mm: null },
  ],
};
const image = { slices: { sagittal: { position_mm: 1 }, coronal: { position_mm: 2 }, axial: { position_mm: 3 } } };
const scene = {
  image,
  beam: {
    id: '',
    looks: {},
    opacity: 0.15,
    slice: { visible: false, along_mm: 0 },
    draft: { enabled: false, line: { name: '', entry_mm: [0, 0, 0], target_mm: [0, 0, 0] } },
    kept: {},
  },
};
const after = (patch, before = scene) => mergePatch(before, patch);
const near = (actual, expected, tolerance = 1e-9) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${actual} is not ${expected}`));

test('the first beam is chosen without an id, the named one with it, and none by an id that the plan does not have', () => {
  assert.equal(beams.chosenBeam(plan, scene).id, 'b1');
  assert.equal(beams.chosenBeam(plan, after({ beam: { id: 'b2' } })).id, 'b2');
  assert.equal(beams.chosenBeam(plan, after({ beam: { id: 'gone' } })), null);
});

test('a draft begins where the planned beam is, and only a line with a length is one', () => {
  const drafted = after(beams.newDraft(plan, scene));
  assert.equal(beams.isDrafted(plan, drafted), true);
  assert.deepEqual(beams.shownLine(plan, drafted), { entry_mm: [0, -100, 0], target_mm: [0, 0, 0], aperture_mm: 120 });
  assert.deepEqual(beams.movedFrom(plan.beams[0], drafted.beam.draft.line), { targetMm: 0, directionDeg: 0 });
  assert.equal(beams.isDrafted(plan, after({ beam: { draft: { enabled: true } } })), false, 'entry and target in one point');
  assert.equal(beams.isDrafted(plan, after({ beam: { id: 'gone' } }, drafted)), false);
  assert.equal(beams.isDrafted(plan, after(beams.plannedPatch, drafted)), false);
});

test('in a plan without beams a draft begins at the crosshair, from anterior', () => {
  const bare = { ...plan, beams: [] };
  assert.equal(beams.shownLine(bare, scene), null);
  const drafted = after(beams.newDraft(bare, scene));
  assert.deepEqual(beams.shownLine(bare, drafted), { target_mm: [1, 2, 3], entry_mm: [1, -98, 3], aperture_mm: null });
  assert.equal(beams.movedFrom(null, drafted.beam.draft.line), null);
});

test('moving a point of a planned beam drafts it in one patch; then only that point is sent', () => {
  const patch = beams.redrafted(plan, scene, { target_mm: [3, 4, 0] });
  assert.deepEqual(patch, {
    beam: {
      draft: { enabled: true, shows_planned: false, line: { name: '', entry_mm: [0, -100, 0], target_mm: [3, 4, 0], aperture_mm: null } },
    },
  });
  const drafted = after(patch);
  assert.deepEqual(beams.redrafted(plan, drafted, { entry_mm: [0.12345, -200000, -0.0001] }), {
    beam: { draft: { line: { entry_mm: [0.123, -100000, 0] } } },
  });
  assert.equal(beams.redrafted(plan, drafted, { entry_mm: [3, 4, 0.05] }), null, 'a line without a length is refused');
  const { targetMm, directionDeg } = beams.movedFrom(plan.beams[0], drafted.beam.draft.line);
  near([targetMm, directionDeg], [5, (Math.atan2(3, 104) * 180) / Math.PI], 1e-9);
});

test('the direction between opposite and nearly equal beams is exact', () => {
  const from = plan.beams[0];
  near([beams.movedFrom(from, { entry_mm: [0, 100, 0], target_mm: [0, 0, 0] }).directionDeg], [180], 1e-6);
  near([beams.movedFrom(from, { entry_mm: [1e-4, -100, 0], target_mm: [0, 0, 0] }).directionDeg], [(1e-6 * 180) / Math.PI], 1e-12);
});

test('how far a draft has moved is said in words, without what has not moved', () => {
  assert.equal(movedWords({ targetMm: 5.4, directionDeg: 10.08 }), 'target moved 5.4 mm, direction 10.1°');
  assert.equal(movedWords({ targetMm: 0, directionDeg: 10.08 }), 'direction 10.1°');
  assert.equal(movedWords({ targetMm: 0.04, directionDeg: 0 }), 'as planned');
  assert.equal(movedWords(null), '');
});

test('another beam is chosen without the draft of the one before', () => {
  const drafted = after(beams.newDraft(plan, scene));
  assert.deepEqual(beams.choosePatch(plan, scene, 'b2'), { beam: { id: 'b2' } });
  assert.deepEqual(beams.choosePatch(plan, drafted, 'b2'), { beam: { id: 'b2', draft: { enabled: false, shows_planned: false } } });
});

test('the first change of a look is written whole, a later one by its field', () => {
  const patch = beams.lookPatch(scene, 'b1', { visible: true });
  assert.deepEqual(patch, { beam: { looks: { b1: { visible: true, opening: true, color: '#f4f6f8' } } } });
  assert.deepEqual(beams.lookPatch(after(patch), 'b1', { opening: false }), { beam: { looks: { b1: { opening: false } } } });
});

test('drafts are kept under the next free id, sixteen at most, and one that was kept is the draft again', () => {
  const drafted = after(beams.redrafted(plan, scene, { target_mm: [3, 4, 0] }));
  const { id, patch } = beams.keptDraft(plan, drafted);
  assert.equal(id, 'draft-1');
  const kept = after(patch, drafted);
  assert.deepEqual(kept.beam.kept['draft-1'], { name: '', entry_mm: [0, -100, 0], target_mm: [3, 4, 0], aperture_mm: 120 });
  assert.equal(beams.keptDraft(plan, kept).id, 'draft-2');
  assert.equal(keptName('draft-1', { name: '' }), 'Draft 1');
  assert.equal(keptName('draft-1', { name: 'Through the ear' }), 'Through the ear');
  const again = after(beams.keptPatch(kept.beam.kept['draft-1']), after(beams.plannedPatch, kept));
  assert.deepEqual(beams.shownLine(plan, again), { entry_mm: [0, -100, 0], target_mm: [3, 4, 0], aperture_mm: 120 });
  const full = after(
    {
      beam: { kept: Object.fromEntries(Array.from({ length: 16 }, (_, at) => [`k${at}`, { entry_mm: [0, 0, 0], target_mm: [0, 0, 1] }])) },
    },
    drafted,
  );
  assert.equal(beams.keptDraft(plan, full), null);
});

test('in parallel projection a point moves by the same millimetres wherever it is, and keeps its depth', () => {
  // 200 mm across and 100 mm high, axial: right is L, up is anterior, so that clip y = -P / 50; depth is S
  const matrix = [1 / 100, 0, 0, 0, 0, -1 / 50, 0, 0, 0, 0, 1 / 500, 0, 0, 0, 0, 1];
  near(beams.movedInPicture(matrix, [10, 20, 30], [0.1, 0.25]), [10 + 20, 20 + 25, 30]);
  near(beams.movedInPicture(matrix, [-70, 40, -300], [-0.05, -0.5]), [-80, -10, -300]);
});

test('in perspective a point twice as far moves twice as many millimetres, in the plane parallel to the screen', () => {
  // the eye at the origin looks to posterior with 90 degrees: clip x = L, clip y = S, w = P
  const matrix = [1, 0, 0, 0, 0, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0];
  near(beams.movedInPicture(matrix, [0, 50, 0], [0.1, 0.1]), [10, 50, -10]);
  near(beams.movedInPicture(matrix, [5, 100, 7], [0.1, 0.1]), [25, 100, -13]);
});

test('an exported draft has the plan, both lines, the frame and the units', () => {
  const drafted = after(beams.redrafted(plan, scene, { target_mm: [0, 30, 40] }));
  const answer = {
    sera: { phi_deg: 70, theta_deg: 90 },
    gap_mm: 12,
    depth_mm: null,
    skin_lps_mm: [0, -88, 0],
    iec: null,
    planned: { gap_mm: 10 },
  };
  const file = draftDocument(plan, drafted, 'head', answer);
  assert.deepEqual(file.plan, { id: 'head', name: 'Head' });
  assert.equal(file.frame.axes, 'LPS');
  assert.deepEqual(file.frame.units, { length: 'mm', angle: 'degree' });
  assert.deepEqual(
    [file.draft.target_lps_mm, file.draft.gap_mm, file.draft.depth_mm, file.draft.aperture_mm, file.draft.sera.phi_deg],
    [[0, 30, 40], 12, null, 120, 70],
  );
  near([file.draft.length_mm, file.moved.target_mm], [Math.hypot(130, 40), 50]);
  assert.deepEqual([file.planned.id, file.planned.length_mm, file.planned.gap_mm], ['b1', 100, 10]);
  assert.equal(draftDocument({ ...plan, beams: [] }, drafted, 'head', null).planned, null);
});

const drafted = {
  ...fakeScene,
  beam: { ...scene.beam, draft: { enabled: true, shows_planned: false, line: { name: '', entry_mm: [0, -100, 0], target_mm: [3, 4, 0] } } },
};

/** A room with a draft; the page's member presents, or is on their own beside Dr A. */
function roomWithDraft(isOnOwn) {
  const world = roomWorld(isOnOwn ? members('m2', ['m1']) : members('m1'));
  world.connection.receive(welcome({ scene: drafted, plan: { id: 'p', beams: plan.beams } }));
  world.connection.receive(isOnOwn ? members('m2', ['m1']) : members('m1'));
  world.flush();
  return world.room;
}

test('the presenter looks at the planned beam instead of the draft with everyone, and at the draft again', () => {
  const room = roomWithDraft(false);
  assert.equal(beamUi.toggleCompare(room), true);
  assert.equal(room.scene.value.beam.draft.shows_planned, true, 'in the scene: every member reads it');
  assert.equal(room.view(1).document.value.override, undefined);
  assert.deepEqual(
    [beamUi.isComparing(room), beamUi.isDraftOn(room), beams.isDrafted(room.plan.value, room.scene.value)],
    [true, true, false],
  );
  assert.equal(beamUi.toggleCompare(room), true);
  assert.deepEqual([beamUi.isComparing(room), beams.isDrafted(room.plan.value, room.scene.value)], [false, true]);
});

test('a member on their own looks at the planned beam alone', () => {
  const room = roomWithDraft(true);
  room.following.leave();
  assert.equal(beamUi.toggleCompare(room), true);
  assert.deepEqual(room.view(1).document.value.override.beam.draft, { shows_planned: true });
  assert.equal(beamUi.isComparing(room), true);
  beamUi.endCompare(room);
  assert.equal(beams.isDrafted(room.plan.value, room.scene.value), true);
});

test('a member on their own who has drafted has that draft again after looking at the planned beam', () => {
  const room = roomWithDraft(true);
  room.following.leave();
  room.patchScene({ beam: { draft: { enabled: true, line: { target_mm: [9, 9, 9] } } } });
  beamUi.toggleCompare(room);
  assert.equal(beams.isDrafted(room.plan.value, room.scene.value), false);
  beamUi.endCompare(room);
  assert.deepEqual(beams.shownLine(room.plan.value, room.scene.value).target_mm, [9, 9, 9]);
});

test('who follows the presenter has no pictures of their own to compare in', () => {
  const room = roomWithDraft(true);
  assert.equal(beamUi.toggleCompare(room), false);
  assert.equal(beamUi.isComparing(room), false);
});

test('undo names what of a beam it takes back', () => {
  const room = roomWithDraft(false);
  const name = (path) => stepName([{ of: 'scene', path: ['beam', ...path], before: 1, after: 2 }], room);
  assert.deepEqual([['id'], ['looks', 'b1', 'color'], ['draft', 'line', 'entry_mm'], ['kept', 'draft-1'], ['opacity']].map(name), [
    'chosen beam',
    'look of a beam',
    'draft beam',
    'kept draft',
    'opacity of openings',
  ]);
});
