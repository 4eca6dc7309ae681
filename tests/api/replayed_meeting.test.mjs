// Two hours of a meeting are recorded, the daemon is killed, and the replay is compared with the meeting at random moments, picture by
// picture, byte for byte: sought in random order, and played through at the highest rate. Comparable are pictures at rest: at each
// moment every shared view has its full still, nothing is changed for a while, and the recording's time at the beginning and at the end
// of that while is kept; at any time between the two the replay must come to rest at the same bytes. The clock of recordings runs
// faster than the meeting (--recording-speed). In `make test` the meeting is short.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { call, sleep, startDaemon, until } from './daemon.mjs';
import { Client } from './ws_client.mjs';

const isLong = !!process.env.LONG_TESTS;
const nMoments = isLong ? 64 : 5,
  leastMs = isLong ? 2 * 3600e3 : 0;
const speed = 100,
  replaySpeed = isLong ? 16 : 8,
  highestRate = 16,
  restMs = isLong ? 400 : 250;
const seed = Number(process.env.SEED ?? 20261123);

const data = mkdtempSync(join(tmpdir(), 'beamroom-replayed-'));
const clients = new Set();
let daemon,
  room,
  id,
  moments = [];
after(async () => {
  for (const client of clients) client.cut();
  await daemon?.stop();
  rmSync(data, { recursive: true, force: true });
});

let drawn = seed >>> 0;
const chance = () => {
  // Numerical Recipes' generator
  drawn = (Math.imul(drawn, 1664525) + 1013904223) >>> 0;
  return drawn / 2 ** 32;
};
const below = (n) => Math.floor(chance() * n);
const between = (low, high) => low + Math.round(chance() * (high - low) * 1000) / 1000;
const one = (list) => list[below(list.length)];
const shuffled = (list) =>
  list
    .map((value) => [chance(), value])
    .sort(([a], [b]) => a - b)
    .map(([, value]) => value);

const start = async (times) => {
  daemon = await startDaemon({ data, args: ['--recording-speed', String(times)] });
};
const url = (path) => `${daemon.url}/api/v1/${path}`;
const sceneOf = async (of) => (await call(url(`rooms/${of}/scene`))).json;
const timeNow = async () => (await call(url(`rooms/${room}/recordings`))).json.recordings[0].length_ms;

async function enter(of, name, who = {}) {
  const client = await Client.enter(daemon.url, of, { name, ...who });
  clients.add(client);
  client.views = new Map();
  await client.ready();
  return client;
}

// ---- views: the layout of panes, by number ----
const panes = {
  1: { kind: '3d' },
  2: { kind: 'axial' },
  3: { kind: 'coronal' },
  4: { kind: 'sagittal' },
  5: { kind: 'oblique', plane: 'a' },
  6: { kind: '3d', number: 2 },
  7: { kind: 'beam' },
};
function opens(client, view, size_px) {
  client.views.set(Number(view), size_px);
  client.send({ type: 'view.open', view: Number(view), document: { ...panes[view], size_px }, follow: true });
}
/** The newest picture of a view; frames before it are let go. */
function newest(client, view) {
  for (let i = client.frames.length; i-- > 0; ) if (client.frames[i].view === view) return client.frames[i];
  return null;
}
/** Keeps of each view the newest frame alone. */
function thin(client) {
  const kept = [...client.views.keys()].map((view) => newest(client, view)).filter(Boolean);
  client.frames.splice(0, client.frames.length, ...kept);
}

let input = 0;
const patch = (client, change) => client.send({ type: 'scene.patch', patch: change, input: ++input });

/** Turns every pane of the presenter, so that each has a picture of its own at each moment, and waits until all are at rest. */
async function comesToRest(chair) {
  const first = new Map();
  for (const view of chair.views.keys()) {
    const isSpace = panes[view].kind === '3d' || panes[view].kind === 'beam';
    const angle = between(0, 6.28),
      at = [600 * Math.cos(angle), 600 * Math.sin(angle), between(-100, 300)];
    const camera = isSpace ? { position_mm: at, target_mm: [0, 0, 0], up: [0, 0, 1] } : { height_mm: between(150, 320) };
    first.set(view, ++input);
    chair.send({
      type: 'view.patch',
      view,
      patch: panes[view].kind === 'beam' ? { beam: { aperture_mm: between(40, 200) } } : { camera },
      input,
    });
  }
  for (const [view, number] of first)
    await chair.until(() => {
      const frame = newest(chair, view);
      return frame?.isStill && frame.input >= number;
    }, `the still of view ${view}`);
}

