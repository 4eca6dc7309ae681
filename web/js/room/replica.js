// A local copy of a document on the server. Own changes show at once, before the server has answered; the server's order
// of changes decides in the end.
import { joinPatches, mergePatch } from '../wire/merge.js';

export class Replica {
  #base;
  #sent = []; // {input, patch}, oldest first: sent and not yet answered
  #queued = null; // one patch, to be sent with the next animation frame
  #value;

  constructor(base = {}) {
    this.reset(base);
  }

  /** The document to show: the server's, with our own pending changes applied. */
  get value() {
    return this.#value;
  }

  /** The server's document. */
  get base() {
    return this.#base;
  }

  get isPending() {
    return this.#queued !== null || this.#sent.length > 0;
  }

  /** The change that is still to be sent; null: none. */
  get queued() {
    return this.#queued;
  }

  /** Applies a change at once and queues it for sending. */
  queue(patch) {
    this.#queued = this.#queued ? joinPatches(this.#queued, patch) : patch;
    this.#value = mergePatch(this.#value, patch);
  }

  /** Takes the queued change for sending, under this input number; null when there is none. */
  take(input) {
    const patch = this.#queued;
    this.#queued = null;
    if (patch) this.#sent.push({ input, patch });
    return patch;
  }

  /** Applies a patch the server accepted: ours (input is its number) or another member's. */
  accept(patch, input = 0) {
    this.#base = mergePatch(this.#base, patch);
    this.#sent = this.#sent.filter((entry) => entry.input !== input);
    this.#rebase();
  }

  /** Takes the whole document from the server; pending changes of ours come after it. */
  replace(base) {
    this.#base = base;
    this.#rebase();
  }

  /** Drops pending changes up to input: a picture shows them, so the server's document has them. */
  settle(input) {
    const done = this.#sent.filter((entry) => entry.input <= input);
    if (done.length === 0) return;
    for (const { patch } of done) this.#base = mergePatch(this.#base, patch);
    this.#sent = this.#sent.filter((entry) => entry.input > input);
    this.#rebase();
  }

  /** Drops a change the server refused: the old value shows again. */
  refuse(input) {
    this.#sent = this.#sent.filter((entry) => entry.input !== input);
    this.#rebase();
  }

  /**
   * After a lost connection: queues again what was sent and not answered, before what is queued. The server may have applied
   * it; a merge patch that is applied twice changes nothing more. Returns whether anything is queued.
   */
  recall() {
    const patches = [...this.#sent.map(({ patch }) => patch), ...(this.#queued ? [this.#queued] : [])];
    this.#sent = [];
    this.#queued = patches.length ? patches.reduce(joinPatches) : null;
    return this.#queued !== null;
  }

  /** Starts from a document with nothing pending. */
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
