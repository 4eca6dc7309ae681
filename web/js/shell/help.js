// The list of keys and of what the mouse does, which can be searched, and in which keys are changed. Loaded when it is first opened.
import { html, nothing } from '../../lib/lit-html.js';
import { signal } from '../../lib/signals-core.js';
import { checkbox } from '../parts/fields.js';
import { icon } from '../parts/icons.js';
import { keyText } from '../room/hotkeys.js';
import { given, isChanged, refusalOf, resetAll, resetOne, userOf } from './help_keys.js';
import { say } from './help_words.js';
import { lookChoice } from './look_choice.js';

/** Rows of the list: [what is pressed, what it does], or [a command of room/commands.js, what it does, 'key']. */
const rows = [
  [say.leftDrag, say.leftDragIs],
  [say.click, say.clickIs],
  [say.rest, say.restIs],
  [say.middleDrag, say.middleDragIs],
  [say.rightDrag, say.rightDragIs],
  [say.roll, say.rollIs],
  [say.wheel, say.wheelIs],
  [say.shiftMove, say.shiftMoveIs],
  [say.shiftClick, say.shiftClickIs],
  [say.doubleClick, say.doubleClickIs],
  [say.fingers, say.fingersIs],
  [say.longPress, say.longPressIs],
  [say.doubleTap, say.doubleTapIs],
  [say.arrows, say.arrowsIs],
  [say.pages, say.pagesIs],
  [say.ctrlArrows, say.ctrlArrowsIs],
  [say.numpad, say.numpadIs],
  [say.digits, say.digitsIs],
  [say.shiftDigits, say.shiftDigitsIs],
  ['[ ]', say.bracketsIs],
  [say.moveBeam, say.moveBeamIs],
  [say.treeSpace, say.treeSpaceIs],
  [say.treeShift, say.treeShiftIs],
  [say.transfer, say.transferIs],
  [say.transferPages, say.transferPagesIs],
  [say.transferInsert, say.transferInsertIs],
  [say.presented, say.presentedIs],
  [say.escape, say.escapeIs],
];

/** Words for the act of each command, by its name in room/commands.js. */
export const commandWords = {
  zoomIn: say.zoomIn,
  zoomOut: say.zoomOut,
  rollLeft: say.rollLeft,
  rollRight: say.rollRight,
  fit: say.gIs,
  reset: say.spaceIs,
  beamEye: say.bIs,
  window: say.wIs,
  zoom: say.zIs,
  measure: say.mIs,
  clips: say.cIs,
  caps: say.kIs,
  drawer: say.vIs,
  wash: say.dIs,
  lines: say.iIs,
  tracks: say.tIs,
  pin: say.qIs,
  point: say.pIs,
  askToLook: say.askIs,
  nextCase: say.nextCaseIs,
  note: say.nIs,
  follow: say.fIs,
  undo: say.undoIs,
  redo: say.redoIs,
  help: say.questionMarkIs,
};

const wanted = signal(''); // part of the words
const asked = signal(null); // {id, combo: '' until a key is pressed, problem, other: the command that has that key}

/** Closed: the next time nothing is asked. */
export function forget() {
  if (wanted.peek()) wanted.value = '';
  if (asked.peek()) asked.value = null;
}

const fold = (text) => text.toLowerCase().normalize('NFD').replace(/\p{M}/gu, '');
const isWanted = (...words) => fold(words.join(' ')).includes(fold(wanted.value.trim()));

export function keyList({ ui }) {
  const { keys } = ui;
  const commands = Object.entries(commandWords).filter(([id, what]) => isWanted(...keys.keysOf(id).map(keyText), what));
  const others = rows.filter((row) => isWanted(...row));
  return html`${lookChoice()}<label class="help-search">${icon('search')}<span class="hidden">${say.search}</span><input type="search" placeholder=${say.search} .value=${wanted.value} @input=${(
    event,
  ) => {
    wanted.value = event.target.value;
  }}></label>
    <p class="note">${say.anywhere}</p>
    <div class="checks">${checkbox(
      say.singles,
      !keys.areSinglesOff.value,
      false,
      (isOn) => {
        keys.areSinglesOff.value = !isOn;
      },
      say.singlesIs,
    )}</div>
    <h3>${say.commands}<span class="grow"></span><button class="small" ?disabled=${!Object.keys(keys.own.value).length} @click=${() => {
      asked.value = null;
      resetAll(keys);
    }}>${say.resetAll}</button></h3>
    ${commands.length + others.length ? nothing : html`<p class="note" role="status">${say.nothingFound}</p>`}
    <ul class="help-keys">${commands.map(([id, what]) => commandRow(keys, id, what))}</ul>
    ${others.length ? html`<h3>${say.mouseAndFixed}</h3><dl>${others.map(([key, what]) => html`<dt>${key}</dt><dd>${what}</dd>`)}</dl>` : nothing}
    <p class="note"><a href="gen/reference.html" target="_blank">${say.reference}</a></p>`;
}

function commandRow(keys, id, what) {
  const shown = keys.keysOf(id).map(keyText);
  const isAsked = asked.value?.id === id;
  const ask = (event) => {
    asked.value = isAsked ? null : { id, combo: '', problem: '', other: '' };
    event.currentTarget.focus();
  };
  return html`<li data-command=${id}><button class="help-key" aria-pressed=${isAsked} title=${say.change} aria-label=${say.changeOf({ what, key: shown.join(' ') || say.noKey })}
      @click=${ask} @keydown=${(event) => isAsked && take(event, keys, id)} @blur=${() => isAsked && !asked.value.combo && ((asked.value = null))}>${
        isAsked
          ? html`<span>${say.press}</span>`
          : shown.length
            ? shown.map((key) => html`<kbd>${key}</kbd> `)
            : html`<span class="dim">${say.noKey}</span>`
      }</button>
    <span>${what}${isAsked ? answer(keys, id) : nothing}</span>
    ${
      isChanged(keys, id)
        ? html`<button class="icon-button small" title=${say.resetOne} aria-label=${say.resetOf({ what })} @click=${() => resetOne(keys, id)}>${icon('reset', 12)}</button>`
        : nothing
    }</li>`;
}

/** Tells that the pressed key cannot be used, or that another command has it. */
function answer(keys, id) {
  const { combo, problem, other } = asked.value;
  if (problem) return html`<p class="warn" role="alert">${problem}</p>`;
  if (!other) return nothing;
  const end = (act) => () => {
    asked.value = null;
    act();
  };
  return html`<span class="help-conflict" role="alert">${say.conflict({ key: keyText(combo), what: commandWords[other] })}
    <button class="small" @click=${end(() => given(keys, id, combo))}>${say.useHere}</button><button class="small" @click=${end(() => {})}>${say.leave}</button></span>`;
}

function take(event, keys, id) {
  if (['Tab', 'Escape'].includes(event.key)) {
    if (event.key === 'Escape') event.stopPropagation();
    asked.value = null;
    return;
  }
  const { combo, problem } = refusalOf(event);
  if (!combo) return;
  event.preventDefault();
  event.stopPropagation();
  const other = problem ? '' : userOf(keys, combo, id);
  if (problem || other) asked.value = { id, combo, problem, other };
  else {
    asked.value = null;
    given(keys, id, combo);
  }
}
