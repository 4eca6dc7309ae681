// The name under which the person at this browser appears in rooms: asked for once, kept by the browser.
import { signal } from '../../lib/signals-core.js';

const key = 'beamroom name';
export const maxName = 40; // as in the message hello

/** @param {string} text @returns {string} without spaces around it, control characters, or what is too long */
const tidy = (text) => [...text.replace(/[\s\p{C}]+/gu, ' ').trim()].slice(0, maxName).join('').trim();

export class OwnName {
  #storage;

  /** @param {{getItem: Function, setItem: Function}|null} storage null where the browser keeps nothing */
  constructor(storage) {
    this.#storage = storage;
    const kept = this.#read();
    this.value = signal(tidy(kept ?? '')); // '': the server chooses one
    this.isAsked = signal(kept === null); // true until there was an answer, which may be none
    this.isFixed = signal(false); // the name of who signed in
  }

  /** @param {string} text '' leaves the choice to the server, and is an answer too */
  set(text) {
    this.value.value = tidy(text);
    this.isAsked.value = false;
    try {
      this.#storage?.setItem(key, this.value.value);
    } catch {
      // a browser that keeps nothing asks again next time
    }
  }

  #read() {
    try {
      return this.#storage?.getItem(key) ?? null;
    } catch {
      return null;
    }
  }
}
