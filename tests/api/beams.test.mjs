// A meeting that looks along a beam: one picture for all, drafts and their revisions, who may draft, plans without beams. The matrix of a
// picture says along which line it looks: a direction square to both axes of the picture, through its middle.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { bin, call, demo, openPlan, startDaemon } from './daemon.mjs';
import { Client } from './ws_client.mjs';

let daemon, api, folder;
const clients = [];

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-beams-'));
  const bare = join(folder, 'bare');
  assert.equal(spawnSync(join(bin, 'beamroom'), ['phantom', bare, '--size', '64x64x48']).status, 0);
  const { beams: _, tracks: __, ...plan } = JSON.parse(readFileSync(join(bare, 'plan.json'), 'utf8'));
  writeFileSync(join(bare, 'plan.json'), JSON.stringify(plan));
  daemon = await startDaemon({ plans: [demo, folder] });
  api = `${daemon.url}/api/v1`;
  await openPlan(daemon.url, 'phantom');
});
afterEach(() => {
  for (const client of clients.splice(0)) client.cut();
});
after(async () => {
  if (daemon) assert.equal(await daemon.stop(), 0, daemon.log());
  if (folder) rmSync(folder, { recursive: true, force: true });
});

const newRoom = async (plan = 'phantom') => (await call(`${api}/rooms`, 'POST', { plan })).json.id;
async function enter(room) {
  const client = await Client.enter(daemon.url, room);
  clients.push(client);
  await client.ready();
  return client;
}
const open = (client, view, kind, more = {}, follow = true) =>
  client.send({ type: 'view.open', view, follow, document: { kind, size_px: [96, 72], ...more } });
const still = (client, view, suits = () => true, from = 0) =>
  client.frame((frame) => frame.view === view && frame.isStill && suits(frame), from);
const patch = (client, input, change) => client.send({ type: 'scene.patch', input, patch: change });
const revisionOf = async (client, input) => (await client.message('scene', (message) => message.input === input)).revision;

const planned = { entry_mm: [0, 0, 88], target_mm: [0, 0, 10] }; // core/phantom/head.c
/** A draft that comes from an angle about the patient's axis. */
const line = (degrees) => ({
  entry_mm: [Math.round(120 * Math.sin((degrees * Math.PI) / 180)), Math.round(-120 * Math.cos((degrees * Math.PI) / 180)), 40],
  target_mm: [5, 10, 20],
});
const drafted = (degrees) => ({ beam: { draft: { enabled: true, line: line(degrees) } } });

/** Where a picture has a point, and how far a direction leans in it, both in halves of the picture; 0: along the line of sight. */
const at = ({ matrix: m }, [x, y, z]) => [0, 1].map((r) => m[r] * x + m[4 + r] * y + m[8 + r] * z + m[12 + r]);
function looksAlong(frame, { entry_mm: entry, target_mm: target }, isThroughMiddle = true) {
  const [a, b] = [at(frame, entry), at(frame, target)];
  const lean = Math.hypot(a[0] - b[0], a[1] - b[1]); // parallel: both are at one place
  return lean < 1e-4 && (!isThroughMiddle || Math.hypot(...b) < 1e-4); // the matrix has floats
}

test("followers of a beam's-eye view are sent one picture, and who comes later sees the same beam, eye and ring", {
  timeout: 120000,
}, async () => {
  const room = await newRoom();
  const [presenter, first] = [await enter(room), await enter(room)];
  open(presenter, 1, 'beam', { beam: { aperture_mm: 90, along_mm: -40 } });
  await presenter.frame(); // the shared view is the presenter's, not one that a follower opened first
  open(first, 1, 'beam');
  patch(presenter, 1, drafted(30));
  const revision = await revisionOf(presenter, 1);
  const isNew = (frame) => frame.revision === revision;
  const [own, followed] = [await still(presenter, 1, isNew), await still(first, 1, isNew)];
  assert.ok(own.isShared && followed.isShared && looksAlong(own, line(30)));
  assert.deepEqual([followed.sequence > 0, followed.matrix, followed.picture], [true, own.matrix, own.picture]);

  const late = await enter(room);
  assert.deepEqual(late.welcome.scene.beam.draft.line.entry_mm, line(30).entry_mm);
  open(late, 7, 'beam', { size_px: [200, 100] });
  const { document } = await late.message('view', ({ view }) => view === 7);
  assert.deepEqual([document.kind, document.beam.aperture_mm, document.beam.along_mm], ['beam', 90, -40]);
  const shown = await still(late, 7);
  assert.deepEqual([shown.revision, shown.width, shown.matrix, shown.picture], [revision, 96, own.matrix, own.picture]); // in the presenter's size

  // one drawing for three members
  const renders = async () => Number(/^beamroom_renders_total (\d+)/m.exec((await call(`${daemon.url}/metrics`)).text)[1]);
  const [before, counts] = [await renders(), clients.map(({ frames }) => frames.length)];
  presenter.send({ type: 'view.patch', view: 1, input: 2, patch: { beam: { along_mm: -20 } } });
  await Promise.all(
    [
      [presenter, 1, 0],
      [first, 1, 1],
      [late, 7, 2],
    ].map(([client, view, index]) => still(client, view, () => true, counts[index])),
  );
  const sent = clients.map(({ frames }, index) => frames.length - counts[index]);
  assert.ok((await renders()) - before <= Math.max(...sent), `${(await renders()) - before} drawings for ${sent} pictures`);
});

