// The time from an input to the picture that answers it, as the status bar shows it.
import { signal } from '../../lib/signals-core.js';

const kept = 20;

export class Latency {
  #timesMs = [];
  medianMs = signal(null); // of the last 20; null before the first

  /** @param {number[]} timesMs from the input event to the painted picture */
  add(timesMs) {
    this.#timesMs = [...this.#timesMs, ...timesMs].slice(-kept);
    const sorted = [...this.#timesMs].sort((a, b) => a - b);
    const middle = (sorted.length - 1) / 2;
    this.medianMs.value = sorted.length ? Math.round((sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2) : null;
  }
}
