// Clip planes as far as every page has them: whether something is cut, their note in the tree, the keys that switch them and their caps.
import { enabledClips, toggledCaps, toggledClips } from './clip.js';
import { say } from './words.js';

export const hasClips = (plan) => plan.images.length + plan.regions.length;

/** "2 on"; '' while nothing is cut. */
export function clipNote({ room }) {
  const n = enabledClips(room.plan.value, room.scene.value).length;
  return n ? say.nOn({ n }) : say.off;
}

/** Whether anything is cut off. */
export const isClipped = ({ room }) =>
  Boolean(room.plan.value && room.scene.value?.clip && enabledClips(room.plan.value, room.scene.value).length);

/** Key C: all clip planes off, or on again as they were. */
export function toggleClips(room, ui, at) {
  const { patch, remembered } = toggledClips(room.plan.value, room.scene.value, ui.clips);
  ui.clips = remembered;
  room.patchScene(patch, { view: ui.active.value, at });
}

/** Key K: the caps of all clip planes that cut. */
export function toggleCaps(room, ui, at) {
  const patch = toggledCaps(room.plan.value, room.scene.value);
  if (patch) room.patchScene(patch, { view: ui.active.value, at });
  else ui.notify('ok', say.nothingToCap, 'clip');
}
