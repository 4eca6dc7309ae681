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
    const rows = methods(scene).map((method) => ({ ...method, region: region.id }));
    this.rows.value = rows;
    for (const [i, { query }] of rows.entries()) {
      const answer = await this.#api.surface(plan, region.id, { ...query, frames: '5' }, asking.signal)
        .then((result) => ({ result }), (error) => ({ error: error.message }));
      if (asking.signal.aborted) return;
      rows[i] = { ...rows[i], ...answer };
      this.rows.value = [...rows];
    }
  }
}
