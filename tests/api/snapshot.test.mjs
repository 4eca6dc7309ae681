// Annotated snapshots: what their metadata holds makes the same picture again.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { call, openPlan, renderersOf, startDaemon, until } from './daemon.mjs';
import { readPng } from './png.mjs';
import { parseStrict } from './strict_json.mjs';
import { webm } from './webm.mjs';

let daemon, api, plan, room;

before(async () => {
  daemon = await startDaemon();
  api = `${daemon.url}/api/v1`;
  plan = `${api}/plans/phantom`;
  await until(
    async () => (await call(`${api}/plans`)).json.plans,
    (plans) => plans.length === 1 && plans[0].parts.length,
  );
  await openPlan(daemon.url, 'phantom');
  room = `${api}/rooms/${(await call(`${api}/rooms`, 'POST', { plan: 'phantom' })).json.id}`;
});
after(() => daemon?.stop());

/** The chunks of a PNG, with their data. PNG specification, 3rd edition, section 5. */
function* chunks(bytes) {
  for (let at = 8; at < bytes.length; ) {
    const length = bytes.readUInt32BE(at);
    yield { type: bytes.toString('latin1', at + 4, at + 8), data: bytes.subarray(at + 8, at + 8 + length) };
    at += 12 + length;
  }
}

/** The record in the iTXt chunk of the keyword beamroom (section 11.3.3.4); null: there is none. */
function record(bytes) {
  const texts = [...chunks(bytes)].filter(({ type, data }) => type === 'iTXt' && data.toString('latin1').startsWith('beamroom\0'));
  if (!texts.length) return null;
  assert.equal(texts.length, 1);
  const { data } = texts[0];
  assert.deepEqual([...data.subarray(9, 11)], [1, 0], 'compressed, by deflate');
  assert.deepEqual([...data.subarray(11, 13)], [0, 0], 'no language, no translated keyword');
  return parseStrict(inflateSync(data.subarray(13)).toString('utf8'));
}

async function picture(body) {
  const answer = await fetch(`${plan}/render`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify(body),
  });
  assert.equal(answer.status, 200, answer.status === 200 ? '' : await answer.text());
  return Buffer.from(await answer.arrayBuffer());
}

const query = (view, more) => `${room}/snapshot?view=${encodeURIComponent(JSON.stringify(view))}${more}`;
const snapshot = async (view, more) => Buffer.from(await (await fetch(query(view, more))).arrayBuffer());

/** The number of pixels that differ in the first rows of two pictures of equal width. */
function nDifferent(a, b, height) {
  let n = 0;
  for (let y = 0; y < height; y++) for (let x = 0; x < b.width; x++) n += String(a.at(x, y)) !== String(b.at(x, y));
  return n;
}

const views = [
  { kind: 'axial', size_px: [400, 300] },
  {
    kind: '3d',
    size_px: [400, 300],
    camera: { position_mm: [300, -400.25, 100.1], target_mm: [0, 0, 0.3], up: [0, 0, 1], projection: 'parallel', height_mm: 251.5 },
  },
  {
    kind: 'sagittal',
    size_px: [200, 300],
    camera: { target_mm: [0, 12.5, 3], height_mm: 99 },
    override: { image: { slices: { sagittal: { position_mm: 7.25 } } } },
  },
];

test('scene and view in a snapshot make the same picture again, to the last bit', async () => {
  const changed = {
    regions: { scalp: { visible: false }, brain: { color: '#123456', opacity: 0.3 } },
    image: { window: { center: 33.3, width: 77 } },
  };
  assert.equal((await call(`${room}/scene`, 'PATCH', changed, { 'If-Match': '*' })).status, 200);
  const { json: scene, headers } = await call(`${room}/scene`);
  for (const view of views) {
    const plain = await snapshot(view, '');
    const annotated = await snapshot(view, '&annotations=true');
    assert.equal(record(plain), null);
    const kept = record(annotated);
    assert.equal(kept.version, 1);
    assert.deepEqual(kept.plan, { id: 'phantom', name: (await call(plan)).json.name });
    assert.equal(String(kept.revision), JSON.parse(headers.get('etag')));
    assert.ok(Math.abs(Date.parse(kept.date) - Date.now()) < 60000, kept.date);
    if (!view.override) assert.deepEqual(kept.scene, scene);
    assert.ok(!('override' in kept.view));
    assert.ok((await picture({ scene: kept.scene, view: kept.view })).equals(plain), JSON.stringify(view));
    assert.deepEqual(record(await picture({ scene: kept.scene, view: kept.view, annotations: true })).scene, kept.scene);
  }
});

