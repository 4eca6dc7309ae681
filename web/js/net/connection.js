// One room's WebSocket: hello first, checked messages in and out, back again after a loss.
import { maxClientBytes, protocol } from '../../gen/wire.js';
import { readMessage, readNews } from '../wire/check.js';
import { readFrame } from '../wire/frame.js';

const backoffMs = [500, 1000, 2000, 4000];
const pingMs = 2000;
const silenceMs = 10000; // no pong for this long: the way is gone though nobody closed it

// As CustomEvent, which not every node we test with has.
class News extends Event {
  constructor(type, detail) {
    super(type);
    this.detail = detail;
  }
}

/** News of a connection: "message" and "frame" carry what came in detail; "up", "lost" {retryMs}, "ended" {reason}. */
export class Connection extends EventTarget {
  #url;
  #makeSocket;
  #clock;
  #identity = { name: '', member: '', secret: '' };
  #socket = null;
  #isWelcome = false;
  #isGone;
  #failures = 0;
  #askedWaitMs = 0; // by the last bye
  #retryTimer = 0;
  #pingTimer = 0;
  #heardAt = 0;
  #isEnded = false;

  /**
   * @param {string} url
   * @param {object} world what is handed in, so that tests hand in fakes
   * @param {(url: string) => WebSocket} world.makeSocket
   * @param {{now: () => number, setTimeout: Function, clearTimeout: Function}} world.clock
   * @param {() => Promise<boolean>} [world.isGone] whether the room is no longer there; asked when a socket could not be opened
   * @param {{name?: string, member?: string, secret?: string}} identity who to be (again)
   */
  constructor(url, { makeSocket, clock, isGone = async () => false }, identity = {}) {
    super();
    this.#url = url;
    this.#makeSocket = makeSocket;
    this.#clock = clock;
    this.#isGone = isGone;
    Object.assign(this.#identity, identity);
  }

  get isOpen() {
    return this.#isWelcome;
  }

  open() {
    if (this.#socket || this.#isEnded) return;
    this.#clock.clearTimeout(this.#retryTimer);
    const socket = this.#makeSocket(this.#url);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    let wasOpen = false;
    socket.addEventListener('open', () => {
      if (socket !== this.#socket) return;
      wasOpen = true;
      this.#heardAt = this.#clock.now();
      const { name, member, secret } = this.#identity;
      this.#write({ type: 'hello', protocol, name, ...(member && { member, secret }) });
    });
    socket.addEventListener('message', (event) => {
      if (socket === this.#socket) this.#receive(event.data);
    });
    socket.addEventListener('close', () => this.#lose(socket, wasOpen));
  }

  /** Sends a message of proto/messages.json; false when there is no connection. */
  send(message) {
    if (!this.#isWelcome) return false;
    return this.#write(readMessage(message, 'client'));
  }

  /** Tries at once instead of at the end of the wait. */
  retryNow() {
    this.#failures = 0;
    this.#askedWaitMs = 0;
    this.open();
  }

  close() {
    this.#isEnded = true;
    this.#clock.clearTimeout(this.#retryTimer);
    this.#clock.clearTimeout(this.#pingTimer);
    const socket = this.#socket;
    this.#socket = null;
    this.#isWelcome = false;
    socket?.close();
  }

  #write(message) {
    const text = JSON.stringify(message);
    if (text.length > maxClientBytes) return false;
    this.#socket.send(text);
    return true;
  }

  #receive(data) {
    this.#heardAt = this.#clock.now();
    try {
      if (typeof data !== 'string') return void this.#tell('frame', readFrame(data));
      const message = readNews(JSON.parse(data));
      if (message) this.#take(message);
    } catch (error) {
      // Something from the server that we cannot read is passed over, but never silently.
      console.warn(`beamroom: passed over what the server sent: ${error.message}`);
    }
  }

  #take(message) {
    if (message.type === 'welcome') {
      this.#isWelcome = true;
      this.#failures = 0;
      this.#identity = { name: message.name, member: message.member, secret: message.secret };
      this.#tell('up');
      this.#ping();
    }
    if (message.type === 'bye') {
      if (message.retry_ms === null) this.#isEnded = true;
      else this.#askedWaitMs = message.retry_ms;
    }
    this.#tell('message', message);
    if (this.#isEnded) this.#tell('ended', { reason: message.reason });
  }

  #ping() {
    this.#clock.clearTimeout(this.#pingTimer);
    if (!this.#isWelcome) return;
    const now = this.#clock.now();
    if (now - this.#heardAt > silenceMs) return void this.#socket.close();
    this.send({ type: 'ping', time_ms: now });
    this.#pingTimer = this.#clock.setTimeout(() => this.#ping(), pingMs);
  }

  #lose(socket, wasOpen) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    this.#isWelcome = false;
    this.#clock.clearTimeout(this.#pingTimer);
    if (this.#isEnded) return;
    const retryMs = Math.max(this.#askedWaitMs, backoffMs[Math.min(this.#failures, backoffMs.length - 1)]);
    this.#failures += 1;
    this.#askedWaitMs = 0;
    this.#retryTimer = this.#clock.setTimeout(() => this.open(), retryMs);
    this.#tell('lost', { retryMs });
    if (!wasOpen) void this.#endIfGone();
  }

  /** A browser does not tell a page why a WebSocket was refused. */
  async #endIfGone() {
    if (!(await this.#isGone()) || this.#isEnded) return;
    this.close();
    this.#tell('ended', { reason: 'the room is no longer there; it ends with a restart of the server, and when nobody has been in it for long' });
  }

  #tell(type, detail) {
    this.dispatchEvent(new News(type, detail));
  }
}
