// beamroom-paper by itself, on its socket: hostile orders, short reads and writes, a reader that is gone, too little memory.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { join } from 'node:path';
import { test } from 'node:test';
import { bin } from './daemon.mjs';

const program = join(bin, 'beamroom-paper');
const magic = 0x42525050; // input.h
const mib = 2 ** 20;

/** The head of an order. @param {number[]} pictures bytes of each */
function head(nJson, pictures = [], of = magic) {
  const bytes = Buffer.alloc(28);
  [of, 0, nJson, ...pictures].forEach((value, at) => bytes.writeUInt32LE(value, 4 * at));
  return bytes;
}
const paper = (blocks, more = {}) => ({
  title: 'Record of a plan review',
  identity: { fields: [{ label: 'Patient', text: 'PHANTOM', more: '' }], line: 'PHANTOM' },
  foot: 'record r-1',
  use: 'Research use only.',
  printed: 'printed today',
  time_ms: 1.7e12,
  blocks,
  ...more,
});
function order(json, pictures = []) {
  const text = Buffer.from(typeof json === 'string' ? json : JSON.stringify(json));
  return Buffer.concat([
    head(
      text.length,
      pictures.map(({ length }) => length),
    ),
    text,
    ...pictures,
  ]);
}
const words = (text) => paper([{ type: 'text', text }]);

/** Starts the program. @returns {{socket, ended: Promise<{code, signal, pdf: Buffer, said: string}>}} */
function start(command = [program, '--serve']) {
  const child = spawn(command[0], command.slice(1), { stdio: ['ignore', 'ignore', 'pipe', 'pipe'] });
  const socket = child.stdio[3];
  const [pdf, said] = [[], []];
  socket.on('data', (bytes) => pdf.push(bytes));
  socket.on('error', () => {}); // it ends before it has read all
  child.stderr.on('data', (bytes) => said.push(bytes));
  const ended = once(child, 'close').then(([code, signal]) => ({
    code,
    signal,
    pdf: Buffer.concat(pdf),
    said: Buffer.concat(said).toString(),
  }));
  return { socket, ended };
}
async function drawn(bytes, command) {
  const { socket, ended } = start(command);
  socket.end(bytes);
  return ended;
}
const isWhole = (pdf) => pdf.subarray(0, 5).toString() === '%PDF-' && pdf.subarray(-7).toString().includes('%%EOF');

test('an order that is not whole is refused in words, and not a byte comes back', async () => {
  const good = order(words('As shown'));
  const orders = {
    nothing: Buffer.alloc(0),
    'half a head': good.subarray(0, 13),
    'another magic': Buffer.concat([head(2, [], magic + 1), Buffer.from('{}')]),
    'more JSON than is allowed': Buffer.concat([head(16 * mib + 1), Buffer.alloc(64)]),
    'as much JSON as can be said': head(0xffffffff, [0xffffffff]),
    'less JSON than it says': good.subarray(0, -3),
    'no JSON': head(0),
    'no JSON but bytes': order('\0\0\0\0'),
    'broken JSON': order('{"blocks":[}'),
    'JSON of 100,000 levels': order('['.repeat(1e5)),
    'a picture that is too large': Buffer.concat([head(2, [8 * mib + 1]), Buffer.from('{}')]),
    'a picture that is cut off': Buffer.concat([head(2, [0, 0, 5000]), Buffer.from('{}'), Buffer.alloc(4999)]),
  };
  for (const [what, bytes] of Object.entries(orders)) {
    const { code, pdf, said } = await drawn(bytes);
    assert.deepEqual([code, pdf.length], [1, 0], what);
    assert.match(said, /^beamroom-paper: what came in is not whole$/m, what);
  }
});

