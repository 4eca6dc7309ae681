// Planes in the patient: those of slice panes and oblique panes, and planes made from angles, points or a line. Pure; LPS, mm.
import { add, cross, dot, length, rotate, scale, subtract, unit } from '../parts/vec.js';
import { beamPlane, beamShown } from './beam_line.js';
import { crosshair } from './plan.js';
import { say } from './words.js';

/**
 * @typedef {object} Plane as struct plane in core/scene/plane.h: right, up and normal are unit vectors at right angles
 * @property {number[]} origin @property {number[]} right @property {number[]} up @property {number[]} normal
 */

const kinds = {
  axial: { right: [1, 0, 0], up: [0, -1, 0], normal: [0, 0, 1] },
  coronal: { right: [1, 0, 0], up: [0, 0, 1], normal: [0, 1, 0] },
  sagittal: { right: [0, 1, 0], up: [0, 0, 1], normal: [1, 0, 0] },
};
const axisOf = { axial: 2, coronal: 1, sagittal: 0 };
const degrees = Math.PI / 180;
const leastSine = 1e-6; // vectors whose sine is smaller span no plane
export const maxObliques = 8; // scene.json

/** The normal of each kind of slice, towards the positive patient axis. */
export const normalOfKind = Object.fromEntries(Object.entries(kinds).map(([kind, { normal }]) => [kind, normal]));

/** A slice at a position along its patient axis: plane_of_kind. @returns {Plane} */
export const planeOfKind = (kind, positionMm) => ({ origin: scale(kinds[kind].normal, positionMm), ...kinds[kind] });

/** The kind of slice whose normal is nearest; of equally near ones axial before coronal before sagittal. */
function nearestKind([x, y, z]) {
  const [l, p, s] = [Math.abs(x), Math.abs(y), Math.abs(z)];
  return s >= l && s >= p ? 'axial' : p >= l ? 'coronal' : 'sagittal';
}

/**
 * plane_of_normal in core/scene/plane.c: the axes of the nearest slice, turned into the plane; the normal points to that slice's positive side.
 * @param {number[]} origin @param {number[]} direction any length but 0 @returns {Plane}
 */
export function planeOfNormal(origin, direction) {
  const nearest = kinds[nearestKind(direction)];
  let normal = unit(direction);
  const cosine = dot(normal, nearest.normal);
  if (cosine < 0) normal = scale(normal, -1);
  if (Math.abs(cosine) >= 1) return { origin: scale(nearest.normal, dot(origin, nearest.normal)), ...nearest };
  const up = unit(subtract(nearest.up, scale(normal, dot(nearest.up, normal))));
  const side = Math.sign(dot(cross(nearest.right, nearest.up), nearest.normal));
  return { origin, right: scale(cross(up, normal), side), up, normal };
}

/** The plane of an oblique pane: of the scene's plane with this id; without it the axial slice, as the server draws it. @returns {Plane} */
export function planeOfOblique(scene, id) {
  const oblique = scene?.image.obliques?.[id];
  return oblique ? planeOfNormal(oblique.origin_mm, oblique.normal) : planeOfKind('axial', scene?.image.slices.axial.position_mm ?? 0);
}

/** The plane that a slice pane shows: plane_of_view. @param {{kind: string, plane?: string}} view @param plan of a beam slice @returns {Plane} */
export function planeOfView(scene, view, plan = null) {
  if (view.kind === 'beam-slice') {
    const beam = beamShown(plan, scene);
    return beam ? beamPlane(beam, scene.beam.slice.along_mm) : planeOfOblique(scene, '');
  }
  if (view.kind === 'oblique') return planeOfOblique(scene, view.plane);
  return planeOfKind(view.kind, crosshair(scene)[axisOf[view.kind]]);
}

/** Height of a point above a plane; negative below it. */
export const heightOver = ({ origin, normal }, point) => dot(subtract(point, origin), normal);

/** The point of the plane nearest to a point: where the crosshair is seen in the plane's pane. */
export const nearestIn = (plane, point) => subtract(point, scale(plane.normal, heightOver(plane, point)));

/** Distance of the plane from the patient's origin along its normal; of a slice its position. */
export const positionOf = ({ origin, normal }) => dot(origin, normal);

/** The lowest and the highest position along a normal at which a plane still touches the box. */
export function reachOf(normal, { low, high }) {
  const ends = normal.map((part, axis) => [part * low[axis], part * high[axis]]);
  return { low: ends.reduce((sum, pair) => sum + Math.min(...pair), 0), high: ends.reduce((sum, pair) => sum + Math.max(...pair), 0) };
}

const rounded = (value, parts) => Math.round(value * parts) / parts || 0; // no -0
const roundedTo = (parts) => (vector) => vector.map((value) => rounded(value, parts));
/** Roundings of the scene: origins to 0.001 mm, directions to six digits. */
export const roundedOrigin = roundedTo(1e3);
export const roundedNormal = roundedTo(1e6);

