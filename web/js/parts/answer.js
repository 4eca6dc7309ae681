// A live answer of the server: asked for again whenever its key, everything that it depends on, changes. Debounce, abort, error and age stand here.
// Three askers are no such answers: image/histograms.js asks once for each image, room/pointed.js asks nothing while a question is on its way, and
// measures/ellipses.js asks for as many ellipses as are being drawn.
import { computed, effect, signal, untracked } from '../../lib/signals-core.js';

const [firstMs, pauseMs] = [40, 150]; // of an answer that follows: before a question, and after an answer, as pictures come first
const none = { of: '', result: null, error: '', isSettled: true };

export class Answer {
  #options;
  #known = signal(none);
  #end = null;

  /**
   * @param {object} options
   * @param {() => string} options.key reactive; '': nothing is to be asked, and the last answer stays
   * @param {(key: string, aborted: AbortSignal) => Promise<unknown>} options.ask
   * @param {{setTimeout: Function, clearTimeout: Function}} options.clock
   * @param {number|null} [options.restMs] asks once the key has rested so long, and aborts the question before; null: follows a key that keeps changing, one
   *   question at a time, and shows answers that are older meanwhile
   * @param {() => boolean} [options.isSettled] reactive; an answer from before is asked for once more when this is true
   * @param {boolean} [options.clears] without a key there is no answer
   * @param {boolean} [options.renews] asks anew when there is a key again
   * @param {boolean} [options.whileRead] asks while an effect reads state, instead of between start() and stop()
   */
  constructor({ restMs = null, isSettled = () => true, clears = false, renews = false, whileRead = false, ...options }) {
    this.#options = { restMs, isSettled, clears, renews, ...options };
    /** {result, error, isOld}: isOld: of another key, while the newer answer is still to come */
    this.state = signal(
      { result: null, error: '', isOld: false },
      whileRead ? { watched: () => this.start(), unwatched: () => this.stop() } : {},
    );
  }

  /** The key of the answer; ''. none. Reactive. */
  get of() {
    return this.#known.value.of;
  }

  /** Begins, and asks anew. @returns {() => void} stops */
  start() {
    const { key, clears } = this.#options;
    let last = '';
    const wanted = computed(() => (last = key() || (clears ? '' : last)));
    this.#known.value = { ...this.#known.peek(), of: '' };
    const stops = [effect(() => this.#show(wanted.value)), this.#options.restMs === null ? this.#follow() : this.#rest()];
    this.#end = () => stops.forEach((stop) => stop());
    return () => this.stop();
  }

  stop() {
    this.#end?.();
    this.#end = null;
  }

  /** State changes only where something of it does: those that draw it run again then. */
  #show(wanted) {
    const { of, result, error, isSettled } = this.#known.value;
    const now = { result, error, isOld: wanted !== '' && (wanted !== of || !isSettled) };
    const before = this.state.peek();
    if (Object.keys(now).some((name) => now[name] !== before[name])) this.state.value = now;
  }

  #forget() {
    if (this.#options.clears && this.#known.peek() !== none) this.#known.value = none;
  }

  async #asked(key, aborted) {
    const isSettled = untracked(this.#options.isSettled);
    const answer = await this.#options.ask(key, aborted).then(
      (result) => ({ result, error: '' }),
      (error) => ({ result: null, error: error.message }),
    );
    const isGone = this.#options.clears && !untracked(this.#options.key);
    if (!aborted.aborted && !isGone) this.#known.value = { of: key, ...answer, isSettled };
  }

  #rest() {
    const { clock, key, restMs, renews } = this.#options;
    const now = computed(key);
    let timer = 0;
    let pending = null;
    let wasNone = false;
    const ask = () => {
      pending = new AbortController();
      untracked(() => this.#asked(now.peek(), pending.signal));
    };
    const end = () => {
      clock.clearTimeout(timer);
      pending?.abort();
      pending = null;
    };
    const stop = effect(() => {
      const wanted = now.value;
      end();
      if (wanted && wasNone && renews) this.#known.value = { ...this.#known.peek(), of: '' };
      wasNone = !wanted;
      if (!wanted) this.#forget();
      else if (wanted !== this.#known.peek().of) timer = clock.setTimeout(ask, restMs);
    });
    return () => {
      stop();
      end();
    };
  }

  #follow() {
    const { clock, key, isSettled } = this.#options;
    const now = computed(key);
    const end = new AbortController(); // its answers come to nothing, and are not asked for again
    let timer = 0;
    let isAsking = false;
    let isDue = false;
    const run = async () => {
      timer = 0;
      if (!now.peek()) return;
      isAsking = true;
      await this.#asked(now.peek(), end.signal);
      isAsking = false;
      if (isDue && !end.signal.aborted) timer = clock.setTimeout(run, pauseMs);
      isDue = false;
    };
    const want = () => {
      if (isAsking) isDue = true;
      else timer ||= clock.setTimeout(run, firstMs);
    };
    const stop = effect(() => {
      const wanted = now.value;
      isSettled(); // runs again when it changes
      const { of, isSettled: isDone } = this.#known.peek();
      if (!wanted) this.#forget();
      else if (wanted !== of || !isDone) untracked(want);
    });
    return () => {
      stop();
      end.abort();
      clock.clearTimeout(timer);
    };
  }
}
