// Particle tracks on the page: which are shown, and playing them at a bounded rate, with a clock and a room of the test.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from '../../page.mjs';

const tracks = await load('features/tracks/tracks.js');
const { TrackPlay } = await load('features/tracks/track_play.js');
const { mergePatch } = await load('wire/merge.js');

const plan = { nTracks: 1000 };
const all = {
  visible: true,
  classes: { neutron_high: true, lost: false },
  first: 0,
  count: null,
  energy_low_mev: null,
  energy_high_mev: null,
};
const sceneOf = (part = {}) => ({ tracks: { ...all, ...part } });

test('a class is shown while it and the tracks are, and to show one shows the tracks', () => {
  assert.equal(tracks.isShownClass(sceneOf(), 'neutron-high'), true);
  assert.equal(tracks.isShownClass(sceneOf(), 'lost'), false);
  assert.equal(tracks.isShownClass(sceneOf({ visible: false }), 'neutron-high'), false);
  const after = mergePatch(sceneOf({ visible: false }), tracks.classPatch('lost', true));
  assert.deepEqual([after.tracks.visible, after.tracks.classes.lost, after.tracks.classes.neutron_high], [true, true, true]);
  assert.deepEqual(tracks.classPatch('neutron-high', false), { tracks: { classes: { neutron_high: false } } });
});

test('the range is held to the segments of the files, and all of them are no limit', () => {
  assert.deepEqual(tracks.rangeOf(plan, sceneOf()), { first: 0, most: 1000, count: 1000 });
  assert.deepEqual(tracks.rangeOf(plan, sceneOf({ first: 900, count: 500 })), { first: 900, most: 100, count: 100 });
  assert.deepEqual(tracks.rangeOf(plan, sceneOf({ first: 2000, count: 5 })), { first: 1000, most: 0, count: 0 });
  assert.equal(tracks.countPatch(plan, sceneOf(), 999.4).tracks.count, 999);
  assert.equal(tracks.countPatch(plan, sceneOf(), 1e9).tracks.count, null);
  assert.equal(tracks.countPatch(plan, sceneOf(), -3).tracks.count, 0);
  assert.equal(tracks.isWhole(sceneOf()), true);
  for (const part of [{ first: 1 }, { count: 0 }, { energy_low_mev: 0 }, { energy_high_mev: 1 }])
    assert.equal(tracks.isWhole(sceneOf(part)), false);
});

/** A room whose scene takes each patch at once, and a clock that moves by advance(). */
function world(part) {
  const box = (value) => ({
    value,
    peek() {
      return this.value;
    },
  });
  const timers = new Map();
  let [now, next] = [0, 1];
  const clock = {
    now: () => now,
    setTimeout: (run, ms) => {
      timers.set(next, { run, at: now + ms });
      return next++;
    },
    clearTimeout: (id) => timers.delete(id),
  };
  const patches = [];
  const room = {
    plan: box(plan),
    scene: box(sceneOf(part)),
    canChange: box(true),
    isScenePending: box(false),
    patchScene: (patch) => {
      patches.push({ at: now, ...patch.tracks });
      room.scene.value = mergePatch(room.scene.value, patch);
    },
  };
  const advance = (ms) => {
    for (const end = now + ms; now < end; ) {
      now += 5;
      for (const [id, { run, at }] of [...timers])
        if (at <= now) {
          timers.delete(id);
          run();
        }
    }
  };
  return { room, patches, advance, timers, play: new TrackPlay(room, clock) };
}

test('playing draws all segments in the chosen time, by at most ten changes a second', () => {
  const { play, patches, advance, timers, room } = world();
  play.start();
  assert.equal(room.scene.value.tracks.count, 0);
  advance(5000);
  assert.ok(Math.abs(room.scene.value.tracks.count - 500) <= 12, `${room.scene.value.tracks.count} after half of the time`);
  advance(5200);
  assert.equal(room.scene.value.tracks.count ?? null, null);
  assert.equal(play.isOn.value, false);
  assert.equal(timers.size, 0);
  patches.forEach(({ at, count }, i) => {
    if (!i) return;
    assert.ok(at - patches[i - 1].at >= 100, `${at - patches[i - 1].at} ms between two changes`);
    assert.ok(count === null || count >= patches[i - 1].count);
  });
});

test('it goes on from where it was paused, and waits for a server that has not taken the last change', () => {
  const { play, patches, advance, room } = world({ count: 300 });
  play.start();
  assert.equal(room.scene.value.tracks.count, 300);
  advance(1000);
  play.pause();
  const { count } = room.scene.value.tracks;
  assert.ok(Math.abs(count - 400) <= 12);
  advance(1000);
  assert.equal(room.scene.value.tracks.count, count);
  room.isScenePending.value = true;
  play.start();
  const before = patches.length;
  advance(2000);
  assert.equal(patches.length, before);
  room.isScenePending.value = false;
  advance(200);
  assert.ok(patches.length > before);
});

test('it stops when the tracks are hidden or the scene may not be changed any more', () => {
  for (const stop of [
    (room) => {
      room.scene.value.tracks.visible = false;
    },
    (room) => {
      room.canChange.value = false;
    },
  ]) {
    const { play, patches, advance, room } = world();
    play.start();
    advance(300);
    stop(room);
    const before = patches.length;
    advance(1000);
    assert.equal(play.isOn.value, false);
    assert.equal(patches.length, before);
  }
});
