// The numbers of a beam, and where a beam would run, over HTTP.
import assert from 'node:assert/strict';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { call, demo, openPlan, realData, startDaemon } from './daemon.mjs';

const treated = realData && join(realData, 'dicomrt-oncentra-phantom');
const skip = treated && existsSync(treated) ? false : 'no real plans on this machine';
let daemon, api, planned, folder;

/** The demo plan, with its beam shaped by leaves: a square of 40 mm and apart from it a strip that lies beside the head. */
function writeLeaves(plan) {
  cpSync(join(demo, 'phantom'), plan, { recursive: true });
  const facts = JSON.parse(readFileSync(join(plan, 'plan.json'), 'utf8'));
  const box = ([x0, x1], [y0, y1]) => [
    [x0, y0],
    [x1, y0],
    [x1, y1],
    [x0, y1],
  ];
  const [{ aperture_mm: _, ...beam }] = facts.beams;
  const outline = { kind: 'leaves', polygons_mm: [box([-20, 20], [-20, 20]), box([900, 950], [-20, 20])] };
  facts.beams = [{ ...beam, delivery: { collimator_x_lps: [1, 0, 0], collimator_y_lps: [0, 1, 0], outline } }];
  writeFileSync(join(plan, 'plan.json'), JSON.stringify({ ...facts, name: 'Leaves' }));
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-beam-'));
  writeLeaves(join(folder, 'leaves'));
  daemon = await startDaemon({ plans: skip ? [demo, folder] : [demo, treated, folder] });
  api = `${daemon.url}/api/v1`;
  await openPlan(daemon.url, 'phantom');
  planned = (await call(`${api}/plans/phantom`)).json.beams[0];
});
after(async () => {
  await daemon?.stop();
  if (folder) rmSync(folder, { recursive: true });
});

