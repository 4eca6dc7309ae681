// Giving commands other keys: what cannot be one, who has it already, back to the standard.
import { comboOf, commands } from '../room/commands.js';
import { keyText } from '../room/hotkeys.js';
import { say } from './help_words.js';

/** Keys that mean the same everywhere on the page, or move something by their place. */
const fixed = /^((Ctrl|Shift)\+)*(Arrow\w+|Page(Up|Down)|Home|End|Enter|Backspace|Delete|Insert|Escape|Tab)$|^(Shift\+)?[0-9]$|^[[\]{}]$/;
/** Keys that browsers and systems do not give to a page, or that people expect of these. */
const ofBrowser =
  /^(Ctrl\+(Shift\+)?[ACFHJLNOPQRSTUVWX]|Ctrl\+[+\-0-9]|F(1|3|5|6|7|10|11|12)|Alt\+F4|Alt\+Home|CapsLock|ContextMenu|PrintScreen|Print|Pause|NumLock|ScrollLock)$/;

/** @param {KeyboardEvent} event @returns {{combo: string, problem: string}} combo '' while only Shift or the like is held */
export function refusalOf(event) {
  const combo = comboOf(event);
  const key = keyText(combo);
  if (fixed.test(combo)) return { combo, problem: say.isFixed({ key }) };
  if (ofBrowser.test(combo)) return { combo, problem: say.isOfBrowser({ key }) };
  return { combo, problem: '' };
}

/** The command that has this key already; '' none. @param {import('../room/hotkeys.js').Hotkeys} keys */
export const userOf = (keys, combo, id) => Object.keys(commands).find((other) => other !== id && keys.keysOf(other).includes(combo)) ?? '';

const isSame = (a, b) => a.join(' ') === b.join(' ');
export const isChanged = (keys, id) => !isSame(keys.keysOf(id), commands[id]);

/** Gives a command this key instead of those that it has; who had it is left without. */
export function given(keys, id, combo) {
  const own = { ...keys.own.value };
  for (const other of Object.keys(commands))
    if (other !== id && keys.keysOf(other).includes(combo)) own[other] = keys.keysOf(other).find((one) => one !== combo) ?? '';
  own[id] = combo;
  if (commands[id].length === 1 && commands[id][0] === combo) delete own[id];
  keys.own.value = own;
}

/** Its standard keys again; who has one of them now goes back to its own standard too. */
export function resetOne(keys, id) {
  const own = { ...keys.own.value };
  const queue = [id];
  while (queue.length) {
    const next = queue.pop();
    delete own[next];
    for (const combo of commands[next]) for (const [other, one] of Object.entries(own)) if (one === combo) queue.push(other);
  }
  keys.own.value = own;
}

export function resetAll(keys) {
  keys.own.value = {};
}
