// Measures in the patient: their lengths, angles and areas, the plane of a pane, and which measures lie in it. Pure; LPS mm.
import { add, cross, dot, length, scale, subtract, unit } from '../../parts/vec.js';
import { replaced } from '../../parts/lists.js';
import { freeNumber } from '../../room/marks.js';
import { heightOver } from '../../room/obliques.js';
import { say } from './drawn_words.js';

export const mostMeasures = 64; // proto/scene.json
export const mostPoints = 64;

/** Kinds: word, name, points that are drawn. */
export const kinds = [
  ['distance', say.distance, 2],
  ['angle', say.angle, 3],
  ['polyline', say.polyline, Infinity],
  ['ellipse', say.ellipse, 2],
];
export const kindName = (kind) => kinds.find(([id]) => id === kind)[1];
export const pointsToDraw = (kind) => kinds.find(([id]) => id === kind)[2];

/** @typedef {{kind: string, name: string, visible: boolean, image: string, points: {at_mm: number[]}[]}} Measure */

export const pointsOf = ({ points }) => points.map(({ at_mm: at }) => at);
export const listed = (places) => places.map((at_mm) => ({ at_mm: at_mm.map((value) => Math.round(value * 1000) / 1000 || 0) }));

export const distanceMm = (a, b) => length(subtract(a, b));
export const lineMm = (points) => points.slice(1).reduce((sum, point, at) => sum + distanceMm(points[at], point), 0);

/** At b, between the legs to a and to c, 0 to 180; NaN where a leg has no length. */
export function angleDeg(a, b, c) {
  const [p, q] = [subtract(a, b), subtract(c, b)];
  return length(p) > 0 && length(q) > 0 ? (Math.atan2(length(cross(p, q)), dot(p, q)) * 180) / Math.PI : NaN;
}

/** Area of an ellipse from its centre and the ends of two half axes; also right where these are not at right angles. */
export const areaMm2 = ([center, a, b]) => Math.PI * length(cross(subtract(a, center), subtract(b, center)));

/** Points around an ellipse, the first one not repeated at the end. */
export function around([center, a, b], n = 72) {
  const [p, q] = [subtract(a, center), subtract(b, center)];
  return Array.from({ length: n }, (_, at) =>
    add(center, add(scale(p, Math.cos((2 * Math.PI * at) / n)), scale(q, Math.sin((2 * Math.PI * at) / n)))),
  );
}

/** The number that a measure is for: mm, degrees, or mm2 of an ellipse; null while points are missing. */
export function valueOf(measure) {
  const points = pointsOf(measure);
  if (measure.kind === 'distance') return points.length >= 2 ? distanceMm(points[0], points[1]) : null;
  if (measure.kind === 'angle') return points.length >= 3 ? angleDeg(points[0], points[1], points[2]) : null;
  if (measure.kind === 'polyline') return points.length >= 2 ? lineMm(points) : null;
  return points.length >= 3 ? areaMm2(points) : null;
}

/** The lines of a measure, each a list of points; isClosed: the last point is joined to the first. */
export function linesOf(kind, points) {
  if (kind === 'ellipse' && points.length >= 3) return { lines: [around(points)], isClosed: true };
  return { lines: points.length > 1 ? [points] : [], isClosed: false };
}

// ---- planes of panes -------------------------------------------------------------------------------------------------------

/** Half of a voxel's extent along a direction. Without an image 0.5 mm. */
export function halfVoxelMm(image, normal) {
  if (!image) return 0.5;
  return (
    [0, 1, 2].reduce(
      (sum, column) =>
        sum +
        Math.abs(
          dot(
            image.lpsFromIjk.map((row) => row[column]),
            normal,
          ),
        ),
      0,
    ) / 2
  );
}

/** True where all points of a measure are within half a voxel of the plane. */
export const isIn = (points, plane, halfMm) => points.every((point) => Math.abs(heightOver(plane, point)) <= halfMm + 1e-3);

// ---- changes ------------------------------------------------------------------------------------------------------------------

/** The first id that is free: m1, m2 ... of the presenter, m1-m3, m2-m3 ... of the member m3 who follows; own1, own2 ... for who is on their own, so that it is never
 *  the presenter's next one. @param {boolean} isShared @param {string} suffix */
export function freeId(measures, isShared, suffix = '') {
  const prefix = isShared ? 'm' : 'own';
  return `${prefix}${freeNumber(Object.keys(measures ?? {}), prefix)}${isShared ? suffix : ''}`;
}

/** The patch that takes a measure away; on one's own the presenter's can only be hidden. */
export const removePatch = (id, isShared) => ({ measures: { [id]: isShared || id.startsWith('own') ? null : { visible: false } } });

/** The third point of an ellipse that is drawn as a circle: as far from the centre as the second, at a right angle in the plane. */
export function circle([center, a], normal) {
  return [center, a, add(center, cross(normal, subtract(a, center)))];
}

/** The points with one of them elsewhere. The centre of an ellipse takes the others with it; its half axes stay at right angles. */
export function withPoint(kind, points, index, place) {
  if (kind !== 'ellipse' || points.length < 3) return replaced(points, index, place);
  const [center, a, b] = points;
  const [p, q] = [subtract(a, center), subtract(b, center)];
  if (index === 0) return [place, add(place, p), add(place, q)];
  const normal = unit(cross(p, q));
  if (!(length(normal) > 0)) return replaced(points, index, place);
  const other =
    index === 1
      ? scale(unit(cross(normal, subtract(place, center))), length(q))
      : scale(unit(cross(normal, p)), Math.max(dot(subtract(place, center), unit(cross(normal, p))), 0.01));
  return index === 1 ? [center, place, add(center, other)] : [center, a, add(center, other)];
}

/** Points to begin with around a place, where somebody measures without a pointer: 40 mm across, along two directions of a pane. */
export function pointsAround(kind, at, { right, up }) {
  const [left, to, top] = [add(at, scale(right, -20)), add(at, scale(right, 20)), add(at, scale(up, 20))];
  if (kind === 'distance') return [left, to];
  if (kind === 'angle') return [top, at, to];
  return kind === 'polyline' ? [left, top, to] : [at, to, add(at, scale(up, 10))];
}
