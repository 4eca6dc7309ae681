// The steps of undo over a reload: kept by the tab, given back to the same member. Loaded when somebody begins to use the page, or when something is kept.
import { effect, untracked } from '../../lib/signals-core.js';

const mostBytes = 200e3; // of the tab's storage
export const keptName = (room) => `undo ${room}`;

/** The steps as text, the oldest left out until they fit. */
function textOf(member, { done, undone }) {
  for (let n = done.length; n >= 0; n = Math.floor(n / 2)) {
    const text = JSON.stringify({ member, done: n ? done.slice(-n) : [], undone });
    if (text.length <= mostBytes) return text;
    if (!n) break;
  }
  return '';
}

const isStep = (step) =>
  ['room', 'mark'].includes(step?.place) &&
  Array.isArray(step.changes) &&
  step.changes.every(
    (one) =>
      Array.isArray(one?.path) && one.path.every((name) => typeof name === 'string') && (one.of === 'scene' || Number.isInteger(one.of)),
  );

function read(storage, name) {
  try {
    const { member, done, undone } = JSON.parse(storage.getItem(name));
    return typeof member === 'string' && [...done, ...undone].every(isStep) ? { member, done, undone } : null;
  } catch {
    return null;
  }
}

/**
 * @param {import('./room.js').RoomState} room @param {import('./undo.js').Undo} undo
 * @param {Storage} storage of the tab @param {EventTarget} target the window @returns {() => void} stops
 */
export function keepUndo(room, undo, storage, target) {
  const name = keptName(room.id);
  const kept = read(storage, name);
  let isDone = false;
  const stop = effect(() => {
    const member = room.member.value;
    if (!member || isDone) return;
    isDone = true;
    if (kept?.member === member) untracked(() => undo.restore(kept));
  });
  const write = () => {
    try {
      storage.setItem(name, textOf(room.member.peek(), undo.kept));
    } catch {
      // nothing is kept
    }
  };
  target.addEventListener('pagehide', write);
  return () => {
    stop();
    target.removeEventListener('pagehide', write);
    storage.removeItem(name); // the room is left
  };
}