test('an annotated picture is the plain one with letters and scale on it, and a caption on white below', async () => {
  for (const view of views) {
    const plain = readPng(await snapshot(view, ''));
    const annotated = readPng(await snapshot(view, '&annotations=true'));
    const [width, height] = view.size_px;
    assert.deepEqual([plain.width, plain.height], [width, height]);
    assert.equal(annotated.width, Math.max(width, 320));
    assert.ok(annotated.height > height + 60 && annotated.height < height + 300, String(annotated.height));
    const n = nDifferent(annotated, plain, height);
    assert.ok(n > 200 && n < 0.04 * width * height, `${n} pixels of letters and scale`);
    assert.deepEqual(annotated.at(annotated.width - 1, annotated.height - 1), [255, 255, 255]);
  }
});

test('the crosshair is drawn on a slice where it was asked for, in no other picture, and with a caption alone', async () => {
  const slice = { kind: 'coronal', size_px: [400, 300] };
  const [bare, crossed] = [await snapshot(slice, '&annotations=true'), await snapshot(slice, '&annotations=true&crosshair=true')].map(
    readPng,
  );
  let [rows, columns] = [0, 0]; // over most of the picture, with the dark rim of the lines
  const isDrawn = (x, y) => String(bare.at(x, y)) !== String(crossed.at(x, y));
  for (let y = 0; y < 300; y++) rows += Array.from({ length: 400 }, (_, x) => isDrawn(x, y)).filter(Boolean).length > 300;
  for (let x = 0; x < 400; x++) columns += Array.from({ length: 300 }, (_, y) => isDrawn(x, y)).filter(Boolean).length > 220;
  assert.ok(rows >= 2 && rows <= 5 && columns >= 2 && columns <= 5, `${rows} rows, ${columns} columns`);
  const space = { size_px: [400, 300] };
  assert.equal(
    nDifferent(
      ...[await snapshot(space, '&annotations=true'), await snapshot(space, '&annotations=true&crosshair=true')].map(readPng),
      300,
    ),
    0,
  );
  for (const [more, code] of [
    ['&crosshair=true', 'annotations'],
    ['&annotations=true&crosshair=yes', 'type'],
  ])
    assert.deepEqual(await call(query(slice, more)).then(({ status, json }) => [status, json.pointer, json.code]), [
      422,
      '/crosshair',
      code,
    ]);
});

test('perspective has no scale bar', async () => {
  const view = { size_px: [400, 300] };
  const parallel = { ...view, camera: { projection: 'parallel' } };
  const changes = async (given) => {
    const plain = readPng(await picture({ view: given }));
    const annotated = readPng(await picture({ view: given, annotations: true }));
    let n = 0;
    for (let y = 270; y < 300; y++) for (let x = 0; x < 150; x++) n += String(annotated.at(x, y)) !== String(plain.at(x, y));
    return n;
  };
  assert.equal(await changes(view), 0);
  assert.ok((await changes(parallel)) > 100);
});

test('a JPEG has the caption and no record, and wrong words are refused', async () => {
  const answer = await fetch(query(views[0], '&annotations=true&format=jpeg'));
  const bytes = Buffer.from(await answer.arrayBuffer());
  assert.equal(bytes.readUInt16BE(0), 0xffd8);
  const start = bytes.indexOf(Buffer.from([0xff, 0xc0]));
  assert.ok(bytes.readUInt16BE(start + 5) > 360, 'higher than the picture');
  assert.ok(!bytes.includes('beamroom') && !bytes.includes('phantom'));
  assert.equal((await call(query(views[0], '&annotations=yes'))).json.pointer, '/annotations');
  const wrong = await call(`${plan}/render`, 'POST', { annotations: 'true' });
  assert.deepEqual([wrong.status, wrong.json.pointer], [422, '/annotations']);
  assert.equal(readPng(await snapshot(views[0], '&annotations=false')).height, 300);
});

// ---- films ------------------------------------------------------------------------------------------------------------

const order = { seconds: 1, fps: 4, view: { size_px: [480, 360] } };
const job = async (id) => (await call(`${api}/jobs/${id}`)).json;
const goesOn = ({ state }) => ['queued', 'running'].includes(state);
const ended = (id) =>
  until(
    () => job(id),
    (one) => !goesOn(one),
  );
