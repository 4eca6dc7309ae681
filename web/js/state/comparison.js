// The figures of every method for one region, asked for one after the other.
import { methods } from './shapes.js';

/** Asks for one method after the other; what a newer question replaces is dropped. */
export class Comparison {
  #api;
  #asking = null;

  /** @param {object} api @param {import('../../lib/signals-core.js').Signal} rows */
  constructor(api, rows) {
    this.#api = api;
    this.rows = rows;
  }

  stop() {
    this.#asking?.abort();
    this.#asking = null;
  }

  async start(plan, region, scene) {
    this.stop();
    const asking = new AbortController();
    this.#asking = asking;
    this.rows.value = methods(scene).map((method) => ({ ...method, region: region.id }));
    for (const [i, { query }] of this.rows.value.entries()) {
      const answer = await this.#api.surface(plan, region.id, { ...query, frames: '5' }, asking.signal)
        .then((result) => ({ result }), (error) => ({ error: error.message }));
      if (asking.signal.aborted) return;
      this.rows.value = this.rows.value.map((row, n) => (n === i ? { ...row, ...answer } : row));
    }
  }
}
