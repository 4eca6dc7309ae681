// Pinning the values at the crosshair, by a key or a button.
import { maxPins, pinnedAt, pinsOf } from './pins.js';
import { crosshair } from '../../room/plan.js';
import { say } from './drawn_words.js';

/** Pins the point of the crosshair. */
export function pinHere({ room, ui }, at) {
  const pinned = pinnedAt(room.scene.value, crosshair(room.scene.value), room.markSuffix);
  if (pinned) room.patchScene(pinned.patch, { view: ui.active.value, at });
  else ui.notify('ok', pinsOf(room.scene.value).length >= maxPins ? say.fullOfPins({ n: maxPins }) : say.pinned, 'pin');
}
