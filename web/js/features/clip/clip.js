// The clip planes of a scene: what each keeps, where it is, the patches that change it. Pure; LPS, mm. The server's side is core/scene/clip.h.
import { dot, scale, unit } from '../../parts/vec.js';
import { alongOf, beamPoint, beamShown } from '../../room/beam_line.js';
import { normalOfAngles, normalOfKind, originAt, reachOf, roundedOrigin } from '../../room/obliques.js';
import { crosshair, shownImage } from '../../room/plan.js';
import { say } from './words.js';

const letters = { axial: 'S', coronal: 'P', sagittal: 'L' };
const axisOf = { axial: 2, coronal: 1, sagittal: 0 };
const axisRow = (axis, end, name, words) => ({
  id: `${axis}_${end}`,
  axis,
  end,
  other: `${axis}_${end === 'low' ? 'high' : 'low'}`,
  name,
  letter: letters[axis],
  ...words,
});

/** The eight planes in the order of the list: of each axis first the one that is used most. high cuts off what lies towards the axis's positive letter.
 *  name: of the axis; whole: with the side that is kept; keeps: that side; spoken: in lower case. */
export const clipTable = [
  axisRow('axial', 'high', say.axial, { whole: say.axialBelow, keeps: say.keepsBelow, spoken: say.axialHigh }),
  axisRow('axial', 'low', say.axial, { whole: say.axialAbove, keeps: say.keepsAbove, spoken: say.axialLow }),
  axisRow('sagittal', 'high', say.sagittal, { whole: say.sagittalRight, keeps: say.keepsRight, spoken: say.sagittalHigh }),
  axisRow('sagittal', 'low', say.sagittal, { whole: say.sagittalLeft, keeps: say.keepsLeft, spoken: say.sagittalLow }),
  axisRow('coronal', 'low', say.coronal, { whole: say.coronalBehind, keeps: say.keepsBehind, spoken: say.coronalLow }),
  axisRow('coronal', 'high', say.coronal, { whole: say.coronalBefore, keeps: say.keepsBefore, spoken: say.coronalHigh }),
  { id: 'beam', name: say.beam, letter: '', whole: say.beamBehind, keeps: say.keepsBehind, spoken: say.beamWord },
  { id: 'free', name: say.free, letter: '', whole: say.free, keeps: '', spoken: say.freeWord },
];
const rowOf = Object.fromEntries(clipTable.map((row) => [row.id, row]));
const tenths = (value) => Math.round(value * 10) / 10 || 0; // no -0

/** "Axial, below": the name with the side that is kept. */
export const clipName = (id) => rowOf[id].whole;
/** "keeps below", '' for the free one: beside a line in a pane. */
export const keepsWords = (id) => rowOf[id].keeps;
/** "axial high" */
export const clipWords = (id) => rowOf[id].spoken;
export const clipRow = (id) => rowOf[id];

/** The beam that the plane of a beam lies across: the scene's chosen one or its draft, or one that is named. */
export const beamOf = (plan, scene) => beamShown(plan, scene, scene.clip.beam.id);
/** The planes that this plan can have: one along a beam needs a beam. */
export const clipsOf = (plan) => clipTable.filter(({ id }) => id !== 'beam' || plan.beams.length);

/** The box in which planes are moved: all that the plan shows. */
export function clipBox(plan, scene) {
  const boxes = [plan.bounds, shownImage(plan, scene)?.bounds].filter(Boolean);
  const ends = (pick, of) => [0, 1, 2].map((axis) => of(...boxes.map((box) => box[pick][axis])));
  return { low: ends('low', Math.min), high: ends('high', Math.max) };
}

/**
 * The plane, its normal towards what it cuts off. @returns {{origin: number[], normal: number[]}|null} null: no such beam
 */
export function clipPlane(plan, scene, id) {
  const { axis, end } = rowOf[id];
  const style = scene.clip[id];
  if (axis) return { origin: scale(normalOfKind[axis], style.position_mm), normal: scale(normalOfKind[axis], end === 'low' ? -1 : 1) };
  if (id === 'free') return { origin: style.origin_mm, normal: unit(style.normal) };
  const beam = beamOf(plan, scene);
  if (!beam) return null;
  return { origin: beamPoint(beam, style.along_mm), normal: scale(beam.direction, -1) };
}

/** The planes that cut, in the order of the list: {id, origin, normal}. */
export const enabledClips = (plan, scene) =>
  scene?.clip
    ? clipsOf(plan)
        .filter(({ id }) => scene.clip[id].enabled)
        .map(({ id }) => ({ id, ...clipPlane(plan, scene, id) }))
    : [];

/** Where a plane is: along the patient's axis, along the beam, or along its normal from the patient's origin. */
export function positionOfClip(plan, scene, id) {
  const style = scene.clip[id];
  if (rowOf[id].axis) return style.position_mm;
  return id === 'beam' ? style.along_mm : dot(style.origin_mm, unit(style.normal));
}

