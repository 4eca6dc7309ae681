// Where the value of a measure stands in a picture: beside its anchor, clear of letters, crosshair and other values. Pure; CSS px.
import { placeBeside } from '../../parts/place.js';

const digitPx = 6.6;
export const linePx = 15;
const gapPx = 12;
const [edgePx, footPx, figurePx] = [26, 30, 96]; // letters at the edges; scale and window at the foot; axes figure in 3-D

/** Boxes that no value may cover. @param {{x: number, y: number}|null} mark the crosshair @returns {import('../../parts/place.js').Box[]} */
export function takenIn([width, height], is3d, mark) {
  const half = edgePx / 2;
  const square = (x, y) => ({ x, y, width: edgePx, height: edgePx });
  const boxes = [
    square(0, height / 2 - half),
    square(width - edgePx, height / 2 - half),
    square(width / 2 - half, 0),
    { x: 0, y: height - footPx, width, height: footPx },
  ];
  if (is3d) boxes.push({ x: width - figurePx, y: height - figurePx, width: figurePx, height: figurePx });
  if (mark) boxes.push(square(mark.x - half, mark.y - half));
  return boxes;
}

/** The box of the lines of text, which is taken from then on. */
export function labelBox(texts, anchor, pane, taken) {
  const size = [Math.max(...texts.map(({ length }) => length)) * digitPx + 4, texts.length * linePx];
  const box = { ...placeBeside(anchor, size, pane, taken, gapPx), width: size[0], height: size[1] };
  taken.push(box);
  return box;
}