// ---- what people do: each is (chair, others) ----
const regions = ['scalp', 'cranium', 'brain', 'target', 'tumour'];
let items = [],
  undo = null;
const acts = {
  region: (chair) =>
    patch(chair, {
      regions: {
        [one(regions)]: one([
          { visible: false },
          { visible: true },
          { opacity: between(0.2, 1) },
          { color: one(['#ff8800', '#0088ff', '#88ff00']) },
          { representation: one(['surface', 'outline']) },
        ]),
      },
    }),
  slices: (chair) =>
    patch(chair, {
      image: {
        slices: {
          axial: { position_mm: between(-60, 60) },
          coronal: { visible: chance() < 0.5, position_mm: between(-80, 80) },
          sagittal: { position_mm: between(-60, 60) },
        },
      },
    }),
  window: (chair) =>
    patch(chair, { image: { window: { center: between(-100, 300), width: between(100, 1500) }, color_map: one(['grey', 'grey']) } }),
  clip: (chair) =>
    patch(chair, {
      clip: {
        [one(['axial_low', 'axial_high', 'coronal_low', 'sagittal_high'])]: { enabled: chance() < 0.6, position_mm: between(-40, 40) },
      },
    }),
  freeClip: (chair) =>
    patch(chair, { clip: { free: { enabled: chance() < 0.6, origin_mm: [0, between(-30, 30), 0], normal: [0, 0.6, 0.8] } } }),
  dose: (chair) =>
    patch(chair, {
      dose: {
        wash: { visible: chance() < 0.7 },
        lines: { visible: chance() < 0.5 },
        quantity: one(['weighted', 'boron', 'gamma', 'total']),
      },
    }),
  weights: (chair) =>
    patch(chair, { dose: { blood_ppm: between(5, 40), weights: { [one(regions)]: { cbe: between(1, 4), boron_ratio: between(1, 4) } } } }),
  levels: (chair) =>
    patch(chair, {
      dose: {
        levels: {
          [`level-${1 + below(6)}`]: one([null, { value: between(20, 99), unit: 'percent', color: '#ffffff' }, { visible: false }]),
        },
      },
    }),
  draft: (chair) =>
    patch(chair, {
      beam: {
        draft: {
          enabled: chance() < 0.7,
          shows_planned: true,
          line: { name: 'draft', entry_mm: [between(-20, 20), -110, between(0, 40)], target_mm: [0, 0, 0], aperture_mm: between(60, 140) },
        },
      },
    }),
  beam: (chair) => patch(chair, { beam: { slice: { visible: chance() < 0.5, along_mm: between(0, 60) }, opacity: between(0.1, 0.5) } }),
  tracks: (chair) => patch(chair, { tracks: { visible: chance() < 0.5 } }),
  volume: (chair) => patch(chair, { image: { volume: { visible: chance() < 0.4, method: one(['mip', 'ray']) } } }),
  oblique: (chair) =>
    patch(chair, {
      image: {
        obliques: {
          a: {
            visible: true,
            origin_mm: [between(-20, 20), 0, 0],
            normal: one([
              [0, 0.6, 0.8],
              [0.6, 0, 0.8],
              [0, 0, 1],
            ]),
          },
        },
      },
    }),
  undo: async (chair) => {
    const before = (await sceneOf(room)).axes.visible;
    patch(chair, { axes: { visible: !before } });
    undo = { axes: { visible: before } };
    patch(chair, undo);
  },
  layout: (chair) => {
    const view = one([5, 6, 7]);
    if (chair.views.delete(view)) chair.send({ type: 'view.close', view });
    else opens(chair, view, [160 + 20 * below(4), 140]);
  },
  size: (chair) => {
    const view = one([1, 2, 3, 4]),
      size_px = [200 + 20 * below(5), 160 + 10 * below(4)];
    chair.send({ type: 'view.patch', view, patch: { size_px }, input: ++input });
  },
  pointers: (chair, others) => {
    for (const client of [chair, ...others])
      client.send({ type: 'pointer', view: 1 + below(4), point_mm: [between(-50, 50), between(-50, 50), 0] });
  },
  note: async (chair, others) => {
    const client = one([chair, ...others]),
      mine = ++input;
    client.send({
      type: 'item.put',
      kind: 'note',
      body: { text: `note ${mine}`, anchor: { point_mm: [between(-50, 50), 0, 0] } },
      input: mine,
    });
    items.push((await client.message('item', (message) => message.input === mine)).item);
  },
  save: async (chair) => {
    const mine = ++input,
      views = [
        { view: 1, document: { kind: '3d', camera: { position_mm: [between(300, 600), 100, 50], target_mm: [0, 0, 0], up: [0, 0, 1] } } },
      ];
    chair.send({ type: 'item.put', kind: 'bookmark', body: { name: `Saved ${mine}`, order: mine, views, layout: {} }, input: mine });
    items.push((await chair.message('item', (message) => message.input === mine)).item);
  },
  show: async (chair) => {
    // a saved view: its scene and its camera
    const saved = one(items.filter(({ kind }) => kind === 'bookmark'));
    if (!saved) return;
    patch(chair, saved.body.scene);
    chair.send({ type: 'view.patch', view: 1, patch: { camera: saved.body.views[0].document.camera }, input: ++input });
  },
  own: (chair, others) => {
    for (const client of others) client.send({ type: 'follow', follow: chance() < 0.5 });
  },
};

