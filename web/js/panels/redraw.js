// When panels are drawn again while something is dragged: a pane once per animation frame, after the pictures that are painted in it; what is around
// the panes ten times a second, and marked as pending (css/room.css); a hidden pane afterwards. At rest everything is drawn at once.
import { batch } from '../../lib/signals-core.js';

const slowMs = 100;

export class Redraw {
  #requestFrame;
  #clock;
  #callbacks = [];
  #isRequested = false;
  #inFrame = new Set(); // ticks to be set in the next frame
  #slow = new Map(); // tick -> time from which it may be set
  #atRest = new Set();
  #pending = new Set(); // elements marked as pending
  #lastAt = new WeakMap(); // tick of a slow panel -> when it was drawn last
  #timer = 0;
  #pressed = null; // element
  #isDragging = false;

  /** @param {(callback: () => void) => void} requestFrame @param {{now, setTimeout, clearTimeout}} clock */
  constructor(requestFrame, clock) {
    this.#requestFrame = requestFrame;
    this.#clock = clock;
  }

  /** Calls back before the next paint, and before the panes are drawn for it. */
  schedule = (callback) => {
    this.#callbacks.push(callback);
    this.#request();
  };

  /** Whether this part of the page is to be drawn later; tick is set then. @param {HTMLElement} host @param {import('../../lib/signals-core.js').Signal} tick */
  puts(host, tick) {
    if (!this.#isDragging) return false;
    const pane = host.closest('.pane');
    if (pane?.hidden) this.#atRest.add(tick);
    else if (pane || host.contains(this.#pressed)) {
      this.#inFrame.add(tick);
      this.#request();
    } else this.#putSlow(host, tick);
    return true;
  }

  /** Reads from the page when something is dragged in it. @param {EventTarget} target the window @returns {() => void} stops */
  watch(target) {
    const abort = new AbortController();
    const on = (type, act) => target.addEventListener(type, act, { signal: abort.signal, capture: true, passive: true });
    on('pointerdown', (event) => { this.#pressed = event.target; });
    on('pointermove', ({ buttons }) => {
      if (!buttons) this.#end();
      else if (this.#pressed) this.#isDragging = true;
    });
    for (const type of ['pointerup', 'pointercancel']) on(type, () => this.#end());
    on('blur', (event) => { if (event.target === target) this.#end(); }); // not when the focus moves within the page, as it does at a press
    return () => {
      abort.abort();
      this.#end();
    };
  }

  #end() {
    this.#pressed = null;
    if (!this.#isDragging) return;
    this.#isDragging = false;
    const ticks = [...this.#inFrame, ...this.#slow.keys(), ...this.#atRest];
    for (const all of [this.#inFrame, this.#slow, this.#atRest]) all.clear();
    this.#set(ticks);
    for (const host of this.#pending) host.toggleAttribute('data-pending', false);
    this.#pending.clear();
  }

  #putSlow(host, tick) {
    if (!this.#pending.has(host)) {
      this.#pending.add(host);
      host.toggleAttribute('data-pending', true);
    }
    this.#slow.set(tick, (this.#lastAt.get(tick) ?? -Infinity) + slowMs);
    this.#wake();
  }

  /** Asks for a frame when the first slow panel is due. */
  #wake() {
    if (this.#timer || !this.#slow.size) return;
    const waitMs = Math.max(0, Math.min(...this.#slow.values()) - this.#clock.now());
    this.#timer = this.#clock.setTimeout(() => {
      this.#timer = 0;
      this.#request();
    }, waitMs);
  }

  #request() {
    if (this.#isRequested) return;
    this.#isRequested = true;
    this.#requestFrame(() => this.#frame());
  }

  #frame() {
    this.#isRequested = false;
    const callbacks = this.#callbacks;
    this.#callbacks = [];
    for (const callback of callbacks) {
      try {
        callback();
      } catch (error) {
        queueMicrotask(() => { throw error; }); // the others are called, and the browser tells it
      }
    }
    const ticks = [...this.#inFrame];
    this.#inFrame.clear();
    const now = this.#clock.now();
    const due = [...this.#slow].find(([, at]) => at <= now)?.[0]; // one for each frame, so that none takes long
    if (due) {
      this.#slow.delete(due);
      this.#lastAt.set(due, now);
      ticks.push(due);
    }
    this.#set(ticks);
    this.#wake();
  }

  #set(ticks) {
    batch(() => {
      for (const tick of ticks) tick.value += 1;
    });
  }
}
