// When panels are drawn again while something is dragged: the pane in which it is, once per animation frame, after the pictures that are painted in it;
// any other pane with its next picture, or soon without one; what is around the panes ten times a second, and marked as pending (js/shell/room.css); a hidden
// pane afterwards. At rest everything is drawn at once.
// While pictures follow one another in that pane, those of the other panes, which come one by one behind them, share a frame, and what an input changes in
// the pane meanwhile is drawn in it, too: a frame costs the browser more than what is drawn in it, and the pane's next picture waits for each.
import { batch } from '../../lib/signals-core.js';

const pictureMs = 40; // another pane waits at most this long for its picture
const flowMs = 100; // pictures follow one another when the last came this recently
const gatherMs = 25; // how long the other panes' pictures wait then for one another
const slowMs = 100;
const earlyMs = 30; // panels around the panes may be drawn this much early in a frame without pictures: pictures must not wait for them
const enoughMs = 2; // of drawing in a frame, after which no further panel around the panes is begun in it

export class Redraw {
  #requestFrame;
  #clock;
  #callbacks = [];
  #isRequested = false;
  #inFrame = new Set(); // ticks to be set in the next frame
  #withPicture = new Map(); // tick -> {pane, at: time from which it is set without a picture}
  #painted = new Set(); // panes with a new picture in this frame
  #gathered = []; // callbacks that paint other panes' pictures
  #gatheredAt = Infinity; // time from which they are called
  #flowedAt = -Infinity; // when a picture came for the pane in which something is dragged
  #slow = new Map(); // tick -> time from which it may be set
  #atRest = new Set();
  #pending = new Set(); // elements marked as pending
  #lastAt = new WeakMap(); // tick of a slow panel -> when it was drawn last
  #timer = 0;
  #timerAt = 0;
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

  /** Schedules the painting of a picture in a pane, perhaps some milliseconds later. */
  schedulePicture(pane, callback) {
    const isHere = this.#isDragging && pane.contains(this.#pressed);
    if (isHere) this.#flowedAt = this.#clock.now();
    if (isHere || !this.#isFlowing) return this.schedule(callback);
    this.#gathered.push(callback);
    this.#gatheredAt = Math.min(this.#gatheredAt, this.#clock.now() + gatherMs);
    this.#wake();
  }

  get #isFlowing() {
    return this.#isDragging && this.#clock.now() - this.#flowedAt < flowMs;
  }

  /** Whether this part of the page is to be drawn later; tick is set then. @param {HTMLElement} host @param {import('../../lib/signals-core.js').Signal} tick */
  puts(host, tick) {
    if (!this.#isDragging) return false;
    const pane = host.closest('.pane');
    const isHere = (pane ?? host).contains(this.#pressed);
    if (pane?.hidden) this.#atRest.add(tick);
    else if (this.#painted.has(pane) || (isHere && !this.#gathered.length)) {
      this.#inFrame.add(tick);
      this.#request();
    } else if (pane) {
      this.#withPicture.set(tick, { pane, at: isHere ? this.#gatheredAt : this.#clock.now() + pictureMs });
      this.#wake();
    } else this.#putSlow(host, tick);
    return true;
  }

  /** To be called when a picture is painted in a pane, in a callback of schedulePicture(). */
  painted(pane) {
    if (!this.#isDragging) return;
    this.#painted.add(pane);
    for (const [tick, { pane: of }] of this.#withPicture) if (of === pane) this.#inFrame.add(tick);
  }

  /** Reads from the page when something is dragged in it. @param {EventTarget} target the window @returns {() => void} stops */
  watch(target) {
    const abort = new AbortController();
    const on = (type, act) => target.addEventListener(type, act, { signal: abort.signal, capture: true, passive: true });
    on('pointerdown', (event) => {
      this.#pressed = event.target;
    });
    on('pointermove', ({ buttons }) => {
      if (!buttons) this.#end();
      else if (this.#pressed) this.#isDragging = true;
    });
    for (const type of ['pointerup', 'pointercancel']) on(type, () => this.#end());
    on('blur', (event) => {
      if (event.target === target) this.#end();
    }); // not when the focus moves within the page, as it does at a press
    return () => {
      abort.abort();
      this.#end();
    };
  }

  #end() {
    this.#pressed = null;
    if (!this.#isDragging) return;
    this.#isDragging = false;
    if (this.#gathered.length) this.#request();
    this.#callbacks.push(...this.#gathered.splice(0));
    this.#gatheredAt = Infinity;
    const ticks = new Set([...this.#inFrame, ...this.#withPicture.keys(), ...this.#slow.keys(), ...this.#atRest]);
    for (const all of [this.#inFrame, this.#withPicture, this.#slow, this.#atRest]) all.clear();
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

  /** Asks for a frame when the first of the panels that wait is due. */
  #wake() {
    const at = Math.min(this.#gatheredAt, ...this.#slow.values(), ...[...this.#withPicture.values()].map((other) => other.at));
    if (at === Infinity || (this.#timer && this.#timerAt <= at)) return;
    this.#clock.clearTimeout(this.#timer);
    this.#timerAt = at;
    this.#timer = this.#clock.setTimeout(
      () => {
        this.#timer = 0;
        const now = this.#clock.now();
        const isDue =
          this.#gatheredAt <= now ||
          [...this.#slow.values()].some((other) => other <= now) ||
          [...this.#withPicture.values()].some((other) => other.at <= now);
        if (isDue) this.#request();
        else this.#wake(); // those for which the timer was set were drawn with a picture
      },
      Math.max(0, at - this.#clock.now()),
    );
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
    if (this.#gatheredAt <= this.#clock.now()) callbacks.push(...this.#gathered.splice(0));
    if (!this.#gathered.length) this.#gatheredAt = Infinity;
    for (const callback of callbacks) {
      try {
        callback();
      } catch (error) {
        queueMicrotask(() => {
          throw error;
        }); // the others are called, and the browser tells it
      }
    }
    const now = this.#clock.now();
    for (const [tick, { at }] of this.#withPicture) if (at <= now) this.#inFrame.add(tick);
    const ticks = [...this.#inFrame];
    for (const tick of ticks) this.#withPicture.delete(tick);
    this.#inFrame.clear();
    this.#painted.clear();
    this.#set(ticks);
    this.#drawSlow(now, callbacks.length ? now : now + earlyMs);
    this.#wake();
  }

  #drawSlow(now, to) {
    for (const [tick, at] of [...this.#slow]) {
      if (at > to) continue;
      this.#slow.delete(tick);
      this.#lastAt.set(tick, now);
      this.#set([tick]);
      if (this.#clock.now() - now >= enoughMs) return;
    }
  }

  #set(ticks) {
    batch(() => {
      for (const tick of ticks) tick.value += 1;
    });
  }
}
