// Draws measures over a picture, by the matrix that came with it: lines, handles, values.
import { nothing, svg } from '../../../lib/lit-html.js';
import { linesOf } from './measures.js';
import { labelBox, linePx, takenIn } from './measure_label.js';
import { toPicture } from '../../parts/vec.js';

const handlePx = 6; // kept free around a point

/** @typedef {{id: string, kind: string, points: number[][], texts: string[], isChosen: boolean, hasHandles: boolean}} Drawn */

/**
 * @param {object} what
 * @param {Drawn[]} what.measures that lie in the plane of the picture, in 3-D all @param {boolean} what.is3d
 * @param {number[]} what.matrix clip from LPS @param {{x, y, width, height}} what.box of the picture @param {number[]} what.pane its size
 * @param {{x: number, y: number}|null} what.mark the crosshair, which no value covers
 */
export function measureOverlay({ measures, is3d, matrix, box, pane, mark }) {
  const place = (point) => {
    const at = toPicture(matrix, point);
    return at && { x: box.x + at[0] * box.width, y: box.y + at[1] * box.height };
  };
  const taken = takenIn(pane, is3d, mark);
  if (!is3d)
    for (const { x, y } of measures.flatMap(({ points }) => points.map(place)).filter(Boolean))
      taken.push({ x: x - handlePx, y: y - handlePx, width: 2 * handlePx, height: 2 * handlePx });
  return svg`<g class=${is3d ? 'image-measures faint' : 'image-measures'}>${measures.map((measure) => drawn(measure, place, pane, taken, is3d))}</g>`;
}

function drawn({ id, kind, points, texts, isChosen, hasHandles }, place, pane, taken, is3d) {
  const { lines, isClosed } = linesOf(kind, points);
  const paths = lines.map((line) => line.map(place)).filter((line) => line.every(Boolean));
  const d = paths.map((line) => `M${line.map(({ x, y }) => `${x.toFixed(2)} ${y.toFixed(2)}`).join('L')}${isClosed ? 'Z' : ''}`).join('');
  const handles = points.map(place).filter(Boolean);
  const anchor = anchorOf(kind, handles);
  const isIn = anchor && anchor.x >= 0 && anchor.y >= 0 && anchor.x <= pane[0] && anchor.y <= pane[1];
  return svg`<g class=${isChosen ? 'measure chosen' : 'measure'} data-measure=${id}>
    ${d ? svg`<path class="under" d=${d} /><path class="ink" d=${d} />` : nothing}
    ${is3d ? nothing : handles.map(({ x, y }) => svg`<circle class="under" cx=${x} cy=${y} r=${hasHandles ? 4.5 : 2} /><circle class="ink" cx=${x} cy=${y} r=${hasHandles ? 4.5 : 2} />`)}
    ${isIn && texts.length ? label(texts, anchor, pane, taken) : nothing}</g>`;
}

/** Beside the last point of a line, the second of an angle, the edge of an ellipse. */
const anchorOf = (kind, handles) => (kind === 'angle' || kind === 'ellipse' ? handles[1] : handles.at(-1)) ?? handles[0];

function label(texts, anchor, pane, taken) {
  const { x, y } = labelBox(texts, anchor, pane, taken);
  return svg`<text class="halo image-value">${texts.map((text, line) => svg`<tspan x=${x + 2} y=${y + linePx * line + 11}>${text}</tspan>`)}</text>`;
}
