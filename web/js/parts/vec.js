// Vectors of three numbers, and projections by a 4 x 4 column-major clip matrix.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(...a);
export const unit = (a) => scale(a, 1 / (length(a) || 1));

/** Rotates about a unit axis by the right-hand rule (Rodrigues). */
export function rotate(vector, axis, angleRad) {
  const c = Math.cos(angleRad);
  const s = Math.sin(angleRad);
  return add(add(scale(vector, c), scale(cross(axis, vector), s)), scale(axis, dot(axis, vector) * (1 - c)));
}

const row = (m, r) => [m[r], m[4 + r], m[8 + r]];
const applyRow = (m, r, p) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];

/** Projects a patient point: x right, y down, 0 to 1; null behind the eye. */
export function toPicture(matrix, point) {
  const w = applyRow(matrix, 3, point);
  if (!(w > 1e-9)) return null;
  return [(applyRow(matrix, 0, point) / w + 1) / 2, (1 - applyRow(matrix, 1, point) / w) / 2];
}

/** Unit vectors right, up and forward of a picture in patient space, from its clip matrix. */
export function pictureAxes(matrix) {
  const w = row(matrix, 3);
  // perspective: w grows along the line of sight; parallel: w is 1 and clip z grows along it
  const forward = length(w) > 1e-6 * length(row(matrix, 0)) ? w : row(matrix, 2);
  return { right: unit(row(matrix, 0)), up: unit(row(matrix, 1)), forward: unit(forward) };
}

/** Perspective: where the eye is, the point that projects nowhere. */
export function eyeOf(matrix) {
  const [x, y, w] = [0, 1, 3].map((r) => row(matrix, r));
  const parts = [scale(cross(y, w), -matrix[12]), scale(cross(w, x), -matrix[13]), scale(cross(x, y), -matrix[15])];
  return scale(parts.reduce(add), 1 / dot(x, cross(y, w)));
}

/** Parallel projection: the patient point at x, y (0 to 1, y down) in the plane parallel to the picture through a given point. */
export function fromPicture(matrix, [x, y], through) {
  const rows = [row(matrix, 0), row(matrix, 1)];
  const at = toPicture(matrix, through);
  const right = ((x - at[0]) * 2) / length(rows[0]);
  const up = ((at[1] - y) * 2) / length(rows[1]);
  return add(through, add(scale(unit(rows[0]), right), scale(unit(rows[1]), up)));
}

const barLengths = [1, 2, 5, 10, 20, 50, 100, 200];
const longestBarPx = 110;

/** Length of a scale bar: the longest round length that fits. */
export const barMm = (pxPerMm, roomPx = longestBarPx) =>
  barLengths.filter((mm) => mm * pxPerMm <= Math.min(roomPx, longestBarPx)).at(-1) ?? barLengths[0];
