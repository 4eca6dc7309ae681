// The beam that a scene chooses, as it is drawn: core/scene/beam_shown.h. Pure; LPS, mm.
import { add, cross, dot, length, scale, subtract, unit } from '../parts/vec.js';
import { say } from './words.js';

const leastMm = 1e-3; // a shorter draft is none
const pole = 0.01; // sine of the angle to the patient's axis, under which anterior is up

/**
 * The beam with this id; '': the one that the scene chooses, as its draft if that is on.
 * @returns {{id: string, name: string, isDraft: boolean, entry: number[], target: number[], direction: number[], length: number, aperture: number|null, isShaped: boolean}|null} id '': a draft in a plan without beams; null: there is none
 */
export function beamShown(plan, scene, id = '') {
  if (!plan || !scene) return null;
  const { id: chosen = '', draft = null } = scene.beam ?? {};
  const wanted = id || chosen;
  const planned = wanted ? plan.beams.find((beam) => beam.id === wanted) : plan.beams[0];
  const isDraft =
    !id &&
    Boolean(draft?.enabled) &&
    !(draft.shows_planned && planned) &&
    length(subtract(draft.line.target_mm, draft.line.entry_mm)) >= leastMm;
  if (!planned && (!isDraft || chosen)) return null;
  const { entry_mm: entry, target_mm: target, aperture_mm: aperture } = isDraft ? draft.line : planned;
  const line = subtract(target, entry);
  return {
    id: planned?.id ?? '',
    name: (isDraft && draft.line.name) || planned?.name || planned?.id || say.draft,
    isDraft,
    entry,
    target,
    direction: unit(line),
    length: length(line),
    aperture: aperture ?? planned?.aperture_mm ?? null,
    isShaped: !isDraft && Boolean(planned.delivery?.outline),
  };
}

/** A point of the beam's line; 0: the entry, positive towards the target and beyond. */
export const beamPoint = ({ entry, direction }, alongMm) => add(entry, scale(direction, alongMm));

/** The distance along a beam at which a point lies. */
export const alongOf = ({ entry, direction }, point) => dot(subtract(point, entry), direction);

/** The plane across a beam, turned as its beam's-eye view: beam_plane. @returns {import('./obliques.js').Plane} */
export function beamPlane(beam, alongMm) {
  const { direction } = beam;
  const towards = Math.hypot(direction[0], direction[1]) < pole ? [0, -1, 0] : [0, 0, 1];
  const up = unit(subtract(towards, scale(direction, dot(towards, direction))));
  return { origin: beamPoint(beam, alongMm), right: cross(direction, up), up, normal: scale(direction, -1) };
}
