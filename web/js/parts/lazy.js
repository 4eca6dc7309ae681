// Parts of the page that are loaded when they are first drawn, so that they do not weigh on a first visit.
import { html } from '../../lib/lit-html.js';
import { signal } from '../../lib/signals-core.js';
import { scaleConditions } from './page_look.js';
import { say } from './words.js';

/** @template T */
export class Lazy {
  #load;
  #loading = null; // the promise of an attempt that goes on
  #error = signal(false);

  /** @param {() => Promise<T>} load imports the module, and makes of it what is drawn */
  constructor(load) {
    this.#load = load;
    this.loaded = signal(null); // T; null: not yet
  }

  /** The template of the loaded part; until then, and when it could not be loaded, one that says so. Reactive: an effect that reads this runs again when it loads. @param {(loaded: T) => unknown} use */
  draw(use) {
    if (this.loaded.value) return use(this.loaded.value);
    if (this.#error.value)
      return html`<p class="empty" role="alert">${say.notLoaded} <button class="link" @click=${() => {
        this.#error.value = false;
      }}>${say.tryAgain}</button></p>`;
    this.load();
    return html`<p class="empty">${say.loading}</p>`;
  }

  /** Loads it before it is drawn; resolves when it is there, or cannot be loaded, whoever asked for it first. */
  load() {
    if (!this.loaded.peek()) this.#loading ??= this.#attempt();
    return this.#loading;
  }

  async #attempt() {
    try {
      this.loaded.value = await this.#load();
    } catch {
      this.#error.value = true;
    }
    this.#loading = null;
  }
}

/** A module that is loaded with its style sheets when it is first drawn or known. @param {() => Promise<object>} load imports it @param {string[]} sheets */
export const later = (load, ...sheets) => new Lazy(async () => (await Promise.all([load(), ...sheets.map(styled)]))[0]);

/** The loaded module; until it is there null, and loads it. */
export function known(lazy) {
  const module = lazy.loaded.value;
  if (!module) lazy.load();
  return module;
}

const forwarded = ['layer', 'lines', 'head', 'key', 'start', 'move', 'end', 'tap', 'doubleTap', 'hover'];

/**
 * The part of a feature in a pane (PanePart of features/index.js), made when there is something for it; until then it draws and takes nothing.
 * @template T @param {() => boolean} isNeeded reactive @param {Lazy<T>} code @param {(loaded: T) => object} make
 */
export function laterPart(isNeeded, code, make) {
  let part = null;
  const made = () => {
    if (!part && isNeeded()) {
      const module = known(code);
      part = module && make(module);
    }
    return part;
  };
  return Object.fromEntries(forwarded.map((name) => [name, (...args) => made()?.[name]?.(...args)]));
}

/** Adds a style sheet to the page, once; resolves when it is there. @param {string} sheet "js/parts/fields.css" */
export async function styled(sheet) {
  const href = `/${sheet}`;
  const known = document.querySelector(`link[href="${href}"]`);
  if (known?.sheet) return;
  const link = known ?? Object.assign(document.createElement('link'), { rel: 'stylesheet', href });
  await new Promise((done, failed) => {
    link.addEventListener('load', done);
    link.addEventListener('error', () => {
      link.remove();
      failed(new Error(href));
    });
    if (!known) document.head.append(link);
  });
  scaleConditions(link.sheet);
}
