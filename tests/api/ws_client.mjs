// A small WebSocket client over a plain socket: node 18 has none, and this one can also misbehave (fragments, bad masks, not reading).
import { createHash, randomBytes } from 'node:crypto';
import { connect } from 'node:net';
import { connect as connectSecurely } from 'node:tls';
import { heldToSentences } from './sentences.mjs';
import { parseStrict } from './strict_json.mjs';

const TEXT = 1,
  BINARY = 2,
  CLOSE = 8,
  PING = 9,
  PONG = 10;

/** The header of proto/frame.md, read independently of the page and the daemon. */
export function readFrame(bytes) {
  const at = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const flags = at.getUint8(9);
  return {
    magic: at.getUint32(0, true),
    version: at.getUint16(4, true),
    headerBytes: at.getUint16(6, true),
    codec: at.getUint8(8),
    isStill: !!(flags & 1),
    isFullColor: !!(flags & 4),
    isShared: !!(flags & 8),
    isCoarse: !!(flags & 16),
    divisor: flags & 64 ? 4 : flags & 32 ? 2 : 1,
    quality: at.getUint8(10),
    scale: at.getUint8(11),
    view: at.getUint32(12, true),
    sequence: at.getUint32(16, true),
    revision: at.getUint32(20, true),
    input: at.getUint32(24, true),
    width: at.getUint16(28, true),
    height: at.getUint16(30, true),
    renderUs: at.getUint32(32, true),
    payloadBytes: at.getUint32(40, true),
    matrix: Array.from({ length: 16 }, (_, i) => at.getFloat32(48 + 4 * i, true)),
    picture: bytes.subarray(at.getUint16(6, true)),
    at: performance.now(),
  };
}

export class Client {
  #socket;
  #bytes = Buffer.alloc(0);
  #waiting = [];
  #isOpen = false;
  #fragment = [];
  /** HTTP status of the handshake; 101 when open. */
  status = 0;
  messages = [];
  frames = [];
  /** Close code, once the server closed; 1006 without one. */
  closeCode = 0;
  /** Acknowledge each frame on arrival, as the page does. */
  shows = true;