/** The origin of the plane moved along its normal to this position. */
export const originAt = ({ origin, normal }, positionMm) => roundedOrigin(add(origin, scale(normal, positionMm - dot(origin, normal))));

/** The origin scrolled by a distance along the normal of its pane, inside the box. */
export function scrolledOrigin(plane, distanceMm, box) {
  const { low, high } = reachOf(plane.normal, box);
  return originAt(plane, Math.min(Math.max(positionOf(plane) + distanceMm, low), high));
}

/** The step of the wheel across a plane: the image's steps along the patient axes, weighted by the normal. */
export const stepAcross = (normal, stepMm) => normal.reduce((sum, part, axis) => sum + part * part * stepMm[axis], 0);

// ---- making planes ---------------------------------------------------------------------------------------------------

/**
 * The direction that two angles name. turn: about the patient's long axis, 0 anterior, 90 left, 180 posterior, -90 right;
 * tilt: from there upwards, 90 superior, -90 inferior. As the header of a 3-D pane says where its camera is.
 */
export function normalOfAngles(turnDeg, tiltDeg) {
  const [turn, tilt] = [turnDeg * degrees, tiltDeg * degrees];
  return roundedNormal([Math.sin(turn) * Math.cos(tilt), -Math.cos(turn) * Math.cos(tilt), Math.sin(tilt)]);
}

/** Turn, -180 to 180, and tilt of a direction, in degrees; straight up and down the turn is 0. */
export function anglesOf(direction) {
  const [x, y, z] = unit(direction);
  const turn = Math.hypot(x, y) < leastSine ? 0 : Math.atan2(x, -y) / degrees;
  return { turn: rounded(turn, 1e4), tilt: rounded(Math.asin(Math.min(Math.max(z, -1), 1)) / degrees, 1e4) };
}

/** The plane through three points; null when they lie on one line. @returns {{origin_mm: number[], normal: number[]}|null} */
export function throughPoints(a, b, c) {
  const [ab, ac] = [subtract(b, a), subtract(c, a)];
  const across = cross(ab, ac);
  if (!(length(across) > leastSine * length(ab) * length(ac))) return null;
  const centre = scale(add(add(a, b), c), 1 / 3);
  return { origin_mm: roundedOrigin(centre), normal: roundedNormal(planeOfNormal(centre, across).normal) };
}

/** The plane through a line drawn on a plane, square to that plane; null when the line has no length. */
export function throughLine(plane, from, to) {
  const along = subtract(to, from);
  const across = cross(along, plane.normal);
  if (!(length(across) > leastSine)) return null;
  const middle = scale(add(from, to), 0.5);
  return { origin_mm: roundedOrigin(middle), normal: roundedNormal(planeOfNormal(middle, across).normal) };
}

/** The plane that holds the axis of a beam, as upright as that allows; of a vertical beam the sagittal one. */
export function alongBeam({ entry_mm: entry, target_mm: target }) {
  const axis = subtract(target, entry);
  if (!(length(axis) > 0)) return null;
  const level = cross(axis, [0, 0, 1]);
  const normal = length(level) > leastSine * length(axis) ? level : [1, 0, 0];
  return { origin_mm: roundedOrigin(target), normal: roundedNormal(planeOfNormal(target, normal).normal) };
}

/** The normal turned about the viewing axis of a pane, by the right-hand rule. */
export const turned = (normal, axis, angleRad) => roundedNormal(rotate(normal, axis, angleRad));

/** The angle by which a direction in a plane turns to become another, about the plane's normal by the right-hand rule. */
export const angleBetween = (plane, from, to) => Math.atan2(dot(plane.normal, cross(from, to)), dot(from, to));

/** A plane as the scene keeps it, with every field: only so can its making be undone. @param {{origin_mm: number[], normal: number[]}} plane */
export const newOblique = ({ origin_mm, normal }, visible = true) => ({ visible, name: '', origin_mm, normal });

/** An id that no oblique plane has yet: "plane-1". */
export function freeId(obliques) {
  for (let n = 1; ; n++) if (!obliques[`plane-${n}`]) return `plane-${n}`;
}

/** "Plane 2" for the id plane-2, when it was given no name. */
export const obliqueName = (id, { name = '' } = {}) => name || id.replace(/^plane-(\d+)$/, (_, n) => say.plane({ n }));

/** "Faces 30° left of anterior, 12° up". */
export function facing(direction) {
  const { turn, tilt } = anglesOf(direction);
  const level = Math.round(tilt);
  if (Math.abs(level) === 90) return level > 0 ? say.superior : say.inferior;
  const side = Math.round(turn);
  const words =
    { 0: say.anterior, 90: say.left, 180: say.posterior, '-180': say.posterior, '-90': say.right }[side] ??
    (side > 0 ? say.leftBy : say.rightBy)({ n: Math.abs(side) });
  return level ? (level > 0 ? say.upBy : say.downBy)({ direction: words, n: Math.abs(level) }) : words;
}
