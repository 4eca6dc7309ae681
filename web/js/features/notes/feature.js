// Notes. The rest is loaded with the first note, or when somebody writes one.
import { effect, untracked } from '../../../lib/signals-core.js';
import { crosshair } from '../../room/plan.js';
import { known, later } from '../../parts/lazy.js';
import { say } from './words.js';

const parts = later(() => import('./later.js'), 'js/features/notes/notes.css');

/** Exports of later.js; null while the room has no note, and until they are loaded. */
const ofNotes = ({ items }) => (items.notes.value.length ? known(parts) : null);

/** Tells of notes that mention this person, from the first note on. */
function watchNotes(world) {
  let stop = null;
  const wait = effect(() => {
    const module = ofNotes(world.room);
    if (module && !stop) stop = untracked(() => module.watch(world));
  });
  return () => {
    wait();
    stop?.();
  };
}

/** Key N: begins a note at the crosshair. */
export function noteHere({ room, ui }) {
  ui.newNote.value = { point_mm: crosshair(room.scene.value).map((value) => Math.round(value * 1000) / 1000 || 0) };
  ui.showTab('notes');
}

/** @type {import('../index.js').Feature} */
export const notes = {
  tabs: [
    {
      id: 'notes',
      name: say.tab,
      count: ({ room }) => room.items.nOpen.value,
      draw: (world) => parts.draw(({ notesTab }) => notesTab(world)),
    },
  ],
  keys: { note: noteHere },
  start: watchNotes,
  pane: (world) => ({ pins: (place) => ofNotes(world.room)?.notePins(world, place()) }),
};
