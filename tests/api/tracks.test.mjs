// Particle tracks over HTTP: counts equal to the file's, lost particles in their regions, and the track under a pixel.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, startDaemon } from './daemon.mjs';

let daemon, api, folder;

// Lost particles by their first point, LPS mm, and where it lies in the modified Snyder head: ellipsoids around the
// patient's axis, brain with semi-axes 60, 90, 65 mm around (0, 0, 10), cranium 68, 98, 83 around the origin,
// scalp 73, 103, 88; in the brain the target, 20, 22, 18 around (22, 20, 32), and in it the tumour, 11, 12, 10 around
// (24, 24, 34).
const lost = [
  { at: [-40, 30, 10], region: 'brain' },
  { at: [0, 0, 79], region: 'cranium' },
  { at: [70.5, 0, 0], region: 'scalp' },
  { at: [0, 0, 300], region: null },
  { at: [0, -100.5, 0], region: 'scalp' },
  { at: [24, 24, 34], region: 'tumour' },
  { at: [8, 20, 32], region: 'target' },
];
const table = [
  'x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm,class,energy_mev',
  '0,-300,0,0,-200,0,neutron-high,2',
  '-50,-150,0,50,-150,0,gamma-low,0.478',
  '-50,0,0,50,0,0,neutron-low,2.53e-8',
  '0,0,150,0,0,10,beam-line,',
  ...lost.map(({ at: [x, y, z] }) => `${x},${y},${z},${x + 6},${y},${z + 8},lost,`),
].join('\n');

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-tracks-'));
  const plan = join(folder, 'lost');
  mkdirSync(plan);
  for (const name of ['labels.nii.gz', 'labels.json']) cpSync(join(demo, 'phantom', name), join(plan, name));
  writeFileSync(join(plan, 'a.csv'), table);
  writeFileSync(join(plan, 'b.pp'), '0 0 0 1 0 0 0 3\n0 0 0 0 1 0 1 0\n');
  writeFileSync(
    join(plan, 'plan.json'),
    JSON.stringify({
      format: 'beamroom-plan',
      version: 1,
      regions: [{ path: 'labels.nii.gz', names: 'labels.json' }],
      hierarchy: { scalp: ['cranium'], cranium: ['brain'], brain: ['target'], target: ['tumour'] },
      tracks: [{ path: 'a.csv' }, { path: 'b.pp', unit: 'mm' }],
    }),
  );
  daemon = await startDaemon({ plans: [demo, folder] });
  api = `${daemon.url}/api/v1`;
  await openPlan(daemon.url, 'phantom');
  await openPlan(daemon.url, 'lost');
});
after(async () => {
  await daemon?.stop();
  rmSync(folder, { recursive: true, force: true });
});

const ask = async (plan, question, { scene, view, ...query } = {}) => {
  const override = scene && { ...view, override: scene };
  const answer = await call(
    `${api}/plans/${plan}/${question}?${new URLSearchParams({ ...query, ...((override ?? view) && { view: JSON.stringify(override ?? view) }) })}`,
  );
  assert.equal(answer.status, 200, answer.text);
  return answer.json;
};

test('classes and counts are those of the file, and the shown ones those that the scene leaves', async () => {
  const counts = {};
  const words = { 0: 'neutron', 1: 'gamma', 2: 'beam-line', 3: 'lost' },
    energies = { 1: '-high', 2: '-medium', 3: '-low', 0: '' };
  for (const line of readFileSync(join(demo, 'phantom', 'tracks.pp'), 'utf8').split('\n')) {
    const fields = line.trim().split(/\s+/);
    if (fields.length !== 8 || line.startsWith('#')) continue;
    const word = `${words[fields[6]]}${fields[6] < 2 ? energies[fields[7]] : ''}`;
    counts[word] = (counts[word] ?? 0) + 1;
  }
  const all = Object.values(counts).reduce((a, b) => a + b);
  const tracks = await ask('phantom', 'tracks');
  assert.equal(tracks.segments, all);
  assert.equal(tracks.shown, all);
  for (const [word, n] of Object.entries(tracks.counts)) assert.equal(n, counts[word] ?? 0, word);
  assert.deepEqual(tracks.energies, { segments: 0, low_mev: null, high_mev: null });
  assert.deepEqual(tracks.files, [{ path: 'tracks.pp', first: 0, segments: all, unit: 'mm' }]);
  assert.equal(tracks.lost.length, counts.lost);
  const without = await ask('phantom', 'tracks', { scene: { tracks: { classes: { gamma_high: false, lost: false } } } });
  assert.equal(without.shown, all - counts['gamma-high'] - counts.lost);
  assert.equal((await ask('phantom', 'tracks', { scene: { tracks: { first: 10, count: 7 } } })).shown, 7);
  const few = await ask('phantom', 'tracks', { lost: 2 });
  assert.equal(few.lost.length, 2);
  assert.equal(few.lost_left_out, counts.lost - 2);
});

