// Finds which visible regions cannot be shown in the chosen representation, and why. Only splines can be impossible for a region.
import { shapeQuery } from './shapes.js';

const most = 400; // answers kept; more than most plans have regions

/** The visible regions whose representation may be refused, each with the query to ask the server. */
export function inQuestion(plan, scene) {
  if (!plan || !scene) return [];
  return plan.regions
    .filter(
      ({ id, voxels }) =>
        voxels && scene.regions[id]?.visible && scene.regions[id].opacity > 0 && scene.regions[id].representation === 'nurbs',
    )
    .map(({ id }) => ({ id, query: shapeQuery(scene, 'nurbs') }));
}

/** Asks the server about one region after the other; the same question only once. */
export class Refusals {
  #api;
  #known = new Map(); // question -> '' or the reason
  #pending = null;

  /** @param {object} api @param {import('../../../lib/signals-core.js').Signal<Record<string, string>>} reasons by region; only refused ones */
  constructor(api, reasons) {
    this.#api = api;
    this.reasons = reasons;
  }

  stop() {
    this.#pending?.abort();
    this.#pending = null;
  }

  /** @param {string} plan @param {{id: string, query: Record<string, string>}[]} questions */
  async ask(plan, questions) {
    this.stop();
    const pending = new AbortController();
    this.#pending = pending;
    const key = ({ id, query }) => JSON.stringify([plan, id, query]);
    const tell = () => {
      this.reasons.value = Object.fromEntries(
        questions.flatMap((question) => (this.#known.get(key(question)) ? [[question.id, this.#known.get(key(question))]] : [])),
      );
    };
    tell();
    for (const question of questions) {
      if (this.#known.has(key(question))) continue;
      try {
        await this.#api.surface(plan, question.id, question.query, pending.signal);
        this.#keep(key(question), '');
      } catch (error) {
        if (pending.signal.aborted) return;
        if (error.status !== 422) continue; // busy, or gone: that says nothing about the region
        this.#keep(key(question), error.message);
      }
      if (pending.signal.aborted) return;
      tell();
    }
  }

  #keep(key, reason) {
    if (this.#known.size >= most) this.#known.delete(this.#known.keys().next().value);
    this.#known.set(key, reason);
  }
}
