// Beams of a scene: which one is chosen, the line of its draft, drafts that were kept. Pure; LPS, mm.
import { add, dot, length, scale, subtract, unit } from '../../parts/vec.js';
import { beamShown } from '../../room/beam_line.js';
import { crosshair } from '../../room/plan.js';

export const shortestMm = 0.1; // no entry is dragged closer to its target
export const maxKept = 16; // scene.json
const farMm = 100; // from target to entry, of a draft in a plan without beams
const limitMm = 1e5; // scene.json
const plainColor = '#f4f6f8';

const rounded = (point) => point.map((value) => Math.round(Math.min(Math.max(value, -limitMm), limitMm) * 1e3) / 1e3 || 0); // no -0

/** The beam of the plan that the scene chooses, as planned; null: there is none. */
export function chosenBeam(plan, scene) {
  const { id } = scene.beam;
  return (id ? plan.beams.find((beam) => beam.id === id) : plan.beams[0]) ?? null;
}

export const beamName = (beam) => beam.name || beam.id;

/** True while the scene's chosen beam is its draft. */
export const isDrafted = (plan, scene) => beamShown(plan, scene)?.isDraft === true;

/** The line of the chosen beam or of its draft; null: there is neither. @returns {{entry_mm: number[], target_mm: number[], aperture_mm: number|null}|null} */
export function shownLine(plan, scene) {
  const shown = beamShown(plan, scene);
  return shown && { entry_mm: shown.entry, target_mm: shown.target, aperture_mm: shown.aperture };
}

/** How far the draft is from the planned beam; null where the plan has no beam. @returns {{targetMm: number, directionDeg: number}|null} */
export function movedFrom(planned, line) {
  if (!planned) return null;
  const [a, b] = [planned, line].map(({ entry_mm: entry, target_mm: target }) => unit(subtract(target, entry)));
  const sine = length(subtract(a, b)) / 2; // exact for small angles, as the arc cosine is not
  return {
    targetMm: length(subtract(line.target_mm, planned.target_mm)),
    directionDeg: (2 * Math.asin(Math.min(sine, 1)) * 180) / Math.PI,
  };
}

// ---- how beams are drawn ------------------------------------------------------------------------------------------------

/** The look of a beam: the scene's, or the one that it would get. */
export const lookOf = (scene, id) => ({ visible: false, opening: true, color: plainColor, ...scene.beam.looks[id] });

/** Written whole, so that undo finds the first change of a beam's look as it was. */
export const lookPatch = (scene, id, fields) => ({
  beam: { looks: { [id]: scene.beam.looks[id] ? fields : { ...lookOf(scene, id), ...fields } } },
});

/** Chooses another beam; a draft belongs to the one that was chosen, and is put away. */
export const choosePatch = (plan, scene, id) => ({
  beam: { id, ...(isDrafted(plan, scene) ? { draft: { enabled: false, shows_planned: false } } : {}) },
});

// ---- the draft ----------------------------------------------------------------------------------------------------------

const draftPatch = (line) => ({ beam: { draft: { enabled: true, shows_planned: false, line } } });

/** In a plan without beams: at the crosshair, from anterior. */
const firstLine = (scene) => {
  const target_mm = rounded(crosshair(scene));
  return { target_mm, entry_mm: rounded(add(target_mm, [0, -farMm, 0])) };
};

/** A draft where the planned beam is. */
export function newDraft(plan, scene) {
  const planned = chosenBeam(plan, scene);
  const { entry_mm, target_mm } = planned ?? firstLine(scene);
  return draftPatch({ name: '', entry_mm: rounded(entry_mm), target_mm: rounded(target_mm), aperture_mm: null });
}

/** The draft with fields of its line changed; where nothing is drafted yet, a new one of the planned beam. Null: that would be no line. */
export function redrafted(plan, scene, fields) {
  const line = Object.fromEntries(Object.entries(fields).map(([name, value]) => [name, Array.isArray(value) ? rounded(value) : value]));
  const base = isDrafted(plan, scene) ? scene.beam.draft.line : newDraft(plan, scene).beam.draft.line;
  const whole = { ...base, ...line };
  if (length(subtract(whole.target_mm, whole.entry_mm)) < shortestMm) return null;
  return isDrafted(plan, scene) ? { beam: { draft: { line } } } : draftPatch(whole);
}

/** Back to the planned beam. */
export const plannedPatch = { beam: { draft: { enabled: false, shows_planned: false } } };

// ---- drafts that were kept ----------------------------------------------------------------------------------------------

/** Null: there are as many as there may be. @returns {{id: string, patch: object}|null} */
export function keptDraft(plan, scene, name = '') {
  const { kept } = scene.beam;
  if (Object.keys(kept).length >= maxKept) return null;
  let n = 1;
  while (kept[`draft-${n}`]) n += 1;
  const { entry_mm, target_mm, aperture_mm } = shownLine(plan, scene);
  return {
    id: `draft-${n}`,
    patch: { beam: { kept: { [`draft-${n}`]: { name, entry_mm, target_mm, ...(aperture_mm ? { aperture_mm } : {}) } } } },
  };
}

/** A kept line becomes the draft. */
export const keptPatch = ({ name, entry_mm, target_mm, aperture_mm = null }) => draftPatch({ name, entry_mm, target_mm, aperture_mm });

// ---- moving a point in a picture ----------------------------------------------------------------------------------------

const rowOf = (m, r) => [m[r], m[4 + r], m[8 + r]];

/**
 * A patient point moved in the plane parallel to the picture that it lies in; in a slice pane that keeps its height over the slice.
 * @param {ArrayLike<number>} matrix clip from LPS @param {[number, number]} by parts of the picture's width and height, y down
 */
export function movedInPicture(matrix, point, [du, dv]) {
  const [x, y, w] = [rowOf(matrix, 0), rowOf(matrix, 1), dot(rowOf(matrix, 3), point) + matrix[15]];
  return add(point, add(scale(unit(x), (2 * du * w) / length(x)), scale(unit(y), (-2 * dv * w) / length(y))));
}
