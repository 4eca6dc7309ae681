// Presenting, following and leaving, with a connection and a clock that are fakes.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FakeConnection, members, roomWorld, scene, welcome } from '../fake_room.mjs';
import { load } from '../page.mjs';

const { RoomState } = await load('room/room.js');
const { widen, widening } = await load('room/own_camera.js');

const camera = { position_mm: [0, 0, -1000], target_mm: [0, 0, 0], up: [0, -1, 0], projection: 'parallel', fov_deg: 30, height_mm: 300 };
const shared = {
  kind: 'axial',
  number: 1,
  plane: '',
  size_px: [900, 600],
  pixel_ratio: 1,
  foot_px: 0,
  camera,
  beam: { along_mm: null, crosshair: true, aperture_mm: null },
  override: {},
};
const viewMessage = (follow, more = {}) => ({ type: 'view', view: 2, document: { ...shared, ...more }, follow, by: 'm2' });
const sent = (connection) => connection.sent.map(({ type }) => type);

/** A follower of Dr A whose axial pane is 400 x 400 px; the shared view has 900 x 600. */
function follower(list = members('m2', ['m1'])) {
  const world = roomWorld(list);
  world.room.showView(2, [400, 400]);
  world.connection.receive(viewMessage(true));
  world.connection.sent.length = 0;
  return world;
}

test('a member alone presents: changes go to the room', () => {
  const { room, connection, flush } = roomWorld();
  assert.equal(room.following.standing.value, 'presenting');
  room.showView(2, [400, 400]);
  connection.sent.length = 0;
  room.patchView(2, { camera });
  room.patchScene({ image: { slices: { axial: { position_mm: 7 } } } }, { view: 2 });
  flush();
  assert.deepEqual(sent(connection), ['view.patch', 'scene.patch']);
  assert.deepEqual(connection.sent[0].patch, { camera });
});

test('before the list of members has come nothing can be changed, as nobody knows whose change it would be', () => {
  const connection = new FakeConnection();
  const room = new RoomState('r', { connection, clock: { now: () => 0 }, schedule: (callback) => callback(), notify: () => {} });
  connection.receive(welcome());
  const { canChange } = room;
  assert.equal(canChange.value, false);
  room.patchScene({ image: { slices: { axial: { position_mm: 7 } } } });
  assert.equal(room.following.isFollowing.value, true, 'nobody leaves a room of which they may be the presenter');
  connection.receive(members('m1'));
  assert.equal(canChange.value, true);
});

test('a follower who moves the crosshair leaves: with their own size, scale and slices, and the room hears of no change', () => {
  const { room, connection, flush, told } = follower();
  assert.equal(room.following.standing.value, 'following');
  room.patchScene({ image: { slices: { axial: { position_mm: 7 } } } }, { view: 2 });
  assert.equal(room.following.standing.value, 'own');
  assert.equal(room.scene.value.image.slices.axial.position_mm, 7, 'shown at once');
  flush();
  assert.deepEqual(sent(connection), ['follow', 'view.patch']);
  const [{ follow, views }, { patch }] = connection.sent;
  assert.equal(follow, false);
  assert.deepEqual(
    views.map(({ view }) => view),
    [2],
  );
  const [{ document }] = views;
  assert.deepEqual([document.size_px, document.foot_px], [[400, 400], 28]);
  // 900 x 600 is shown 400 px wide, at 4/9; 300 mm over 600 px is 0.5 mm a px, so 1.125 mm per own px: 450 mm over 400 px
  assert.ok(Math.abs(document.camera.height_mm - 450) < 1e-9);
  assert.deepEqual(document.override, {
    image: { slices: { axial: { position_mm: 0 }, coronal: { position_mm: 0 }, sagittal: { position_mm: 0 } } },
  });
  assert.deepEqual(patch, { override: { image: { slices: { axial: { position_mm: 7 } } } } });
  assert.deepEqual(
    told.map(([, text, , action]) => [text, action.word]),
    [['On your own.', 'Return']],
  );
});

test('lines are as wide on any screen and fade at the foot of slices: shown first, and of their own after leaving', () => {
  const { devicePixelRatio } = globalThis;
  globalThis.devicePixelRatio = 2;
  try {
    const { room, connection } = follower();
    room.showView(1, [300, 300]);
    const { document: opened } = connection.sent.find(({ type }) => type === 'view.open');
    assert.deepEqual([opened.pixel_ratio, opened.foot_px], [2, 28]);
    room.following.leave();
    const { views } = connection.sent.find(({ type }) => type === 'follow');
    for (const { document } of views) assert.deepEqual([document.pixel_ratio, document.foot_px], [2, 28]);
  } finally {
    globalThis.devicePixelRatio = devicePixelRatio;
  }
});

