// Small made-up DICOM plans, as files: explicit VR, little endian. Nobody's data.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const classes = '1.2.840.10008.5.1.4.1.1.';
const longForms = new Set(['OB', 'OW', 'SQ', 'UN', 'UT']);

function element(tag, vr, value) {
  let bytes = Buffer.isBuffer(value) ? value : Array.isArray(value) ? Buffer.concat(value.map(item)) : Buffer.from(String(value));
  if (vr === 'US') {
    bytes = Buffer.alloc(2);
    bytes.writeUInt16LE(value);
  }
  if (bytes.length % 2) bytes = Buffer.concat([bytes, Buffer.from(vr === 'UI' || vr === 'OB' ? '\0' : ' ')]);
  const head = Buffer.alloc(longForms.has(vr) ? 12 : 8);
  head.writeUInt16LE(tag >>> 16, 0);
  head.writeUInt16LE(tag & 0xffff, 2);
  head.write(vr, 4, 'latin1');
  if (longForms.has(vr)) head.writeUInt32LE(bytes.length, 8);
  else head.writeUInt16LE(bytes.length, 6);
  return Buffer.concat([head, bytes]);
}

function item(elements) {
  const bytes = dataSet(elements);
  const head = Buffer.from([0xfe, 0xff, 0x00, 0xe0, 0, 0, 0, 0]);
  head.writeUInt32LE(bytes.length, 4);
  return Buffer.concat([head, bytes]);
}

/** elements: [[tag, VR, value]], in any order; a sequence's value is a list of such lists. Those without a value (undefined) are left out. */
const dataSet = (elements) =>
  Buffer.concat(
    elements
      .filter(([, , value]) => value !== undefined)
      .sort(([a], [b]) => a - b)
      .map((e) => element(...e)),
  );

const sequence = (tag, ...items) => [tag, 'SQ', items];
const refer = (tag, sopClass, uid, more) =>
  sequence(tag, [[0x00081150, 'UI', classes + sopClass], [0x00081155, 'UI', uid], ...(more ? [more] : [])]);
const ofBeam = (number) => sequence(0x300c0020, [[0x300c0022, 'IS', 1], sequence(0x300c0004, [[0x300c0006, 'IS', number]])]);

/** The bytes of a file. */
export const dicomFile = (elements) =>
  Buffer.concat([Buffer.alloc(128), Buffer.from('DICM'), element(0x00020010, 'UI', '1.2.840.10008.1.2.1'), dataSet(elements)]);

/** Elements that say whose an object is. owner: {id, name, birthDate, study, frame} */
const owned = (owner, sopClass, uid, modality, series) => [
  [0x00080005, 'CS', 'ISO_IR 192'],
  [0x00080016, 'UI', classes + sopClass],
  [0x00080018, 'UI', uid],
  [0x00080060, 'CS', modality],
  [0x00100010, 'PN', owner.name],
  [0x00100020, 'LO', owner.id],
  [0x00100030, 'DA', owner.birthDate],
  [0x0020000d, 'UI', owner.study ?? '1.2.31'],
  [0x0020000e, 'UI', series],
  [0x00200052, 'UI', owner.frame ?? '1.2.41'],
];

const grid = (rows, columns) => [
  [0x00280002, 'US', 1],
  [0x00280004, 'CS', 'MONOCHROME2'],
  [0x00280010, 'US', rows],
  [0x00280011, 'US', columns],
  [0x00280100, 'US', 16],
  [0x00280101, 'US', 16],
  [0x00280102, 'US', 15],
  [0x00200037, 'DS', '1\\0\\0\\0\\1\\0'],
];

/** n slices of 16 x 16 voxels of 2 x 2 x 3 mm from the origin on. */
export function putImages(folder, owner, { series = '1.2.51', modality = 'CT', prefix = 'ct', n = 8 } = {}) {
  mkdirSync(folder, { recursive: true });
  for (let k = 0; k < n; k++) {
    const pixels = Buffer.alloc(2 * 16 * 16);
    for (let i = 0; i < 256; i++) pixels.writeInt16LE(-200 + i + 10 * k, 2 * i);
    writeFileSync(
      join(folder, `${prefix}${k}.dcm`),
      dicomFile([
        ...owned(owner, modality === 'MR' ? '4' : '2', `${series}.${k + 1}`, modality, series),
        ...grid(16, 16),
        [0x00280103, 'US', 1],
        [0x00280030, 'DS', '2\\2'],
        [0x00180050, 'DS', '3'],
        [0x00200013, 'IS', k + 1],
        [0x00200032, 'DS', `0\\0\\${3 * k}`],
        [0x7fe00010, 'OW', pixels],
      ]),
    );
  }
}

