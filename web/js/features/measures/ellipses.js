// Means and standard deviations of images within ellipses: asked for once an ellipse rests, the newest answer of each is kept.
import { signal } from '../../../lib/signals-core.js';

export const restMs = 120;

/** @typedef {{mean: number, sd: number, n: number}} Statistics */

export class Ellipses {
  #ask;
  #clock;
  #wanted = new Map(); // measure -> {key, timer}
  #known = signal(new Map()); // measure -> {key, statistics: Statistics|null}

  /**
   * @param {(plan: string, image: string, points: number[][]) => Promise<Statistics>} ask
   * @param {{setTimeout: Function, clearTimeout: Function}} clock
   */
  constructor(ask, clock) {
    this.#ask = ask;
    this.#clock = clock;
  }

  /**
   * Read in an effect, it is told when they come.
   * @returns {{isOld: boolean, statistics: Statistics|null}} statistics null: the server has none, or not yet; isOld: of where the ellipse was before
   */
  of(id, plan, image, points) {
    const key = JSON.stringify([plan, image, points]);
    const known = this.#known.value.get(id);
    if (known?.key !== key && this.#wanted.get(id)?.key !== key) this.#want(id, key);
    return { isOld: known?.key !== key, statistics: known?.statistics ?? null };
  }

  #want(id, key) {
    this.#clock.clearTimeout(this.#wanted.get(id)?.timer);
    this.#wanted.set(id, { key, timer: this.#clock.setTimeout(() => this.#load(id, key), restMs) });
  }

  async #load(id, key) {
    const statistics = await this.#ask(...JSON.parse(key)).catch(() => null);
    if (this.#wanted.get(id)?.key !== key) return;
    this.#wanted.delete(id);
    this.#known.value = new Map(this.#known.peek()).set(id, { key, statistics });
  }
}
