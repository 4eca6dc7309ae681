// Annotated pictures that come back: PNG files, also hostile ones, and what they say.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { load } from '../../page.mjs';

const { crc32, isPng, textOfPng } = await load('net/png.js');
const { difference, readRecord, recordOfFile, restore } = await load('features/report/snapshot_record.js');
const { readDocument } = await load('wire/check.js');
const { mergePatch } = await load('wire/merge.js');

const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
const number = (n) => Buffer.from([n >>> 24, (n >>> 16) & 255, (n >>> 8) & 255, n & 255]);
const chunk = (type, data = Buffer.alloc(0), crc = crc32(Buffer.concat([Buffer.from(type), data]))) =>
  Buffer.concat([number(data.length), Buffer.from(type), data, number(crc)]);
const itxt = (
  text,
  { keyword = 'beamroom', flag = 1, method = 0, data = flag ? deflateSync(text) : Buffer.from(text), middle = '\0\0' } = {},
) => Buffer.concat([Buffer.from(`${keyword}\0`), Buffer.from([flag, method]), Buffer.from(middle), data]);
const header = chunk('IHDR', Buffer.from([0, 0, 0, 1, 0, 0, 0, 1, 8, 6, 0, 0, 0]));
const png = (...chunks) => Buffer.concat([signature, header, ...chunks]);
const end = chunk('IEND');
const read = (bytes) => textOfPng(new Uint8Array(bytes), 'beamroom');

test('checksums are those of the specification', () => {
  assert.equal(crc32(Buffer.from('123456789')), 0xcbf43926); // the check value of CRC-32/ISO-HDLC
  assert.equal(crc32(Buffer.from('IEND')), 0xae426082); // of every PNG's last chunk
});

test('the text of a picture is found among other chunks, compressed or not', async () => {
  const other = chunk('iTXt', itxt('wrong', { keyword: 'beamroom2' }));
  const longer = chunk('iTXt', itxt('wrong', { keyword: 'Author' }));
  assert.equal(await read(png(other, longer, chunk('iTXt', itxt('{"ä": "→"}')), chunk('IDAT'), end)), '{"ä": "→"}');
  assert.equal(await read(png(chunk('iTXt', itxt('plain', { flag: 0, middle: 'en\0Wort\0' })), end)), 'plain');
  assert.equal(await read(png(chunk('IDAT', Buffer.alloc(100)), end)), null);
  assert.equal(await read(png(end, chunk('iTXt', itxt('behind the end')))), null);
  assert.equal(await read(Buffer.from('GIF89a')), null);
  assert.equal(await read(Buffer.alloc(0)), null);
  assert.ok(!isPng(signature.subarray(0, 7)));
});

test('damaged and hostile pictures are refused with a sentence', async () => {
  const good = png(chunk('iTXt', itxt('{}')), end);
  const refused = (bytes, words) => assert.rejects(read(bytes), (error) => words.test(error.message), String(words));
  await refused(good.subarray(0, 40), /cut off/);
  await refused(png(), /cut off/);
  await refused(Buffer.concat([signature, number(0xffffffff), Buffer.from('iTXt'), Buffer.alloc(20)]), /cut off/);
  await refused(png(chunk('iTXt', itxt('{}'), 1), end), /damaged/); // wrong checksum
  await refused(png(chunk('iTXt', itxt('', { data: Buffer.from('no zlib stream') })), end), /damaged/);
  await refused(png(chunk('iTXt', itxt('', { data: deflateSync('{}'.repeat(500)).subarray(0, 8) })), end), /damaged/);
  await refused(png(chunk('iTXt', itxt('{}', { flag: 7 })), end), /damaged/);
  await refused(png(chunk('iTXt', itxt('{}', { method: 3 })), end), /damaged/);
  await refused(png(chunk('iTXt', Buffer.from('beamroom\0')), end), /damaged/);
  await refused(png(chunk('iTXt', itxt('', { data: deflateSync(Buffer.from([0xff, 0xfe, 0x80])) })), end), /damaged/); // no UTF-8
  await refused(png(chunk('iTXt', itxt('', { data: deflateSync(Buffer.alloc(200 << 20), { level: 1 }) })), end), /too long/); // 200 MB from 1 MB
  for (let at = 0; at < good.length; at++) await read(good.subarray(0, at)).catch((error) => assert.match(error.message, /picture/));
});

