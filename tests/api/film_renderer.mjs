// A made-up renderer for films: it draws nothing, writes each packet about a film into packets.jsonl beside it, and does what a film's quality says.
// quality 2: its pictures never come; 3: the film has 31 MiB; 4: its third picture is refused as busy, once; 5: its second one was too slow;
// 6: the process ends at its second one, once.
import { appendFileSync, existsSync, readSync, writeFileSync, writeSync } from 'node:fs';
import { argv } from 'node:process';

const log = new URL('packets.jsonl', import.meta.url);
const ended = new URL('ended', import.meta.url);
const magic = 0x4b505242; // proto/packets.json

function writeAll(bytes) {
  for (let at = 0; at < bytes.length; ) at += writeSync(3, bytes, at);
}
function send(json, blob = Buffer.alloc(0)) {
  const text = Buffer.from(JSON.stringify(json));
  const head = Buffer.alloc(12);
  [magic, text.length, blob.length].forEach((value, at) => head.writeUInt32LE(value, 4 * at));
  for (const part of [head, text, blob]) writeAll(part);
}
function read(n) {
  const bytes = Buffer.alloc(n);
  for (let at = 0; at < n; ) {
    const got = readSync(3, bytes, at, n - at, null);
    if (!got) process.exit(0);
    at += got;
  }
  return bytes;
}

const wereBusy = new Set();
function draw({ id, quality, film, film_at: at, film_end: isLast }) {
  const problem = (type, more) => send({ type: 'problem', id, problem: { type: `/problems/${type}`, detail: type, ...more } });
  if (quality === 2 && film) return;
  if (quality === 4 && at === 2 && !wereBusy.has(film)) {
    wereBusy.add(film);
    problem('busy', { retry_after_ms: 900 });
    return;
  }
  if (quality === 5 && at === 1) {
    problem('timeout');
    return;
  }
  if (quality === 6 && at === 1 && !existsSync(ended)) {
    writeFileSync(ended, '');
    process.exit(1);
  }
  const film_bytes = Buffer.alloc(quality === 3 ? 31 << 20 : 64);
  film_bytes.writeUInt32BE(0x1a45dfa3); // EBML
  const others = { height_px: 48, scene_revision: 0, render_us: 9, encode_us: 9, pixels_per_mm: 1 };
  const matrix = Array.from({ length: 16 }, (_, n) => n);
  send({ type: 'frame', id, width_px: 64, ...others, clip_from_lps_mm: matrix }, isLast ? film_bytes : Buffer.alloc(1));
}

send({ type: 'gl', back_end: 'made-up' });
send({ type: 'ready', plan: { id: argv[argv.indexOf('--plan-id') + 1], images: [{ id: 'ct' }] }, scene: {}, confined: 'no', load_ms: 1 });
for (;;) {
  const head = read(12);
  const packet = JSON.parse(read(head.readUInt32LE(4)));
  read(head.readUInt32LE(8));
  const { type, id, film = 0, film_at, quality, named, words, film_times: times = 1 } = packet;
  if (type === 'ping') send({ type: 'pong' });
  if (film) appendFileSync(log, `${JSON.stringify({ type, film, film_at, quality, named, words, times, ms: Date.now() })}\n`);
  if (type === 'render') draw(packet);
  if (type === 'await_ready') send({ type: 'answer', id, body: {} });
}
