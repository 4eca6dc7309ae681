// Which visible regions cannot be shown in the way that was chosen, and why. Only splines are refused for what a region is like.
import { shapeQuery } from './shapes.js';

const most = 400; // answers kept, more than a plan has regions

/** The visible regions whose way of being shown may be refused, each with the question that tells. */
export function inQuestion(plan, scene) {
  if (!plan || !scene) return [];
  return plan.regions.filter(({ id, voxels }) => voxels && scene.regions[id]?.visible && scene.regions[id].opacity > 0 && scene.regions[id].representation === 'nurbs')
    .map(({ id }) => ({ id, query: shapeQuery(scene, 'nurbs') }));
}

/** Asks the server about one region after the other; each question only once. */
export class Refusals {
  #api;
  #known = new Map(); // question -> '' or the reason
  #asking = null;

  /** @param {object} api @param {import('../../lib/signals-core.js').Signal<Record<string, string>>} reasons by region, of those refused */
  constructor(api, reasons) {
    this.#api = api;
    this.reasons = reasons;
  }

  stop() {
    this.#asking?.abort();
    this.#asking = null;
  }

  /** @param {string} plan @param {{id: string, query: Record<string, string>}[]} questions */
  async ask(plan, questions) {
    this.stop();
    const asking = new AbortController();
    this.#asking = asking;
    const key = ({ id, query }) => JSON.stringify([plan, id, query]);
    const tell = () => {
      this.reasons.value = Object.fromEntries(questions.flatMap((question) => (this.#known.get(key(question)) ? [[question.id, this.#known.get(key(question))]] : [])));
    };
    tell();
    for (const question of questions) {
      if (this.#known.has(key(question))) continue;
      try {
        await this.#api.surface(plan, question.id, question.query, asking.signal);
        this.#keep(key(question), '');
      } catch (error) {
        if (asking.signal.aborted) return;
        if (error.status !== 422) continue; // busy, or gone: nothing is known of the region
        this.#keep(key(question), error.message);
      }
      if (asking.signal.aborted) return;
      tell();
    }
  }

  #keep(key, reason) {
    if (this.#known.size >= most) this.#known.delete(this.#known.keys().next().value);
    this.#known.set(key, reason);
  }
}

/** "liver and colon", "liver, colon and 21 more" */
export function nameSome(names, shown = 3) {
  if (names.length <= 1) return names[0] ?? '';
  if (names.length <= shown) return `${names.slice(0, -1).join(', ')} and ${names.at(-1)}`;
  return `${names.slice(0, shown - 1).join(', ')} and ${names.length - shown + 1} more`;
}