/** The lowest and the highest position over the plan's box, in steps of 0.1 mm. */
export function rangeOfClip(plan, scene, id) {
  const box = clipBox(plan, scene);
  const { axis } = rowOf[id];
  if (axis) return { low: Math.floor(box.low[axisOf[axis]] * 10) / 10, high: Math.ceil(box.high[axisOf[axis]] * 10) / 10 };
  const { low, high } = id === 'free' ? reachOf(unit(scene.clip.free.normal), box) : alongReach(beamOf(plan, scene), box);
  return { low: Math.floor(low * 10) / 10, high: Math.ceil(high * 10) / 10 };
}

function alongReach(beam, box) {
  if (!beam) return { low: 0, high: 0 };
  const entry = dot(beam.entry, beam.direction);
  const { low, high } = reachOf(beam.direction, box);
  return { low: low - entry, high: high - entry };
}

const patchOf = (id, style) => ({ clip: { [id]: style } });

/** The patch that moves a plane to a position, in steps of 0.1 mm inside its range. */
export function movedClip(plan, scene, id, positionMm) {
  const { low, high } = rangeOfClip(plan, scene, id);
  const position = tenths(Math.min(Math.max(positionMm, low), high));
  if (rowOf[id].axis) return patchOf(id, { position_mm: position });
  if (id === 'beam') return patchOf(id, { along_mm: position });
  const { origin_mm: origin, normal } = scene.clip.free;
  return patchOf(id, { origin_mm: originAt({ origin, normal: unit(normal) }, position) });
}

/** The position of the plane of this direction through a point. */
export function positionThrough(plan, scene, id, point) {
  const { axis } = rowOf[id];
  if (axis) return point[axisOf[axis]];
  if (id === 'free') return dot(point, unit(scene.clip.free.normal));
  const beam = beamOf(plan, scene);
  return beam ? alongOf(beam, point) : 0;
}

/** The patch that moves a plane through a point; the free plane gets it as its origin. */
export const clipThrough = (plan, scene, id, point) =>
  id === 'free' ? patchOf(id, { origin_mm: roundedOrigin(point) }) : movedClip(plan, scene, id, positionThrough(plan, scene, id, point));

const isUntouched = (scene, id) => {
  const { position_mm: position, along_mm: along, origin_mm: origin } = scene.clip[id];
  return !(position || along || origin?.some(Boolean));
};

/** The patch that turns a plane on or off. One that was never moved begins at the crosshair, where it can be seen. */
export function switchedClip(plan, scene, id, isOn) {
  const start = isOn && isUntouched(scene, id) ? clipThrough(plan, scene, id, crosshair(scene)).clip[id] : {};
  return patchOf(id, { enabled: isOn, ...start });
}

/** The patch that keeps the other side of a plane, and the plane that then cuts: of an axis the other one, at the same place. The plane of a beam has one side only. */
export function flippedClip(scene, id) {
  const { other } = rowOf[id];
  const style = scene.clip[id];
  if (id === 'free') return { id, patch: patchOf(id, { normal: style.normal.map((part) => -part || 0) }) };
  if (!other) return null;
  return {
    id: other,
    patch: {
      clip: {
        [other]: { enabled: style.enabled, position_mm: style.position_mm, cap: style.cap },
        [id]: { enabled: false, position_mm: scene.clip[other].position_mm },
      },
    },
  };
}

/** True if the two planes of an axis leave nothing between them. */
export const leavesNothing = (scene, axis) => {
  const [low, high] = [scene.clip[`${axis}_low`], scene.clip[`${axis}_high`]];
  return low.enabled && high.enabled && low.position_mm >= high.position_mm;
};

/** All planes that cut, through the crosshair. */
export const allThroughCrosshair = (plan, scene) => ({
  clip: Object.assign({}, ...enabledClips(plan, scene).map(({ id }) => clipThrough(plan, scene, id, crosshair(scene)).clip)),
});

/**
 * Key C: all planes off, or those on again that were; with none to remember the axial one through the crosshair.
 * @param {string[]} remembered @returns {{patch: object, remembered: string[]}}
 */
export function toggledClips(plan, scene, remembered) {
  const on = enabledClips(plan, scene).map(({ id }) => id);
  const known = remembered.filter((id) => clipsOf(plan).some((row) => row.id === id));
  const ids = on.length ? on : known.length ? known : ['axial_high'];
  const patches = ids.map((id) => switchedClip(plan, scene, id, on.length === 0).clip);
  return { patch: { clip: Object.assign({}, ...patches) }, remembered: on.length ? on : known };
}

/** Key K: caps of all planes that cut, off when all of them have one; null when none cuts. */
export function toggledCaps(plan, scene) {
  const ids = enabledClips(plan, scene).map(({ id }) => id);
  if (!ids.length) return null;
  const cap = !ids.every((id) => scene.clip[id].cap);
  return { clip: Object.fromEntries(ids.map((id) => [id, { cap }])) };
}

/** The free plane in a direction that two angles name. */
export const freeByAngles = (turnDeg, tiltDeg) => patchOf('free', { normal: normalOfAngles(turnDeg, tiltDeg) });

/** "image, region colours", "nothing": what caps show. */
export const capWords = ({ image, regions, outlines }) =>
  [image && say.image, regions && say.regions, outlines && say.outlines].filter(Boolean).join(', ') || say.nothing;
