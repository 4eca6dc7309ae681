// Facts at the place where the pointer rests in one pane: asks for them, one question at a time, and keeps the newest answer.
import { signal } from '../../lib/signals-core.js';

export const restMs = 150;
export const shownMs = 3000; // after the pointer's last move
const slackPx = 3;

const browserClock = { setTimeout: (callback, ms) => setTimeout(callback, ms), clearTimeout: (timer) => clearTimeout(timer) };

export class Pointed {
  #ask;
  #clock;
  #place = null; // where the pointer is; null: not over the picture, or pressed
  #timer = 0;
  #end = 0; // timer; 0: nothing is shown of this rest
  #left = null; // where the card has gone from under a pointer that rests
  #isAsking = false;
  #isDue = false;
  #picture = ''; // names the picture that the facts are of

  /**
   * @param {(x: number, y: number) => Promise<object|null>} ask the facts at a place, CSS px in the picture; null: none
   * @param {{setTimeout: Function, clearTimeout: Function}} clock
   */
  constructor(ask, clock = browserClock) {
    this.#ask = ask;
    this.#clock = clock;
    this.shown = signal(null); // {x, y, isHeld, facts}
  }

  /** The pointer has moved, with nothing pressed. */
  hover(x, y) {
    const shown = this.shown.peek();
    const isHere = shown && Math.hypot(x - shown.x, y - shown.y) <= slackPx;
    if (isHere || (this.#left && Math.hypot(x - this.#left.x, y - this.#left.y) <= slackPx)) return;
    this.hide();
    this.#place = { x, y };
    this.#wait();
  }

  /** Shows facts at a place until hide() is called. */
  hold(x, y, facts) {
    this.hide();
    this.shown.value = { x, y, isHeld: true, facts };
  }

  hide() {
    this.#clock.clearTimeout(this.#timer);
    this.#clock.clearTimeout(this.#end);
    this.#end = 0;
    this.#left = null;
    this.#place = null;
    this.#isDue = false;
    if (this.shown.peek()) this.shown.value = null;
  }

  /** Another picture may be on the screen: facts of an older one are taken away, and asked again once it rests. */
  picture(name) {
    if (name === this.#picture) return;
    this.#picture = name;
    if (!this.#place) return;
    this.shown.value = null;
    this.#wait();
  }

  /** A pointer that only lies there asks for nothing more until it moves. */
  #leave() {
    const place = this.#place;
    this.hide();
    this.#left = place;
  }

  #wait() {
    this.#clock.clearTimeout(this.#timer);
    this.#timer = this.#clock.setTimeout(() => this.#rest(), restMs);
  }

  async #rest() {
    if (this.#isAsking) {
      this.#isDue = true;
      return;
    }
    const place = this.#place;
    const picture = this.#picture;
    this.#isAsking = true;
    const facts = await this.#ask(place.x, place.y).catch(() => null); // the pointer is no command: nobody waits for this
    this.#isAsking = false;
    if (this.#isDue) {
      this.#isDue = false;
      if (this.#place) this.#rest();
    } else if (place === this.#place && picture === this.#picture && facts) {
      this.shown.value = { ...place, isHeld: false, facts };
      this.#end ||= this.#clock.setTimeout(() => this.#leave(), shownMs); // not anew for another picture: that may be the presenter's
    }
  }
}
