// The small picture of the presenter: in which corner it stands, whether it is folded or closed. Kept by the browser.
import { effect, signal } from '../../../lib/signals-core.js';
import { say } from './later_words.js';

const key = 'beamroom watch';
/** Clockwise. */
export const corners = ['bottom-right', 'bottom-left', 'top-left', 'top-right'];

function read(storage) {
  try {
    return JSON.parse(storage?.getItem(key) ?? '{}') ?? {};
  } catch {
    return {};
  }
}

export class Watching {
  /** @param {{getItem: Function, setItem: Function}|null} storage null where the browser keeps nothing */
  constructor(storage = null) {
    const kept = read(storage);
    this.corner = signal(corners.includes(kept.corner) ? kept.corner : ''); // '': where it hides least
    this.isFolded = signal(kept.isFolded === true);
    this.isClosed = signal(kept.isClosed === true);
    this.stop = effect(() => {
      const text = JSON.stringify({ corner: this.corner.value, isFolded: this.isFolded.value, isClosed: this.isClosed.value });
      try {
        storage?.setItem(key, text);
      } catch {
        // a browser that keeps nothing begins anew
      }
    });
  }
}

const settledMs = 600; // worked in a view for so long, it is the one that others are shown
const backMs = 2000; // not sooner back to the view before

/** Finds the view that a presenter works in: the one acted in last, once that lasts; not back and forth between two faster than others can follow. */
export class WorkedIn {
  #tell;
  #clock;
  #timer = 0;
  #told = 0; // view; 0: none
  #before = 0; // the view told before
  #toldAt = 0;
  #next = 0; // the view acted in since, which is not told yet

  /** @param {(view: number) => void} tell @param {{now: () => number, setTimeout: Function, clearTimeout: Function}} clock */
  constructor(tell, clock) {
    this.#tell = tell;
    this.#clock = clock;
  }

  /** The person acted in this view: a drag, a wheel, a key, a slider, a tap, or chose it. */
  acted(view) {
    if (!this.#told) return void this.#say(view);
    if (view === this.#next) return;
    this.#clock.clearTimeout(this.#timer);
    this.#next = view === this.#told ? 0 : view;
    if (!this.#next) return;
    const now = this.#clock.now();
    const due = view === this.#before ? Math.max(now + settledMs, this.#toldAt + backMs) : now + settledMs;
    this.#timer = this.#clock.setTimeout(() => this.#say(view), due - now);
  }

  #say(view) {
    [this.#before, this.#told, this.#next] = [this.#told, view, 0];
    this.#toldAt = this.#clock.now();
    this.#tell(view);
  }

  /** Begins anew: the next act is told at once. */
  restart() {
    this.#clock.clearTimeout(this.#timer);
    this.#told = this.#before = this.#next = 0;
  }
}

/** The presenter seen in the small picture: {name, isAway}; null: nobody, as this member follows or presents, or nobody else presents. @param {import('../../room/room.js').RoomState} room */
export function watched({ following, recording }) {
  if (following.isFollowing.value || following.isPresenting.value) return null;
  const presenter = following.presenter.value;
  if (presenter) return { name: presenter.name, isAway: presenter.connected === false };
  return recording.replay.value ? { name: say.theReplay, isAway: false } : null;
}

/**
 * Whether the picture shows what the presenter sees now, in words. Pure.
 * @param {object} of link: of the room; renderer: its state; isLate: the server says so; paintedAt: ms since 1970, 0: there is no picture yet; isAway: the presenter is
 * @returns {{state: 'wait'|'live'|'old'|'lost', text: string, why: string}}
 */
export function liveness({ link, renderer, isLate, paintedAt, isAway }) {
  if (!paintedAt) return { state: 'wait', text: say.noPicture, why: '' };
  const old = (why, state = 'old') => ({ state, text: say.old({ time: new Date(paintedAt).toLocaleTimeString('en-GB') }), why });
  if (link.state !== 'open') return old(say.lost, 'lost');
  if (link.quietSince) return old(say.noAnswer);
  if (renderer !== 'ready') return old(say.notDrawn);
  if (isLate) return old(say.notCome);
  if (isAway) return { ...old(say.isAway), text: say.away };
  return { state: 'live', text: say.live, why: '' };
}
