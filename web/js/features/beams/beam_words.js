// Words for beams, their drafts and places.
import { movedFrom, shownLine, chosenBeam } from './beams.js';
import { number } from '../../parts/format.js';

/** "target moved 5.4 mm, direction 10.1°", "as planned"; '' in a plan without beams. @param {{targetMm: number, directionDeg: number}|null} moved */
export function movedWords(moved) {
  if (!moved) return '';
  const parts = [
    moved.targetMm >= 0.05 && `target moved ${number(moved.targetMm, 1)} mm`,
    moved.directionDeg >= 0.05 && `direction ${number(moved.directionDeg, 1)}°`,
  ].filter(Boolean);
  return parts.join(', ') || 'as planned';
}

/** Says whose dose is shown while a beam is drafted; in a plan without doses, that the beam is not the planned one. */
export function draftBelongs(plan, scene) {
  if (!chosenBeam(plan, scene)) return 'this plan has no planned beam';
  return plan.doses.length ? 'dose shown belongs to the planned beam' : 'not the planned beam';
}

/** How far the draft of a scene has moved, as movedWords says it. */
export function draftWords(plan, scene) {
  return movedWords(movedFrom(chosenBeam(plan, scene), shownLine(plan, scene)));
}

/** "L 24.9", "P 38.4", "S −64.9" */
export const coordinates = (point) => ['L', 'P', 'S'].map((letter, axis) => `${letter} ${number(point[axis], 1)}`);
export const angle = (value) => `${number(value, 1)}°`;
export const mm = (value) => `${number(value, 1)} mm`;