const makeRoom = async (scene) => {
  const room = (await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id;
  if (scene) assert.equal((await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' })).status, 200);
  return room;
};
const ask = async (path, query = {}, of = 'phantom') => {
  const answer = await call(`${api}/plans/${of}/${path}?${new URLSearchParams(query)}`);
  assert.equal(answer.status, 200, answer.text);
  return answer.json;
};
const near = (value, expected, within, what) => assert.ok(Math.abs(value - expected) <= within, `${what}: ${value}, expected ${expected}`);
const nearAll = (values, expected, within, what) => expected.forEach((mm, axis) => near(values[axis], mm, within, what));
const at = (beam, mm) => beam.entry_lps_mm.map((from, axis) => from + mm * beam.direction[axis]);
const draftOf = (entry_mm, target_mm, more = {}) => ({ beam: { draft: { enabled: true, line: { entry_mm, target_mm, ...more } } } });

test('the bands of a beam are the innermost regions at its points, and its lengths add up', async () => {
  const room = await makeRoom(draftOf([150, -90, 120], [5, 8, -3]));
  const beam = await ask('beam', { room });
  assert.ok(beam.bands.length >= 3);
  for (const { region, from_mm: from, to_mm: to } of beam.bands) {
    const [x, y, z] = at(beam, (from + to) / 2);
    assert.equal((await ask('probe', { x, y, z })).regions[0], region);
  }
  nearAll(at(beam, beam.skin_along_mm), beam.skin_lps_mm, 1e-9, 'skin');
  assert.equal(beam.skin_along_mm, beam.bands[0].from_mm);
  near(beam.gap_mm + beam.depth_mm, beam.length_mm, 1e-9, 'gap and depth');
  for (const { region, length_mm: length, to_target_mm: toTarget } of beam.crossed) {
    const bands = beam.bands.filter((band) => band.region === region);
    near(
      length,
      bands.reduce((sum, { from_mm, to_mm }) => sum + to_mm - from_mm, 0),
      1e-9,
      region,
    );
    near(
      toTarget,
      bands.reduce((sum, { from_mm, to_mm }) => sum + Math.max(0, Math.min(to_mm, beam.length_mm) - from_mm), 0),
      1e-9,
      region,
    );
  }
  const rad = Math.PI / 180,
    {
      target_cm: [pa, rl, is],
      z_cm: z,
      phi_deg: phi,
      theta_deg: theta,
    } = beam.sera;
  nearAll([10 * rl, -10 * pa, 10 * is], [5, 8, -3], 1e-9, 'target');
  const source = [
    pa + z * Math.sin(phi * rad) * Math.sin(theta * rad),
    rl - z * Math.sin(phi * rad) * Math.cos(theta * rad),
    is + z * Math.cos(phi * rad),
  ];
  nearAll(source, [9, 15, 12], 1e-9, "source in SERA's axes, cm");
  const card = beam.card
    .split('\n')
    .filter((line) => line && !line.startsWith('#'))
    .map((line) => line.trim().split(/\s+/).map(Number));
  nearAll(card.flat(), [pa, rl, is, z, phi, theta], 2e-5, 'card');
});

test('the regions in an opening of leaves are those between the cylinders in and around it; a ring that is asked for counts instead', async () => {
  await openPlan(daemon.url, 'leaves');
  const of = async (query) => (await ask('beam', query, 'leaves')).aperture;
  const square = await of({});
  assert.deepEqual([square.diameter_mm, square.opening, square.is_ring], [null, 'leaves', false]);
  const [inner, outer] = [await of({ aperture_mm: 40 }), await of({ aperture_mm: 40 * Math.SQRT2 })];
  assert.deepEqual([inner.diameter_mm, inner.opening, inner.is_ring], [40, null, true]);
  const share = (list, id) => list.regions.find(({ region }) => region === id)?.share ?? 0;
  assert.ok(square.regions.length >= 4);
  for (const { region, share: own, inside_cm3: inside, region_cm3: whole } of square.regions) {
    assert.ok(share(inner, region) <= own && own <= share(outer, region), region);
    near(inside, own * whole, 1e-9, region);
  }
  // of what is wide in all directions the part is that of the areas: 40 x 40 to pi 20 x 20
  const cm3 = (list) => list.regions.find(({ region }) => region === 'brain').inside_cm3;
  near(cm3(square) / cm3(inner), 4 / Math.PI, 0.05, 'brain');
  const room = (await call(`${api}/rooms`, 'POST', { plan: 'leaves' })).json.id;
  const scene = draftOf([0, -100, 40], [0, 0, 10]);
  assert.equal((await call(`${api}/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' })).status, 200);
  const drafted = await ask('beam', { room }, 'leaves');
  assert.equal(drafted.aperture, null, "a draft's collimator is not placed");
  assert.deepEqual(drafted.planned.aperture, square);
});

test('an aperture around the whole plan holds all of every region, a narrow one a part', async () => {
  const {
    json: { regions },
  } = await call(`${api}/plans/phantom`);
  const wide = (await ask('beam', { aperture_mm: 2000 })).aperture,
    narrow = (await ask('beam', { aperture_mm: 40 })).aperture;
  assert.equal(wide.regions.length, regions.filter(({ voxels }) => voxels > 0).length);
  for (const { region, inside_cm3: inside, region_cm3: whole, share } of wide.regions) {
    near(share, 1, 0, region);
    near(inside, whole, 1e-9, region);
    near(whole, regions.find(({ id }) => id === region).volume_cm3, 1e-9, region);
  }
  for (const { region, inside_cm3: inside, region_cm3: whole, share } of narrow.regions) {
    assert.ok(share > 0 && share < 1, region);
    near(inside, share * whole, 1e-9, region);
  }
  assert.ok(narrow.regions.every(({ first_mm: first }, i, all) => i === 0 || first >= all[i - 1].first_mm));
});

test('a draft is told beside the planned beam, which stays as it is', async () => {
  const room = await makeRoom();
  const before = await ask('beam', { room });
  assert.deepEqual([before.is_draft, before.source, before.planned, before.moved, before.iec], [false, 'plan-folder', null, null, null]);
  nearAll(before.entry_lps_mm, planned.entry_mm, 0, 'entry');
  /* the whole beam 30 mm to the left, then turned about its target */
  const shift = ([x, y, z]) => [x + 30, y, z];
  await call(`${api}/rooms/${room}/scene`, 'PATCH', draftOf(shift(planned.entry_mm), shift(planned.target_mm), { name: 'aside' }), {
    'If-Match': '*',
  });
  const aside = await ask('beam', { room });
  assert.deepEqual([aside.is_draft, aside.source, aside.name, aside.beam], [true, 'draft', 'aside', planned.id]);
  nearAll([aside.moved.entry_mm, aside.moved.target_mm, aside.moved.direction_deg], [30, 30, 0], 1e-6, 'moved');
  const { planned: kept, moved, ...rest } = before;
  assert.deepEqual(aside.planned, rest);
  const length = Math.hypot(...planned.entry_mm.map((mm, axis) => mm - planned.target_mm[axis]));
  await call(
    `${api}/rooms/${room}/scene`,
    'PATCH',
    draftOf([planned.target_mm[0] + length, planned.target_mm[1], planned.target_mm[2]], planned.target_mm),
    { 'If-Match': '*' },
  );
  near((await ask('beam', { room })).moved.direction_deg, 90, 1e-9, "a beam along the patient's axis, now from the left");
  assert.deepEqual(await ask('beam', { room, beam: planned.id }), before, 'by its id a beam is as planned');
});

test('a beam that is placed has the gap, the point and the angles asked for', async () => {
  const room = await makeRoom(draftOf([90, -150, 40], [10, 5, -20], { aperture_mm: 60 }));
  const place = async (query) => {
    const { entry_mm, target_mm, why, ...rest } = await ask('beam/place', { room, ...query });
    assert.equal(why, null);
    assert.deepEqual(target_mm, [10, 5, -20]);
    const beam = await ask('beam', { room: await makeRoom(draftOf(entry_mm, target_mm)) });
    nearAll([beam.gap_mm, beam.depth_mm], [rest.gap_mm, rest.depth_mm], 1e-9, 'as told');
    return beam;
  };
  const draft = await ask('beam', { room });
  const gap = await place({ mode: 'gap', gap_mm: 55 });
  near(gap.gap_mm, 55, 1e-9, 'gap');
  nearAll(gap.direction, draft.direction, 1e-12, 'direction');
  const through = await place({ mode: 'through', point_lps_mm: '10,5,40' });
  nearAll(through.direction, [0, 0, -1], 1e-12, 'direction');
  near(through.gap_mm, draft.gap_mm, 1e-9, 'gap');
  const angles = await place({ mode: 'angles', phi_deg: 90, theta_deg: 0 });
  nearAll(angles.direction, [1, 0, 0], 1e-12, 'from the right');
  near(angles.length_mm, draft.length_mm, 1e-9, 'length');
  const shortest = await place({ mode: 'shortest', gap_mm: 10 });
  near(shortest.gap_mm, 10, 1e-9, 'gap');
  assert.ok([draft, gap, through, angles].every(({ depth_mm: depth }) => depth >= shortest.depth_mm - 1e-6));
  assert.deepEqual(await ask('beam', { room }), draft, 'nothing was altered');
});

test("a ring that is asked about is no aperture: the plan's and a draft's own stay what they are", async () => {
  const said = ({ aperture_mm, aperture }) => [aperture_mm, aperture?.diameter_mm, aperture?.is_ring];
  assert.deepEqual(said(await ask('beam', { aperture_mm: 40 })), [planned.aperture_mm, 40, true]);
  assert.deepEqual(said(await ask('beam', { aperture_mm: planned.aperture_mm })), [planned.aperture_mm, planned.aperture_mm, false]);
  assert.deepEqual(said(await ask('beam')), [planned.aperture_mm, planned.aperture_mm, false]);
  const room = await makeRoom(draftOf([90, -150, 40], [10, 5, -20], { aperture_mm: 60 }));
  const draft = await ask('beam', { room, aperture_mm: 75 });
  assert.deepEqual(
    [said(draft), said(draft.planned)],
    [
      [60, 75, true],
      [planned.aperture_mm, 75, true],
    ],
  );
  assert.deepEqual(said(await ask('beam', { room })), [60, 60, false]);
});

test('what cannot be asked or placed is refused or said', async () => {
  const room = await makeRoom(draftOf([300, 300, 0], [300, -300, 0]));
  const refused = async (path) => {
    const { status, json } = await call(`${api}/plans/phantom/${path}`);
    return `${status} ${json.pointer} ${json.code ?? ''}`.trim();
  };
  assert.equal(await refused('beam?beam=nowhere'), '404 /beam');
  assert.equal(await refused('beam?aperture_mm=0'), '422 /aperture_mm range');
  assert.equal(await refused('beam/place'), '422 /mode required');
  assert.equal(await refused('beam/place?mode=sideways'), '422 /mode enum');
  assert.equal(await refused('beam/place?mode=gap'), '422 /gap_mm required');
  assert.equal(await refused('beam/place?mode=gap&gap_mm=-1'), '422 /gap_mm range');
  assert.equal(await refused('beam/place?mode=through'), '422 /point_lps_mm required');
  assert.equal(await refused('beam/place?mode=angles&phi_deg=3'), '422 /theta_deg required');
  const beside = await ask('beam', { room });
  assert.equal(beside.skin_reason, "The beam's axis meets no region.");
  assert.deepEqual(
    [beside.skin_lps_mm, beside.skin_along_mm, beside.gap_mm, beside.depth_mm, beside.bands, beside.crossed],
    [null, null, null, null, [], []],
  );
  for (const query of [{ mode: 'gap', gap_mm: 5 }, { mode: 'shortest' }]) {
    const { entry_mm, target_mm, why } = await ask('beam/place', { room, ...query });
    assert.deepEqual([entry_mm, target_mm], [null, null]);
    assert.match(why, /^The .*\.$/);
  }
});

test('a treatment beam has its outline and gantry; its draft has the gantry of its own direction', { skip }, async () => {
  await openPlan(daemon.url, 'dicomrt-oncentra-phantom');
  const of = 'dicomrt-oncentra-phantom',
    {
      json: {
        beams: [first],
      },
    } = await call(`${api}/plans/${of}`);
  const beam = await ask('beam', {}, of);
  assert.deepEqual(
    [beam.source, beam.radiation, beam.iec],
    ['treatment-plan', 'PHOTON', { gantry_deg: 0, couch_deg: 0, patient_position: 'HFS' }],
  );
  const [x, y] = [first.delivery.jaws_x_mm, first.delivery.jaws_y_mm],
    [polygon] = beam.outline.polygons_mm;
  assert.equal(beam.outline.kind, 'jaws');
  assert.deepEqual(
    polygon.map(String).sort(),
    [
      [x[0], y[0]],
      [x[1], y[0]],
      [x[1], y[1]],
      [x[0], y[1]],
    ]
      .map(String)
      .sort(),
  );
  assert.deepEqual(
    [beam.outline.x_lps, beam.outline.y_lps],
    [
      [1, 0, 0],
      [0, 0, 1],
    ],
  );
  const room = (await call(`${api}/rooms`, 'POST', { plan: of })).json.id,
    [tx, ty, tz] = beam.target_lps_mm;
  const turned = draftOf([tx + 1000 * Math.sin(0.5), ty - 1000 * Math.cos(0.5), tz], [tx, ty, tz]); /* from the front towards the left */
  assert.equal((await call(`${api}/rooms/${room}/scene`, 'PATCH', turned, { 'If-Match': '*' })).status, 200);
  const draft = await ask('beam', { room }, of);
  near(draft.iec.gantry_deg, (0.5 * 180) / Math.PI, 1e-9, 'gantry');
  near(draft.iec.couch_deg, 0, 1e-9, 'couch');
  assert.equal(draft.outline, null);
});
