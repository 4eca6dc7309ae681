// Sends where this person points: at most one message every 30 ms, the newest place always; in 3-D of what is seen there, one question at a time.

const everyMs = 30; // as the server passes on
const lastMs = 42; // what no newer place replaces is sent then: the mouse is read 60 times a second, and every second place goes at once, not a bit older by a timer

export class Pointing {
  #pointers;
  #clock;
  #sentAt = -Infinity;
  #timer = 0;
  #waiting = null; // {view, point}
  #isAsking = false;
  #next = null; // the newest place that is to be asked about: {view, ask}

  /** @param {import('../../room/pointers.js').Pointers} pointers @param {{now, setTimeout, clearTimeout}} clock */
  constructor(pointers, clock) {
    this.#pointers = pointers;
    this.#clock = clock;
  }

  /** @param {number} view @param {number[]|null} point */
  at(view, point) {
    this.#next = null;
    this.#put(view, point);
  }

  /** Points at what a question will tell. @param {() => Promise<number[]|null>} ask */
  async seen(view, ask) {
    this.#next = { view, ask };
    if (this.#isAsking) return;
    this.#isAsking = true;
    while (this.#next) {
      const asked = this.#next;
      const point = await asked.ask().catch(() => undefined); // the pointer is no command: nobody waits for this
      if (!this.#next) break; // pointed elsewhere meanwhile, or not any more
      if (this.#next === asked) this.#next = null;
      if (point !== undefined) this.#put(asked.view, point);
    }
    this.#isAsking = false;
  }

  stop() {
    this.#next = null;
    this.#put(0, null);
  }

  #put(view, point) {
    this.#waiting = { view, point };
    const sinceMs = this.#clock.now() - this.#sentAt;
    if (sinceMs >= everyMs) this.#flush();
    else this.#timer ||= this.#clock.setTimeout(() => this.#flush(), lastMs - sinceMs);
  }

  #flush() {
    const { view, point } = this.#waiting;
    this.#clock.clearTimeout(this.#timer);
    this.#timer = 0;
    this.#sentAt = this.#clock.now();
    this.#pointers.point(view, point);
  }
}
