// State of beams that this page alone has: the point that the tool moves, and whether the planned beam is looked at instead of the draft.
import { signal } from '../../../lib/signals-core.js';
import { isDrafted } from './beams.js';

export const movedPoint = signal('target'); // target | entry

/** A scene without the comparison: with its draft. */
export const withDraft = (scene) => ({ ...scene, beam: { ...scene.beam, draft: { ...scene.beam.draft, shows_planned: false } } });

/** True while there is a draft, also while the planned beam is looked at instead. */
export const isDraftOn = ({ plan, scene }) => Boolean(plan.value && scene.value?.beam) && isDrafted(plan.value, withDraft(scene.value));

/** True while the planned beam is looked at instead of the draft. */
export const isComparing = (room) => isDraftOn(room) && !isDrafted(room.plan.value, room.scene.value);

/** Shows the planned beam instead of the draft, or the draft again: the presenter to everyone, a member on their own to themselves. */
export function toggleCompare(room, options = {}) {
  if (!room.canShowOwn) return false;
  room.patchScene({ beam: { draft: { shows_planned: !isComparing(room) } } }, options);
  return true;
}

/** The pictures show the draft again. */
export function endCompare(room) {
  if (isComparing(room)) toggleCompare(room);
}
