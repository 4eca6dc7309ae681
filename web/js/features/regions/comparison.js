// The figures of one region by every method, requested one after the other.
import { methods } from './shapes.js';

/** Requests the figures of one method after the other; starting again drops the answers of the run before. */
export class Comparison {
  #api;
  #pending = null;

  /** @param {object} api @param {import('../../../lib/signals-core.js').Signal} rows */
  constructor(api, rows) {
    this.#api = api;
    this.rows = rows;
  }

  stop() {
    this.#pending?.abort();
    this.#pending = null;
  }

  async start(plan, region, scene) {
    this.stop();
    const pending = new AbortController();
    this.#pending = pending;
    const rows = methods(scene).map((method) => ({ ...method, region: region.id }));
    this.rows.value = rows;
    for (const [i, { query }] of rows.entries()) {
      const answer = await this.#api.surface(plan, region.id, { ...query, frames: '5' }, pending.signal).then(
        (result) => ({ result }),
        (error) => ({ error: error.message }),
      );
      if (pending.signal.aborted) return;
      rows[i] = { ...rows[i], ...answer };
      this.rows.value = [...rows];
    }
  }
}
