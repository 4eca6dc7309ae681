// Records what the daemon answers to the tests of tests/api. Loaded before a test file by `node --import` (tests/same.sh), so that no test knows of it.
// Appends sorted lines "FILE WHAT HASH LENGTH" to the file BEAMROOM_SAME; each hashed text stays in the folder `texts` beside it, named by the hash.
//
// `rules` lists what is masked because it differs between two runs of one build, and `leftOut` what is not recorded because it depends on how fast the
// machine is. Of GETs of one address between two other requests only the last is recorded: the others wait for something.
import { createHash } from 'node:crypto';
import { appendFileSync, mkdirSync, writeFileSync } from 'node:fs';
import { createRequire, syncBuiltinESMExports } from 'node:module';
import { basename, dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';

const rules = {
  // in any text: [what, written as]
  texts: [
    [/\b(127\.0\.0\.\d+|localhost):\d+/g, 'HOST'],
    [/\/tmp\/[\w.-]+/g, '/tmp/X'], // a test's own folder
    [/\bpage\/[\w-]+/g, 'page/X'], // named by its contents
    [/^0\.\d+\.\d+$/, 'VERSION'], // of the program
    [/\b\d{4}-\d\d-\d\d[T ][\d:.]+( UTC|Z)?/g, 'TIME'],
    [/\b[a-hj-km-np-z02-9]{4}-[a-hj-km-np-z02-9]{4}\b/g, 'ROOM'], // random
    [/\b(?=[a-z]*\d)[a-z0-9]{8,}\b/g, 'ID'], // rows, secrets, tokens, hashes
  ],
  // numbers under these names: times, durations, sizes that hold texts of these
  numbers: /(^|_)(ms|us|s|seconds|time|at|since|until|uptime|pid|rss|bytes|mib|load|sequence|port)$/,
  // figures of other numbers: threads add sums in no fixed order
  figures: 10,
  // the revision in a review's record and in messages about the scene, and anything under these names: how far the disk, the folders,
  // a recording, a renderer are; the program with its version
  names: new Set(['saved', 'audit', 'parts', 'marks', 'renderer', 'server', 'program']),
};
const leftOut = {
  // messages that tell how something goes on, or where others are just now
  messages: /^(frame|lag|members|pointer|pong|recording|renderer|replay|saved|view|watch)/,
  // the list of plans, which fills while folders are read, and that of rooms, ordered by their last use; the description of the API, a
  // document; moments of a recording; how many frames are drawn in a time; pictures that show the time
  addresses: /^GET \/api\/v1\/(plans|rooms)$|^GET \/api\/v1\/openapi.json|[?&]t_ms=|[?&]frames=|annotations"?[:=]true/,
  // which of two comes first, what goes on or is busy, which allocation fails
  texts: /"status":(409|503|504)|"state":"(running|queued)"|no memory for|"state":"not-loaded"/,
};

const target = process.env.BEAMROOM_SAME;
const texts = join(dirname(target ?? ''), 'texts');
const file = basename(process.argv[1] ?? '');
const lines = [];
const mask = (text) => rules.texts.reduce((masked, [what, as]) => masked.replace(what, as), text);

function masked(value, name = '') {
  if (rules.names.has(name)) return 'LEFT OUT';
  if (Array.isArray(value)) return value.map((one) => masked(one, name));
  if (value && typeof value === 'object')
    return Object.fromEntries(
      Object.entries(value).map(([key, one]) => [
        mask(key),
        key === 'revision' && ('made_ms' in value || value.type === 'scene') ? 'LEFT OUT' : masked(one, key),
      ]),
    );
  if (typeof value === 'number') return rules.numbers.test(name) ? 0 : Number(value.toPrecision(rules.figures));
  return typeof value === 'string' ? mask(value) : value;
}

/** A PNG without its texts, which hold the time. */
function withoutTexts(bytes) {
  const chunks = [];
  for (let at = 8; at + 12 <= bytes.length; at += 12 + bytes.readUInt32BE(at))
    if (bytes.toString('latin1', at + 4, at + 8) !== 'iTXt') chunks.push(bytes.subarray(at, at + 12 + bytes.readUInt32BE(at)));
  return Buffer.concat(chunks);
}

function comparable(bytes, type, path) {
  if (type.startsWith('image/png')) return withoutTexts(bytes);
  if (!/json|^text\//.test(type)) return bytes;
  const text = bytes.toString('utf8');
  if (path === '/metrics') return text.replace(/ \S+$/gm, '');
  try {
    return JSON.stringify(masked(JSON.parse(text)));
  } catch {
    return mask(text);
  }
}

function line(what, bytes) {
  const hash = createHash('sha256').update(bytes).digest('hex').slice(0, 20);
  if (typeof bytes === 'string') writeFileSync(join(texts, hash), bytes);
  return `${file} ${what.replaceAll(/\s/g, '_').slice(0, 400)} ${hash} ${bytes.length}`;
}

function recordCalls() {
  const polled = new Map();
  const settle = () => {
    lines.push(...polled.values());
    polled.clear();
  };
  const plain = globalThis.fetch;
  globalThis.fetch = async (address, options = {}) => {
    const answer = await plain(address, options);
    const type = answer.headers.get('content-type') ?? '';
    if (/^(multipart\/x-mixed-replace|text\/event-stream)/.test(type)) return answer;
    const bytes = Buffer.from(
      await answer
        .clone()
        .arrayBuffer()
        .catch(() => Buffer.from('cut')),
    );
    const url = new URL(address);
    const method = options.method ?? 'GET';
    const what = `${method} ${mask(decodeURIComponent(url.pathname + url.search))}`;
    const text = comparable(bytes, type, url.pathname);
    const isOut = leftOut.addresses.test(what) || leftOut.addresses.test(String(options.body));
    if (method !== 'GET') settle();
    if (isOut || (typeof text === 'string' && leftOut.texts.test(text))) return answer;
    if (method === 'GET') polled.set(url.href, line(`${what} ${answer.status} ${type}`, text));
    else lines.push(line(`${what} ${answer.status} ${type}`, text));
    return answer;
  };
  process.on('exit', settle);
}

/** Connections that send bytes of their own: what came first, if it is a refusal or an answer. */
function recordConnections() {
  const net = createRequire(import.meta.url)('node:net');
  const { connect } = net;
  const all = [];
  net.connect = (...args) => {
    const socket = connect(...args);
    const came = [];
    all.push(came);
    socket.prependListener('data', (bytes) => {
      if (came.length < 100) came.push(Buffer.from(bytes, 'latin1'));
    });
    return socket;
  };
  syncBuiltinESMExports();
  net.connect = connect;
  process.on('exit', () => {
    for (const came of all) {
      const text = Buffer.concat(came).toString('latin1');
      if (/^HTTP\/1\.1 (?!101)/.test(text)) lines.push(line(`plain ${text.slice(9, 12)}`, mask(text).replace(/^Date: .*$/gm, 'Date:')));
    }
  });
}

/** Messages of each kind that came to any client, once each: how often one comes depends on time. */
async function recordMessages() {
  const { Client } = await import(pathToFileURL(join(process.cwd(), 'tests/api/ws_client.mjs')));
  const came = new Set();
  const keep = (message) => {
    if (leftOut.messages.test(message.type)) return;
    const text = JSON.stringify(masked(message));
    if (!leftOut.texts.test(text)) came.add(line(`ws ${message.type}`, text));
  };
  const { open } = Client;
  Client.open = async (...args) => {
    const client = await open.apply(Client, args);
    for (const message of client.messages) keep(message);
    client.messages.push = (message) => {
      keep(message);
      return Array.prototype.push.call(client.messages, message);
    };
    return client;
  };
  process.on('exit', () => lines.push(...came));
}

if (target && file.endsWith('.test.mjs')) {
  mkdirSync(texts, { recursive: true });
  recordCalls();
  recordConnections();
  await recordMessages();
  process.on('exit', () => appendFileSync(target, lines.length ? `${lines.sort().join('\n')}\n` : ''));
}
