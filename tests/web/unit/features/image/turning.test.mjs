// A picture that turns by itself: a step for each picture that came, what stops it, and that undo knows nothing of it.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const { startTurning } = await load('features/image/turning.js');
const { signal } = await load('../lib/signals-core.js');

const front = { position_mm: [0, -500, 0], target_mm: [0, 0, 0], up: [0, 0, 1], projection: 'perspective', fov_deg: 30, height_mm: null };
const angle = ({ position_mm: [x, y] }) => (Math.atan2(x, -y) * 180) / Math.PI;

/** A page with one 3-D pane; frame() makes a picture come after so many ms. */
function made() {
  const page = Object.assign(new EventTarget(), { hidden: false });
  const view = { number: 1, kind: '3d', painted: signal(null), isOpen: signal(true) };
  const actions = { view, camera: front, sets: [] };
  actions.cameras = {
    set(camera, at, isStep) {
      actions.camera = camera;
      actions.sets.push({ at, isStep });
    },
  };
  const following = { isFollowing: signal(false), isPresenting: signal(false) };
  const world = {
    room: { canChange: signal(true), following, view: () => view },
    ui: { active: signal(1), visible: signal([1]) },
    panes: () => [{ actions }],
    turning: signal(null),
  };
  let now = 0;
  let waiting = null;
  const frames = {
    requestAnimationFrame: (run) => {
      waiting = run;
      return 1;
    },
    cancelAnimationFrame: () => {
      waiting = null;
    },
  };
  const frame = (ms) => {
    now += ms;
    view.painted.value = { sequence: now };
    const run = waiting;
    waiting = null;
    run?.();
  };
  startTurning(world, { clock: () => now, page, frames });
  return { world, view, actions, page, following, frame, isOn: () => world.turning.value !== null };
}

test('each picture brings a step of speed times time, which is none of undo', () => {
  const { world, actions, frame } = made();
  for (let i = 0; i < 10; i += 1) frame(100);
  assert.equal(actions.sets.length, 10);
  assert.ok(Math.abs(angle(actions.camera) - 15) < 1e-6, '15 degrees in a second');
  assert.ok(actions.sets.every(({ at, isStep }) => at === 0 && isStep === false));
  assert.equal(world.turning.value.view, 1, 'the header of the pane says so');
  world.turning.value.stop();
  frame(100);
  assert.equal(actions.sets.length, 10, 'it stands');
});

test('Esc, a hidden tab, a closed view, another presenter and a lost right stop it', () => {
  const stops = {
    escape: ({ page }) => page.dispatchEvent(Object.assign(new Event('keydown'), { key: 'Escape' })),
    hidden: ({ page }) => {
      page.hidden = true;
      page.dispatchEvent(new Event('visibilitychange'));
    },
    closed: ({ view, frame }) => {
      view.isOpen.value = false;
      frame(20);
    },
    follows: ({ following, frame }) => {
      following.isFollowing.value = true;
      frame(20);
    },
    right: ({ world, frame }) => {
      world.room.canChange.value = false;
      frame(20);
    },
  };
  for (const [name, stop] of Object.entries(stops)) {
    const made1 = made();
    made1.frame(20);
    assert.ok(made1.isOn(), name);
    stop(made1);
    assert.equal(made1.isOn(), false, name);
    const n = made1.actions.sets.length;
    made1.page.hidden = false;
    made1.frame(20);
    assert.equal(made1.actions.sets.length, n, `${name}: no step after it`);
  }
});

test('another key and a presenter who turns do not stop it; a second start takes the place of the first', () => {
  const { world, page, following, frame, isOn, actions } = made();
  page.dispatchEvent(Object.assign(new Event('keydown'), { key: 'a' }));
  following.isFollowing.value = following.isPresenting.value = true;
  frame(20);
  assert.ok(isOn());
  const first = world.turning.value;
  startTurning(world, { clock: () => 0, page, frames: { requestAnimationFrame: () => 2, cancelAnimationFrame: () => {} } });
  assert.notEqual(world.turning.value, first);
  assert.ok(actions.sets.length > 0);
  world.turning.value.stop();
});
