// A document that lives on the server and is changed here at once: own changes show before the server has answered, and the
// server's order wins in the end.
import { joinPatches, mergePatch } from '../wire/merge.js';

export class Replica {
  #base;
  #sent = []; // {input, patch}, oldest first: on the way, not yet answered
  #queued = null; // one patch that waits for the next animation frame
  #value;

  constructor(base = {}) {
    this.reset(base);
  }

  /** What to show: the server's document with everything of ours that is under way. */
  get value() {
    return this.#value;
  }

  get isPending() {
    return this.#queued !== null || this.#sent.length > 0;
  }

  /** Shows a change now; it waits to be sent. */
  queue(patch) {
    this.#queued = this.#queued ? joinPatches(this.#queued, patch) : patch;
    this.#value = mergePatch(this.#value, patch);
  }

  /** The change to send, from now on known by its input number; null when nothing waits. */
  take(input) {
    const patch = this.#queued;
    this.#queued = null;
    if (patch) this.#sent.push({ input, patch });
    return patch;
  }

  /** The server accepted a patch, ours (then input is its number) or somebody else's. */
  accept(patch, input = 0) {
    this.#base = mergePatch(this.#base, patch);
    this.#sent = this.#sent.filter((entry) => entry.input !== input);
    this.#rebase();
  }

  /** The server tells the whole document; what is still under way will come after it. */
  replace(base) {
    this.#base = base;
    this.#rebase();
  }

  /** A picture shows our changes up to input: they are in the server's document now. */
  settle(input) {
    const done = this.#sent.filter((entry) => entry.input <= input);
    if (done.length === 0) return;
    for (const { patch } of done) this.#base = mergePatch(this.#base, patch);
    this.#sent = this.#sent.filter((entry) => entry.input > input);
    this.#rebase();
  }

  /** The server refused our change: the old value comes back. */
  refuse(input) {
    this.#sent = this.#sent.filter((entry) => entry.input !== input);
    this.#rebase();
  }

  /** A fresh start: nothing is under way. */
  reset(base) {
    this.#base = base;
    this.#sent = [];
    this.#queued = null;
    this.#rebase();
  }

  #rebase() {
    let value = this.#base;
    for (const { patch } of this.#sent) value = mergePatch(value, patch);
    this.#value = this.#queued ? mergePatch(value, this.#queued) : value;
  }
}