// ---- the record -------------------------------------------------------------------------------------------------------

const scene = readDocument('scene', { regions: { brain: { opacity: 0.5 }, skull: {} }, image: { window: { center: 40, width: 80 } } });
const view = readDocument('view', { kind: 'axial', camera: { height_mm: 120, target_mm: [1, 2, 3] } });
const record = {
  version: 1,
  program: 'Beamroom 9',
  plan: { id: 'head-1', name: 'Head' },
  date: '2026-07-01T09:30:00Z',
  revision: 12,
  scene,
  view,
};
const file = (json) => new Blob([png(chunk('iTXt', itxt(typeof json === 'string' ? json : JSON.stringify(json))), end)]);

test('a record is read with its defaults, and what is wrong with one is said', async () => {
  const got = await recordOfFile(file(record));
  assert.deepEqual([got.plan, got.revision, got.date], [{ id: 'head-1', name: 'Head' }, 12, '2026-07-01T09:30:00.000Z']);
  assert.deepEqual([got.scene, got.view], [scene, view]);
  assert.equal(await recordOfFile(new Blob(['PK archive'])), null);
  const refused = (json, words) => assert.rejects(recordOfFile(file(json)), (error) => words.test(error.message), String(words));
  await refused('{', /damaged/);
  await refused('null', /which plan/);
  await refused({ ...record, plan: { id: '../etc' } }, /which plan/);
  await refused({ ...record, version: 2 }, /another version/);
  await refused({ ...record, scene: { ...scene, script: 1 } }, /not valid: \/script/);
  await refused({ ...record, scene: { ...scene, regions: JSON.parse('{"__proto__": {"visible": true}}') } }, /not valid/);
  await refused({ ...record, view: { ...view, kind: 'beneath' } }, /not valid: \/kind/);
  await assert.rejects(recordOfFile(new Blob([png(end)])), /does not say what it shows/);
  assert.equal(readRecord(JSON.stringify({ ...record, plan: { id: 'head-1', name: 'x'.repeat(5000) } })).plan.name.length, 200);
  assert.equal(readRecord(JSON.stringify({ ...record, date: 'yesterday', revision: -1 })).date, '');
});

test('the difference of two scenes is the patch from one to the other', () => {
  const now = mergePatch(scene, {
    regions: { brain: { opacity: 1, color: '#010203' }, other: { visible: true } },
    image: { window: { width: 400 } },
    surface: { normals: 'face' },
  });
  const patch = difference(now, scene);
  assert.deepEqual(patch, {
    regions: { brain: { opacity: 0.5, color: '#c8c8c8' } },
    image: { window: { width: 80 } },
    surface: { normals: 'vertex' },
  });
  assert.deepEqual(difference(mergePatch(now, patch), scene), {});
  assert.deepEqual(difference(scene, scene), {});
});

