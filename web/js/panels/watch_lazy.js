// The small picture of the presenter, as far as it is loaded when somebody else is in the room; the rest comes when this member looks for themselves.
// A presenter's page tells here in which view they work: it is the one that the small pictures of the others, and displays, show.
import { effect, untracked } from '../../lib/signals-core.js';
import { Watching, watched } from '../state/watching.js';
import { Lazy, styled } from './lazy.js';

const panel = new Lazy(async () => (await Promise.all([import('./watch.js'), styled('css/watch.css')]))[0]);

function tellActive({ room, ui, connection }) {
  return effect(() => {
    const view = ui.active.value;
    if (!room.following.isPresenting.value || !room.view(view).isOpen.value) return;
    untracked(() => connection.send({ type: 'view.patch', view, patch: {} }));
  });
}

/** @param {object} world {room, ui, connection, decode, storage} @returns {() => void} stops */
export function startWatch(world) {
  world.watching = new Watching(world.storage);
  let stop = null;
  const stops = [tellActive(world), world.watching.stop, effect(() => {
    if (!watched(world.room) || world.watching.isClosed.value) return;
    if (!panel.loaded.value) return void panel.load();
    stop ??= untracked(() => panel.loaded.value.startPicture(world));
  })];
  return () => [...stops, () => stop?.()].forEach((end) => end());
}
