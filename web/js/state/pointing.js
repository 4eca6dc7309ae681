// Sends where this person points: at most one message every 33 ms, the newest place always; in 3-D of what is seen there, one question at a time.

export const everyMs = 33; // as the server passes on

export class Pointing {
  #pointers;
  #clock;
  #sentAt = -Infinity;
  #timer = 0;
  #waiting = null; // {view, point}
  #isAsking = false;
  #next = null; // the newest place that is to be asked about: {view, ask}

  /** @param {import('./pointers.js').Pointers} pointers @param {{now, setTimeout, clearTimeout}} clock */
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
    if (this.#timer) return;
    const waitMs = this.#sentAt + everyMs - this.#clock.now();
    if (waitMs <= 0) this.#flush();
    else this.#timer = this.#clock.setTimeout(() => this.#flush(), waitMs);
  }

  #flush() {
    const { view, point } = this.#waiting;
    this.#timer = 0;
    this.#sentAt = this.#clock.now();
    this.#pointers.point(view, point);
  }
}
