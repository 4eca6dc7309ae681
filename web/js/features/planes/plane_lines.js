// Where planes cut the slice that a pane shows, by the matrix of the very picture: the line, the part that is cut off, a place for the name. Pure; CSS px.
import { heightOver } from '../../room/obliques.js';
import { overlap } from '../../parts/place.js';
import { fromPicture } from '../../parts/vec.js';

const endPx = 26; // a line ends this far before the picture's edge, as the crosshair does
const handleHalf = 22; // px kept free around a handle
const charPx = 6.2; // of a caption, on average
const letterHalf = 24; // px kept free on both sides of a letter
const footPx = 30; // scale bar and window
const leastGradient = 1e-6; // mm per px: below, plane and slice are parallel
const slackMm = 1e-3; // a slice in a clip plane is not cut off

/**
 * Heights over a plane as they run across the picture: h(x, y) = at + x * gx + y * gy, mm; x, y in px from the pane's left and top.
 * @param {ArrayLike<number>} matrix clip from LPS @param {number[]} through a point of the slice @param {{x, y, width, height}} box of the picture
 */
export function heightsOver(plane, matrix, through, box) {
  const [corner, right, below] = [
    [0, 0],
    [1, 0],
    [0, 1],
  ].map((place) => heightOver(plane, fromPicture(matrix, place, through)));
  const [gx, gy] = [(right - corner) / box.width, (below - corner) / box.height];
  return { at: corner - box.x * gx - box.y * gy, gx, gy };
}

export const heightAt = ({ at, gx, gy }, [x, y]) => at + x * gx + y * gy;

/**
 * The line in the picture: its ends, the left or upper one first, and the unit vector towards greater heights.
 * @param {number[]|null} last the direction in which it ran before, which it keeps
 * @returns {{from: number[], to: number[], over: number[], along: number[]}|null} null: outside the picture, or parallel to the slice
 */
export function lineOf(heights, box, last = null) {
  const { gx, gy } = heights;
  const slope = Math.hypot(gx, gy);
  if (!(slope > leastGradient)) return null;
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  const away = heightAt(heights, middle) / slope;
  const over = [gx / slope, gy / slope];
  const foot = [middle[0] - over[0] * away, middle[1] - over[1] * away];
  let along = [-over[1], over[0]];
  const isBackwards = last
    ? along[0] * last[0] + along[1] * last[1] < 0
    : Math.abs(along[0]) > Math.abs(along[1])
      ? along[0] < 0
      : along[1] < 0;
  if (isBackwards) along = [-along[0], -along[1]];
  const inset = Math.min(endPx, box.width / 4, box.height / 4);
  let [from, to] = [-Infinity, Infinity];
  for (const [start, step, low, high] of [
    [foot[0], along[0], box.x + inset, box.x + box.width - inset],
    [foot[1], along[1], box.y + inset, box.y + box.height - inset],
  ]) {
    if (Math.abs(step) < 1e-9) {
      if (start < low - inset || start > high + inset) return null; // along the edge a line stays to be seen, so that it can be taken
      continue;
    }
    const ends = [(low - start) / step, (high - start) / step];
    from = Math.max(from, Math.min(...ends));
    to = Math.min(to, Math.max(...ends));
  }
  if (!(to - from > 1)) return null;
  const point = (t) => [foot[0] + along[0] * t, foot[1] + along[1] * t];
  return { from: point(from), to: point(to), over, along };
}

/** The point at a part of the line, at least 20 px inside its ends. */
export function onLine({ from, to }, part) {
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const t = Math.min(Math.max(part, Math.min(20 / length, 0.5)), Math.max(1 - 20 / length, 0.5));
  return [from[0] + (to[0] - from[0]) * t, from[1] + (to[1] - from[1]) * t];
}

/** The part of the picture that no plane cuts off, as a polygon; [] when nothing is left. @param {object[]} all heights over each plane */
export function keptPart(all, box) {
  let polygon = [
    [box.x, box.y],
    [box.x + box.width, box.y],
    [box.x + box.width, box.y + box.height],
    [box.x, box.y + box.height],
  ];
  for (const heights of all) {
    const next = [];
    for (const [n, corner] of polygon.entries()) {
      const before = polygon.at(n - 1);
      const [h, hBefore] = [heightAt(heights, corner) - slackMm, heightAt(heights, before) - slackMm];
      if (h > 0 !== hBefore > 0) {
        const t = hBefore / (hBefore - h);
        next.push([before[0] + (corner[0] - before[0]) * t, before[1] + (corner[1] - before[1]) * t]);
      }
      if (h <= 0) next.push(corner);
    }
    polygon = next;
  }
  return polygon;
}

/** Boxes taken in every slice pane: the letters in the middle of the edges, scale bar and window at the foot. */
export function takenIn([width, height]) {
  const around = (x, y) => ({ x: x - letterHalf, y: y - letterHalf, width: 2 * letterHalf, height: 2 * letterHalf });
  return [
    around(0, height / 2),
    around(width, height / 2),
    around(width / 2, 0),
    around(width / 2, height),
    { x: 0, y: height - footPx, width, height: footPx },
  ];
}

export const handleBox = ([x, y]) => ({ x: x - handleHalf, y: y - handleHalf, width: 2 * handleHalf, height: 2 * handleHalf });

/** A place for the name beside the line that covers nothing; null: there is none. @returns {{x, y, width, height}|null} */
export function namePlace(line, words, [width, height], taken) {
  const size = [words.length * charPx + 4, 16];
  const isUpright = Math.abs(line.over[0]) > Math.abs(line.over[1]);
  for (const part of [0.86, 0.74, 0.62, 0.26, 0.38])
    for (const side of [1, -1]) {
      const [x, y] = onLine(line, part);
      const corner = isUpright
        ? [side > 0 ? x + 8 : x - 8 - size[0], y - size[1] / 2]
        : [x - size[0] / 2, side > 0 ? y - 6 - size[1] : y + 6];
      const box = { x: corner[0], y: corner[1], width: size[0], height: size[1] };
      const isInside = box.x >= 4 && box.y >= 4 && box.x + box.width <= width - 4 && box.y + box.height <= height - 4;
      if (isInside && taken.every((other) => overlap(box, other) === 0)) return box;
    }
  return null;
}
