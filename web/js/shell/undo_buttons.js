// The buttons of undo and redo.
import { html } from '../../lib/lit-html.js';
import { icon } from '../parts/icons.js';
import { stepTitle } from './undo_words.js';

export function undoButtons({ room, undo }) {
  const button = (verb, keys, changes, wanted, act) => {
    const isOff = !changes || !room.canChange.value;
    const title = stepTitle(verb, keys, changes, wanted, room);
    return html`<button class="tool plain" tabindex="-1" title=${title} aria-label=${title} aria-keyshortcuts=${verb === 'Undo' ? 'Control+Z' : 'Control+Shift+Z Control+Y'}
      data-act=${verb.toLowerCase()} ?disabled=${isOff} @click=${act}>${icon(verb.toLowerCase())}</button>`;
  };
  return html`${button('Undo', 'Ctrl+Z', undo.next.value, 'before', () => undo.undo())}${button('Redo', 'Ctrl+Shift+Z', undo.nextAgain.value, 'after', () => undo.redo())}`;
}
