// The field in which a note, a reply or a change of one is written: @names with completion; what was written stays until the server has it.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { say } from './later_words.js';
import { completion, maxText, mentionsIn } from './threads.js';
import { meIn } from './note_words.js';

const drafts = new Map(); // by room and key: {text, error, isSending, names: completion or null, chosen}
const empty = { text: '', error: '', isSending: false, names: null, chosen: 0 };

function draftOf(room, key) {
  const id = `${room.id} ${key}`;
  if (!drafts.has(id)) drafts.set(id, signal(empty));
  return drafts.get(id);
}

/** Begins with this text, unless something has been written already. */
export function beginWith(room, key, text) {
  const draft = draftOf(room, key);
  if (!draft.peek().text) draft.value = { ...empty, text };
}

export const isWritten = (room, key) => draftOf(room, key).value.text.trim() !== '';

/** Drafts for notes that were deleted meanwhile. @param {Set<string>} ids of the notes that are there @returns {{text: string, drop: () => void}[]} */
export function leftOver(room, ids) {
  return [...drafts].flatMap(([key, draft]) => {
    const [of, name] = key.split(' ');
    const id = /^(?:re|edit)-(.+)$/.exec(name)?.[1];
    if (of !== room.id || !id || ids.has(id) || !draft.value.text.trim()) return [];
    return [
      {
        text: draft.value.text,
        drop: () => {
          draft.value = empty;
        },
      },
    ];
  });
}

/** Moves the focus into the field, once it is drawn. */
export const focusField = (key) => requestAnimationFrame(() => document.querySelector(`#note-field-${key}`)?.focus());

function hint(left) {
  if (left < 0) return say.tooMany({ n: -left });
  if (left < 200) return say.charactersLeft({ n: left });
  const [ctrl, enter] = [html`<kbd>${say.ctrl}</kbd>`, html`<kbd>${say.enter}</kbd>`];
  return html`${say.atNames}<span class="note-keys"> · ${say.keysSend({ ctrl, enter })}</span>`;
}

/**
 * @param {object} world @param {object} what
 * @param {string} what.key of the draft; of letters, digits and "-"
 * @param {string} what.label of the field @param {string} what.word on the button @param {object[]} [what.before] mentions in what is changed
 * @param {(text: string, mentions: object[]) => Promise} what.save @param {() => void} [what.cancel] also called when it is saved
 */
export function noteEditor({ room, ui }, { key, label, word, save, cancel = null, before = [] }) {
  const draft = draftOf(room, key);
  const { text, error, isSending, names, chosen } = draft.value;
  const me = meIn(room);
  const others = room.members.value.filter(({ id }) => id !== me.id);
  const set = (part) => {
    draft.value = { ...draft.peek(), ...part };
  };
  const left = maxText - [...text].length;
  const look = ({ target }) => set({ text: target.value, names: completion(target.value, target.selectionStart, others), chosen: 0 });
  const pick = (field, name) => {
    const { at } = names;
    const value = `${text.slice(0, at)}@${name} ${text.slice(field.selectionStart).replace(/^ /, '')}`;
    field.value = value;
    field.setSelectionRange(at + name.length + 2, at + name.length + 2);
    field.focus();
    set({ text: value, names: null });
  };
  const send = async () => {
    const now = draft.peek();
    if (now.isSending || !now.text.trim() || [...now.text].length > maxText) return;
    set({ isSending: true, error: '', names: null });
    try {
      await save(now.text.trim(), mentionsIn(now.text, others, before));
      draft.value = empty;
      cancel?.();
    } catch (problem) {
      set({ isSending: false, error: problem?.detail || say.refused });
    }
  };
  const stop = () => {
    draft.value = empty;
    cancel?.();
  };
  const onKey = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (names && step) set({ chosen: (chosen + step + names.names.length) % names.names.length });
    else if (names && ['Enter', 'Tab'].includes(event.key)) pick(event.target, names.names[chosen]);
    else if (names && event.key === 'Escape') set({ names: null });
    else if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) send();
    else if (event.key === 'Escape' && cancel && !text.trim()) stop();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const list = `note-names-${key}`;
  return html`<div class="note-editor">
    <label class="note-label" for=${`note-field-${key}`}>${label}</label>
    <textarea id=${`note-field-${key}`} rows="3" .value=${text} ?readonly=${isSending} aria-autocomplete="list"
      aria-controls=${names ? list : nothing} aria-activedescendant=${names ? `${list}-${chosen}` : nothing}
      aria-describedby=${`note-hint-${key}`} @input=${look} @keydown=${onKey} @blur=${() => setTimeout(() => set({ names: null }), 200)}></textarea>
    ${
      names
        ? html`<ul class="note-names" role="listbox" id=${list} aria-label=${say.members}>${names.names.map(
            (name, at) => html`<li role="option" id=${`${list}-${at}`} aria-selected=${at === chosen}
      @pointerdown=${(event) => {
        event.preventDefault();
        pick(event.target.closest('.note-editor').querySelector('textarea'), name);
      }}>${name}</li>`,
          )}</ul>`
        : nothing
    }
    ${error ? html`<p class="note-error" role="alert">${error}</p>` : nothing}
    <p class="note-hint" id=${`note-hint-${key}`}>${isSending && room.link.value.state !== 'open' ? say.kept : hint(left)}</p>
    <div class="note-buttons">
      <button class="note-send" ?disabled=${isSending || !text.trim() || left < 0} @click=${send}>${isSending ? say.sending : word}</button>
      ${cancel ? html`<button ?disabled=${isSending} @click=${stop}>${say.cancel}</button>` : nothing}</div></div>`;
}
