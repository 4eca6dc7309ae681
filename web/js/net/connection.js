// The WebSocket of a room: sends hello, checks messages in both directions, connects again after a loss.
import { maxClientBytes, protocol } from '../../gen/wire.js';
import { told } from '../parts/sentences.js';
import { readMessage, readServerMessage } from '../wire/check.js';
import { readFrame } from '../wire/frame.js';
import { say } from './words.js';

const backoffMs = [500, 1000, 1500]; // who waits longest is back within 2 s after the server
const beatMs = 500;
const pingMs = 1000;
const hurryMs = 250; // a change is followed by a ping, at most this often, so that an answer is due
const quietMs = 2000; // an answer that is due for so long: "quiet"
const lostMs = 5000; // ... the connection counts as lost
const mostLostMs = 40000;
const shortMs = 60000; // a connection that was lost sooner after its welcome
const welcomeMs = 8000; // a new connection without welcome for so long is given up
const changes = new Set(['view.patch', 'scene.patch', 'follow']);

// Like CustomEvent, which older versions of node do not have.
class ConnectionEvent extends Event {
  constructor(type, detail) {
    super(type);
    this.detail = detail;
  }
}

/**
 * Dispatches "message" and "frame" with what was received as detail, "up", "lost" {retryMs} and "ended" {reason, code: of bye, isRefused: the server said so}; "quiet"
 * {since: time of the last sign of the server, dueSince} when an answer is overdue, and "heard" when one came after all;
 * "renewing" when a new socket takes the place of one that works; "paused" when the person has to sign in before it goes on.
 */
export class Connection extends EventTarget {
  #url;
  #makeSocket;
  #clock;
  #identity = { name: '', member: '', secret: '', link: '', person: '' };
  #socket = null;
  #replaced = null; // socket that is kept until the new one has its welcome, so that the member is never away
  #isWelcome = false;
  #isGone;
  #failures = 0;
  #serverWaitMs = 0; // wait that the last bye asked for
  #retryTimer = 0;
  #beatTimer = 0;
  #welcomeTimer = 0;
  #heardAt = 0;
  #pingedAt = 0;
  #dueSince = null; // time of the oldest ping after which nothing was heard
  #beatAt = 0;
  #isQuiet = false;
  #welcomeAt = 0;
  #lostMs = lostMs; // grows while connections are short: a slow link may only be busy with one large picture
  #isEnded = false;
  #isPaused = false;

