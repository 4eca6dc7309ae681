// The small picture of the presenter, as far as it is loaded when somebody else is in the room; the rest comes when this member looks for themselves.
// A presenter's page tells here in which view they work: it is the one that the small pictures of the others, and displays, show.
import { effect, untracked } from '../../../lib/signals-core.js';
import { Watching, WorkedIn, watched } from './watching.js';
import { later } from '../../parts/lazy.js';

const panel = later(() => import('./watch.js'), 'js/features/watch/watch.css');

const acts = ['wheel', 'pointerdown', 'keydown', 'input'];
const timers = { now: () => performance.now(), setTimeout: (...more) => setTimeout(...more), clearTimeout: (timer) => clearTimeout(timer) };

/** A wheel turns slices of a pane that is not the active one: so every act in a pane counts, not the focus alone. */
function tellActive({ room, ui, connection }) {
  const worked = new WorkedIn((view) => {
    if (isShown(view)) connection.send({ type: 'view.active', view });
  }, timers);
  const isShown = (view) => room.following.isPresenting.peek() && room.view(view)?.isOpen.peek();
  const onAct = ({ target }) => {
    const view = Number(target.closest?.('.pane[data-view]')?.dataset.view);
    if (view && isShown(view)) worked.acted(view);
  };
  for (const type of acts) document.addEventListener(type, onAct, { capture: true, passive: true });
  const stop = effect(() => {
    const view = ui.active.value;
    if (!room.following.isPresenting.value || room.link.value.state !== 'open') worked.restart();
    else if (room.view(view).isOpen.value) untracked(() => worked.acted(view));
  });
  return () => {
    stop();
    worked.restart();
    for (const type of acts) document.removeEventListener(type, onAct, { capture: true });
  };
}

/** @param {object} world {room, ui, connection, decode, storage} @returns {() => void} stops */
export function startWatch(world) {
  world.watching = new Watching(world.storage);
  let stop = null;
  const stops = [
    tellActive(world),
    world.watching.stop,
    effect(() => {
      if (!watched(world.room) || world.watching.isClosed.value) return;
      if (!panel.loaded.value) return void panel.load();
      stop ??= untracked(() => panel.loaded.value.startPicture(world));
    }),
  ];
  return () => [...stops, () => stop?.()].forEach((end) => end());
}
