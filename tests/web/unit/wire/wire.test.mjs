// The page's checks of messages, documents and frame headers, over the same examples the C side is held to.
import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load, root } from '../page.mjs';

const { WireError, isId, readDocument, readMessage, readServerMessage } = await load('wire/check.js');
const { joinPatches, mergePatch } = await load('wire/merge.js');

const fixtures = (kind) => {
  const folder = `${root}proto/fixtures/${kind}`;
  return readdirSync(folder)
    .filter((name) => name.endsWith('.json'))
    .map((name) => [name, JSON.parse(readFileSync(`${folder}/${name}`, 'utf8'))]);
};

for (const [name, { from, message }] of fixtures('good'))
  test(`good message ${name} comes back as itself`, () => assert.deepEqual(readMessage(message, from), message));

for (const [name, { from, message, error }] of fixtures('bad'))
  test(`bad message ${name} is refused with its code and place`, () => {
    assert.throws(
      () => readMessage(message, from),
      (thrown) => {
        assert.ok(thrown instanceof WireError, String(thrown));
        assert.deepEqual([thrown.code, thrown.pointer], [error.code, error.pointer]);
        return true;
      },
    );
  });

test('a document gets every default of proto/scene.json', () => {
  const scene = readDocument('scene', { regions: { brain: { opacity: 0.5 } } });
  assert.deepEqual(scene.regions.brain, {
    visible: true,
    representation: 'surface',
    order: 0,
    color: '#c8c8c8',
    opacity: 0.5,
    texture: 'none',
    clipped: true,
  });
  assert.deepEqual(scene.image.window, { center: 40, width: 400, gamma: 1 });
  assert.equal(readDocument('view', {}).camera.fov_deg, 30);
  assert.equal(readDocument('view', {}).camera.position_mm, null);
});

for (const [what, kind, document, code, pointer] of [
  ['an opacity above 1', 'scene', { regions: { brain: { opacity: 1.1 } } }, 'range', '/regions/brain/opacity'],
  ['a region id with a slash', 'scene', { regions: { 'a/b': {} } }, 'pattern', '/regions/a~1b'],
  ['a colour by name', 'scene', { regions: { brain: { color: 'red' } } }, 'pattern', '/regions/brain/color'],
  ['a size of half pixels', 'view', { size_px: [100.5, 100] }, 'type', '/size_px/0'],
  ['a size beyond 4096', 'view', { size_px: [100, 4097] }, 'range', '/size_px/1'],
  ['a point of two numbers', 'view', { camera: { target_mm: [1, 2] } }, 'type', '/camera/target_mm'],
  ['an unknown kind', 'view', { kind: 'beneath' }, 'enum', '/kind'],
  ['an unknown field', 'view', { camera: { roll: 1 } }, 'unknown-field', '/camera/roll'],
])
  test(`a document with ${what} is refused`, () => {
    assert.throws(() => readDocument(kind, document), { code, pointer });
  });

test('fields of a newer server are dropped from its messages, and unknown messages give null', () => {
  assert.deepEqual(readServerMessage({ type: 'pong', time_ms: 5, later: 1 }), { type: 'pong', time_ms: 5 });
  assert.equal(readServerMessage({ type: 'thunder' }), null);
  assert.equal(readServerMessage({ type: '__proto__' }), null);
  assert.throws(() => readServerMessage({ type: 'pong' }), { code: 'required' });
});

test('ids are 1 to 63 of a-z, 0-9 and -', () => {
  for (const good of ['a', 'sera-head', '7q4k-m2', 'x'.repeat(63)]) assert.ok(isId(good), good);
  for (const bad of ['', 'A', '../x', 'a b', 'x'.repeat(64), 7, null]) assert.ok(!isId(bad), String(bad));
});

// The examples of RFC 7396, appendix A.
for (const [target, patch, expected] of [
  [{ a: 'b' }, { a: 'c' }, { a: 'c' }],
  [{ a: 'b' }, { b: 'c' }, { a: 'b', b: 'c' }],
  [{ a: 'b' }, { a: null }, {}],
  [{ a: 'b', b: 'c' }, { a: null }, { b: 'c' }],
  [{ a: ['b'] }, { a: 'c' }, { a: 'c' }],
  [{ a: 'c' }, { a: ['b'] }, { a: ['b'] }],
  [{ a: { b: 'c' } }, { a: { b: 'd', c: null } }, { a: { b: 'd' } }],
  [{ a: [{ b: 'c' }] }, { a: [1] }, { a: [1] }],
  [
    ['a', 'b'],
    ['c', 'd'],
    ['c', 'd'],
  ],
  [{ a: 'b' }, ['c'], ['c']],
  [{ a: 'foo' }, null, null],
  [{ a: 'foo' }, 'bar', 'bar'],
  [{ e: null }, { a: 1 }, { e: null, a: 1 }],
  [[1, 2], { a: 'b', c: null }, { a: 'b' }],
  [{}, { a: { bb: { ccc: null } } }, { a: { bb: {} } }],
])
  test(`merge patch ${JSON.stringify(patch)} on ${JSON.stringify(target)}`, () => assert.deepEqual(mergePatch(target, patch), expected));