/** A box, named, of 12 x 12 mm on the slices from 3 to 15 mm, moved toward the left by `left` mm. */
export function putStructs(
  folder,
  owner,
  { uid = '1.2.61', series = '1.2.51', file = 'structs.dcm', name = 'Box', left = 0, label = 'Set' } = {},
) {
  const frame = owner.frame ?? '1.2.41';
  const contours = [1, 2, 3, 4, 5].map((k) => [
    [0x30060042, 'CS', 'CLOSED_PLANAR'],
    [0x30060046, 'IS', 4],
    [0x30060050, 'DS', [8, 8, 20, 8, 20, 20, 8, 20].flatMap((v, i) => (i % 2 ? [v, 3 * k] : [v + left])).join('\\')],
  ]);
  const frames = sequence(0x30060010, [
    [0x00200052, 'UI', frame],
    sequence(0x30060012, [sequence(0x30060014, [[0x0020000e, 'UI', series]])]),
  ]);
  writeFileSync(
    join(folder, file),
    dicomFile([
      ...owned(owner, '481.3', uid, 'RTSTRUCT', '1.2.62'),
      [0x30060002, 'SH', label],
      frames,
      sequence(0x30060020, [
        [0x30060022, 'IS', 1],
        [0x30060024, 'UI', frame],
        [0x30060026, 'LO', name],
      ]),
      sequence(0x30060039, [sequence(0x30060040, ...contours), [0x30060084, 'IS', 1]]),
    ]),
  );
}

/** A plan with a beam from the front, or several: `beams` has their names. */
export function putPlan(
  folder,
  owner,
  {
    uid = '1.2.71',
    structs = '1.2.61',
    label = 'BNCT-2',
    approval,
    date = '20261101',
    file = 'plan.dcm',
    beam = 'Front',
    beams = [beam],
    isocenter = '14\\14\\9',
  } = {},
) {
  const points = sequence(0x300a0111, [
    [0x300a011e, 'DS', 0],
    [0x300a012c, 'DS', isocenter],
  ]);
  writeFileSync(
    join(folder, file),
    dicomFile([
      ...owned(owner, '481.5', uid, 'RTPLAN', '1.2.72'),
      [0x300a0002, 'SH', label],
      [0x300a0006, 'DA', date],
      [0x300e0002, 'CS', approval],
      sequence(
        0x300a00b0,
        ...beams.map((name, n) => [[0x300a00b4, 'DS', 1000], [0x300a00c0, 'IS', n + 1], [0x300a00c2, 'LO', name], points]),
      ),
      refer(0x300c0060, '481.3', structs),
    ]),
  );
}

/** 8 x 8 x 6 voxels of 4 mm from the origin on, values 0.1 Gy times 1 + i + j + k. plan: SOP Instance UID of the plan that it refers to; beam: number of its beam. */
export function putDose(
  folder,
  owner,
  { uid = '1.2.81', plan, summation = 'PLAN', units = 'GY', file = 'dose.dcm', description, origin = '0\\0\\0', beam } = {},
) {
  const pixels = Buffer.alloc(2 * 8 * 8 * 6);
  for (let k = 0, at = 0; k < 6; k++)
    for (let j = 0; j < 8; j++) for (let i = 0; i < 8; i++, at += 2) pixels.writeUInt16LE(1 + i + j + k, at);
  writeFileSync(
    join(folder, file),
    dicomFile([
      ...owned(owner, '481.2', uid, 'RTDOSE', '1.2.82'),
      [0x0008103e, 'LO', description],
      ...grid(8, 8),
      [0x00280103, 'US', 0],
      [0x00280008, 'IS', 6],
      [0x00280030, 'DS', '4\\4'],
      [0x00200032, 'DS', origin],
      [0x30040002, 'CS', units],
      [0x30040004, 'CS', 'PHYSICAL'],
      [0x3004000a, 'CS', summation],
      [0x3004000c, 'DS', '0\\4\\8\\12\\16\\20'],
      [0x3004000e, 'DS', '0.1'],
      ...(plan ? [refer(0x300c0002, '481.5', plan, beam && ofBeam(beam))] : []),
      [0x7fe00010, 'OW', pixels],
    ]),
  );
}

/** CT, structure set, treatment plan and dose of one person. */
export function putWhole(folder, owner, options = {}) {
  putImages(folder, owner);
  putStructs(folder, owner);
  putPlan(folder, owner, options);
  putDose(folder, owner, { plan: '1.2.71' });
}
