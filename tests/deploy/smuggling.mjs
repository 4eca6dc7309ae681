// Requests of which a proxy and a daemon could disagree where they end, of HTTP/1.1 and of HTTP/2. Each hides a second request, the canary: it writes
// a note into a room, and says that it comes from an address nobody has. A proxy that sees it as a request writes the client's own address into it; so a row of
// the audit with any other address tells that the daemon took for a request what the proxy took for something else.
import { openSecurely } from './world.mjs';

const J = 'Content-Type: application/json\r\n';

/** The address that the canary of a shape claims. */
export const canaryAddress = (n) => `203.0.113.${n + 1}`;
/** @param {{host: string, room: string, cookie: string, signsIn?: string}} where signsIn: it says who it is, as a proxy would; else its cookie does @param {number} n of the shape */
export function canary({ host, room, signsIn, cookie }, n) {
  const who = signsIn ? 'X-Beamroom-User: ann\r\nX-Beamroom-Groups: clinicians\r\n' : `Cookie: ${cookie}\r\n`;
  const body = '{"body":{"text":"hidden"},"name":"Script"}';
  return `POST /api/v1/rooms/${room}/notes HTTP/1.1\r\nHost: ${host}\r\n${J}X-Forwarded-For: ${canaryAddress(n)}\r\n${who}Content-Length: ${body.length}\r\n\r\n${body}`;
}

