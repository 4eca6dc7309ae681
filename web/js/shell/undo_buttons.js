// The buttons of undo and redo.
import { html } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { stepTitle } from './undo_words.js';

export function undoButtons({ room, undo }) {
  const button = (act, keys, changes) => {
    const isOff = !changes || !room.canChange.value;
    const title = stepTitle(act, changes, room);
    return html`<button class="tool plain" tabindex="-1" title=${title} aria-label=${title} aria-keyshortcuts=${keys}
      data-act=${act} ?disabled=${isOff} @click=${() => undo[act]()}>${icon(act)}</button>`;
  };
  return html`${button('undo', 'Control+Z', undo.next.value)}${button('redo', 'Control+Shift+Z Control+Y', undo.nextAgain.value)}`;
}
