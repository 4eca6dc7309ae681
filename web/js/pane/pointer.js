// Reads mouse, pen and touch on a picture and reports drags, taps, long presses, wheel steps, pinches and the pointer at rest.
import { boxOf, placeOf } from '../parts/page_look.js';

const slopPx = 4; // a press that moves less is a tap
// A tap is reported once it is known not to be the first of two: what a double tap does must not move anything before.
const doubleMs = { mouse: 250, pen: 300, touch: 300 };
const doublePx = 24;
const longMs = 500;
const notchFrom = 40; // wheelDeltaY of a notch: 120 at 100 %, by the zoom less in Chromium, as deltaY is
const turnMs = 200; // a pause from which on a turn of the wheel, or a stroke on a trackpad, is another one
const [notchPx, notchLines] = [100, 3];
const earlyMs = 14; // a move that comes this long after the one before is not kept until the next animation frame

/**
 * @typedef {object} PointerHandlers each gets CSS pixels relative to the element, and at: time of the input event
 * @property {(mode: 'primary'|'pan'|'zoom'|'roll', at: {x: number, y: number}) => void} start
 * @property {(mode: string, move: {x: number, y: number, dx: number, dy: number, alt: boolean, at: number}) => void} move
 * @property {(mode: string) => void} end
 * @property {(tap: {x: number, y: number, shift: boolean, alt: boolean, at: number}) => void} tap
 * @property {(tap: {x: number, y: number, touch: boolean, at: number}) => void} doubleTap
 * @property {(press: {x: number, y: number, at: number}) => void} longPress
 * @property {(hover: {x: number, y: number, shift: boolean, alt: boolean, at: number}) => void} hover a mouse or pen that moves with nothing pressed
 * @property {() => void} leave
 * @property {(wheel: {x: number, y: number, steps: number, ctrl: boolean, at: number}) => void} wheel
 * @property {(pinch: {x: number, y: number, dx: number, dy: number, factor: number, at: number}) => void} pinch
 */
export class PointerReader {
  #element;
  #handlers;
  #fingers = new Map();
  #mode = null;
  #start = null;
  #isDrag = false;
  #isStartDue = false; // the start of a touch drag waits, as a second finger makes it a pinch
  #waiting = null; // a tap that may be the first of two
  #isSecond = false; // the press may be the second of two
  #tapTimer = 0;
  #longTimer = 0;
  #wheelRest = 0;
  #wheelAt = -Infinity;
  #notch = 0; // wheelDeltaY of one notch in this turn; 0: of a trackpad
  #movedAt = -Infinity;
  #abort = new AbortController();