const onDisk = () =>
  Number(
    execFileSync(
      'python3',
      [
        '-c',
        `import sqlite3, sys
print(sqlite3.connect('file:%s?mode=ro' % sys.argv[1], uri=True, timeout=30).execute('SELECT max(t_ms) FROM recording_batches').fetchone()[0] or 0)`,
        join(data, 'beamroom.db'),
      ],
      { encoding: 'utf8' },
    ),
  );

test('a meeting is recorded, and the pictures of the presenter are kept at random moments', { timeout: 900000 }, async () => {
  await start(speed);
  room = (await call(url('rooms'), 'POST', { plan: 'phantom' })).json.id;
  const ann = await enter(room, 'Ann'),
    ben = await enter(room, 'Ben');
  let cem = await enter(room, 'Cem'),
    chair = ann;
  for (const [n, client] of [ann, ben, cem].entries())
    for (const view of [1, 2, 3, 4]) opens(client, view, [240 + 40 * n, 180 + 10 * view]);
  ann.send({ type: 'recording.start' });
  id = (await ben.message('recording')).id;
  let names = [];
  const isEnough = () => moments.length >= nMoments && moments.at(-1).to >= leastMs;
  while (!isEnough()) {
    const others = [ann, ben, cem].filter((client) => client !== chair && !client.closeCode);
    for (let n = 1 + below(3); n > 0; n--) {
      if (!names.length) names = shuffled([...Object.keys(acts), 'handOver', 'comesAndGoes']);
      const name = names.pop();
      if (name === 'handOver') {
        const next = chair === ann ? ben : ann;
        chair.send({ type: 'control.give', member: next.welcome.member });
        await until(
          async () => (await call(url(`rooms/${room}`))).json.members.find((member) => member.id === next.welcome.member),
          ({ presenting }) => presenting,
        );
        for (const view of next.views.keys()) if (view > 4) next.views.delete(view);
        chair = next;
        for (const view of chair.views.keys()) opens(chair, view, chair.views.get(view)); // this window's own sizes
      } else if (name === 'comesAndGoes') {
        cem.cut();
        clients.delete(cem);
        cem = await enter(room, 'Cem', { member: cem.welcome.member, secret: cem.welcome.secret });
        opens(cem, 1, [200, 150]);
      } else {
        await acts[name](chair, others);
      }
    }
    for (const client of [ann, ben, cem]) thin(client);
    for (;;) {
      await comesToRest(chair);
      const from = await timeNow(),
        shown = [...chair.views.keys()].map((view) => [view, newest(chair, view)]);
      await sleep(restMs);
      const to = (await timeNow()) - 1;
      if (!shown.every(([view, frame]) => newest(chair, view) === frame && !frame.isCoarse)) continue; // not at rest yet
      moments.push({
        from,
        to,
        scene: await sceneOf(room),
        presenter: chair.welcome.member,
        pictures: shown.map(([view, { picture }]) => [view, Buffer.from(picture)]),
      });
      break;
    }
  }
  const last = moments.at(-1);
  await until(
    () => {
      chair.send({ type: 'pointer', view: 1, point_mm: [between(-50, 50), 0, 0] });
      return onDisk();
    },
    (t_ms) => t_ms > last.to,
  );
  const facts = (await call(url(`rooms/${room}/recordings`))).json.recordings[0];
  console.log(
    `# seed ${seed}: ${(last.to / 3600e3).toFixed(2)} h, ${facts.n_events} events, ${Math.round(facts.n_bytes / 1024)} KiB, ${moments.length} moments, ${moments.reduce((n, { pictures }) => n + pictures.length, 0)} pictures`,
  );
  const ended = new Promise((done) => daemon.child.on('exit', done));
  daemon.child.kill('SIGKILL');
  await ended;
});