  /**
   * @param {string} url
   * @param {object} world passed in, so that tests can use fakes
   * @param {(url: string) => WebSocket} world.makeSocket
   * @param {{now: () => number, setTimeout: Function, clearTimeout: Function}} world.clock
   * @param {() => Promise<boolean>} [world.isGone] whether the room no longer exists; called when a socket could not be opened
   * @param {{name?: string, member?: string, secret?: string, link?: string, person?: string, wall?: boolean}} identity name and link for a new member, member and secret to come back as, person of this browser
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

  open(waitMs = welcomeMs) {
    if (this.#socket || this.#isEnded || this.#isPaused) return;
    this.#clock.clearTimeout(this.#retryTimer);
    const socket = this.#makeSocket(this.#url);
    socket.binaryType = 'arraybuffer';
    this.#socket = socket;
    let wasOpen = false;
    // closing a socket whose packets get lost takes minutes: it is left to itself
    this.#welcomeTimer = this.#clock.setTimeout(() => this.#abandon(socket, wasOpen), waitMs);
    socket.addEventListener('open', () => {
      if (socket !== this.#socket) return;
      wasOpen = true;
      this.#heardAt = this.#clock.now();
      const { name, member, secret, link, person, wall } = this.#identity;
      this.#write({
        type: 'hello',
        protocol,
        name,
        ...(member && { member, secret }),
        ...(link && { link }),
        ...(person && { person }),
        ...(wall && { wall }),
      });
    });
    socket.addEventListener('message', (event) => {
      if (socket === this.#socket) this.#receive(event.data);
    });
    socket.addEventListener('close', () => this.#lose(socket, wasOpen));
  }

  /** Sends a message of proto/messages.json; returns false without a connection. */
  send(message) {
    if (!this.#isWelcome) return false;
    if (!this.#write(readMessage(message, 'client'))) return false;
    if (changes.has(message.type) && this.#dueSince === null && this.#clock.now() - this.#pingedAt > hurryMs) this.#ping();
    return true;
  }

  /** Takes another name: comes back at once, as the same member. */
  rename(name) {
    this.#identity.name = name;
    this.renew();
  }

  /** Comes back at once, as the same member: under another name, or by a new sign-in, as a socket belongs to that with which it was opened. */
  renew() {
    if (this.#isEnded) return;
    if (!this.#isWelcome) return void this.retryNow(); // an attempt under way may have told the old name
    this.#replaced = this.#socket;
    this.#socket = null;
    this.#isWelcome = false;
    this.#isQuiet = false;
    this.#dueSince = null;
    this.#stopTimers();
    this.#tell('renewing');
    this.open(quietMs);
  }

  /** Connects at once instead of at the end of the wait. */
  retryNow() {
    this.#isPaused = false;
    this.#failures = 0;
    this.#serverWaitMs = 0;
    if (!this.#isWelcome) {
      // also instead of an attempt that got no answer yet
      this.#stopTimers();
      this.#socket?.close();
      this.#socket = null;
    }
    this.open();
  }

  close() {
    this.#isEnded = true;
    this.#leave();
  }

  /** Stands still until retryNow(): the person is not signed in any more. The member and its secret are kept. @param {object} seat {member, secret, name} as whom it comes back, if not as who it is */
  pause(seat = {}) {
    if (this.#isEnded || this.#isPaused) return;
    this.#isPaused = true;
    Object.assign(this.#identity, seat);
    this.#leave();
    this.#tell('paused');
  }

  #leave() {
    this.#clock.clearTimeout(this.#retryTimer);
    this.#stopTimers();
    const socket = this.#socket;
    this.#socket = null;
    this.#isWelcome = this.#isQuiet = false;
    this.#dueSince = null;
    socket?.close();
    this.#dropReplaced();
  }

  #dropReplaced() {
    this.#replaced?.close();
    this.#replaced = null;
  }

  #write(message) {
    const text = JSON.stringify(message);
    if (text.length > maxClientBytes) return false;
    this.#socket.send(text);
    return true;
  }

  #receive(data) {
    this.#heardAt = this.#clock.now();
    this.#dueSince = null;
    if (this.#isQuiet) this.#tell('heard');
    this.#isQuiet = false;
    try {
      if (typeof data !== 'string') return void this.#tell('frame', readFrame(data));
      const message = readServerMessage(told(JSON.parse(data)));
      if (message) this.#take(message);
    } catch (error) {
      // A message of the server that cannot be read is ignored, but never silently.
      console.warn(`beamroom: passed over what the server sent: ${error.message}`);
    }
  }

  #take(message) {
    if (message.type === 'welcome') {
      this.#isWelcome = true;
      this.#failures = 0;
      this.#dropReplaced();
      Object.assign(this.#identity, { name: message.name, member: message.member, secret: message.secret });
      this.#tell('up');
      this.#clock.clearTimeout(this.#welcomeTimer);
      this.#beatAt = this.#welcomeAt = this.#clock.now();
      this.#ping();
      this.#beat();
    }
    if (message.type === 'bye') {
      if (message.code === 'sign-in') return this.pause();
      if (message.retry_ms === null) this.#isEnded = true;
      else this.#serverWaitMs = message.retry_ms;
    }
    this.#tell('message', message);
    if (this.#isEnded) this.#tell('ended', { reason: message.reason, code: message.code, isRefused: true });
  }

  #ping() {
    this.#pingedAt = this.#clock.now();
    this.#dueSince ??= this.#pingedAt;
    this.#write({ type: 'ping', time_ms: this.#pingedAt });
  }

  #beat() {
    this.#clock.clearTimeout(this.#beatTimer);
    if (!this.#isWelcome) return;
    const now = this.#clock.now();
    // After a sleep of the page, what came meanwhile is still to be read.
    if (now - this.#beatAt > 4 * beatMs && this.#dueSince !== null) this.#dueSince = now;
    this.#beatAt = now;
    const dueMs = this.#dueSince === null ? 0 : now - this.#dueSince;
    if (dueMs >= this.#lostMs) {
      this.#lostMs = now - this.#welcomeAt < shortMs ? Math.min(2 * this.#lostMs, mostLostMs) : lostMs;
      return void this.#abandon(this.#socket, true);
    }
    if (dueMs >= quietMs && !this.#isQuiet) {
      this.#isQuiet = true;
      this.#tell('quiet', { since: this.#heardAt, dueSince: this.#dueSince });
    }
    if (now - this.#pingedAt >= pingMs) this.#ping();
    this.#beatTimer = this.#clock.setTimeout(() => this.#beat(), beatMs);
  }

  /** Gives a socket up without waiting for its end. */
  #abandon(socket, wasOpen) {
    if (socket !== this.#socket) return;
    socket.close();
    this.#lose(socket, wasOpen);
  }

  #stopTimers() {
    this.#clock.clearTimeout(this.#beatTimer);
    this.#clock.clearTimeout(this.#welcomeTimer);
  }

  #lose(socket, wasOpen) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    this.#isWelcome = false;
    this.#isQuiet = false;
    this.#dueSince = null;
    this.#stopTimers();
    this.#dropReplaced();
    if (this.#isEnded) return;
    const retryMs = Math.max(this.#serverWaitMs, backoffMs[Math.min(this.#failures, backoffMs.length - 1)]);
    this.#failures += 1;
    this.#serverWaitMs = 0;
    this.#retryTimer = this.#clock.setTimeout(() => this.open(), retryMs);
    this.#tell('lost', { retryMs });
    if (!wasOpen) void this.#endIfGone();
  }

  /** Ends when the room is gone. Asks over HTTP, as a browser does not tell a page why a WebSocket was refused. */
  async #endIfGone() {
    if (!(await this.#isGone()) || this.#isEnded) return;
    this.close();
    this.#tell('ended', {
      reason: say.gone,
    });
  }

  #tell(type, detail) {
    this.dispatchEvent(new ConnectionEvent(type, detail));
  }
}
