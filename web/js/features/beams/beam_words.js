// Words for beams, their drafts and places.
import { movedFrom, shownLine, chosenBeam } from './beams.js';
import { number } from '../../parts/format.js';
import { say } from './row_words.js';

/** "target moved 5.4 mm, direction 10.1°", "as planned"; '' in a plan without beams. @param {{targetMm: number, directionDeg: number}|null} moved */
export function movedWords(moved) {
  if (!moved) return '';
  return movedBy(moved, say.moved, say.movedTarget, say.movedDirection);
}

function movedBy({ targetMm, directionDeg }, both, target, direction) {
  const values = { mm: number(targetMm, 1), degrees: number(directionDeg, 1) };
  if (targetMm >= 0.05) return (directionDeg >= 0.05 ? both : target)(values);
  return directionDeg >= 0.05 ? direction(values) : say.asPlanned;
}

/** Says whose dose is shown while a beam is drafted; in a plan without doses, that the beam is not the planned one. */
export function draftBelongs(plan, scene) {
  if (!chosenBeam(plan, scene)) return say.noPlanned;
  return plan.doses.length ? say.doseOfPlanned : say.notPlanned;
}

/** How far the draft of a scene has moved, as movedWords says it. */
export function draftWords(plan, scene) {
  return movedWords(movedFrom(chosenBeam(plan, scene), shownLine(plan, scene)));
}

/** That in a row of the tree: "5.4 mm, 10.1°". */
export function draftFigures(plan, scene) {
  const moved = movedFrom(chosenBeam(plan, scene), shownLine(plan, scene));
  return moved ? movedBy(moved, say.figures, say.figureTarget, say.figureDirection) : '';
}

/** "Draft 2" for the id draft-2, when it was given no name. */
export const keptName = (id, { name = '' } = {}) => name || id.replace(/^draft-(\d+)$/, (_, n) => say.draftNumber({ n }));

/** "L 24.9", "P 38.4", "S −64.9" */
export const coordinates = (point) => ['L', 'P', 'S'].map((letter, axis) => `${letter} ${number(point[axis], 1)}`);
export const angle = (value) => `${number(value, 1)}°`;
export const mm = (value) => `${number(value, 1)} mm`;
