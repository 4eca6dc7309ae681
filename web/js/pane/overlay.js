// Draws over a picture, by the matrix that came with it: letters, crosshair, ends of the patient's axes, scale bar, window.
import { nothing, svg } from '../../lib/lit-html.js';
import { isInSpace } from '../room/kinds.js';
import { crosshair } from '../room/plan.js';
import { edgeLetters } from './letters.js';
import { axisEnds } from './orientation.js';
import { barMm, toPicture } from '../parts/vec.js';

const gapPx = 22;
const marginPx = 26;
const letterPx = 14;
const windowFrom = 360; // px of width; the strip at the foot has no room for the window's text below
const scaleFrom = 280;
const letterHalf = 24; // px kept free on both sides of the letter in the middle of the strip
const digitPx = 7; // widest character of a caption, on average

/**
 * @param {object} what
 * @param {string} what.kind @param {import('../wire/frame.js').FrameHeader} what.header
 * @param {{x: number, y: number, width: number, height: number}} what.box position and size of the picture, CSS px
 * @param {number[]} what.pane size of the pane, CSS px
 * @param {number[]|null} what.point the crosshair, LPS mm
 * @param {boolean} [what.isOffPlane] the crosshair lies beside the plane of the pane
 * @param {{box: {low: number[], high: number[]}, form: string, crosshair: number[]}|null} [what.axes] the plan's box, where its axes have letters
 * @param {number} what.pxPerMm CSS px; 0 in perspective
 * @param {string} what.windowText
 * @param {string} [what.ground] the scene's colour behind 3-D pictures, #rrggbb
 */
export function overlay({
  kind,
  header,
  box,
  pane: [width, height],
  point,
  isOffPlane = false,
  axes = null,
  pxPerMm,
  windowText,
  ground = '',
}) {
  const matrix = header.clip_from_lps_mm;
  const at = point && toPicture(matrix, point);
  const mark = at && { x: box.x + at[0] * box.width, y: box.y + at[1] * box.height };
  return svg`
    ${mark && (isInSpace(kind) ? marker(mark, box) : cross(mark, box, isOffPlane))}
    <g class=${kind === '3d' && isLight(ground) ? 'on-light' : ''}>${edgeText(edgeLetters(matrix), width, height)}
    ${isInSpace(kind) && axes ? axesText(matrix, axes, box, header.full_px) : nothing}
    ${pxPerMm > 0 && width >= scaleFrom ? scaleBar(pxPerMm, width, height) : nothing}</g>
    ${!isInSpace(kind) && width >= windowFrom ? svg`<text class="halo caption" x=${width - 12} y=${height - 12} text-anchor="end">${fitting(windowText, width / 2 - letterHalf - 12)}</text>` : nothing}`;
}

/** The patient's axes of which letters are drawn: axes of overlay(). */
export const axesOf = ({ axes, ...scene }, plan) =>
  axes?.visible && axes.letters !== false && plan?.bounds ? { box: plan.bounds, form: axes.form, crosshair: crosshair(scene) } : null;

/** Dark ink has more contrast on it than light ink: WCAG 2.2, relative luminance. As visible_ground_is_light of core/render/visible. @param {string} color #rrggbb */
export function isLight(color) {
  const parts = [0.2126, 0.7152, 0.0722];
  const linear = (part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
  return parts.reduce((sum, part, c) => sum + part * linear(Number.parseInt(color.slice(1 + 2 * c, 3 + 2 * c), 16) / 255), 0) > 0.179;
}

/** The text, without what stands after the window's centre and width where there is no room for it; '' where there is none for those. */
function fitting(text, roomPx) {
  const fits = (words) => words.length * digitPx <= roomPx;
  if (fits(text)) return text;
  const short = text.split('  ').slice(0, 2).join('  ');
  return fits(short) ? short : '';
}

const line = (x1, y1, x2, y2) => svg`<line x1=${x1} y1=${y1} x2=${x2} y2=${y2} />`;

function cross({ x, y }, box, isOffPlane) {
  const left = box.x + marginPx;
  const right = box.x + box.width - marginPx;
  const top = box.y + marginPx;
  const bottom = box.y + box.height - marginPx;
  const isIn = (value, low, high) => value > low - marginPx && value < high + marginPx;
  if (!isIn(x, left, right) || !isIn(y, top, bottom)) return nothing;
  const half = gapPx / 2;
  return svg`<g class=${isOffPlane ? 'crosshair off' : 'crosshair'}>
    ${x - half > left ? line(left, y, x - half, y) : nothing} ${x + half < right ? line(x + half, y, right, y) : nothing}
    ${y - half > top ? line(x, top, x, y - half) : nothing} ${y + half < bottom ? line(x, y + half, x, bottom) : nothing}</g>`;
}

function marker({ x, y }, box) {
  if (x < box.x || y < box.y || x > box.x + box.width || y > box.y + box.height) return nothing;
  return svg`<g class="marker">${[0, 1].map(
    (layer) => svg`<g class=${layer ? 'ink' : 'under'}>
    <circle cx=${x} cy=${y} r="7" />${line(x - 12, y, x - 7, y)}${line(x + 7, y, x + 12, y)}${line(x, y - 12, x, y - 7)}${line(x, y + 7, x, y + 12)}</g>`,
  )}</g>`;
}

function edgeText(letters, width, height) {
  const text = (x, y, anchor, word) => svg`<text class="halo letter" x=${x} y=${y} text-anchor=${anchor}>${word}</text>`;
  const middle = height / 2 + 5;
  return svg`<g data-letters=${`${letters.left} ${letters.right} ${letters.top} ${letters.bottom}`}>
    ${text(letterPx - 4, middle, 'start', letters.left)}${text(width - letterPx + 4, middle, 'end', letters.right)}
    ${text(width / 2, letterPx + 5, 'middle', letters.top)}${text(width / 2, height - letterPx + 4, 'middle', letters.bottom)}</g>`;
}

/** At the ends of the patient's axes, where the box of the plan is not empty. */
function axesText(matrix, { box: bounds, form, crosshair }, box, size) {
  return svg`<g class="axes">${axisEnds(matrix, bounds, form, crosshair, size).map(
    ({ letter, x, y }) => svg`<text class="halo letter" text-anchor="middle"
    x=${box.x + x * box.width} y=${box.y + y * box.height + 5}>${letter}</text>`,
  )}</g>`;
}

/** Left of the letter in the middle of the foot. */
function scaleBar(pxPerMm, width, height) {
  const roomPx = width / 2 - letterHalf - 20 - '500 mm'.length * digitPx;
  const mm = barMm(pxPerMm, roomPx);
  const length = mm * pxPerMm;
  const y = height - 16;
  const path = `M12.5 ${y - 6}V${y}H${12.5 + length}V${y - 6}M${12.5 + length / 2} ${y - 3.5}V${y}`;
  return svg`<g class="scale"><path class="under" d=${path} /><path class="ink" d=${path} />
    <text class="halo caption" x=${length + 20} y=${y + 4}>${mm} mm</text></g>`;
}