test('two patches joined do what they do one after the other', () => {
  const target = { a: { b: 1, c: 2 }, d: 3 };
  for (const [first, second] of [
    [{ a: { b: 5 } }, { a: { c: null } }],
    [{ a: null }, { a: { b: 7 } }],
    [{ d: 4 }, { d: { x: 1 } }],
    [{ a: { b: null } }, { a: { b: 2 } }],
  ]) {
    const joined = mergePatch(target, joinPatches(first, second));
    const after = mergePatch(mergePatch(target, first), second);
    // a removal that is followed by an object keeps what the removal took away: the one case a single patch cannot say
    if (first.a === null) assert.equal(joined.a.b, 7);
    else assert.deepEqual(joined, after);
  }
});

test('a patch cannot reach the prototype of objects', () => {
  const patch = JSON.parse('{"__proto__": {"polluted": true}}');
  mergePatch({}, patch);
  joinPatches({}, patch);
  assert.equal({}.polluted, undefined);
});

// ---- frames: bytes written by hand after proto/frame.md --------------------------------------------------------------

const { readFrame } = await load('wire/frame.js');

function frameBytes(change = () => {}, { headerBytes = 112, pictureBytes = 5 } = {}) {
  const data = new DataView(new ArrayBuffer(headerBytes + pictureBytes));
  'BRMR'.split('').forEach((letter, at) => data.setUint8(at, letter.charCodeAt(0)));
  data.setUint16(4, 1, true);
  data.setUint16(6, headerBytes, true);
  data.setUint8(8, 1); // JPEG
  data.setUint8(9, 1 | 4 | 16); // still, full colour, coarse
  data.setUint8(10, 95);
  data.setUint8(11, 50);
  data.setUint32(12, 3, true);
  data.setUint32(16, 77, true);
  data.setUint32(20, 12, true);
  data.setUint32(24, 4000000001, true);
  data.setUint16(28, 640, true);
  data.setUint16(30, 480, true);
  data.setUint32(32, 12345, true);
  data.setUint32(36, 678, true);
  data.setUint32(40, pictureBytes, true);
  data.setUint32(44, 2500, true);
  for (let i = 0; i < 16; i++) data.setFloat32(48 + 4 * i, i + 0.5, true);
  for (let i = 0; i < pictureBytes; i++) data.setUint8(headerBytes + i, i + 1);
  change(data);
  return data.buffer;
}

test('a frame header is read field by field', () => {
  const { header, picture } = readFrame(frameBytes());
  assert.deepEqual(
    { ...header, clip_from_lps_mm: [...header.clip_from_lps_mm] },
    {
      media_type: 'image/jpeg',
      is_still: true,
      is_lossless: false,
      is_full_color: true,
      is_shared: false,
      is_coarse: true,
      quality: 95,
      scale_percent: 50,
      view: 3,
      sequence: 77,
      scene_revision: 12,
      input_id: 4000000001,
      width_px: 640,
      height_px: 480,
      full_px: [1280, 960],
      render_us: 12345,
      encode_us: 678,
      pixels_per_mm: 2.5,
      clip_from_lps_mm: Array.from({ length: 16 }, (_, i) => i + 0.5),
    },
  );
  assert.deepEqual([...picture], [1, 2, 3, 4, 5]);
});

test('a reduced picture stands for a view of its size times the divisor', () => {
  const of = (flags, scale) =>
    readFrame(
      frameBytes((data) => {
        data.setUint8(9, flags);
        data.setUint8(11, scale);
      }),
    ).header.full_px;
  assert.deepEqual(of(8, 100), [640, 480]);
  assert.deepEqual(of(8 | 32, 100), [1280, 960]);
  assert.deepEqual(of(8 | 64, 50), [5120, 3840]);
});

test('a longer header of a later version of the same format is skipped', () => {
  assert.deepEqual([...readFrame(frameBytes(() => {}, { headerBytes: 120 })).picture], [1, 2, 3, 4, 5]);
});

for (const [what, message] of [
  ['fewer than 112 bytes', new ArrayBuffer(111)],
  ['another magic', frameBytes((data) => data.setUint8(0, 65))],
  ['another version', frameBytes((data) => data.setUint16(4, 2, true))],
  ['a header below 112 bytes', frameBytes((data) => data.setUint16(6, 111, true))],
  ['a header beyond the message', frameBytes((data) => data.setUint16(6, 118, true))],
  ['a picture that ends too early', frameBytes((data) => data.setUint32(40, 4, true))],
  ['a picture that ends too late', frameBytes((data) => data.setUint32(40, 0xffffffff, true))],
  ['an unknown codec', frameBytes((data) => data.setUint8(8, 3))],
  ['a scale of 9', frameBytes((data) => data.setUint8(11, 9))],
  ['a scale of 101', frameBytes((data) => data.setUint8(11, 101))],
  ['no width', frameBytes((data) => data.setUint16(28, 0, true))],
  ['no height', frameBytes((data) => data.setUint16(30, 0, true))],
  ['a matrix with infinity', frameBytes((data) => data.setFloat32(60, Infinity, true))],
  ['a matrix with no number', frameBytes((data) => data.setFloat32(108, NaN, true))],
])
  test(`a frame with ${what} is refused`, () => assert.throws(() => readFrame(message), RangeError));
