// The figures of one region by every method, requested one after the other.
import { computed, effect, signal } from '../../../lib/signals-core.js';
import { methods } from './representations.js';

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

/** Starts the comparison when its dialog opens or, while it is open, another region is chosen. */
export function startComparison(world) {
  const { room, ui, api } = world;
  const comparison = new Comparison(api, signal([]));
  world.comparison = comparison;
  const of = computed(() => (ui.popover.value === 'figures' ? ui.region.value : ''));
  const stop = effect(() => {
    const id = of.value;
    const region = room.plan.peek()?.regions.find((other) => other.id === id);
    if (region) comparison.start(room.planId.peek(), region, room.scene.peek());
    else comparison.stop();
  });
  return () => {
    stop();
    comparison.stop();
  };
}