test('the drag that made a member leave goes on in the own view, in its scale', () => {
  const { room, connection, flush } = follower();
  const moved = { ...camera, target_mm: [5, 0, 0] };
  room.patchView(2, { camera: moved });
  flush();
  assert.deepEqual(sent(connection), ['follow', 'view.patch']);
  assert.deepEqual(connection.sent[1].patch.camera.target_mm, [5, 0, 0]);
  assert.ok(Math.abs(connection.sent[1].patch.camera.height_mm - 450) < 1e-9);
  room.patchView(2, { camera: { ...moved, height_mm: 200 } });
  flush();
  assert.equal(connection.sent[2].patch.camera.height_mm, 200, 'later ones are of the own view already');
});

test("a change of the scene by somebody on their own goes into all own views, and the presenter's stays under it", () => {
  const { room, connection, flush } = follower();
  room.showView(1, [800, 600]);
  room.following.leave();
  connection.sent.length = 0;
  room.patchScene({ regions: { brain: { visible: false } } }, { view: 1 });
  flush();
  assert.deepEqual(
    connection.sent.map(({ type, view }) => [type, view]),
    [
      ['view.patch', 1],
      ['view.patch', 2],
    ],
  );
  connection.receive({
    type: 'scene',
    revision: 2,
    patch: { regions: { brain: { opacity: 0.5, visible: true } }, image: { slices: { axial: { position_mm: 30 } } } },
    by: 'm2',
  });
  const { regions, image } = room.scene.value;
  assert.deepEqual([regions.brain.visible, regions.brain.opacity, image.slices.axial.position_mm], [false, 0.5, 0]);
  room.showView(3, [300, 300]); // a pane that opens later
  assert.equal(connection.sent.at(-1).follow, false);
  assert.equal(connection.sent.at(-1).document.override.regions.brain.visible, false);
});

test("the size of a follower's pane is told and changes no shared document; a presenter's does", () => {
  const { room, connection, flush } = follower();
  room.showView(2, [500, 300]);
  flush();
  assert.deepEqual(
    connection.sent.map(({ patch }) => patch),
    [{ size_px: [500, 300] }],
  );
  assert.deepEqual(room.view(2).document.value.size_px, [900, 600]);
  connection.receive(viewMessage(true, { size_px: [700, 700] }));
  room.following.leave();
  assert.deepEqual(connection.sent.at(-1).views[0].document.size_px, [500, 300], 'the one measured last');
  connection.receive(viewMessage(false, { size_px: [700, 700] }));
  assert.deepEqual(room.view(2).document.value.size_px, [500, 300]);
});

test('return follows again with all panes and drops the override; Esc and F have nothing to do then', () => {
  const { room, connection } = follower();
  room.patchScene({ image: { slices: { axial: { position_mm: 7 } } } });
  connection.receive(viewMessage(false, { override: { image: { slices: { axial: { position_mm: 7 } } } } }));
  connection.sent.length = 0;
  assert.equal(room.following.return(), true);
  assert.equal(room.scene.value.image.slices.axial.position_mm, 0);
  assert.deepEqual(
    connection.sent.map(({ type, follow }) => [type, follow]),
    [['follow', true]],
  );
  assert.equal(room.following.return(), false);
});

test('a message that is older than leaving does not call back; the answer and what comes after it count', () => {
  const { room, connection } = follower();
  room.following.leave();
  connection.receive(viewMessage(true, { camera: { ...camera, height_mm: 50 } })); // the presenter moved meanwhile
  assert.equal(room.following.isFollowing.value, false);
  assert.ok(room.view(2).document.value.camera.height_mm > 400);
  connection.receive(viewMessage(false));
  assert.equal(room.following.isFollowing.value, false);
  connection.receive(viewMessage(true)); // "Show everyone"
  assert.equal(room.following.isFollowing.value, true);
});

test('leaving, returning and leaving again during a lag ends on the own view', () => {
  const { room, connection } = follower();
  room.following.leave();
  room.following.return();
  room.following.leave();
  for (const follow of [true, false, true, false]) {
    connection.receive(viewMessage(follow));
    assert.equal(room.following.isFollowing.value, false);
  }
});

test('F of the presenter changes nothing and says so', () => {
  const { room, connection, told } = roomWorld(members('m1', ['m2']));
  connection.sent.length = 0;
  room.following.toggle();
  assert.deepEqual(connection.sent, []);
  assert.match(told.at(-1)[1], /presenting/);
  assert.equal(room.following.nFollowers.value, 1);
});

