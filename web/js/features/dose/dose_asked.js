// An answer of the server that is asked for again whenever what it depends on has changed: once that rests, and the newest answer wins.
import { computed, effect, signal } from '../../../lib/signals-core.js';

export const restMs = 200;

/**
 * @typedef {object} Wanted what is to be asked now
 * @property {string} key everything that the answer depends on: the same key is not asked twice
 * @property {(signal: AbortSignal) => Promise<object>} ask
 */

export class Asked {
  #clock;
  #timer = 0;
  #pending = null;
  #stop;
  #known = signal({ key: '', result: null, error: '' });

  /** @param {() => Wanted|null} wanted read in an effect; null: nothing is to be asked, and the last answer stays */
  constructor(wanted, clock) {
    this.#clock = clock;
    const now = computed(wanted);
    const key = computed(() => now.value?.key ?? '');
    /** {result, error, isOld}: isOld: of what was before, while the newer answer is still to come */
    this.state = computed(() => {
      const { key: of, result, error } = this.#known.value;
      return { result, error, isOld: key.value !== '' && key.value !== of };
    });
    this.#stop = effect(() => {
      const wantedKey = key.value;
      this.#clock.clearTimeout(this.#timer);
      this.#pending?.abort();
      this.#pending = null;
      if (!wantedKey || wantedKey === this.#known.peek().key) return;
      this.#timer = this.#clock.setTimeout(() => this.#ask(now.peek()), restMs);
    });
  }

  stop() {
    this.#stop();
    this.#clock.clearTimeout(this.#timer);
    this.#pending?.abort();
  }

  async #ask({ key, ask }) {
    this.#pending = new AbortController();
    const { signal: aborted } = this.#pending;
    const answer = await ask(aborted).then(
      (result) => ({ result, error: '' }),
      (error) => ({ result: null, error: error.message }),
    );
    if (!aborted.aborted) this.#known.value = { key, ...answer };
  }
}
