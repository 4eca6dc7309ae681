// Orientation letters: the patient's direction at each edge of a picture.
import { pictureAxes, scale } from '../parts/vec.js';

const names = [
  ['L', 'R'],
  ['P', 'A'],
  ['S', 'I'],
];
const secondFrom = 0.3; // cosine from which on an oblique direction gets a second letter

/** "L", or "AR" for an oblique direction, dominant letter first. @param {number[]} direction unit, LPS */
export function letters(direction) {
  const parts = direction
    .map((cosine, axis) => ({ size: Math.abs(cosine), letter: names[axis][cosine >= 0 ? 0 : 1] }))
    .sort((a, b) => b.size - a.size);
  return parts[0].letter + (parts[1].size >= secondFrom ? parts[1].letter : '');
}

/** @param {ArrayLike<number>} matrix clip from LPS */
export function edgeLetters(matrix) {
  const { right, up } = pictureAxes(matrix);
  return { left: letters(scale(right, -1)), right: letters(right), top: letters(up), bottom: letters(scale(up, -1)) };
}