  /** Resolves when the server has answered the handshake, also when it refused. socket: a connection that was used before; else a new one. */
  static async open(url, path, headers = {}, socket = null) {
    const client = new Client();
    const { hostname, port, host, protocol } = new URL(url);
    const key = randomBytes(16).toString('base64');
    const to = { host: hostname, port: Number(port) };
    client.#socket = socket ?? (protocol === 'https:' ? connectSecurely({ ...to, rejectUnauthorized: false }) : connect(to));
    client.#socket.on('error', () => {});
    client.#socket.on('data', (bytes) => client.#take(bytes, key));
    client.#socket.on('close', () => {
      client.closeCode ||= 1006;
      client.#checkWaiting();
    });
    const lines = {
      Host: host,
      Connection: 'Upgrade',
      Upgrade: 'websocket',
      'Sec-WebSocket-Version': '13',
      'Sec-WebSocket-Key': key,
      ...headers,
    };
    client.#socket.write(
      `GET ${path} HTTP/1.1\r\n${Object.entries(lines)
        .map(([name, value]) => `${name}: ${value}\r\n`)
        .join('')}\r\n`,
    );
    await client.until(() => client.status !== 0 || client.closeCode, 'an answer to the handshake');
    return client;
  }

  /** Enters a room: resolves when the server has welcomed the member, with `welcome` in the client. @param {object} hello fields of the message beside the protocol */
  static async enter(url, room, hello = {}) {
    const client = await Client.hello(url, room, hello);
    client.welcome = await client.message('welcome');
    client.headers = { 'Beamroom-Member': `${client.welcome.member} ${client.welcome.secret}` };
    return client;
  }

  /** Like enter, without waiting for an answer. */
  static async hello(url, room, hello = {}) {
    const client = await Client.open(url, `/api/v1/rooms/${room}/ws`);
    client.send({ type: 'hello', protocol: 2, ...hello });
    return client;
  }

  /** Resolves when the plan can be drawn. */
  ready() {
    return this.message('renderer', ({ state }) => state === 'ready');
  }

  #take(bytes, key) {
    this.#bytes = Buffer.concat([this.#bytes, bytes]);
    if (!this.#isOpen) {
      const end = this.#bytes.indexOf('\r\n\r\n');
      if (end < 0) return;
      const head = this.#bytes.subarray(0, end).toString('latin1');
      this.#bytes = this.#bytes.subarray(end + 4);
      this.status = Number(/^HTTP\/1\.[01] (\d+)/.exec(head)?.[1] ?? 0);
      const expected = createHash('sha1').update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
      const accept = /sec-websocket-accept: *(\S+)/i.exec(head)?.[1];
      if (this.status === 101 && accept !== expected) throw new Error(`Sec-WebSocket-Accept is ${accept}, expected ${expected}`);
      if (/sec-websocket-extensions/i.test(head)) throw new Error('an extension nobody asked for');
      this.#isOpen = this.status === 101;
    }
    while (this.#isOpen && this.#parse());
    this.#checkWaiting();
  }

  #parse() {
    const b = this.#bytes;
    if (b.length < 2) return false;
    if (b[1] & 0x80) throw new Error('a server must not mask');
    let n = b[1] & 0x7f,
      at = 2;
    if (n === 126) {
      if (b.length < 4) return false;
      n = b.readUInt16BE(2);
      at = 4;
    } else if (n === 127) {
      if (b.length < 10) return false;
      n = Number(b.readBigUInt64BE(2));
      at = 10;
    }
    if (b.length < at + n) return false;
    const payload = Buffer.from(b.subarray(at, at + n)),
      isFinal = !!(b[0] & 0x80),
      code = b[0] & 0x0f;
    this.#bytes = b.subarray(at + n);
    if (code === PING) {
      this.write(PONG, payload);
      return true;
    }
    if (code === CLOSE) {
      this.closeCode = n >= 2 ? payload.readUInt16BE(0) : 1005;
      return true;
    }
    if (code === TEXT || code === BINARY) this.#fragment = [code];
    this.#fragment.push(payload);
    if (!isFinal) return true;
    const [kind, ...parts] = this.#fragment;
    const whole = Buffer.concat(parts);
    if (kind === TEXT) this.messages.push(heldToSentences(parseStrict(whole.toString('utf8'))));
    else if (kind === BINARY) {
      const frame = readFrame(whole);
      this.frames.push(frame);
      if (this.shows) this.send({ type: 'frame.shown', view: frame.view, sequence: frame.sequence });
    }
    return true;
  }

  #checkWaiting() {
    for (const look of [...this.#waiting]) look();
  }

  /** Waits until test() returns something true, and returns it. */
  until(test, what = 'something', ms = 60000) {
    return new Promise((done, failed) => {
      let timer;
      const look = () => {
        const value = test();
        if (!value) return;
        clearTimeout(timer);
        this.#waiting = this.#waiting.filter((l) => l !== look);
        done(value);
      };
      timer = setTimeout(() => {
        this.#waiting = this.#waiting.filter((l) => l !== look);
        failed(
          new Error(
            `${what} did not come within ${ms} ms; ${this.frames.length} frames, closed ${this.closeCode}, last messages: ${JSON.stringify(
              this.messages.slice(-3),
            ).slice(0, 600)}`,
          ),
        );
      }, ms);
      this.#waiting.push(look);
      look();
    });
  }

  /** The first message of this type, from index `from` on, that suits; waits for it when needed. */
  message(type, suits = () => true, from = 0, ms) {
    return this.until(() => this.messages.slice(from).find((m) => m.type === type && suits(m)), `message ${type}`, ms);
  }

  frame(suits = () => true, from = 0, ms) {
    return this.until(() => this.frames.slice(from).find(suits), 'a frame', ms);
  }

  write(code, payload, { isFinal = true } = {}) {
    const mask = randomBytes(4),
      n = payload.length;
    const head =
      n < 126
        ? Buffer.from([0, 0x80 | n])
        : n < 65536
          ? Buffer.from([0, 0xfe, n >> 8, n & 255])
          : Buffer.from([0, 0xff, 0, 0, 0, 0, 0, 0, 0, 0]);
    if (n >= 65536) head.writeBigUInt64BE(BigInt(n), 2);
    head[0] = (isFinal ? 0x80 : 0) | code;
    const masked = Buffer.from(payload);
    for (let i = 0; i < n; i++) masked[i] ^= mask[i & 3];
    this.#socket.write(Buffer.concat([head, mask, masked]));
  }

  writeRaw(bytes) {
    this.#socket.write(bytes);
  }

  send(message) {
    this.write(TEXT, Buffer.from(typeof message === 'string' ? message : JSON.stringify(message)));
  }

  /** Sends one message in n fragments. */
  sendInPieces(message, n) {
    const bytes = Buffer.from(JSON.stringify(message)),
      size = Math.ceil(bytes.length / n);
    for (let at = 0; at < bytes.length; at += size)
      this.write(at === 0 ? TEXT : 0, bytes.subarray(at, at + size), { isFinal: at + size >= bytes.length });
  }

  sendBinary(bytes) {
    this.write(BINARY, bytes);
  }
  /** Stops reading: what the server sends stays in the kernel's buffers. */
  pause() {
    this.#socket.pause();
  }
  resume() {
    this.#socket.resume();
  }
  /** Closes the connection without a close frame. */
  cut() {
    this.#socket.destroy();
  }
}
