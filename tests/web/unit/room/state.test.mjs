// Own changes and other people's: what the page shows, with a connection and a clock that are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FakeConnection, roomWorld, welcome } from '../fake_room.mjs';
import { load } from '../page.mjs';

const { Replica } = await load('room/replica.js');
const { RoomState } = await load('room/room.js');
const { fidelity, worst } = await load('room/fidelity.js');
const { crosshairPatch, isLowWhite, readPlan, shownImage, soloPatch } = await load('room/plan.js');

test("an own change shows at once; the server's order wins", () => {
  const replica = new Replica({ opacity: 1, color: 'red' });
  replica.queue({ opacity: 0.5 });
  assert.equal(replica.value.opacity, 0.5);
  assert.deepEqual(replica.take(1), { opacity: 0.5 });
  replica.accept({ opacity: 0.2, color: 'blue' }); // somebody else, before ours on the server
  assert.deepEqual(replica.value, { opacity: 0.5, color: 'blue' }, 'ours comes after it');
  replica.accept({ opacity: 0.5 }, 1);
  replica.accept({ opacity: 0.7 }); // somebody else, after ours
  assert.deepEqual(replica.value, { opacity: 0.7, color: 'blue' });
  assert.equal(replica.isPending, false);
});

test('a refused change goes back to the old value and leaves others alone', () => {
  const replica = new Replica({ a: 1, b: 1 });
  replica.queue({ a: 2 });
  replica.take(1);
  replica.queue({ b: 2 });
  replica.take(2);
  replica.refuse(1);
  assert.deepEqual(replica.value, { a: 1, b: 2 });
});

test('changes of one animation frame go as one patch', () => {
  const replica = new Replica({});
  replica.queue({ camera: { fov_deg: 20 } });
  replica.queue({ camera: { up: [0, 0, 1] } });
  assert.deepEqual(replica.take(1), { camera: { fov_deg: 20, up: [0, 0, 1] } });
  assert.equal(replica.take(2), null);
});

test('a picture that shows an input settles it', () => {
  const replica = new Replica({ x: 0 });
  replica.queue({ x: 1 });
  replica.take(5);
  replica.settle(4);
  assert.equal(replica.isPending, true);
  replica.settle(5);
  assert.deepEqual([replica.isPending, replica.value], [false, { x: 1 }]);
});

// ---- a room over a fake connection -------------------------------------------------------------------------------------

test('a change that was on its way when another name was given is sent again, and the link counts as open meanwhile', () => {
  const { room, connection, flush, back } = roomWorld();
  const patch = { regions: { brain: { opacity: 0.4 } } };
  room.patchScene(patch);
  flush();
  room.rename('Dr Chen');
  assert.deepEqual(connection.names, ['Dr Chen']);
  assert.equal(room.link.value.state, 'open');
  assert.equal(room.scene.value.regions.brain.opacity, 0.4);
  back();
  assert.deepEqual(
    connection.sent.filter(({ type }) => type === 'scene.patch').map((message) => message.patch),
    [patch],
  );
});

test('many changes before a paint become one message with a growing input', () => {
  const { room, connection, flush } = roomWorld();
  room.showView(1, [800, 600]);
  connection.sent.length = 0;
  for (const opacity of [0.9, 0.8, 0.7]) room.patchScene({ regions: { brain: { opacity } } }, { view: 1 });
  room.patchView(1, { camera: { fov_deg: 20 } });
  flush();
  assert.deepEqual(
    connection.sent.map(({ type, patch }) => [type, patch]),
    [
      ['view.patch', { camera: { fov_deg: 20 } }],
      ['scene.patch', { regions: { brain: { opacity: 0.7 } } }],
    ],
  );
  assert.ok(connection.sent[1].input > connection.sent[0].input);
  assert.equal(connection.sent[1].view, 1, 'its pictures go first');
  flush();
  assert.equal(connection.sent.length, 2);
});

test('a refusal brings the old value back and says why', () => {
  const { room, connection, flush, told } = roomWorld();
  room.patchScene({ regions: { brain: { opacity: 7 } } });
  flush();
  const { input } = connection.sent.at(-1);
  connection.receive({ type: 'problem', to: 'scene.patch', view: 0, input, problem: { detail: 'opacity is 7, expected 0 to 1' } });
  assert.equal(room.scene.value.regions.brain.opacity, 1);
  assert.deepEqual(told, [['err', 'opacity is 7, expected 0 to 1']]);
});

test('after a lost connection every open picture is asked for again', () => {
  const { room, connection, lose, back } = roomWorld();
  room.showView(1, [800, 600]);
  room.showView(3, [400, 300]);
  lose();
  assert.equal(room.canChange.value, true, 'changes are kept meanwhile');
  back(undefined, { revision: 9 });
  assert.deepEqual(
    connection.sent.map(({ type, view }) => [type, view]),
    [
      ['view.open', 1],
      ['view.open', 3],
    ],
  );
  assert.equal(room.revision.value, 9);
});

