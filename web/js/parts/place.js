// How large the card at the pointer is, and where it goes beside a point so that it covers no letter and stays inside its pane. Pure; CSS px.

/** @typedef {{x: number, y: number, width: number, height: number}} Box */

const marginPx = 6;
const stepPx = 4;
const widest = 196;
const [smallPane, narrow] = [400, 140]; // in a pane narrower than the first, a card is as wide as the second, so that letters and point stay free
const heights = { padding: 18, name: 18, line: 16, large: 26 }; // as in js/pane/pane.css

/** The area that two boxes share. */
export const overlap = (a, b) =>
  Math.max(0, Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x)) *
  Math.max(0, Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y));

/**
 * @param {{x: number, y: number}} point @param {[number, number]} size of the card @param {[number, number]} pane
 * @param {Box[]} taken what must not be covered @param {number} gap between point and card
 * @returns {{x: number, y: number}} the card's corner: the nearest place that is free, else the one that covers least
 */
export function placeBeside(point, [width, height], pane, taken, gap) {
  const inside = (value, size, side) => Math.max(marginPx, Math.min(value, side - size - marginPx));
  const around = { x: point.x - gap / 2, y: point.y - gap / 2, width: gap, height: gap }; // the point itself stays to be seen
  const coveredBy = (card) => overlap(card, around) * 4 + taken.reduce((sum, box) => sum + overlap(card, box), 0);
  for (const away of [gap, gap * 2, gap * 3]) {
    const columns = [point.x + away, point.x - away - width];
    const rows = [point.y + away, point.y - height / 2, point.y - away - height];
    const places = [
      [columns[0], rows[0]],
      [columns[0], rows[1]],
      [columns[0], rows[2]],
      [columns[1], rows[0]],
      [columns[1], rows[1]],
      [columns[1], rows[2]],
      [point.x - width / 2, rows[0]],
      [point.x - width / 2, rows[2]],
    ];
    for (const [left, top] of places) {
      const card = { x: inside(left, width, pane[0]), y: inside(top, height, pane[1]), width, height };
      if (coveredBy(card) === 0) return { x: card.x, y: card.y };
    }
  }
  return leastCovered(point, [width, height], pane, coveredBy);
}

/** In a small pane: of all places, a few pixels apart, the one that covers least, and of these the nearest. */
function leastCovered(point, [width, height], pane, coveredBy) {
  let best = null;
  const last = (side, size) => Math.max(marginPx, side - size - marginPx);
  for (let y = marginPx; y <= last(pane[1], height); y += stepPx)
    for (let x = marginPx; x <= last(pane[0], width); x += stepPx) {
      const covered = coveredBy({ x, y, width, height });
      const distance = Math.hypot(x + width / 2 - point.x, y + height / 2 - point.y);
      if (!best || covered < best.covered || (covered === best.covered && distance < best.distance)) best = { x, y, covered, distance };
    }
  return { x: best.x, y: best.y };
}

/** The words with the size of their card in a pane of this width; in a narrow one the position takes two lines. */
export function cardOf(shown, paneWidth, isHeld) {
  const width = Math.min(paneWidth < smallPane ? narrow : widest, paneWidth - 2 * marginPx);
  const lines = width < widest ? shown.lines.flatMap((line) => line.split(/ {2}(?=S )/)) : shown.lines;
  const height = heights.padding + heights.name + lines.length * heights.line + (shown.value ? (isHeld ? heights.large : heights.line) : 0);
  return { ...shown, lines, width, height };
}
