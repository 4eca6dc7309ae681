// Notes on the page: what a first visit loads of them. The rest comes with the first note, or when somebody writes one.
import { effect, untracked } from '../../../lib/signals-core.js';
import { crosshair } from '../../room/plan.js';
import { known, Lazy, styled } from '../../parts/lazy.js';

const notes = new Lazy(async () => (await Promise.all([import('./later.js'), styled('js/features/notes/notes.css')]))[0]);

/** The inspector's Notes. */
export const drawNotes = (world) => notes.draw(({ notesTab }) => notesTab(world));

/** Exports of notes.js; null while the room has no note, and until they are loaded. */
export const ofNotes = ({ items }) => (items.notes.value.length ? known(notes) : null);

/** Tells of notes that mention this person, from the first note on. */
export function watchNotes(world) {
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
