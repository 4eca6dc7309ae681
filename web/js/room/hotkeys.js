// The keys of this person: which command a press gives, and what tooltips say of it. Kept by the browser. Changing them: shell/help_keys.js.
import { computed, effect, signal } from '../../lib/signals-core.js';
import { comboOf, commands, isSingle } from './commands.js';
import { say } from './words.js';

const key = 'beamroom keys';

export class Hotkeys {
  #byCombo;

  /** @param {{getItem: Function, setItem: Function}|null} storage null where the browser keeps nothing */
  constructor(storage = null) {
    const kept = read(storage);
    this.own = signal(kept.own); // by command: its key; '' none
    this.areSinglesOff = signal(kept.areSinglesOff);
    this.#byCombo = computed(() => new Map(Object.keys(commands).flatMap((id) => this.keysOf(id).map((combo) => [combo, id]))));
    effect(() => write(storage, { own: this.own.value, areSinglesOff: this.areSinglesOff.value }));
  }

  /** @param {string} id of a command @returns {string[]} also those that are off */
  keysOf(id) {
    const own = this.own.value[id];
    return own === undefined ? commands[id] : own ? [own] : [];
  }

  /** @param {KeyboardEvent} event @returns {string} '' none */
  commandOf(event) {
    const combo = comboOf(event);
    return (!this.areSinglesOff.value || !isSingle(combo)) && (this.#byCombo.value.get(combo) ?? '');
  }

  /** "W" as people read it; '' for a command without a key, and for single keys while these are off. */
  text(id) {
    const combo = this.keysOf(id).find((one) => !this.areSinglesOff.value || !isSingle(one));
    return combo ? keyText(combo) : '';
  }

  /** "Reset this view (R)" */
  tip(words, id) {
    const text = this.text(id);
    return text ? say.withKey({ words, key: text }) : words;
  }

  /** "Esc or F" */
  orEscape(id) {
    const text = this.text(id);
    return text ? say.escapeOr({ key: text }) : say.escape;
  }
}

/** "Ctrl+Shift+Z" in the words that are on the keys. @param {string} combo as comboOf() names it */
export const keyText = (combo) =>
  combo
    .replace(/Ctrl(?=\+)/, say.ctrl)
    .replace(/Shift(?=\+)/, say.shift)
    .replace(/Space$/, say.space);

/** Keys that the browser kept; entries that are no keys are left out. */
function read(storage) {
  try {
    const { own = {}, areSinglesOff } = JSON.parse(storage?.getItem(key) ?? '{}');
    const isKey = ([id, combo]) => Object.hasOwn(commands, id) && typeof combo === 'string' && combo.length <= 32;
    return { own: Object.fromEntries(Object.entries(own).filter(isKey)), areSinglesOff: areSinglesOff === true };
  } catch {
    return { own: {}, areSinglesOff: false };
  }
}

function write(storage, kept) {
  try {
    storage?.setItem(key, JSON.stringify(kept));
  } catch {
    // a browser that keeps nothing starts with the standard next time
  }
}