test('each lost particle is in the region where the test placed it', async () => {
  const tracks = await ask('lost', 'tracks');
  assert.deepEqual(
    tracks.lost.map(({ region }) => region),
    lost.map(({ region }) => region),
  );
  tracks.lost.forEach(({ segment, reason, from_lps_mm: from, to_lps_mm: to }, i) => {
    assert.equal(segment, 4 + i);
    assert.deepEqual(from, lost[i].at);
    assert.deepEqual(
      to,
      lost[i].at.map((mm, axis) => mm + [6, 0, 8][axis]),
    );
    assert.equal(reason, lost[i].region ? null : 'outside all regions');
  });
  assert.equal(tracks.lost_left_out, 0);
  assert.deepEqual(
    tracks.files.map(({ path, first, segments }) => [path, first, segments]),
    [
      ['a.csv', 0, 11],
      ['b.pp', 11, 2],
    ],
  );
  assert.equal(tracks.energies.segments, 3);
  assert.ok(Math.abs(tracks.energies.low_mev - 2.53e-8) < 1e-14 && tracks.energies.high_mev === 2);
});

test('limits of energy leave segments without an energy, and those within the limits', async () => {
  assert.equal((await ask('lost', 'tracks', { scene: { tracks: { energy_low_mev: 0.1 } } })).shown, 12);
  assert.equal((await ask('lost', 'tracks', { scene: { tracks: { energy_low_mev: 0.1, energy_high_mev: 1 } } })).shown, 11);
});

const view = { kind: '3d', size_px: [401, 401], camera: { position_mm: [0, -500, 0], target_mm: [0, 0, 0], up: [0, 0, 1], fov_deg: 30 } };
const focal = 401 / 2 / Math.tan(Math.PI / 12);
const pixel = ([x, y, z]) => ({ px: 200.5 + (focal * x) / (y + 500), py: 200.5 - (focal * z) / (y + 500) });

test('the track under a pixel is told with its class, energy, length, regions and place in its file', async () => {
  const shown = { tracks: { visible: true } };
  const track = await ask('lost', 'track', { scene: shown, view, ...pixel([30, -150, 0]) });
  assert.equal(track.segment, 1);
  assert.deepEqual([track.class, track.file, track.file_segment, track.length_mm], ['gamma-low', 'a.csv', 1, 100]);
  assert.ok(Math.abs(track.energy_mev - 0.478) < 1e-7);
  assert.deepEqual([track.from_lps_mm, track.to_lps_mm, track.from_region, track.to_region], [[-50, -150, 0], [50, -150, 0], null, null]);
  assert.ok(Math.hypot(track.point_lps_mm[0] - 30, track.point_lps_mm[2]) < 1e-3);
  // that in the brain lies behind the one before the head; with clip planes that cut off all before P -10 mm it is seen
  const cut = { tracks: { visible: true }, clip: { coronal_low: { enabled: true, position_mm: -10, cap: false } } };
  const inside = await ask('lost', 'track', { scene: cut, view, ...pixel([30, 0, 0]) });
  assert.deepEqual([inside.segment, inside.from_region, inside.to_region], [2, 'brain', 'brain']);
  const capped = { ...cut, clip: { coronal_low: { enabled: true, position_mm: -10, cap: true } } };
  assert.equal((await ask('lost', 'track', { scene: capped, view, ...pixel([30, 0, 0]) })).segment, null);
});

test('without tracks that are shown, in a slice pane or beside all lines there is no track', async () => {
  const at = pixel([30, -150, 0]);
  assert.equal((await ask('lost', 'track', { view, ...at })).segment, null);
  assert.equal(
    (await ask('lost', 'track', { scene: { tracks: { visible: true, classes: { gamma_low: false } } }, view, ...at })).class,
    'neutron-low',
  ); // the next one, through the translucent head
  assert.equal(
    (await ask('lost', 'track', { scene: { tracks: { visible: true } }, view: { ...view, kind: 'axial' }, ...at })).segment,
    null,
  );
  assert.equal((await ask('lost', 'track', { scene: { tracks: { visible: true } }, view, px: at.px, py: at.py + 10 })).segment, null);
  const refused = await call(`${api}/plans/lost/track?px=3`);
  assert.deepEqual([refused.status, refused.json.errors?.[0]?.pointer ?? refused.json.pointer], [422, '/py']);
});
