// All of notes that is loaded with the first one: the inspector's tab, the pins on the pictures, what is told of mentions.
import { effect } from '../../../lib/signals-core.js';
import { say } from './later_words.js';
import { mentions } from './threads.js';
import { meIn } from './note_words.js';

export { notePins } from './note_pins.js';
export { notesTab } from './notes_tab.js';

/** Opens a note in the inspector. */
export function openNote(ui, id) {
  ui.note.value = id;
  ui.showTab('notes');
}

/** Scrolls to a note that is opened, and tells of a note or a reply of somebody else that mentions this person. @returns {() => void} */
export function watch({ room, ui }) {
  const stop = effect(() => {
    if (ui.note.value && ui.tab.value === 'notes')
      requestAnimationFrame(() => document.querySelector('.notes > li.open')?.scrollIntoView({ block: 'nearest' })); // once it is drawn
  });
  const end = room.items.listen((item) => {
    if (item.kind === 'note' && mentions(item, meIn(room)))
      ui.notify('ok', say.mentionsYou({ name: item.author_name }), `note ${item.id}`, {
        word: say.show,
        act: () => openNote(ui, item.body.parent || item.id),
      });
  });
  return () => {
    stop();
    end();
  };
}
