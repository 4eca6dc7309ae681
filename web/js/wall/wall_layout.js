// Which views a wall shows, and how they stand. Pure.
import { views as allViews } from '../room/layout.js';

const standard = [1, 2, 3, 4];
const large = 2; // a view with more than so many times the area of the next one has the large place

/** The number of the page's view of this kind; 0: there is none. @param {{kind: string, number?: number}|null} name of the message wall */
export const viewOf = (name) =>
  name ? allViews.findIndex(({ kind, number = 1 }) => kind === name.kind && number === (name.number ?? 1)) + 1 : 0;

/** A view that is none of the four has the place of the 3-D one. */
const four = (active) => (active && !standard.includes(active) ? [active, ...standard.slice(1)] : standard);

/**
 * @param {{layout: string, views: {kind, number, size_px}[]}} told the message wall @param {number} active view that is worked in; 0: none is known
 * @param {number} alone view that a wall of one pane shows; 0: none is known
 * @returns {{grid: 'one'|'two'|'three'|'four'|'1+3', cells: number[]}}
 */
export function arranged({ layout, views }, active, alone) {
  if (layout === 'worked-in') return { grid: 'one', cells: [alone || 1] };
  const open = views.map((view) => ({ number: viewOf(view), area: view.size_px[0] * view.size_px[1] })).filter(({ number }) => number);
  if (layout !== 'presenter' || !open.length) return { grid: 'four', cells: four(active) };
  const sorted = [...open].sort((a, b) => b.area - a.area);
  const isLarge = open.length > 1 && sorted[0].area > large * sorted[1].area;
  const cells = (isLarge ? [sorted[0], ...open.filter((view) => view !== sorted[0])] : open).slice(0, 4).map(({ number }) => number);
  return { grid: ['one', 'two', 'three', isLarge ? '1+3' : 'four'][cells.length - 1], cells };
}
