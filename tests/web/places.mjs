// Where things lie in the pictures of a page: computed from the matrix of the frame that is painted, not by the page's own functions.
import { header } from './browser.mjs';

const apply = (m, row, [x, y, z]) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
const size = (page, view) =>
  page.evaluate((n) => {
    const { width, height } = document.querySelector(`#picture-${n}`).getBoundingClientRect();
    return [width, height];
  }, view);

/** Where a picture lies in its pane: as large as fits, in the middle. */
export async function boxOf(page, view) {
  const [[width, height], { width_px, height_px }] = [await size(page, view), await header(page, view)];
  const k = Math.min(width / width_px, height / height_px);
  return { x: (width - k * width_px) / 2, y: (height - k * height_px) / 2, width: k * width_px, height: k * height_px };
}

/** The place of a patient point in a pane, in px. */
export async function project(page, view, point) {
  const m = (await header(page, view)).clip_from_lps_mm;
  const box = await boxOf(page, view);
  const w = apply(m, 3, point);
  return [box.x + ((apply(m, 0, point) / w + 1) / 2) * box.width, box.y + ((1 - apply(m, 1, point) / w) / 2) * box.height];
}

/** The point of an axial slice under a place of the pane: two equations of the matrix with S known. */
export async function axialPoint(page, view, [px, py], s) {
  const m = (await header(page, view)).clip_from_lps_mm;
  const box = await boxOf(page, view);
  const [u, v] = [((px - box.x) / box.width) * 2 - 1, 1 - ((py - box.y) / box.height) * 2];
  const [a, b, c, d] = [m[0], m[4], m[1], m[5]];
  const [e, f] = [u - m[8] * s - m[12], v - m[9] * s - m[13]];
  return [(e * d - b * f) / (a * d - b * c), (a * f - e * c) / (a * d - b * c), s];
}

/** The mark of a member in a pane: {x, y, words, strength}; null: none. */
export const mark = (page, view, member = 'm1') =>
  page.evaluate(
    ([n, id]) => {
      const data = document.querySelector(`[data-view="${n}"] .person-pointer[data-member="${id}"]`)?.dataset;
      return data ? { x: Number(data.x), y: Number(data.y), words: data.words, strength: Number(data.strength) } : null;
    },
    [view, member],
  );
export const near = (at, [x, y], px = 1.5) => at !== null && Math.hypot(at.x - x, at.y - y) <= px;

/** Moves the mouse in a pane, to parts of its width and height. Returns the place in px. */
export async function pointAt(page, view, [u, v]) {
  const { x, y, width, height } = await page.locator(`#picture-${view}`).boundingBox();
  const at = [Math.round(width * u), Math.round(height * v)];
  await page.mouse.move(x + at[0], y + at[1]);
  return at;
}
