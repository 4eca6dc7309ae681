// When a picture counts as stale: random changes, layouts and lost connections, against a server that sends what proto/ promises.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { roomWorld } from '../fake_room.mjs';
import { load } from '../page.mjs';

const { fidelity } = await load('room/fidelity.js');

const views = [1, 2, 3];
const patch = (value) => ({ image: { slices: { axial: { position_mm: value } } } });

/** Whole numbers below n, the same sequence each time. */
function numbers(seed) {
  let state = seed;
  return (n) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return (state >>> 16) % n;
  };
}

/** Server and page. A picture is on its way until it is delivered; texts overtake it. */
function staleWorld(seed) {
  const world = roomWorld();
  const { room, connection, flush, advance } = world;
  const below = numbers(seed);
  const server = { revision: 1, reached: new Map(), latest: new Map(), waits: new Map(), onWay: new Map(), sequence: 0 };
  const drawn = new Map(); // by view: the revision that the picture on the screen was drawn from
  const isCurrent = (view) => (server.latest.get(view) ?? 0) >= (server.reached.get(view) ?? 1);

  function sendPicture(view) {
    const of = server.latest.get(view);
    if (!of || !room.view(view).isOpen.value) return;
    const held = isCurrent(view) ? server.revision : of;
    const input_id = isCurrent(view) ? (server.waits.get(view) ?? 0) : 0;
    server.onWay
      .get(view)
      .push({ of, header: { view, sequence: ++server.sequence, input_id, scene_revision: held, is_still: true, scale_percent: 100 } });
  }
  function tell(input, isReached) {
    server.revision++;
    for (const view of views) if (isReached(view)) server.reached.set(view, server.revision);
    const unchanged = views.filter((view) => room.view(view).isOpen.value && !isReached(view));
    connection.receive({
      type: 'scene',
      revision: server.revision,
      patch: patch(server.revision),
      by: input ? 'm1' : 'm2',
      input,
      unchanged: unchanged.length ? unchanged : null,
    });
  }
  /** Reads what the page has sent. */
  function serve(isReached = () => true) {
    for (const message of connection.sent.splice(0)) {
      if (message.type === 'view.open') {
        server.waits.set(message.view, message.input);
        server.onWay.set(message.view, []);
        sendPicture(message.view);
      } else if (message.type === 'scene.patch') {
        for (const view of views) if (isReached(view)) server.waits.set(view, message.input);
        tell(message.input, isReached);
      }
    }
  }
  const acts = {
    othersChange: () => {
      const mask = below(8);
      tell(0, (view) => mask & (1 << (view - 1)));
    },
    ownChange: () => {
      const mask = below(8);
      room.patchScene(patch(server.revision + 1), { view: views[below(3)], at: 5 });
      flush();
      serve((view) => mask & (1 << (view - 1)));
    },
    changeOfNothing: () =>
      connection.receive({ type: 'scene', revision: server.revision, patch: patch(server.revision), by: 'm1', input: 0, unchanged: null }),
    layout: () => {
      const view = views[below(3)];
      if (room.view(view).isOpen.value) room.hideView(view);
      else room.showView(view, [400, 300]);
      flush();
      serve();
    },
    reconnect: () => {
      world.lose();
      advance(500);
      for (const view of views) server.onWay.set(view, []);
      world.back(undefined, { revision: server.revision });
      serve();
    },
    draw: () => {
      const view = views[below(3)];
      server.latest.set(view, server.revision);
      sendPicture(view);
    },
    deliver: () => {
      const view = views[below(3)];
      const { of, header } = server.onWay.get(view).shift() ?? {};
      if (!header || !room.view(view).isOpen.value) return;
      room.frameCame(header);
      room.frameShown(header);
      drawn.set(view, of);
      if (header.input_id >= (server.waits.get(view) ?? 0)) server.waits.delete(view);
    },
  };

  function check(what) {
    for (const view of views) {
      const state = room.view(view);
      if (!state.painted.value || !state.isOpen.value) continue;
      const badge = fidelity({
        link: room.link.value,
        renderer: 'ready',
        header: state.painted.value,
        staleSince: state.staleSince.value,
        behindSince: state.behindSince.value,
        fps: 0,
        now: 1e9,
      });
      const isDue = server.waits.has(view) || drawn.get(view) < (server.reached.get(view) ?? 1);
      assert.equal(
        badge.state === 'stale',
        isDue,
        `run ${seed}, after ${what}: view ${view} is ${badge.state}, and a newer picture is ${isDue ? '' : 'not '}due`,
      );
    }
  }
  for (const view of views) room.showView(view, [400, 300]);
  for (const view of views) server.onWay.set(view, []);
  flush();
  serve();
  return { acts, check, below, advance };
}

test('a badge is stale exactly while a newer picture is due', () => {
  for (let seed = 1; seed <= 60; seed++) {
    const { acts, check, below, advance } = staleWorld(seed);
    const names = [...Object.keys(acts), 'draw', 'draw', 'deliver', 'deliver', 'deliver'];
    for (let at = 0; at < 120; at++) {
      const name = names[below(names.length)];
      acts[name]();
      check(`step ${at}, ${name}`);
      advance(10);
    }
  }
});

test('a picture that is always one change behind is not stale while newer ones come, and is a second after the last', () => {
  const { room, connection, advance } = roomWorld();
  room.showView(1, [400, 300]);
  const header = (revision) => ({ view: 1, sequence: revision, input_id: 99, scene_revision: revision });
  const change = (revision) => connection.receive({ type: 'scene', revision, patch: patch(revision), by: 'm2', input: 0, unchanged: null });
  room.frameShown(header(1));
  for (let revision = 2; revision < 50; revision++) {
    advance(100);
    change(revision);
    if (revision < 20) room.frameShown(header(revision - 1));
  }
  assert.equal(room.view(1).behindSince.value, 1000 + 18 * 100, 'changes that go on do not put it off');
});