test('every picture along and across a draft is of the draft of its revision, while it is dragged', { timeout: 120000 }, async () => {
  const room = await newRoom();
  const [presenter, follower] = [await enter(room), await enter(room)];
  for (const client of [presenter, follower]) {
    open(client, 1, 'beam', client === presenter ? { beam: { aperture_mm: 80 } } : {});
    open(client, 2, 'beam-slice');
    open(client, 3, '3d');
  }
  await still(follower, 3);
  const drafts = new Map();
  const last = 40;
  for (let input = 1; input <= last; input++) {
    patch(presenter, input, input === 1 ? { beam: { slice: { visible: true, along_mm: 60 }, ...drafted(3).beam } } : drafted(3 * input));
    const revision = await revisionOf(presenter, input);
    drafts.set(revision, line(3 * input));
    if (input === last / 2) for (const view of [1, 2]) await follower.frame((frame) => frame.view === view && frame.revision === revision); // one on the way for certain
  }
  const newest = Math.max(...drafts.keys());
  assert.equal(drafts.size, last, 'each change is a revision of its own');
  for (const client of [presenter, follower])
    for (const view of [1, 2, 3]) await still(client, view, ({ revision }) => revision === newest);
  for (const client of [presenter, follower]) {
    const told = client.messages.filter(({ type, revision }) => type === 'scene' && drafts.has(revision));
    assert.ok(told.length && told.every(({ unchanged }) => !unchanged), 'the draft reaches all three views');
    for (const view of [1, 2]) {
      const frames = client.frames.filter((frame) => frame.view === view);
      for (const frame of frames) {
        const shown = drafts.get(frame.revision) ?? planned;
        assert.ok(looksAlong(frame, shown, view === 1), `view ${view}, revision ${frame.revision}`);
      }
      frames.reduce((before, { revision }) => {
        assert.ok(revision >= before, 'no older picture after a newer one');
        return revision;
      }, 0);
    }
  }
  // back: the planned beam again, which the draft has not changed
  patch(presenter, last + 1, { beam: { draft: { enabled: false } } });
  const back = await revisionOf(presenter, last + 1);
  assert.ok(looksAlong(await still(follower, 1, ({ revision }) => revision === back), planned));
  assert.deepEqual((await call(`${api}/plans/phantom`)).json.beams[0].entry_mm, planned.entry_mm);
});

test('who does not present cannot draft for the room, but in views of their own', { timeout: 120000 }, async () => {
  const room = await newRoom();
  const [presenter, member] = [await enter(room), await enter(room)];
  for (const client of [presenter, member]) open(client, 1, 'beam', { beam: { aperture_mm: 90 } });
  const { revision } = await still(presenter, 1);
  await still(member, 1);
  patch(member, 1, drafted(60));
  const { problem } = await member.message('problem', ({ to }) => to === 'scene.patch');
  assert.equal(problem.type, '/problems/not-presenter');
  member.send({
    type: 'follow',
    follow: false,
    input: 2,
    views: [{ view: 1, document: { kind: 'beam', size_px: [96, 72], beam: { aperture_mm: 90 }, override: drafted(60) } }],
  });
  const own = await still(member, 1, (frame) => !frame.isShared && looksAlong(frame, line(60)));
  assert.equal(own.revision, revision);
  const { json } = await call(`${api}/rooms/${room}/scene`);
  assert.equal(json.beam.draft.enabled, false);
  assert.ok(presenter.frames.every((frame) => looksAlong(frame, planned)));
});

test('in a plan without beams views along and across one show 3-D and the axial slice, until there is a draft', {
  timeout: 120000,
}, async () => {
  await openPlan(daemon.url, 'bare');
  const presenter = await enter(await newRoom('bare'));
  ['3d', 'beam', 'axial', 'beam-slice'].forEach((kind, index) => open(presenter, index + 1, kind));
  const [space, eye, axial, slice] = await Promise.all([1, 2, 3, 4].map((view) => still(presenter, view)));
  assert.deepEqual([eye.matrix, eye.picture], [space.matrix, space.picture]);
  assert.deepEqual([slice.matrix, slice.picture], [axial.matrix, axial.picture]);
  patch(presenter, 1, { beam: { draft: { enabled: true, line: planned } } });
  const revision = await revisionOf(presenter, 1);
  presenter.send({ type: 'view.patch', view: 2, input: 2, patch: { beam: { aperture_mm: 60 } } });
  assert.ok(looksAlong(await still(presenter, 2, (frame) => frame.revision === revision && frame.input >= 2), planned));
});
