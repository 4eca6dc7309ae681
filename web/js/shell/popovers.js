// Keeps open popovers inside the window: moved to the side, above their button where there is no room below. Loaded before the first click.
import { effect } from '../../lib/signals-core.js';
import { boxOf, pageFactor } from '../parts/page_look.js';

const edge = 6; // px to the sides of the window

/** How far a box has to go, to each side of which `low` and `high` are free. */
const inside = (from, to, low, high) => (from < low || to - from > high - low ? low - from : to > high ? high - to : 0);

/**
 * @param {{left, top, right, bottom, height}} box of the popover @param {{top: number}} anchor its button's box @param {{width, height}} window
 * @returns {{x: number, y: number}} how far it has to be moved
 */
export function movedInside(box, anchor, { width, height }) {
  const x = inside(box.left, box.right, edge, width - edge);
  const isBelow = box.top >= anchor.top;
  const above = anchor.top - edge - box.height;
  if (isBelow && box.bottom > height - edge && above >= edge) return { x, y: above - box.top };
  return { x, y: inside(box.top, box.bottom, edge, height - edge) };
}

/** @param {HTMLElement} host of the page @returns {() => void} stops */
export function keepInside(host, ui) {
  const place = (popover) => {
    popover.style.translate = '';
    const anchor = popover.closest('.anchor');
    if (!anchor) return;
    const { clientWidth, clientHeight } = document.documentElement;
    const { x, y } = movedInside(boxOf(popover), boxOf(anchor), { width: clientWidth / pageFactor(), height: clientHeight / pageFactor() });
    if (x || y) popover.style.translate = `${Math.round(x)}px ${Math.round(y)}px`;
  };
  const observer = new ResizeObserver((entries) => entries.forEach(({ target }) => place(target)));
  const watch = () => host.querySelectorAll('.anchor > .popover').forEach((popover) => observer.observe(popover));
  const drawn = new MutationObserver(watch); // some are loaded first
  const stop = effect(() => {
    observer.disconnect();
    drawn.disconnect();
    if (!ui.popover.value) return;
    drawn.observe(host, { childList: true, subtree: true });
    watch();
  });
  return () => {
    stop();
    observer.disconnect();
    drawn.disconnect();
  };
}