const started = async (body, of = plan) => {
  const answer = await call(`${of}/video`, 'POST', body);
  assert.equal(answer.status, 202, answer.text);
  assert.equal(answer.json.kind, 'film');
  return answer.json.id;
};
async function filmOf(id) {
  const answer = await fetch(`${api}/jobs/${id}/video`);
  assert.deepEqual([answer.status, answer.headers.get('content-type')], [200, 'video/webm']);
  assert.match(answer.headers.get('content-disposition'), /^attachment; filename="phantom-turn-\d{8}T\d{6}Z.webm"$/);
  return webm(Buffer.from(await answer.arrayBuffer()));
}

test('a film of a plan or of a room is WebM of the ordered length, with the caption below each picture', async () => {
  const caption = readPng(await picture({ view: { size_px: [480, 360] }, annotations: true })).height;
  for (const of of [plan, room]) {
    const id = await started(order, of);
    const done = await ended(id);
    assert.deepEqual([done.state, done.percent, done.plan, done.problem], ['done', 100, 'phantom', null]);
    const { width, height, ...rest } = await filmOf(id);
    assert.deepEqual(rest, { nFrames: 4, ms: 1000, codec: 'V_VP9' });
    assert.equal(width, 480);
    assert.ok(of === room || (height >= caption && height <= caption + 80), `${height}, a picture with caption has ${caption}`);
  }
});

test('an order for a film outside its limits is refused, and says which field', async () => {
  const wrong = [
    [{ seconds: undefined }, '/seconds'],
    [{ seconds: 0.5 }, '/seconds'],
    [{ seconds: 61 }, '/seconds'],
    [{ seconds: '2' }, '/seconds'],
    [{ fps: 31 }, '/fps'],
    [{ fps: 2.5 }, '/fps'],
    [{ quality: 0 }, '/quality'],
    [{ degrees: 0 }, '/degrees'],
    [{ degrees: 361 }, '/degrees'],
    [{ identity: 'yes' }, '/identity'],
    [{ size: 3 }, '/size'],
    [{ view: { kind: 'axial' } }, '/view/kind'],
    [{ view: { size_px: [1922, 400] } }, '/view/size_px'],
    [{ view: { size_px: [1920, 1200] } }, '/view/size_px'],
    [{ view: { size_px: [200, 400] } }, '/view/size_px'],
  ];
  for (const [change, pointer] of wrong)
    for (const of of [plan, room]) {
      const answer = await call(`${of}/video`, 'POST', { ...order, ...change });
      assert.deepEqual([answer.status, answer.json.pointer], [422, pointer], JSON.stringify(change));
    }
  assert.equal((await call(`${room}/video`, 'POST', { ...order, scene: {} })).json.pointer, '/scene', 'of a room it is the room’s');
  assert.equal((await call(`${api}/jobs/open-1/video`)).status, 404);
  assert.equal((await call(`${api}/plans/none/video`, 'POST', order)).status, 404);
});

test('a film begins anew when its renderer is killed, and is whole', async () => {
  const id = await started({ seconds: 1, fps: 12, view: { size_px: [240, 240] } });
  await until(
    () => job(id),
    ({ percent }) => percent > 20,
  );
  for (const pid of renderersOf(daemon.child.pid)) process.kill(pid, 'SIGKILL');
  assert.equal((await ended(id)).state, 'done');
  assert.equal((await filmOf(id)).nFrames, 12);
});

test('two films are made at once and eight wait; a cancelled one gives its place to the next', async () => {
  const long = { seconds: 60, fps: 30, view: { size_px: [240, 240] } };
  const ids = [];
  for (let i = 0; i < 10; i++) ids.push(await started(long));
  assert.deepEqual([(await call(`${plan}/video`, 'POST', long)).status, (await job(ids[2])).state], [429, 'queued']);
  const early = await call(`${api}/jobs/${ids[2]}/video`);
  assert.deepEqual([early.status, early.json.type], [409, '/problems/conflict']);
  assert.equal((await call(`${api}/jobs/${ids[0]}`, 'DELETE')).json.state, 'cancelled');
  assert.equal((await job(ids[2])).state, 'running');
  assert.equal((await call(`${api}/jobs/${ids[0]}/video`)).status, 409);
  for (const id of ids.slice(1).reverse()) assert.equal((await call(`${api}/jobs/${id}`, 'DELETE')).json.state, 'cancelled');
  assert.equal((await ended(await started(order))).state, 'done', 'the renderer has room for films again');
});
