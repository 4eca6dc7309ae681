// The orientation figure: a cube with the patient's six sides, turned as the picture is. Pure.
import { add, dot, pictureAxes, scale, toPicture } from '../parts/vec.js';

/** The sides of the cube: the name of what one looks from, and its direction in LPS. */
export const sides = [
  { letter: 'A', name: 'anterior', out: [0, -1, 0] },
  { letter: 'P', name: 'posterior', out: [0, 1, 0] },
  { letter: 'L', name: 'left', out: [1, 0, 0] },
  { letter: 'R', name: 'right', out: [-1, 0, 0] },
  { letter: 'S', name: 'superior', out: [0, 0, 1] },
  { letter: 'I', name: 'inferior', out: [0, 0, -1] },
];
const seenFrom = 0.05; // cosine from which on a side is drawn

/**
 * The sides that are seen, the one that faces the eye most last. Coordinates: x right, y down; the cube's edges have length 1.
 * @param {ArrayLike<number>} matrix clip from LPS
 * @returns {{letter: string, name: string, facing: number, middle: number[], corners: number[][]}[]} facing: cosine of the angle to the line of sight
 */
export function cubeSides(matrix) {
  const { right, up, forward } = pictureAxes(matrix);
  const onPicture = (point) => [dot(point, right) / 2, -dot(point, up) / 2];
  return sides
    .map(({ out, ...side }) => {
      const [a, b] = [
        [out[1], out[2], out[0]],
        [out[2], out[0], out[1]],
      ]; // along the side's edges
      const corners = [
        [1, 1],
        [-1, 1],
        [-1, -1],
        [1, -1],
      ].map(([i, j]) => onPicture(add(out, add(scale(a, i), scale(b, j)))));
      return { ...side, facing: -dot(out, forward), middle: onPicture(out), corners };
    })
    .filter(({ facing }) => facing > seenFrom)
    .sort((a, b) => a.facing - b.facing);
}

const reach = 0.6; // half the length of a patient axis, in sizes of the plan's box
const corner = { aside: 0.15, up: 0.2, letter: 0.105 }; // in parts of the picture's shorter side

/**
 * Where the letters of the patient's axes are in a picture, 0 to 1, as core/scene/axes.h has them; those behind the eye are left out.
 * @param {{low: number[], high: number[]}} box of the plan @param {string} [form] a word of axes_form @param {number[]} [crosshair]
 * @param {number[]} [size] of the picture, px
 */
export function axisEnds(matrix, { low, high }, form, crosshair, [width, height] = [1, 1]) {
  if (form === 'corner') {
    const { right, up } = pictureAxes(matrix);
    const side = Math.min(width, height);
    return ['L', 'P', 'S'].map((letter, axis) => ({
      letter,
      x: (side * (corner.aside + corner.letter * right[axis])) / width,
      y: 1 - (side * (corner.up + corner.letter * up[axis])) / height,
    }));
  }
  const middle = scale(add(low, high), 0.5);
  return sides.flatMap(({ letter, out }) => {
    const axis = out.findIndex((part) => part !== 0);
    const end = middle[axis] + out[axis] * reach * (high[axis] - low[axis]);
    const at = toPicture(
      matrix,
      (form === 'crosshair' ? crosshair : middle).map((value, other) => (other === axis ? end : value)),
    );
    return at ? [{ letter, x: at[0], y: at[1] }] : [];
  });
}
