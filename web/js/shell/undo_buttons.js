// The buttons of undo and redo. What a step is called is loaded when somebody begins to use the page.
import { html, nothing } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { known, later } from '../parts/lazy.js';
import { say } from './words.js';

export const undoNames = later(() => import('./undo_words.js'));
const none = { undo: say.undoNone, redo: say.redoNone };

export function undoButtons({ room, ui, undo }) {
  const button = (act, changes) => {
    const isOff = !changes || !room.canChange.value;
    const title = ui.keys.tip((changes && known(undoNames)?.stepTitle(act, changes, room)) || none[act], act);
    return html`<button class="tool plain" tabindex="-1" title=${title} aria-label=${title} aria-keyshortcuts=${ui.keys.keysOf(act).join(' ').replaceAll('Ctrl', 'Control') || nothing}
      data-act=${act} ?disabled=${isOff} @click=${() => undo[act]()}>${icon(act)}</button>`;
  };
  return html`${button('undo', undo.next.value)}${button('redo', undo.nextAgain.value)}`;
}
