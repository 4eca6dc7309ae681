// Questions to the server about something that changes often.

const restMs = 40;
const pauseMs = 150; // between an answer and the next question: read-outs follow a drag at their own pace, pictures come first

/** Asks again whenever what it depends on has changed; while one question is under way, the changes become one. */
export class Asker {
  #ask;
  #clock;
  #isAsking = false;
  #isDue = false;
  #timer = 0;
  #isStopped = false;

  /** @param {() => Promise<unknown>} ask @param {{setTimeout: Function, clearTimeout: Function}} clock */
  constructor(ask, clock) {
    this.#ask = ask;
    this.#clock = clock;
  }

  want() {
    if (this.#isAsking) {
      this.#isDue = true;
      return;
    }
    if (!this.#timer) this.#timer = this.#clock.setTimeout(() => this.#run(), restMs);
  }

  async #run() {
    this.#timer = 0;
    this.#isAsking = true;
    await this.#ask();
    this.#isAsking = false;
    const isDue = this.#isDue;
    this.#isDue = false;
    if (isDue && !this.#isStopped) this.#timer = this.#clock.setTimeout(() => this.#run(), pauseMs);
  }

  stop() {
    this.#isStopped = true;
    this.#clock.clearTimeout(this.#timer);
  }
}
