// Where this person has the dose legend, and whether isodose lines have their values. Kept by the browser.
import { signal } from '../../../lib/signals-core.js';

const key = 'beamroom legend';
const columnFrom = 1600; // px of the window, from which on the column is offered
const places = new WeakMap(); // by the state of a page

class LegendPlace {
  #ui;
  #storage;
  #kept;

  constructor({ ui, storage }) {
    this.#ui = ui;
    this.#storage = storage;
    this.#kept = signal(read(storage));
  }

  /** True where the window has room for the column. */
  get isOffered() {
    return this.#ui.window.value.width >= columnFrom && !this.#ui.isTouch.value;
  }

  get isColumn() {
    return this.isOffered && this.#kept.value.stands === 'column';
  }

  /** True: the isodose lines in panes say their values. */
  get hasValues() {
    return this.#kept.value.values !== false;
  }

  /** @param {{stands?: 'strip'|'column', values?: boolean}} change */
  set(change) {
    this.#kept.value = { ...this.#kept.peek(), ...change };
    try {
      this.#storage?.setItem(key, JSON.stringify(this.#kept.peek()));
    } catch {
      // a browser that keeps nothing starts with the strip next time
    }
  }
}

function read(storage) {
  try {
    const { stands, values } = JSON.parse(storage?.getItem(key) ?? '{}') ?? {};
    return { stands: stands === 'column' ? stands : 'strip', values: values !== false };
  } catch {
    return {};
  }
}

/** @param {object} world that of the room page @returns {LegendPlace} */
export function legendPlace(world) {
  if (!places.has(world.ui)) places.set(world.ui, new LegendPlace(world));
  return places.get(world.ui);
}
