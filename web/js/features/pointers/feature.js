// Pointing, as far as every page has it: keys P and Shift+P. The rest, with the buttons of the strip, is loaded when somebody else is in the room.
import { effect } from '../../../lib/signals-core.js';
import { later } from '../../parts/lazy.js';
import { say } from './words.js';

const panels = later(() => import('./later.js'), 'js/features/pointers/point.css');

/** @param {object} world {room, ui, api, clock, panes, storage} @returns {() => void} stops */
function startPointers(world) {
  let stop = null;
  const stopEffect = effect(() => {
    if (!world.room.pointers.shown.value.length) return;
    if (!panels.loaded.value) return void panels.load();
    stop ??= panels.loaded.value.start(world);
  });
  return () => {
    stopEffect();
    stop?.();
  };
}

/** Why this person cannot point now; '' when they can. */
function refusal({ pointers }) {
  if (!pointers.others.peek().length) return say.alone;
  return pointers.mayPoint.peek() ? '' : say.observer;
}

/** Pointing on or off; isAsking: asks everybody to look here. */
export async function pointKey(room, ui, isAsking) {
  const why = refusal(room);
  if (why) return void ui.notify('ok', why, 'point');
  if (!isAsking) return void (room.pointers.isPointing.value = !room.pointers.isPointing.peek());
  await panels.load();
  if (!refusal(room)) panels.loaded.peek()?.askToLook({ room, ui });
}

/** @type {import('../index.js').Feature} */
export const pointers = {
  keys: { point: ({ room, ui }) => pointKey(room, ui, false), askToLook: ({ room, ui }) => pointKey(room, ui, true) },
  strip: { meet: (world, isDock) => panels.loaded.value?.pointTools(world, isDock) },
  start: startPointers,
};