test('without a presenter every member can take over; before, nobody', () => {
  const { room, connection, told } = follower();
  room.following.present();
  assert.deepEqual(connection.sent, []);
  connection.receive(members('m2', ['m1'], { m2: { connected: false } }));
  assert.equal(room.following.standing.value, 'away');
  connection.receive(members(null, ['m1', 'm3']));
  assert.equal(room.following.standing.value, 'none');
  assert.equal(told.at(-1)[3].word, 'Take over');
  room.following.present();
  assert.deepEqual(sent(connection), ['present']);
  connection.receive(members('m1', ['m3']));
  assert.equal(room.following.standing.value, 'presenting');
});

test('who is left alone is told so, and not that somebody who is gone called', () => {
  const { room, connection, told } = follower();
  room.following.leave();
  connection.receive(viewMessage(false));
  connection.receive(members('m2', ['m1'], { m2: { connected: false } }));
  told.length = 0;
  connection.receive(viewMessage(true)); // the own views have become the room's
  connection.receive(members('m1', ['m2'], { m2: { connected: false } }));
  assert.equal(room.following.standing.value, 'presenting');
  assert.deepEqual(
    told.map(([, text]) => text),
    ['You are alone here, and present now.'],
  );
});

// ---- what crosses on the way ----------------------------------------------------------------------------------------------

const notPresenter = (to, input, more = {}) => ({
  type: 'problem',
  to,
  view: 0,
  input,
  problem: { type: '/problems/not-presenter', status: 403, detail: 'only the presenter, m2, may do that' },
  ...more,
});

test('a change that was on its way when the presenter called everybody back is dropped without a word', () => {
  const { room, connection, flush, told } = follower();
  room.following.leave();
  connection.receive(viewMessage(false));
  room.patchView(2, { camera: { ...camera, height_mm: 200 } });
  room.patchScene({ regions: { brain: { visible: false } } });
  flush();
  const [{ type, input }] = connection.sent.slice(-1);
  assert.equal(type, 'view.patch');
  connection.receive(viewMessage(true)); // "Show everyone"
  connection.receive(members('m2', ['m1']));
  told.length = 0;
  connection.receive(notPresenter('view.patch', input, { view: 2 }));
  assert.deepEqual(told, []);
  assert.deepEqual(room.view(2).document.value, { ...shared });
  assert.equal(room.scene.value.regions.brain.visible, true);
});

test('a change of the room that was on its way when somebody else took over is taken back, and said', () => {
  const { room, connection, flush, told } = roomWorld(members('m1', ['m2']));
  room.patchScene({ regions: { brain: { opacity: 0.5 } } });
  flush();
  const { input } = connection.sent.at(-1);
  connection.receive(members('m2', ['m1']));
  told.length = 0;
  connection.receive(notPresenter('scene.patch', input));
  assert.deepEqual(
    told.map(([kind, text]) => [kind, text]),
    [['warn', 'Dr A presents now: your last change was not made.']],
  );
  assert.equal(room.scene.value.regions.brain.opacity, 1);
});

test('what only a presenter may do is still refused aloud while this member presents', () => {
  const { room, connection, flush, told } = roomWorld(members('m1', ['m2']));
  room.patchScene({ regions: { brain: { opacity: 0.5 } } });
  flush();
  told.length = 0;
  connection.receive(notPresenter('scene.patch', connection.sent.at(-1).input));
  assert.deepEqual(
    told.map(([kind]) => kind),
    ['err'],
  );
});

test('who leaves in the moment in which they are left alone presents what the page shows, without a word', () => {
  const { room, connection, flush, told } = follower();
  room.patchScene({ image: { slices: { axial: { position_mm: 7 } } } }, { view: 2 });
  flush();
  const { input } = connection.sent.find(({ type }) => type === 'follow');
  connection.receive(viewMessage(true));
  connection.receive(members('m1', ['m2'], { m2: { connected: false } }));
  told.length = 0;
  connection.sent.length = 0;
  connection.receive(notPresenter('follow', input)); // the presenter cannot leave
  assert.deepEqual(told, []);
  assert.deepEqual([room.following.isFollowing.value, room.following.override.value], [true, null]);
  // the server has taken the patch that followed for one of the shared view
  const [{ type, view, patch }] = connection.sent;
  assert.deepEqual([type, view, patch.override, patch.camera], ['view.patch', 2, null, room.view(2).document.value.camera]);
});

test('of two who take over at once the later one is told who presents', () => {
  const { room, connection, told } = follower();
  connection.receive(members(null, ['m1', 'm3']));
  room.following.present();
  connection.receive(members('m3', ['m1']));
  connection.receive(notPresenter('present', connection.sent.at(-1).input));
  assert.deepEqual(told.at(-1).slice(0, 2), ['ok', 'Dr B has taken over.']);
});

// ---- a lost connection --------------------------------------------------------------------------------------------------