  /** @param {HTMLElement} element @param {PointerHandlers} handlers */
  constructor(element, handlers) {
    this.#element = element;
    this.#handlers = handlers;
    const on = (type, handler, options) => element.addEventListener(type, handler, { signal: this.#abort.signal, ...options });
    on('pointerdown', (event) => this.#down(event));
    on('pointermove', (event) => this.#move(event));
    on('pointerrawupdate', (event) => {
      if (this.#isDrag && this.#fingers.size === 1 && event.timeStamp - this.#movedAt >= earlyMs) this.#move(event);
    });
    on('pointerup', (event) => this.#up(event));
    on('pointercancel', (event) => this.#up(event, true));
    on('pointerleave', () => this.#fingers.size || this.#handlers.leave());
    on('wheel', (event) => this.#wheel(event), { passive: false });
    on('contextmenu', (event) => event.preventDefault());
  }

  stop() {
    clearTimeout(this.#longTimer);
    clearTimeout(this.#tapTimer);
    this.#abort.abort();
  }

  #point(event) {
    const box = boxOf(this.#element);
    const { x, y } = placeOf(event);
    return { x: x - box.left, y: y - box.top };
  }

  #down(event) {
    if (event.button === 1) event.preventDefault(); // stops the browser's automatic scrolling
    const point = this.#point(event);
    this.#fingers.set(event.pointerId, point);
    this.#element.setPointerCapture(event.pointerId);
    this.#element.focus({ preventScroll: true });
    clearTimeout(this.#longTimer);
    clearTimeout(this.#tapTimer);
    if (this.#fingers.size > 1) {
      this.#waiting = null;
      this.#isDrag = true;
      this.#isStartDue = false;
      this.#mode = 'pinch';
      return;
    }
    this.#isDrag = false;
    this.#isSecond = this.#waiting !== null && Math.hypot(point.x - this.#waiting.x, point.y - this.#waiting.y) < doublePx;
    if (!this.#isSecond) this.#settle();
    this.#start = { ...point, shift: event.shiftKey, at: event.timeStamp };
    const isRight = event.button === 2 || (event.button === 0 && event.ctrlKey);
    this.#mode =
      event.button === 0 && event.ctrlKey && event.shiftKey
        ? 'roll'
        : isRight
          ? 'zoom'
          : event.button === 1 || event.shiftKey
            ? 'pan'
            : 'primary';
    this.#isStartDue = true;
    if (event.pointerType === 'touch') this.#longTimer = setTimeout(() => this.#long(event.timeStamp), longMs);
    else this.#begin(point);
  }

  #begin(point) {
    if (!this.#isStartDue) return;
    this.#isStartDue = false;
    this.#handlers.start(this.#mode, point);
  }

  #long(at) {
    if (this.#isDrag || this.#fingers.size !== 1) return;
    this.#settle();
    this.#isDrag = true; // the release is not a tap
    this.#isStartDue = false;
    this.#mode = 'held';
    this.#handlers.longPress({ x: this.#start.x, y: this.#start.y, at });
  }

  #move(event) {
    const before = this.#fingers.get(event.pointerId);
    const at = event.timeStamp;
    if (!before) {
      if (event.pointerType !== 'touch' && !event.buttons)
        this.#handlers.hover({ ...this.#point(event), shift: event.shiftKey, alt: event.altKey, at });
      return;
    }
    const point = this.#point(event);
    if (this.#mode === 'pinch') {
      const other = [...this.#fingers].find(([id]) => id !== event.pointerId)?.[1];
      this.#fingers.set(event.pointerId, point);
      if (other) this.#pinch(before, point, other, at);
      return;
    }
    if (!this.#isDrag && Math.hypot(point.x - this.#start.x, point.y - this.#start.y) < slopPx) return;
    this.#isDrag = true;
    clearTimeout(this.#longTimer);
    this.#settle();
    if (this.#mode !== 'held') this.#begin(this.#start);
    this.#fingers.set(event.pointerId, point);
    this.#movedAt = at;
    if (point.x === before.x && point.y === before.y) return; // as the early one said
    if (this.#mode !== 'held')
      this.#handlers.move(this.#mode, { ...point, dx: point.x - before.x, dy: point.y - before.y, alt: event.altKey, at });
  }

  #pinch(before, point, other, at) {
    const apart = (a) => Math.max(Math.hypot(a.x - other.x, a.y - other.y), 10);
    const middle = (a) => ({ x: (a.x + other.x) / 2, y: (a.y + other.y) / 2 });
    const from = middle(before);
    const to = middle(point);
    this.#handlers.pinch({ ...to, dx: to.x - from.x, dy: to.y - from.y, factor: apart(point) / apart(before), at });
  }

  #up(event, isCancelled = false) {
    if (!this.#fingers.delete(event.pointerId)) return;
    clearTimeout(this.#longTimer);
    if (this.#fingers.size) {
      this.#mode = 'held'; // after a pinch the remaining finger does nothing
      return;
    }
    const point = this.#point(event);
    const at = event.timeStamp;
    const mode = this.#mode;
    this.#mode = null;
    if (mode !== 'held' && mode !== 'pinch') this.#handlers.end(mode);
    if (this.#isDrag || isCancelled || event.button > 0) return;
    this.#begin(point);
    const isTouch = event.pointerType === 'touch';
    if (this.#isSecond) {
      this.#waiting = null;
      this.#handlers.doubleTap({ ...point, touch: isTouch, at });
      return;
    }
    this.#waiting = { ...point, shift: this.#start.shift, alt: event.altKey };
    const waitMs = doubleMs[event.pointerType] ?? doubleMs.mouse;
    if (at - this.#start.at > waitMs)
      this.#settle(); // nobody begins a double click that slowly
    else this.#tapTimer = setTimeout(() => this.#settle(), waitMs);
  }

  /** Reports the tap that waited for a second one. */
  #settle() {
    clearTimeout(this.#tapTimer);
    const tap = this.#waiting;
    this.#waiting = null;
    this.#isSecond = false;
    if (tap) this.#handlers.tap({ ...tap, at: performance.now() }); // the wait is no delay of the picture
  }

  /**
   * The notches of a wheel; else, of a trackpad, their like in px. No measure of a notch is the same in all browsers, systems and zooms, but the first event of
   * a turn is one notch, while a trackpad begins with less. That of a Mac tells three times its px.
   */
  #notches({ deltaMode, deltaY, wheelDeltaY, timeStamp }) {
    const turned = Math.abs(wheelDeltaY || 0);
    if (timeStamp - this.#wheelAt > turnMs)
      this.#notch = turned >= notchFrom && (deltaMode || turned !== Math.abs(3 * deltaY)) ? turned : 0;
    this.#wheelAt = timeStamp;
    const n = this.#notch && turned / this.#notch;
    const isWhole = n > 0.98 && Math.abs(n - Math.round(n)) < 0.02;
    if (!isWhole) return deltaY / [notchPx, notchLines, 1][deltaMode || 0];
    this.#wheelRest = 0; // of a trackpad
    return Math.sign(deltaY) * Math.round(n);
  }

  #wheel(event) {
    event.preventDefault();
    // trackpads send many small deltas: reports whole steps and keeps the rest
    const notches = this.#notches(event);
    this.#wheelRest += notches;
    const steps = event.ctrlKey ? this.#wheelRest : Math.trunc(this.#wheelRest);
    if (steps === 0) return;
    this.#wheelRest -= steps;
    this.#handlers.wheel({ ...this.#point(event), steps, ctrl: event.ctrlKey, at: event.timeStamp });
  }
}
