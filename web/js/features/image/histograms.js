// Histograms of the plan's images, for percentiles and for the editor of the transfer function: each is asked for once, when it is first needed.
import { signal } from '../../../lib/signals-core.js';

/** @typedef {{low: number, high: number, counts: number[], percentiles: Record<string, number>}} Histogram */

export class Histograms {
  #ask;
  #pending = new Map(); // plan and image -> Promise<Histogram|null>
  /** The answers, by plan and image; null: the server has none. */
  #known = signal(new Map());

  /** @param {(plan: string, image: string) => Promise<Histogram>} ask */
  constructor(ask) {
    this.#ask = ask;
  }

  /** The histogram as far as it is known, and asks for it when it is not. Read in an effect, it is told when it comes. @returns {Histogram|null} */
  of(plan, image) {
    const key = `${plan}/${image}`;
    const known = this.#known.value.get(key);
    if (known === undefined) this.load(plan, image);
    return known ?? null;
  }

  /** @returns {Promise<Histogram|null>} null: there is none */
  load(plan, image) {
    const key = `${plan}/${image}`;
    if (!this.#pending.has(key))
      this.#pending.set(
        key,
        this.#ask(plan, image)
          .catch(() => null)
          .then((answer) => {
            const histogram = isUsable(answer) ? answer : null;
            this.#known.value = new Map(this.#known.peek()).set(key, histogram);
            return histogram;
          }),
      );
    return this.#pending.get(key);
  }
}

const isUsable = (answer) =>
  Array.isArray(answer?.counts) && answer.counts.length > 0 && Number.isFinite(answer.low) && answer.high > answer.low;

/**
 * The threshold between the dark and the bright values of an image: where the variance between the two classes is largest, in the middle where it is so
 * in several places. N. Otsu, IEEE Trans. Syst. Man Cybern. 9 (1979) 62.
 * @param {Histogram} histogram @returns {number} the upper end of the last dark bin, to three figures
 */
export function otsu({ low, high, counts }) {
  const all = counts.reduce((sum, n) => sum + n, 0);
  const whole = counts.reduce((sum, n, bin) => sum + n * bin, 0);
  let [n, sum, most] = [0, 0, -1];
  let best = [];
  for (const [bin, count] of counts.slice(0, -1).entries()) {
    n += count;
    sum += count * bin;
    if (!n || n === all) continue;
    const between = n * (all - n) * (sum / n - (whole - sum) / (all - n)) ** 2;
    if (between > most * (1 + 1e-12)) [most, best] = [between, []];
    if (between >= most * (1 - 1e-12)) best.push(bin);
  }
  const middle = best.length ? (best[0] + best.at(-1)) / 2 : 0;
  return Number((low + ((middle + 1) * (high - low)) / counts.length).toPrecision(3));
}