test('a paper of hostile blocks is drawn, or refused in words', async () => {
  const curve = (more) => ({ name: 'a', color: '#102030', dash: 1, from: 0, width: 1, percent: [100, 50], missing_percent: 0, ...more });
  const cells = (n) => Array.from({ length: n }, () => ({ text: 'x' }));
  const blocks = {
    'not blocks': [1, null, 'text', [], { type: 7 }, { type: 'table' }, { type: 'chart' }, { type: 'figures' }, { type: 'heading' }],
    'numbers without end': [
      { type: 'chart', x: 'x', y: 'y', curves: [curve({ from: 1e308, width: 1e308 }), curve({ from: -1e308, missing_percent: 1e308 })] },
      { type: 'chart', curves: [curve({ width: -1 }), curve({ percent: ['a', null, 1e300], dash: 1e9, color: '#zzzzzz' })] },
    ],
    'columns and rows': [
      {
        type: 'table',
        columns: cells(100).map((cell) => ({ ...cell, percent: 1e300 })),
        rows: [cells(500), 'row', [], [{ text: 'long '.repeat(20000) }]],
      },
    ],
    'pictures that are none': [
      {
        type: 'figures',
        width: 'whole',
        figures: [{ place: 0, width_px: 4096, height_px: 1, title: 't', caption: [{ rgb: '#', text: '' }] }],
      },
      { type: 'figures', width: 'half', figures: [{ place: 1, width_px: 1, height_px: 4096 }, { place: 99 }, { place: -1 }] },
    ],
    'words of any script': [{ type: 'text', text: `${'א'.repeat(3000)} ${'ﷺ'.repeat(300)} \u202e\u0000 ${'e\u0301\u0302'.repeat(2000)}` }],
  };
  for (const [what, list] of Object.entries(blocks)) {
    const { code, pdf, said } = await drawn(order(paper(list), [Buffer.from('not a JPEG'), Buffer.alloc(0)]));
    assert.ok(code === 0 ? isWhole(pdf) : code === 1 && /beamroom-paper: \w+ .{8}/.test(said), `${what}: ${code} ${said}`);
  }
  const pages = Array.from({ length: 1200 }, (_, at) => (at % 2 ? { type: 'page' } : { type: 'text', text: `${at}` }));
  const { code, pdf, said } = await drawn(order(paper(pages)));
  assert.deepEqual([code, pdf.length, said.includes('it has too many pages')], [1, 0, true]);
});

// Start of an image, and a frame of 8 x 6 pixels of three components: ITU-T T.81.
const jpegStart = [0xff, 0xd8, 0xff, 0xc0, 0, 17, 8, 0, 6, 0, 8, 3, 1, 0x11, 0, 2, 0x11, 1, 3, 0x11, 1];

test('an order that comes byte by byte and a reader that is slow give the same PDF', async () => {
  const bytes = order(
    paper([{ type: 'figures', width: 'whole', figures: [{ place: 0, width_px: 8, height_px: 6, title: 'Figure 1', caption: [] }] }]),
    [
      Buffer.concat([Buffer.from(jpegStart), Buffer.alloc(3 * mib, 1), Buffer.from([255, 217])]), // more than a socket holds
    ],
  );
  const whole = await drawn(bytes);
  assert.ok(whole.code === 0 && isWhole(whole.pdf) && whole.pdf.length > 3 * mib, `${whole.code} ${whole.pdf.length} ${whole.said}`);
  const { socket, ended } = start();
  socket.pause();
  for (const byte of bytes.subarray(0, 400)) if (!socket.write(Buffer.from([byte]))) await once(socket, 'drain');
  socket.end(bytes.subarray(400));
  await once(socket, 'finish'); // the writer waits now for a reader
  socket.resume();
  const slow = await ended;
  assert.equal(slow.code, 0, slow.said);
  assert.ok(slow.pdf.equals(whole.pdf));
});

test('a reader that is gone ends it, with a sentence or by the signal of a broken pipe', async () => {
  const { socket, ended } = start();
  const bytes = order(words('As shown '.repeat(2000)));
  socket.write(bytes.subarray(0, -1));
  socket.write(bytes.subarray(-1), () => socket.destroy());
  const { code, signal } = await ended;
  assert.ok(code === 1 || signal === 'SIGPIPE', `${code} ${signal}`);
});

test('too little memory is no half of a PDF', async () => {
  const bytes = order(words('As shown '.repeat(3000)), [Buffer.concat([Buffer.from([255, 216]), Buffer.alloc(2 * mib)])]);
  const ends = [];
  for (const kib of [20000, 40000, 80000, 700000]) {
    const { code, pdf } = await drawn(bytes, ['sh', '-c', `ulimit -v ${kib}; exec "$0" --serve`, program]);
    assert.ok(code !== 0 || isWhole(pdf), `${kib} KiB: ${code}, ${pdf.length} bytes`);
    ends.push(code === 0);
  }
  assert.deepEqual([ends[0], ends.at(-1)], [false, true], 'both ends were met');
});