test('a size that comes before the connection, or without one, is the one asked for', () => {
  const connection = new FakeConnection();
  const room = new RoomState('r', { connection, clock: { now: () => 0 }, schedule: () => {}, notify: () => {} });
  const opened = () => connection.sent.filter(({ type }) => type === 'view.open').map(({ document }) => document.size_px);
  room.showView(1, [456, 218]); // before the page has its final layout
  room.showView(1, [456, 270]);
  connection.sent.length = 0;
  connection.receive(welcome());
  assert.deepEqual(opened(), [[456, 270]]);
  connection.tell('lost', { retryMs: 500 });
  room.showView(1, [800, 600]);
  connection.sent.length = 0;
  connection.receive(welcome());
  assert.deepEqual(opened(), [[800, 600]]);
});

test('the time an input waits ends with the picture that shows it', () => {
  const { room, connection, flush } = roomWorld();
  room.showView(1, [800, 600]);
  room.patchView(1, { camera: { fov_deg: 20 } }, { at: 990 });
  flush();
  const { input } = connection.sent.at(-1);
  const frame = (input_id) => ({ view: 1, sequence: 1, input_id, scene_revision: 1 });
  assert.equal(room.frameShown(frame(input - 1)).filter((entry) => entry.input === input).length, 0);
  assert.deepEqual(
    room.frameShown(frame(input)).map(({ at }) => at),
    [990],
  );
  assert.equal(connection.sent.at(-1).type, 'frame.shown');
});

test('a picture that came before the refusal does not end it, whatever has changed meanwhile; one that comes later does', () => {
  const { room, connection } = roomWorld();
  room.showView(1, [800, 600]);
  const frame = (sequence) => ({ view: 1, sequence, input_id: 0, scene_revision: 1 });
  const refuse = () => connection.receive({ type: 'problem', to: '', view: 1, problem: { detail: 'no eye' } });
  room.frameCame(frame(1)); // is being decoded
  refuse();
  room.showView(1, [801, 600]);
  room.frameShown(frame(1));
  assert.equal(room.view(1).refusal.value, 'no eye');
  room.frameCame(frame(2));
  room.frameShown(frame(2));
  assert.equal(room.view(1).refusal.value, '');
  refuse();
  connection.tell('lost', { retryMs: 500 }); // pictures are counted anew on the next connection
  connection.receive(welcome());
  room.frameCame(frame(1));
  room.frameShown(frame(1));
  assert.equal(room.view(1).refusal.value, '');
});

// ---- badges ---------------------------------------------------------------------------------------------------------------

const facts = {
  link: { state: 'open', retryAt: 0 },
  renderer: 'ready',
  staleSince: 0,
  behindSince: 0,
  fps: 27,
  now: 10000,
  header: { is_still: false, is_lossless: false, is_coarse: false, scale_percent: 100, quality: 80, scene_revision: 3 },
};
const still = { ...facts.header, is_still: true };
for (const [what, change, state] of [
  ['nothing before the first picture', { header: null }, undefined],
  ['moving at full size', {}, 'live'],
  ['half size', { header: { ...facts.header, scale_percent: 50 } }, 'reduced'],
  ['coarse surfaces', { header: { ...facts.header, is_coarse: true } }, 'reduced'],
  ['a still', { header: still }, 'full'],
  ['an input unanswered for 0.9 s', { header: still, staleSince: 9100 }, 'full'],
  ['an input unanswered for 1.1 s', { header: still, staleSince: 8900 }, 'stale'],
  ['an older scene for 1.1 s', { header: still, behindSince: 8900 }, 'stale'],
  ['a view that cannot be drawn as it is', { header: still, refusal: 'the camera looks at itself' }, 'stale'],
  ['a restarting renderer', { header: still, renderer: 'restarting' }, 'stale'],
  ['a link that is quiet for 3 s', { header: still, link: { state: 'open', retryAt: 0, quietSince: 7000, dueSince: 7500 } }, 'link'],
  [
    'an answer that is due for 5 s',
    { header: still, link: { state: 'open', retryAt: 0, quietSince: 4500, dueSince: 5000 } },
    'disconnected',
  ],
  ['a lost connection', { header: still, link: { state: 'lost', retryAt: 12000 } }, 'disconnected'],
])
  test(`badge of ${what}`, () => assert.equal(fidelity({ ...facts, ...change })?.state, state));

test('the age of a quiet link counts', () => {
  const link = { state: 'open', retryAt: 0, quietSince: 7000, dueSince: 7500 };
  assert.deepEqual(
    [9200, 10000, 11900].map((now) => fidelity({ ...facts, link, now }).text),
    ['Link? 2 s', 'Link? 3 s', 'Link? 4 s'],
  );
});

