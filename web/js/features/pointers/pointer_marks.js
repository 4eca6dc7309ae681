// Where pointers stand in a picture, by the matrix that came with it, and how they look: their size and strength, the boxes of their labels. Pure; CSS px.
import { dot, pictureAxes, subtract, toPicture } from '../../parts/vec.js';
import { takenIn } from '../measures/measure_label.js';
import { overlap, placeBeside } from '../../parts/place.js';
import { say } from './later_words.js';

export const fullMs = 3000; // a pointer that stops is drawn in full so long
export const goneMs = 8000; // and is gone after this: POINTER_KEPT_MS of the server
export const farMm = 50; // beyond this distance from a slice it is not drawn there
export const inFrontMm = 3; // what is seen nearer to the eye than the point by more than this hides it
const [leastSize, nearStrength, leastStrength, hiddenStrength, fadedStrength] = [0.5, 0.8, 0.4, 0.45, 0.25];
const [radiusPx, heightPx, paddingPx, gapPx] = [8, 20, 6, 12];
const widthOf = (text) =>
  [...text].reduce((sum, char) => sum + (/[mwMW@]/.test(char) ? 11 : /[A-Z0-9…]/.test(char) ? 8 : /[ ilj.,:·']/.test(char) ? 4.5 : 6.6), 0); // of the font, rounded up
const mostChars = 24;

/** How strong a pointer is after it has not moved for so long: 1 to 0. */
export function fading(ms) {
  if (ms <= fullMs) return 1;
  return ms >= goneMs ? 0 : 1 - ((1 - fadedStrength) * (ms - fullMs)) / (goneMs - fullMs);
}

/**
 * In a slice pane: whole within half a slice of the plane, smaller and fainter farther away, null beyond farMm.
 * @param {number} heightMm over the plane @param {number} halfSliceMm @returns {{size: number, strength: number, words: string}|null}
 */
export function lookInSlice(heightMm, halfSliceMm) {
  const mm = Math.abs(heightMm);
  if (mm <= halfSliceMm) return { size: 1, strength: 1, words: '' };
  if (mm > farMm) return null;
  const part = (mm - halfSliceMm) / Math.max(farMm - halfSliceMm, 1e-9);
  return {
    size: 1 - (1 - leastSize) * part,
    strength: nearStrength - (nearStrength - leastStrength) * part,
    words: `${mm < 9.95 ? mm.toFixed(1) : Math.round(mm)} mm`,
  };
}

export const lookInSpace = (isHidden) => ({ size: 1, strength: isHidden ? hiddenStrength : 1, words: isHidden ? say.behind : '' });

/** Whether what is seen at the point's pixel lies nearer to the eye than the point. @param {ArrayLike<number>} matrix clip from LPS @param {number[]|null} seen */
export function isBehind(matrix, point, seen) {
  return seen !== null && dot(subtract(point, seen), pictureAxes(matrix).forward) > inFrontMm;
}

/** The place of a patient point in a pane; null: behind the eye, or not in the picture. @param {{x, y, width, height}} box of the picture */
export function placeOf(matrix, point, box) {
  const at = toPicture(matrix, point);
  if (!at || !(at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1)) return null;
  return { x: box.x + at[0] * box.width, y: box.y + at[1] * box.height };
}

const shortened = (name) => (name.length > mostChars ? `${name.slice(0, mostChars - 1)}…` : name);

/**
 * Gives each mark the text and the box of its label, which covers no letter, no other mark and no other label.
 * @param {{x: number, y: number, name: string, words: string}[]} marks @param {number[]} pane @param {boolean} isInSpace
 * @param {{x: number, y: number}|null} away labels stand on the side away from this point, where there is place
 */
export function labelled(marks, pane, isInSpace, away = null) {
  const taken = takenIn(pane, isInSpace, null);
  for (const { x, y } of marks) taken.push({ x: x - radiusPx, y: y - radiusPx, width: 2 * radiusPx, height: 2 * radiusPx });
  return marks.map((mark) => {
    const text = [shortened(mark.name), mark.words].filter(Boolean).join(' · ');
    const [width, height] = [Math.ceil(widthOf(text)) + 2 * paddingPx, heightPx];
    const opposite = away && beyond(mark, away, [width, height]);
    const isFree = opposite && isInside(opposite, pane) && taken.every((box) => !overlap(opposite, box));
    const box = isFree ? opposite : { ...placeBeside(mark, [width, height], pane, taken, gapPx), width, height };
    taken.push(box);
    return { ...mark, text, box };
  });
}

/** The box beside a mark, on its side away from a point. */
function beyond({ x, y }, away, [width, height]) {
  return { x: x < away.x ? x - gapPx - width : x + gapPx, y: y - height / 2, width, height };
}

const isInside = ({ x, y, width, height }, pane) => x >= 0 && y >= 0 && x + width <= pane[0] && y + height <= pane[1];

/** Colours of members whose own the server does not tell. */
const colors = ['#56b4e9', '#e69f00', '#2fc99b', '#f0e442', '#cc79a7', '#ff7f50', '#9aa8ff', '#7fd84f'];
export const colorOf = ({ id, color }) =>
  /^#[0-9a-f]{6}$/i.test(color ?? '') ? color : colors[(Number.parseInt(String(id).slice(1), 10) || 0) % colors.length];
