// A transfer function as its editor changes it: points by ascending value, each with a colour and an opacity per millimetre. Pure.
import { replaced } from '../../parts/lists.js';

export const mostPoints = 16; // proto/scene.json
const apart = 1e-6; // of the axis: a new point is no nearer to another
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** @typedef {{value: number, color: string, opacity: number}} Point @typedef {{low: number, high: number}} Axis */

/** The values that the editor shows: where the image has nearly all of its voxels, and every point. @returns {Axis} */
export function axisOf(image, histogram, points) {
  const at = histogram?.percentiles ?? {};
  const values = points.map(({ value }) => value);
  const low = Math.min(at['0.1'] ?? histogram?.low ?? image.low, ...values);
  const high = Math.max(at['99.9'] ?? histogram?.high ?? image.high, ...values);
  const margin = (high - low) * 0.03 || 1;
  return { low: low - margin, high: high + margin };
}

/** Places in the plot, 0 to 1 from its left and its foot. Low opacities have more room, as they matter most: y is the square root. */
export const toPlot = ({ value, opacity }, { low, high }) => [(value - low) / (high - low), Math.sqrt(opacity)];
export const fromPlot = ([x, y], { low, high }) => ({ value: low + x * (high - low), opacity: clamp(y, 0, 1) ** 2 });

const channels = (color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
const hex = (rgb) => `#${rgb.map((value) => Math.round(value).toString(16).padStart(2, '0')).join('')}`;

/** Colour and opacity of a value: linear between points, constant beyond the first and the last. */
export function sampleAt(points, value) {
  if (!points.length) return { color: '#ffffff', opacity: 0 };
  const right = points.findIndex((point) => point.value >= value);
  if (right === 0) return { color: points[0].color, opacity: points[0].opacity };
  if (right < 0) return { color: points.at(-1).color, opacity: points.at(-1).opacity };
  const [a, b] = [points[right - 1], points[right]];
  const part = (value - a.value) / (b.value - a.value);
  const mix = (from, to) => from + (to - from) * part;
  const [from, to] = [channels(a.color), channels(b.color)];
  return { color: hex(from.map((channel, at) => mix(channel, to[at]))), opacity: mix(a.opacity, b.opacity) };
}

/** Short enough to read, exact enough to edit: a thousandth of a thousandth of the axis. */
function rounded(value, axis) {
  const digits = clamp(5 - Math.floor(Math.log10(axis.high - axis.low)), 0, 20);
  return Number(value.toFixed(digits));
}

const roundedOpacity = (opacity) => Math.round(clamp(opacity, 0, 1) * 1e4) / 1e4;

/** A point at this value with the colour that is there, and its index; opacity null: the one that is there. Nothing where the list is full or a point is there. */
export function inserted(points, axis, value, opacity = null) {
  const at = points.findIndex((point) => point.value > value);
  const index = at < 0 ? points.length : at;
  const least = apart * (axis.high - axis.low);
  if (points.length >= mostPoints || points.some((point) => Math.abs(point.value - value) < least)) return { points, index: -1 };
  const here = sampleAt(points, value);
  const point = { value: rounded(value, axis), color: here.color, opacity: roundedOpacity(opacity ?? here.opacity) };
  return { points: [...points.slice(0, index), point, ...points.slice(index)], index };
}

/** The widest gap beside a point, for a new one by key: between it and its neighbour, or beyond the last. */
export function gapBeside(points, axis, index) {
  if (!points.length) return (axis.low + axis.high) / 2;
  const { value } = points[index];
  const next = points[index + 1]?.value ?? axis.high;
  const before = points[index - 1]?.value ?? axis.low;
  return next - value >= value - before ? (value + next) / 2 : (value + before) / 2;
}

/** The point elsewhere: never beyond its neighbours, whose order stays. */
export function moved(points, axis, index, { value = points[index].value, opacity = points[index].opacity }) {
  const [low, high] = [points[index - 1]?.value ?? -1e12, points[index + 1]?.value ?? 1e12];
  return replaced(points, index, { ...points[index], value: clamp(rounded(value, axis), low, high), opacity: roundedOpacity(opacity) });
}

export const recolored = (points, index, color) => replaced(points, index, { ...points[index], color });
export { isSamePoints, showPatchWithVolume, visiblePatch } from './volume_patches.js';
export { without as removed } from '../../parts/lists.js';

/** The point nearest to a place of the plot, within a distance in pixels; -1: none. */
export function nearest(points, axis, [x, y], [width, height], withinPx) {
  let best = { index: -1, px: withinPx };
  for (const [index, point] of points.entries()) {
    const [px, py] = toPlot(point, axis);
    const away = Math.hypot((px - x) * width, (py - y) * height);
    if (away <= best.px) best = { index, px: away };
  }
  return best.index;
}

/** Heights of a histogram's bins over an axis, 0 to 1 by the logarithm of their counts: [x, y][], at most n. */
export function bars(histogram, axis, n = 128) {
  const { low, high, counts } = histogram;
  const width = (high - low) / counts.length;
  const sums = Array(n).fill(0);
  counts.forEach((count, bin) => {
    const x = (low + (bin + 0.5) * width - axis.low) / (axis.high - axis.low);
    if (x >= 0 && x < 1) sums[Math.floor(x * n)] += count;
  });
  const top = Math.log1p(Math.max(...sums, 1));
  return sums.map((sum, at) => [(at + 0.5) / n, Math.log1p(sum) / top]);
}