test('latency is the median of the last 20 times from input to paint', () => {
  const { room } = roomWorld();
  assert.equal(room.latencyMs.value, null);
  room.measured([1000, 1000, 1000]);
  room.measured(Array.from({ length: 19 }, (_, at) => at + 1)); // 1000 and 1 to 19 stay
  assert.equal(room.latencyMs.value, 11); // the middle of 10 and 11, rounded
});

test('the badge of all panes is the worst of them', () => {
  assert.equal(worst([{ state: 'full' }, null, { state: 'stale' }, { state: 'live' }]).state, 'stale');
});

test('solo shows one region only, and all again the second time', () => {
  const regions = [{ id: 'a' }, { id: 'b' }];
  const both = { regions: { a: { visible: true }, b: { visible: true } } };
  assert.deepEqual(soloPatch(regions, both, 'b').regions, { a: { visible: false }, b: { visible: true } });
  const alone = { regions: { a: { visible: false }, b: { visible: true } } };
  assert.deepEqual(soloPatch(regions, alone, 'b').regions, { a: { visible: true }, b: { visible: true } });
});

test('low values are white where the scene says so, else where the image does', () => {
  for (const isInverted of [false, true])
    for (const [low_values, expected] of [
      ['own', isInverted],
      ['black', false],
      ['white', true],
    ])
      assert.equal(isLowWhite({ isInverted }, { image: { low_values } }), expected);
});

// ---- the crosshair ------------------------------------------------------------------------------------------------------

/** A plan with one image: rows map voxel indices to patient mm. */
function imagePlan(rows, size, bounds) {
  const plan = readPlan({ id: 'p', images: [{ id: 'ct', window: {}, grid: { size, lps_mm_from_ijk: rows, bounds_mm: bounds } }] });
  return { plan, image: shownImage(plan, { image: { id: '' } }) };
}
const placed = (patch) => ['sagittal', 'coronal', 'axial'].map((name) => patch.image.slices[name].position_mm);

test("the crosshair snaps to the centre of the image's voxel, also where axes are reversed and exchanged", () => {
  // i runs to the right in steps of 0.5 mm, j to superior in 2.5, k to posterior in 3: centres at L 10 - 0.5 i, P -4 + 3 k, S 1 + 2.5 j
  const { plan, image } = imagePlan(
    [
      [-0.5, 0, 0, 10],
      [0, 0, 3, -4],
      [0, 2.5, 0, 1],
    ],
    [41, 11, 5],
    { low: [-10.25, -5.5, -0.25], high: [10.25, 9.5, 27.25] },
  );
  assert.deepEqual(placed(crosshairPatch(plan, image, [7.2, 0.6, 9])), [7, 2, 8.5]);
  assert.deepEqual(placed(crosshairPatch(plan, image, [7.26, 0.4, 9.8])), [7.5, -1, 11]);
  assert.deepEqual(placed(crosshairPatch(plan, image, [99, -99, 99])), [10, -4, 26], 'outside: the outermost voxel');
  assert.deepEqual(placed(crosshairPatch(plan, image, [7.23, 0.62, 9.08], { isFree: true })), [7.2, 0.6, 9.1]);
});

test('the crosshair snaps to voxels of an oblique image in all three coordinates', () => {
  // turned by 30 degrees about S: i towards (cos 30, sin 30), 2 mm apart
  const [c, s] = [Math.sqrt(3) / 2, 0.5];
  const { plan, image } = imagePlan(
    [
      [2 * c, -2 * s, 0, 0],
      [2 * s, 2 * c, 0, 0],
      [0, 0, 2, 0],
    ],
    [10, 10, 10],
    { low: [-10, -1, -1], high: [18, 28, 19] },
  );
  const centre = [2 * c * 3 - 2 * s * 4, 2 * s * 3 + 2 * c * 4, 10]; // of voxel 3, 4, 5
  const found = placed(crosshairPatch(plan, image, [centre[0] + 0.6, centre[1] - 0.5, centre[2] + 0.9]));
  found.forEach((value, axis) => assert.ok(Math.abs(value - centre[axis]) < 1e-4, `${found}, expected ${centre}`));
});

test('the first image is that of the shown patient, as on the server', () => {
  const images = [
    { id: 'a', patient: 1 },
    { id: 'b', patient: 0 },
    { id: 'c', patient: null },
  ];
  const idOf = (shownPatient, id = '') => shownImage({ images, shownPatient }, { image: { id } })?.id ?? null;
  assert.deepEqual([idOf(0), idOf(1), idOf(null), idOf(2), idOf(0, 'a')], ['b', 'a', 'a', 'c', 'a']);
  assert.equal(shownImage({ images: images.slice(0, 1), shownPatient: 0 }, { image: { id: '' } }), null);
});

test('without an image the crosshair is free within the plan', () => {
  const plan = readPlan({ id: 'p', bounds_mm: { low: [0, 0, 0], high: [10, 10, 10] } });
  assert.deepEqual(placed(crosshairPatch(plan, null, [3.14, 20, -1])), [3.1, 10, 0]);
});
