// Handlers that see a pane's input before the pane and draw into it: the chosen tool if it is loaded later, as "Move beam", and that of panes along a beam (beam_panes.js).
import { signal } from '../../lib/signals-core.js';
import { features } from '../features/index.js';

/**
 * Each event is as in pointer.js; a handler that returns true has used it, and the pane does nothing.
 * @typedef {object} PaneHandler
 * @property {(mode: string, at: object) => boolean} [start] @property {(mode: string, move: object) => boolean} [move] @property {() => boolean} [end] also of a drag that was not taken
 * @property {(tap: object) => boolean} [tap] @property {(tap: object) => boolean} [doubleTap] @property {(press: object) => boolean} [longPress] @property {(hover: object) => boolean} [hover]
 * @property {(wheel: object) => boolean} [wheel] @property {(pinch: object) => boolean} [pinch]
 * @property {(event: KeyboardEvent, at: number) => (() => void)|null} [key] what the key does
 * @property {(at: number) => boolean} [reset] @property {(steps: number, at: number) => boolean} [stepSlice] @property {(mm: number, at: number) => boolean} [setSlice]
 * @property {(place: {header: object|null, box: object, pane: number[]}) => {where?: string, head?: unknown, overlay?: unknown, handles?: unknown, slider?: unknown, foot?: unknown}} [draw]
 *   overlay: SVG above the picture, CSS px of the pane; handles: HTML above that; header: of the picture on the screen
 */

const makers = signal(new Map()); // of tools, by name
/** The part of a feature for panes of this kind; undefined: none. */
const ofKind = (kind) => features.find(({ panesOf }) => panesOf?.has(kind))?.panesOf;

/**
 * Adds a tool: while ui.tool is its name, it takes part in panes of every kind.
 * @param {string} name @param {(pane: {room, ui, api, view, actions: import('./pane_actions.js').PaneActions}) => PaneHandler} make called once for each pane
 */
export function addTool(name, make) {
  makers.value = new Map(makers.peek()).set(name, make);
}

const isPrimary = (name, [first]) => (name === 'tap' ? !first.shift : ['start', 'move'].includes(name) && first === 'primary');

export class PaneTools {
  #pane;
  #parts;
  #made = new Map();
  #isLost = false; // the drag began before its tool was loaded

  /** @param {object} pane {room, ui, api, view, actions} @param {PaneHandler[]} parts of the features, which are asked last */
  constructor(pane, parts) {
    this.#pane = pane;
    this.#parts = parts;
  }

  #of(name, make) {
    if (make && !this.#made.has(name)) this.#made.set(name, make(this.#pane));
    return this.#made.get(name);
  }

  /** The handlers, in the order in which they are asked. Reactive: an effect that reads this runs again when one is loaded. @returns {PaneHandler[]} */
  get #handlers() {
    const { ui, view } = this.#pane;
    const tool = ui.tool.value;
    const kind = ofKind(view.kind)?.code.loaded.value?.makePane;
    return [this.#of(tool, makers.value.get(tool)), this.#of('kind', kind || null)].filter(Boolean);
  }

  /** A view whose camera is locked is moved by nobody until that is loaded. */
  get #isWaiting() {
    const { kind } = this.#pane.view;
    const own = ofKind(kind);
    return own?.isLocked(kind) && !own.code.loaded.peek();
  }

  /** True for what is meant for a tool that is not loaded yet, to the end of the drag: another tool must not act in its place. */
  #isForLater(name, args) {
    if (!isPrimary(name, args)) return false;
    const tool = this.#pane.ui.tool.peek();
    const isComing = !makers.peek().has(tool) && features.some(({ lateTools }) => lateTools?.includes(tool));
    if (name === 'start') this.#isLost = isComing;
    return isComing || (name === 'move' && this.#isLost);
  }

  /** Offers an event. Returns whether it was used; in a view whose camera is locked it always is until that is loaded. */
  take(name, ...args) {
    if (this.#isForLater(name, args)) return true;
    const isTaken = (handler) => handler[name]?.(...args);
    return this.#handlers.some(isTaken) || this.#isWaiting || this.#parts.some(isTaken);
  }

  /** Ends a drag, also one that none of them had taken. */
  end(at) {
    this.#handlers.some((handler) => handler.end?.());
    for (const part of this.#parts) part.end?.(at);
  }

  key(event, at) {
    for (const handler of [...this.#handlers, ...this.#parts]) {
      const act = handler.key?.(event, at);
      if (act) return act;
    }
    return null;
  }

  /** Drawings of the handlers in the pane. */
  draw(place) {
    if (this.#pane.view.isOpen.value) ofKind(this.#pane.view.kind)?.code.load();
    const drawn = this.#handlers.map((handler) => handler.draw?.(place) ?? {});
    return { ...Object.assign({}, ...drawn), overlay: drawn.map(({ overlay }) => overlay), handles: drawn.map(({ handles }) => handles) };
  }
}