/** Opens what panes a moment has; the sizes are other ones than in the meeting. */
function opensAll(dee, { pictures }) {
  for (const [view] of pictures) if (!dee.views.has(view)) opens(dee, view, [100 + 30 * view, 90]);
}
const differing = (dee, { pictures }) =>
  pictures
    .filter(([view, bytes]) => {
      const frame = newest(dee, view);
      return !frame?.isStill || !bytes.equals(frame.picture);
    })
    .map(([view]) => view);
async function showsAs(dee, moment, n) {
  opensAll(dee, moment);
  await dee
    .until(() => !differing(dee, moment).length, `moment ${n}: the pictures of the meeting, from ${moment.from} to ${moment.to} ms,`)
    .catch((error) => {
      throw new Error(`views ${differing(dee, moment)} differ: ${error.message}`);
    });
  thin(dee);
}

let dee;
test('after the daemon was killed, the replay shows the same bytes at each moment, in any order', { timeout: 900000 }, async () => {
  await start(replaySpeed);
  const made = await call(url('rooms'), 'POST', { recording: { room, id } });
  assert.equal(made.status, 201, made.text);
  dee = await enter(made.json.id, 'Dee');
  assert.equal((await dee.message('replay')).plan_changed, false);
  for (const [n, moment] of shuffled([...moments.entries()])) {
    const t_ms = between(moment.from, moment.to);
    dee.send({ type: 'replay.seek', t_ms });
    await showsAs(dee, moment, n);
    if (chance() < 0.3) dee.send({ type: 'view.patch', view: 1, patch: { size_px: [150 + below(200), 120] } }); // a window that changes
    assert.deepEqual(await sceneOf(made.json.id), moment.scene);
  }
});

test('played through at the highest rate, it comes by the same bytes', { timeout: 900000 }, async () => {
  const stands = async (from) => (await dee.message('replay.at', ({ state }) => state === 'paused' || state === 'ended', from)).t_ms;
  let at = 0,
    nAgain = 0;
  dee.send({ type: 'replay.pause' });
  dee.send({ type: 'replay.seek', t_ms: 0 });
  for (const [n, moment] of moments.entries()) {
    const begin = at;
    for (let rate = highestRate; ; rate = Math.max(rate / 2, 0.25)) {
      const asked = dee.messages.length;
      dee.send({ type: 'replay.play', rate });
      const playing = await dee.message('replay.at', ({ state, rate: now }) => state === 'playing' && now === rate, asked);
      const aim = moment.from + (moment.to - moment.from) / 4;
      await sleep(Math.max(0, (aim - playing.t_ms) / (rate * replaySpeed) - 2));
      const paused = dee.messages.length;
      dee.send({ type: 'replay.pause' });
      at = await stands(paused);
      if (at >= moment.from && at <= moment.to) break;
      assert.ok(rate > 0.25, `moment ${n} is not met: ${at} is not from ${moment.from} to ${moment.to}`);
      if (at > moment.to) {
        // this machine was too slow for so high a rate: once more
        nAgain++;
        dee.send({ type: 'replay.seek', t_ms: begin });
      }
    }
    await showsAs(dee, moment, n);
  }
  console.log(
    `# ${moments.length - nAgain} of ${moments.length} moments were met at ${highestRate * replaySpeed} times the meeting's pace at once`,
  );
});
