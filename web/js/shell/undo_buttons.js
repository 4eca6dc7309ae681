// The buttons of undo and redo. What a step is called is loaded when somebody begins to use the page.
import { html } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { known, later } from '../parts/lazy.js';
import { say } from './words.js';

export const undoNames = later(() => import('./undo_words.js'));
const none = { undo: say.undoNone({ keys: 'Ctrl+Z' }), redo: say.redoNone({ keys: 'Ctrl+Shift+Z' }) };

export function undoButtons({ room, undo }) {
  const button = (act, keys, changes) => {
    const isOff = !changes || !room.canChange.value;
    const title = (changes && known(undoNames)?.stepTitle(act, changes, room)) || none[act];
    return html`<button class="tool plain" tabindex="-1" title=${title} aria-label=${title} aria-keyshortcuts=${keys}
      data-act=${act} ?disabled=${isOff} @click=${() => undo[act]()}>${icon(act)}</button>`;
  };
  return html`${button('undo', 'Control+Z', undo.next.value)}${button('redo', 'Control+Shift+Z Control+Y', undo.nextAgain.value)}`;
}