test('what the presenter changed without a connection, and what was on its way, is sent after it as one newest change', () => {
  const { room, connection, flush, lose, back } = roomWorld();
  room.showView(2, [400, 400]);
  room.patchScene({ regions: { brain: { opacity: 0.9 } } });
  flush(); // sent, and never answered
  lose();
  for (const opacity of [0.5, 0.4]) room.patchScene({ regions: { brain: { opacity, visible: false } } });
  room.patchView(2, { camera });
  flush();
  assert.equal(room.scene.value.regions.brain.opacity, 0.4, 'shown meanwhile');
  back();
  assert.deepEqual(sent(connection), ['view.open', 'view.patch', 'scene.patch']);
  assert.deepEqual(connection.sent[1].patch, { camera });
  assert.deepEqual(connection.sent[2].patch, { regions: { brain: { opacity: 0.4, visible: false } } });
  assert.equal(room.scene.value.regions.brain.opacity, 0.4);
});

test('when somebody else presents after it, the kept changes are shown as lost', () => {
  const { room, connection, lose, back, told } = roomWorld(members('m1', ['m2']));
  room.showView(2, [400, 400]);
  lose();
  room.patchScene({ regions: { brain: { opacity: 0.4 } } });
  back(members('m2', ['m1']));
  assert.deepEqual(sent(connection), ['view.open']);
  assert.equal(room.scene.value.regions.brain.opacity, 1);
  assert.match(told.at(-1)[1], /are lost: Dr A presents now/);
});

test('who leaves without a connection is on their own after it, with the then current documents', () => {
  const { room, connection, flush, lose, back } = follower();
  lose();
  room.patchScene({ image: { slices: { axial: { position_mm: 9 } } } }, { view: 2 });
  flush();
  back();
  assert.deepEqual(
    connection.sent.map(({ type, follow }) => [type, follow]),
    [['view.open', false]],
  );
  const { document } = connection.sent[0];
  assert.equal(document.override.image.slices.axial.position_mm, 9);
  assert.deepEqual(document.size_px, [400, 400]);
  assert.equal(room.scene.value.image.slices.axial.position_mm, 9);
  assert.equal(scene.image.slices.axial.position_mm, 0);
});

test("who comes back on their own and is alone presents what they see: the own views become the room's", () => {
  const { room, connection, lose, back } = follower();
  room.patchScene({ image: { slices: { axial: { position_mm: 9 } } } }, { view: 2 });
  connection.receive(viewMessage(false));
  lose();
  back(members('m1', ['m2'], { m2: { connected: false } }));
  assert.deepEqual(
    connection.sent.map(({ type, follow }) => [type, follow]),
    [
      ['view.open', false],
      ['present', undefined],
    ],
  );
  assert.equal(room.scene.value.image.slices.axial.position_mm, 9, 'until the server has answered, too');
  assert.equal(room.following.return(), false);
  connection.receive({
    type: 'scene',
    revision: 2,
    patch: { image: { slices: { axial: { position_mm: 9 } } } },
    by: 'm1',
    input: connection.sent[1].input,
  });
  connection.receive(viewMessage(true));
  assert.equal(room.following.isFollowing.value, true);
  assert.equal(room.following.override.value, null);
  assert.equal(room.scene.value.image.slices.axial.position_mm, 9);
});

test('who comes back on their own to a server that still loads the plan presents when it is loaded', () => {
  const { room, connection, lose, back } = follower();
  room.following.leave();
  lose();
  back(members('m1'), { plan: null, scene: null });
  assert.deepEqual(sent(connection), ['view.open']);
  connection.receive({ type: 'plan', plan: { id: 'p' }, scene, revision: 1, gl: '' });
  assert.deepEqual(sent(connection), ['view.open', 'present']);
});

// ---- scale ------------------------------------------------------------------------------------------------------------------

test('the own view shows a mm on as many px as the shared picture in the own pane', () => {
  const header = { full_px: [900, 600], pixels_per_mm: 2 };
  // shown at 1/3 in 300 x 300: 2/3 px a mm, so 450 mm across
  assert.ok(Math.abs(widening(camera, 'axial', [900, 600], header, [300, 300]) * 300 - 450) < 1e-9);
  assert.equal(widening(camera, 'axial', [900, 600], header, [900, 600]), 1);
});

test('in perspective the opening angle widens and the eye stays', () => {
  const eye = { ...camera, projection: 'perspective', height_mm: null };
  const factor = widening(eye, '3d', [600, 600], null, [600, 1200]);
  assert.equal(factor, 1, 'the smaller side is the same');
  const wide = widen(eye, '3d', widening(eye, '3d', [900, 600], null, [600, 600])); // shown 600 x 400: 1.5 times as high
  assert.deepEqual(wide.position_mm, eye.position_mm);
  assert.ok(Math.abs(Math.tan((wide.fov_deg * Math.PI) / 360) / Math.tan(Math.PI / 12) - 1.5) < 1e-12);
});
