// Actions on beams: draft, reset, keep, move, show. Every change is a patch of the scene.
import { chosenBeam, choosePatch, keptDraft, keptPatch, maxKept, newDraft, plannedPatch, redrafted } from './beams.js';
import { endCompare } from './beam_ui.js';
import { beamView } from '../../room/layout.js';
import { toggleBeamEye } from './beam_view.js';
import { say } from './later_words.js';

/** The planned beam is looked at no longer, and the scene is changed. make: the patch, of the scene as it is then */
export function changeBeam({ room, ui }, make, event, view = ui.active.value) {
  endCompare(room);
  const patch = make(room.plan.value, room.scene.value);
  if (patch) room.patchScene(patch, { view, at: event.timeStamp });
  return Boolean(patch);
}

export const startDraft = (world, event) => changeBeam(world, newDraft, event);
export const resetDraft = (world, event) => changeBeam(world, () => plannedPatch, event);
export const choose = (world, id, event) => changeBeam(world, (plan, scene) => choosePatch(plan, scene, id), event);
export const useKept = (world, id, event) => changeBeam(world, (_, scene) => keptPatch(scene.beam.kept[id]), event);

/** Sets entry, target or aperture of the draft; begins one where there is none. */
export function setLine(world, fields, event, view) {
  const isSet = changeBeam(world, (plan, scene) => redrafted(plan, scene, fields), event, view);
  if (!isSet) world.ui.notify('warn', say.samePoint, 'beam');
  return isSet;
}

/** Keeps the draft and selects it, so that it can be given a name. */
export function keepDraft(world, event) {
  const { room, ui } = world;
  endCompare(room);
  const kept = keptDraft(room.plan.value, room.scene.value);
  if (!kept) return void ui.notify('warn', say.fullOfKept({ n: maxKept }), 'beam');
  room.patchScene(kept.patch, { view: ui.active.value, at: event.timeStamp });
  ui.choose('kept', kept.id);
}

/** The beam's-eye view: where it stands already, else in place of a 3-D picture. */
export function openBeamsEye({ room, ui }) {
  if (ui.visible.value.includes(beamView)) ui.active.value = beamView;
  else toggleBeamEye(room, ui);
}

/** The beam of the selected row; the chosen one, or the draft, for the row of drafts. */
export const selectedBeam = ({ room, ui }) =>
  ui.selection.value.id
    ? (room.plan.value.beams.find(({ id }) => id === ui.selection.value.id) ?? null)
    : chosenBeam(room.plan.value, room.scene.value);