test('a picture is shown again by one change of the scene and one of the view of its kind, as one step to undo', () => {
  const calls = [];
  const ui = {
    active: { value: 1 },
    maximised: { value: 3 },
    visible: { value: [3] },
    showInPlaceOf: (from, to) => calls.push(['instead', from, to]),
  };
  const room = {
    member: { value: 'm1' },
    scene: { value: mergePatch(scene, { regions: { brain: { opacity: 1 } } }) },
    views: ['3d', 'axial', 'sagittal', 'coronal', 'oblique', '3d'].map((kind, at) => ({ number: at + 1, kind, ofKind: at === 5 ? 2 : 1 })),
    patchScene: (patch) => calls.push(['scene', patch]),
    patchView: (n, patch) => calls.push([n, patch]),
  };
  const undo = { press: () => calls.push('press'), release: () => calls.push('release') };
  restore({ room, ui, undo }, { ...record, scene, view });
  assert.deepEqual(calls, ['press', ['scene', { regions: { brain: { opacity: 0.5 } } }], [2, { camera: view.camera }], 'release']);
  assert.deepEqual([ui.active.value, ui.maximised.value], [2, 2]);
  ui.maximised.value = 0;
  ui.visible.value = [1, 2, 3, 4];
  calls.length = 0;
  restore({ room, ui, undo }, { ...record, scene: room.scene.value, view: { ...view, kind: 'oblique', plane: 'a', number: 1 } });
  assert.deepEqual(calls, ['press', [5, { camera: view.camera, plane: 'a' }], 'release', ['instead', 2, 5]]);
  restore({ room, ui, undo }, { ...record, scene: room.scene.value, view: { ...view, kind: '3d', number: 2 } });
  assert.equal(ui.active.value, 6);
});

// ---- the report to print ------------------------------------------------------------------------------------------------

const { Printout } = await load('features/report/report_pages.js');

class Memory {
  items = new Map();
  most = Infinity;
  getItem(key) {
    return this.items.get(key) ?? null;
  }
  removeItem(key) {
    this.items.delete(key);
  }
  setItem(key, value) {
    if (value.length > this.most) throw new Error('QuotaExceededError');
    this.items.set(key, value);
  }
}
globalThis.FileReader ??= class {
  // as much of a browser's as is needed
  readAsDataURL(blob) {
    blob.arrayBuffer().then((bytes) => {
      this.result = `data:image/png;base64,${Buffer.from(bytes).toString('base64')}`;
      this.onload();
    });
  }
};
const room = { id: 'r1', planId: { value: 'head-1' } };
const plan = {
  regions: [
    { id: 'brain', voxels: 5 },
    { id: 'skull', voxels: 7 },
    { id: 'empty', voxels: 0 },
  ],
};
const probed = [];
const asked = [];
const api = {
  snapshot: async () => file(record),
  probe: async (_, point) => {
    probed.push(point);
    return { regions: [] };
  },
  surface: async (_, region, query) => {
    asked.push([region, query]);
    if (region === 'skull') throw new Error('too many triangles');
    return { triangles: 8 };
  },
};

test('snapshots of a report are put in order, described, kept for a reload, and measured', async () => {
  const storage = new Memory();
  const printout = new Printout('r1', api, storage);
  for (let i = 0; i < 3; i++) await printout.add(room, view);
  assert.deepEqual(probed[0], [0, 0, 0]);
  const [a, b, c] = printout.entries.value.map(({ key }) => key);
  printout.describe(b, 'second');
  printout.keep();
  printout.move(b, -1);
  printout.move(b, -1); // it is the first already
  printout.remove(c);
  assert.deepEqual(
    printout.entries.value.map(({ key, caption }) => [key, caption]),
    [
      [b, 'second'],
      [a, ''],
    ],
  );
  const again = new Printout('r1', api, storage);
  assert.deepEqual(again.entries.value, printout.entries.value);
  assert.equal(new Printout('r2', api, storage).entries.value.length, 0);

  const measuring = again.measure('head-1', plan);
  assert.equal(again.isComplete.value, false);
  await measuring;
  assert.equal(again.isComplete.value, true);
  assert.deepEqual(asked, [
    ['brain', { representation: 'surface', algorithm: 'smooth' }],
    ['skull', { representation: 'surface', algorithm: 'smooth' }],
  ]);
  assert.deepEqual(
    again.figures.value.map(({ region, result, error }) => [region.id, result, error]),
    [
      ['brain', { triangles: 8 }, ''],
      ['skull', null, 'too many triangles'],
    ],
  );
});

test('pictures that are too large to be kept are there all the same, and that is said', async () => {
  const storage = new Memory();
  storage.most = 1000;
  const printout = new Printout('r1', api, storage);
  await printout.add(room, view);
  assert.deepEqual([printout.entries.value.length, printout.isKept.value, storage.items.size], [1, false, 0]);
});