const chunk = (text) => `${text.length.toString(16)}\r\n${text}\r\n`;
/** A POST whose lines and body are free. @type {Record<string, (inner: string, post: (lines: string, body: string) => string, get: (lines: string) => string) => string>} */
export const shapes = {
  'Content-Length before chunked': (inner, post) => post(`Content-Length: 6\r\nTransfer-Encoding: chunked\r\n`, `0\r\n\r\n${inner}`),
  'chunked before Content-Length': (inner, post) => post('Transfer-Encoding: chunked\r\nContent-Length: 4\r\n', `${chunk(inner)}0\r\n\r\n`),
  'Content-Length that covers the hidden one, and chunked': (inner, post) =>
    post(`Content-Length: ${inner.length + 5}\r\nTransfer-Encoding: chunked\r\n`, `0\r\n\r\n${inner}`),
  'chunked twice': (inner, post) =>
    post('Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\nContent-Length: 5\r\n', `0\r\n\r\n${inner}`),
  'chunked, then identity': (inner, post) => post('Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n', `0\r\n\r\n${inner}`),
  'identity, then chunked, with a length': (inner, post) =>
    post(`Transfer-Encoding: identity\r\nTransfer-Encoding: chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'chunked, identity in one line': (inner, post) =>
    post('Transfer-Encoding: chunked, identity\r\nContent-Length: 5\r\n', `0\r\n\r\n${inner}`),
  xchunked: (inner, post) => post(`Transfer-Encoding: xchunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'chunked in quotes': (inner, post) =>
    post(`Transfer-Encoding: "chunked"\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'chunked behind a tab': (inner, post) =>
    post(`Transfer-Encoding:\tchunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'chunked behind a form feed': (inner, post) =>
    post(`Transfer-Encoding: \x0bchunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'chunked in capitals': (inner, post) =>
    post(`TRANSFER-ENCODING: CHUNKED\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'chunked with a parameter': (inner, post) =>
    post(`Transfer-Encoding: chunked;a=b\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'gzip, chunked': (inner, post) => post('Transfer-Encoding: gzip, chunked\r\nContent-Length: 5\r\n', `0\r\n\r\n${inner}`),
  'a space before the colon of Transfer-Encoding': (inner, post) =>
    post(`Transfer-Encoding : chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'a space before the colon of Content-Length': (inner, post) => post(`Content-Length : ${inner.length}\r\n`, inner),
  'a space before the name of Transfer-Encoding': (inner, post) =>
    post(`X: y\r\n Transfer-Encoding: chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'Transfer-Encoding on two lines': (inner, post) =>
    post(`Transfer-Encoding:\r\n chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'Content-Length on two lines': (inner, post) => post(`Content-Length:\r\n ${inner.length}\r\n`, inner),
  Transfer_Encoding: (inner, post) => post(`Transfer_Encoding: chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  Content_Length: (inner, post) => post(`Content_Length: 0\r\nContent-Length: ${inner.length}\r\n`, inner),
  'Transfer-Encoding of HTTP/1.0': (inner, post) =>
    post('Transfer-Encoding: chunked\r\nConnection: keep-alive\r\n', `0\r\n\r\n${inner}`).replace(' HTTP/1.1\r\n', ' HTTP/1.0\r\n'),
  'two lengths, the first one shorter': (inner, post) => post(`Content-Length: 2\r\nContent-Length: ${inner.length + 2}\r\n`, `{}${inner}`),
  'two lengths, the second one shorter': (inner, post) =>
    post(`Content-Length: ${inner.length + 2}\r\nContent-Length: 2\r\n`, `{}${inner}`),
  'two lengths in one line': (inner, post) => post(`Content-Length: 2, ${inner.length + 2}\r\n`, `{}${inner}`),
  'a length with a sign': (inner, post) => post(`Content-Length: +${inner.length}\r\n`, inner),
  'a length below nothing': (inner, post) => post('Content-Length: -1\r\n', inner),
  'a length in hexadecimal': (inner, post) => post(`Content-Length: 0x${inner.length.toString(16)}\r\n`, inner),
  'a length beyond 64 bits': (inner, post) => post('Content-Length: 18446744073709551616\r\n', inner),
  'an empty length': (inner, post) => post('Content-Length:\r\n', inner),
  'a length with a letter behind it': (inner, post) => post(`Content-Length: ${inner.length}a\r\n`, inner),
  'no length at all': (inner, post) => post('', inner),
  'a GET with a body': (inner, _, get) => get(`Content-Length: ${inner.length}\r\n`) + inner,
  'a GET with a chunked body': (inner, _, get) => `${get('Transfer-Encoding: chunked\r\n')}${chunk(inner)}0\r\n\r\n`,
  'a HEAD with a body': (inner, _, get) => get(`Content-Length: ${inner.length}\r\n`).replace('GET', 'HEAD') + inner,
  'an OPTIONS with a body': (inner, _, get) => get(`Content-Length: ${inner.length}\r\n`).replace('GET', 'OPTIONS') + inner,
  'lines that end in LF': (inner, post) => post(`Content-Length: ${inner.length}\r\n`, '').replaceAll('\r\n', '\n') + inner,
  'a LF inside a value': (inner, post) =>
    post(`X: y\nTransfer-Encoding: chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'a CR inside a value': (inner, post) =>
    post(`X: y\rTransfer-Encoding: chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'a NUL in a value': (inner, post) =>
    post(`X: y\0\r\nTransfer-Encoding: chunked\0\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'a line without a colon': (inner, post) =>
    post(`Transfer-Encoding chunked\r\nContent-Length: ${inner.length + 5}\r\n`, `0\r\n\r\n${inner}`),
  'a chunk whose size has a sign': (inner, post) => post('Transfer-Encoding: chunked\r\n', `+2\r\n{}\r\n0\r\n\r\n${inner}`),
  'a chunk whose size has 0x': (inner, post) => post('Transfer-Encoding: chunked\r\n', `0x2\r\n{}\r\n0\r\n\r\n${inner}`),
  'a chunk whose size has a space before it': (inner, post) => post('Transfer-Encoding: chunked\r\n', ` 2\r\n{}\r\n0\r\n\r\n${inner}`),
  'a chunk whose size wraps around': (inner, post) =>
    post('Transfer-Encoding: chunked\r\n', `10000000000000002\r\n{}\r\n0\r\n\r\n${inner}`),
  'a chunk with an extension that has a LF': (inner, post) => post('Transfer-Encoding: chunked\r\n', `2;\n{}\r\n0\r\n\r\n${inner}`),
  'an extension that ends in LF, of the last chunk': (inner, post) =>
    post('Transfer-Encoding: chunked\r\n', `2\r\n{}\r\n0;a\nX: y\r\n\r\n${inner}`),
  'chunks that end in LF': (inner, post) => post('Transfer-Encoding: chunked\r\n', `2\n{}\n0\n\n${inner}`),
  'a chunk longer than its size': (inner, post) => post('Transfer-Encoding: chunked\r\n', `1\r\n{}\r\n0\r\n\r\n${inner}`),
  'the hidden one in an extension of a chunk': (inner, post) =>
    post('Transfer-Encoding: chunked\r\n', `2;${inner.replaceAll('\r\n', '\n')}\r\n{}\r\n0\r\n\r\n`),
  'a trailer that is a length': (inner, post) =>
    post('Transfer-Encoding: chunked\r\n', `2\r\n{}\r\n0\r\nContent-Length: 0\r\n\r\n${inner}`),
  'a trailer that says chunked': (inner, post) =>
    post('Transfer-Encoding: chunked\r\n', `2\r\n{}\r\n0\r\nTransfer-Encoding: chunked\r\n\r\n${inner}`),
  'a trailer that is the hidden one': (inner, post) => post('Transfer-Encoding: chunked\r\n', `2\r\n{}\r\n0\r\n${inner}`),
  'the length named in Connection': (inner, post) => post(`Connection: Content-Length\r\nContent-Length: ${inner.length}\r\n`, inner),
  'chunked named in Connection': (inner, post) =>
    post('Connection: Transfer-Encoding\r\nTransfer-Encoding: chunked\r\n', `${chunk(inner)}0\r\n\r\n`),
  'X-Forwarded-For named in Connection': (inner, post) => post('Connection: X-Forwarded-For, close\r\nContent-Length: 2\r\n', '{}') + inner,
  'Expect: 100-continue with the hidden one as body': (inner, post) =>
    post(`Expect: 100-continue\r\nContent-Length: ${inner.length}\r\n`, inner),
  'an Expect that nobody knows': (inner, post) => post(`Expect: y100-continue\r\nContent-Length: ${inner.length}\r\n`, inner),
  'absolute form': (inner, post) => post(`Content-Length: ${inner.length}\r\n`, inner).replace('POST /', 'POST https://evil.example/'),
  'two names in Host': (inner, post) => post(`Host: evil.example\r\nContent-Length: ${inner.length}\r\n`, inner),
  'HTTP/1.2': (inner, post) => post(`Content-Length: ${inner.length}\r\n`, inner).replace('HTTP/1.1', 'HTTP/1.2'),
  'HTTP/0.9': (inner) => `GET /healthz\r\n\r\n${inner}`,
  'a WebSocket handshake with a version nobody has': (inner, _, get) =>
    get('Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 777\r\nSec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n') +
    inner,
  'a WebSocket handshake to a call': (inner, _, get) =>
    get('Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n') +
    inner,
  'an upgrade to h2c': (inner, _, get) =>
    get('Connection: Upgrade, HTTP2-Settings\r\nUpgrade: h2c\r\nHTTP2-Settings: AAMAAABkAARAAAAAAAIAAAAA\r\n') + inner,
  'a CR LF in the address': (inner, _, get) =>
    get('').replace('/healthz', `/healthz%0d%0a%0d%0a${encodeURIComponent(inner).slice(0, 2000)}`),
  'a raw space in the address': (inner, _, get) =>
    get(`Content-Length: ${inner.length}\r\n`).replace('/healthz', '/healthz HTTP/1.1') + inner,
};

/** The answers to bytes on a connection: until it ends, or is quiet. */
function exchange(socket, bytes, quietMs = 400, mostMs = 4000) {
  return new Promise((done) => {
    let text = '';
    let quiet;
    const end = () => {
      clearTimeout(quiet);
      clearTimeout(late);
      socket.destroy();
      done(text);
    };
    const late = setTimeout(end, mostMs);
    const again = () => {
      clearTimeout(quiet);
      quiet = setTimeout(end, quietMs);
    };
    socket.on('data', (more) => {
      text += more.toString('latin1');
      again();
    });
    socket.on('close', end);
    socket.on('error', end);
    socket.write(Buffer.from(bytes, 'latin1'), again);
  });
}

/** Sends every shape, a few at a time. @param {{port: number, host: string, room: string, cookie: string}} where @returns {Promise<{name: string, n: number, text: string}[]>} */
export async function sendShapes(where) {
  const lines = `Host: ${where.host}\r\n${where.cookie ? `Cookie: ${where.cookie}\r\n` : ''}`;
  const post = (more, body) => `POST /api/v1/rooms HTTP/1.1\r\n${lines}${J}${more}\r\n${body}`;
  const get = (more) => `GET /healthz HTTP/1.1\r\n${lines}${more}\r\n`;
  return inTurn(Object.entries(shapes), async ([name, make], n) => {
    const socket = await openSecurely(where.port, { ALPNProtocols: ['http/1.1'] });
    return { name, n, text: await exchange(socket, make(canary(where, n), post, get)) };
  });
}

/** Six at a time. */
async function inTurn(all, work) {
  const results = [];
  let next = 0;
  await Promise.all(
    Array.from({ length: 6 }, async () => {
      while (next < all.length) {
        const n = next++;
        results[n] = await work(all[n], n);
      }
    }),
  );
  return results;
}

// ---- HTTP/2: frames and headers (RFC 9113, RFC 7541), literal and not indexed, so that each byte can be any
const HEADERS = 1,
  DATA = 0,
  SETTINGS = 4,
  END_STREAM = 1,
  END_HEADERS = 4;

function frame(type, flags, stream, payload) {
  const head = Buffer.alloc(9);
  head.writeUIntBE(payload.length, 0, 3);
  head[3] = type;
  head[4] = flags;
  head.writeUInt32BE(stream, 5);
  return Buffer.concat([head, payload]);
}
function lengthOf(n) {
  if (n < 127) return Buffer.from([n]);
  const bytes = [127];
  for (n -= 127; n >= 128; n >>= 7) bytes.push((n & 127) | 128);
  return Buffer.from([...bytes, n]);
}
const text = (value) => Buffer.concat([lengthOf(value.length), Buffer.from(value, 'latin1')]);
const fields = (list) => Buffer.concat(list.flatMap(([name, value]) => [Buffer.from([0x10]), text(name), text(value)]));

/** Headers behind the first four, and the body. @type {Record<string, (inner: string) => {more?: [string, string][], change?: Record<string, string>, body?: string, trailers?: [string, string][]}>} */
export const h2Shapes = {
  'content-length 0 and a body': (inner) => ({ more: [['content-length', '0']], body: inner }),
  'content-length shorter than the body': (inner) => ({ more: [['content-length', '2']], body: `{}${inner}` }),
  'two lengths': (inner) => ({
    more: [
      ['content-length', '2'],
      ['content-length', String(inner.length + 2)],
    ],
    body: `{}${inner}`,
  }),
  'a length with a sign': (inner) => ({ more: [['content-length', `+${inner.length}`]], body: inner }),
  'transfer-encoding: chunked': (inner) => ({ more: [['transfer-encoding', 'chunked']], body: `0\r\n\r\n${inner}` }),
  'Transfer-Encoding in capitals': (inner) => ({ more: [['Transfer-Encoding', 'chunked']], body: `0\r\n\r\n${inner}` }),
  'a line end in a value': (inner) => ({ more: [['x', 'y\r\nTransfer-Encoding: chunked']], body: `0\r\n\r\n${inner}` }),
  'a LF in a value': (inner) => ({ more: [['x', 'y\nTransfer-Encoding: chunked']], body: `0\r\n\r\n${inner}` }),
  'the hidden one in a value': (inner) => ({ more: [['x', `y\r\n\r\n${inner}`]], body: '{}' }),
  'a line end in a name': (inner) => ({ more: [['x: y\r\ntransfer-encoding', 'chunked']], body: `0\r\n\r\n${inner}` }),
  'a colon in a name': (inner) => ({ more: [['transfer-encoding: chunked', '']], body: `0\r\n\r\n${inner}` }),
  'a space behind a name': (inner) => ({ more: [['transfer-encoding ', 'chunked']], body: `0\r\n\r\n${inner}` }),
  'the hidden one in :path': (inner) => ({ change: { ':path': `/healthz HTTP/1.1\r\nHost: x\r\n\r\n${inner}` } }),
  'a space in :path': (inner) => ({ change: { ':path': '/healthz HTTP/1.1' }, body: inner }),
  'the hidden one in :method': (inner) => ({ change: { ':method': `${inner}GET` } }),
  'the hidden one in :authority': (inner) => ({ change: { ':authority': `x\r\n\r\n${inner}` } }),
  'a line end in :scheme': (inner) => ({ change: { ':scheme': `https://x\r\n\r\n${inner}` } }),
  'host beside :authority': (inner) => ({ more: [['host', 'evil.example']], body: inner }),
  'connection: upgrade': (inner) => ({
    more: [
      ['connection', 'upgrade'],
      ['upgrade', 'websocket'],
    ],
    body: inner,
  }),
  'a trailer that says chunked': (inner) => ({ body: `0\r\n\r\n${inner}`, trailers: [['transfer-encoding', 'chunked']] }),
  'a trailer that is a length': (inner) => ({ body: inner, trailers: [['content-length', '0']] }),
  'a trailer with the hidden one': (inner) => ({ body: '{}', trailers: [['x', `y\r\n\r\n${inner}`]] }),
  'a NUL in a value': (inner) => ({
    more: [
      ['x', 'y\0'],
      ['transfer-encoding', 'chunked\0'],
    ],
    body: `0\r\n\r\n${inner}`,
  }),
};

/** Sends every shape of HTTP/2; their canaries are counted on behind those of HTTP/1.1. */
export async function sendH2Shapes(where) {
  const from = Object.keys(shapes).length;
  return inTurn(Object.entries(h2Shapes), async ([name, make], at) => {
    const n = from + at;
    const { more = [], change = {}, body = '', trailers } = make(canary(where, n));
    const first = { ':method': 'POST', ':scheme': 'https', ':path': '/api/v1/rooms', ':authority': where.host, ...change };
    const list = [...Object.entries(first), ['content-type', 'application/json'], ...more];
    if (where.cookie) list.push(['cookie', where.cookie]);
    const bytes = Buffer.concat([
      Buffer.from('PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n'),
      frame(SETTINGS, 0, 0, Buffer.alloc(0)),
      frame(HEADERS, END_HEADERS, 1, fields(list)),
      frame(DATA, trailers ? 0 : END_STREAM, 1, Buffer.from(body, 'latin1')),
      ...(trailers ? [frame(HEADERS, END_HEADERS | END_STREAM, 1, fields(trailers))] : []),
    ]);
    const socket = await openSecurely(where.port, { ALPNProtocols: ['h2'] });
    if (socket.alpnProtocol !== 'h2') throw new Error('the proxy does not speak HTTP/2');
    return { name, n, text: await exchange(socket, bytes.toString('latin1')) };
  });
}
