// Small pictures of loaded plans for the list. A plan is never loaded for one. They are kept as long as the tab is open, and never
// written to the disk of this computer: they show patients.
import { signal } from '../../../lib/signals-core.js';

const most = 60; // pictures kept

/** Key of a picture: a plan's default scene changes only with its files. */
const keyOf = (plan) => `${plan.id} ${plan.n_bytes}`;

export class Thumbnails {
  #api;
  #makeUrl;
  #dropUrl;
  #isRunning = false;
  #refused = new Set(); // keys of loaded plans whose picture was refused; asked for again after they were closed
  #urls = new Map(); // in order of their making

  /** @param {object} api @param {{createObjectURL: Function, revokeObjectURL: Function}} urls */
  constructor(api, urls) {
    this.#api = api;
    this.#makeUrl = (blob) => urls.createObjectURL(blob);
    this.#dropUrl = (url) => urls.revokeObjectURL(url);
    this.urls = signal({}); // by plan's key
  }

  /** @returns {string} '' while there is none */
  of(plan) {
    return this.urls.value[keyOf(plan)] ?? '';
  }

  /** Makes the pictures that are missing, one after the other. @param {{id: string, state: string, n_bytes: number}[]} plans */
  async update(plans) {
    for (const plan of plans) if (plan.state !== 'ready') this.#refused.delete(keyOf(plan));
    if (this.#isRunning) return;
    this.#isRunning = true;
    for (const plan of plans) {
      const key = keyOf(plan);
      if (plan.state !== 'ready' || this.#urls.has(key) || this.#refused.has(key)) continue;
      try {
        this.#keep(key, this.#makeUrl(await this.#api.thumbnail(plan.id)));
      } catch {
        this.#refused.add(key); // the list shows an icon instead
      }
    }
    this.#isRunning = false;
  }

  #keep(key, url) {
    this.#urls.set(key, url);
    for (const [old, oldUrl] of this.#urls) {
      if (this.#urls.size <= most) break;
      this.#urls.delete(old);
      this.#dropUrl(oldUrl);
    }
    this.urls.value = Object.fromEntries(this.#urls);
  }
}
