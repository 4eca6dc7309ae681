// Where a view looks from, or its slice lies, in words.
import { describe } from '../room/camera.js';
import { isInSpace } from '../room/kinds.js';
import { positionOf } from '../room/obliques.js';
import { alongBeam, millimetres } from '../parts/format.js';
import { letters } from './letters.js';
import { hasOwnRegions } from './orientation_menu.js';
import { say } from './words.js';

/** @param {import('../room/room.js').RoomState} room @param {import('../room/view.js').ViewState} view @param {import('./pane_actions.js').PaneActions} actions of its pane */
export function whereWords(room, view, actions) {
  const { kind } = view;
  const scene = room.scene.value;
  if (!scene || !room.plan.value) return '';
  if (kind === 'beam') return say.locked;
  if (kind === 'beam-slice') return alongBeam(scene.beam.slice.along_mm);
  if (isInSpace(kind)) {
    const camera = view.document.value && actions.camera;
    return hasOwnRegions(view) ? say.targetsOnly({ camera: describe(camera) }) : describe(camera);
  }
  const { plane } = actions;
  return `${letters(plane.normal)} ${millimetres(positionOf(plane))}`;
}
