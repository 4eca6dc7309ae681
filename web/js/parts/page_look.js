// Size and colours of the page, as a person chose them; kept by the browser. The page is laid out in its own px and drawn `size` per cent as large, so places on the
// screen are told in these px by placeOf and boxOf.
import { effect, signal } from '../../lib/signals-core.js';

const key = 'beamroom look';
export const sizes = [100, 125, 150, 200]; // per cent
export const colours = ['dark', 'light', 'system'];

export const pageSize = signal(100);
export const pageColours = signal('dark');
let factor = 1;

/** How much larger than CSS px the page's own px are. */
export const pageFactor = () => factor;

/** Pixels of a picture for each of the page's px. */
export const pixelRatio = () => Math.min((globalThis.devicePixelRatio || 1) * factor, 2);

/** @param {{clientX: number, clientY: number}} event @returns {{x: number, y: number}} in the page's px */
export const placeOf = ({ clientX, clientY }) => ({ x: clientX / factor, y: clientY / factor });

/** The box of an element in the page's px. @param {Element} element @returns {{left, top, right, bottom, width, height}} */
export function boxOf(element) {
  const { left, top, right, bottom, width, height } = element.getBoundingClientRect();
  return {
    left: left / factor,
    top: top / factor,
    right: right / factor,
    bottom: bottom / factor,
    width: width / factor,
    height: height / factor,
  };
}

const conditions = new WeakMap(); // of a rule, as its sheet has it

/** Widths that a sheet asks the window for count in the page's px. @param {CSSStyleSheet|null} sheet */
export function scaleConditions(sheet) {
  for (const rule of sheet?.cssRules ?? []) {
    if (rule.media && !(factor === 1 && !conditions.has(rule))) {
      if (!conditions.has(rule)) conditions.set(rule, rule.media.mediaText);
      rule.media.mediaText = conditions.get(rule).replace(/([\d.]+)px/g, (_, px) => `${Number(px) * factor}px`);
    }
    if (rule.cssRules?.length) scaleConditions(rule);
  }
}

/** Takes what the browser kept, and shows the page so. @param {{getItem: Function, setItem: Function}|null} storage */
export function keepLook(storage) {
  const root = document.documentElement;
  const isLight = matchMedia('(prefers-color-scheme: light)');
  const system = signal(isLight.matches);
  isLight.addEventListener('change', () => {
    system.value = isLight.matches;
  });
  try {
    const kept = JSON.parse(storage?.getItem(key) ?? '{}');
    if (sizes.includes(kept.size)) pageSize.value = kept.size;
    if (colours.includes(kept.colours)) pageColours.value = kept.colours;
  } catch {
    // as it is without
  }
  effect(() => {
    const isNow = pageColours.value === 'light' || (pageColours.value === 'system' && system.value);
    root.dataset.colours = isNow ? 'light' : 'dark';
  });
  effect(() => {
    const next = pageSize.value / 100;
    if (next === factor) return;
    factor = next;
    root.style.setProperty('--page', factor === 1 ? '' : String(factor));
    root.toggleAttribute('data-scaled', factor !== 1);
    for (const sheet of document.styleSheets) scaleConditions(sheet);
    dispatchEvent(new Event('resize')); // panels and panes find their places anew
  });
  effect(() => {
    const kept = JSON.stringify({ size: pageSize.value, colours: pageColours.value });
    try {
      if (pageSize.value === 100 && pageColours.value === 'dark')
        storage?.removeItem(key); // nothing chosen, nothing kept
      else storage?.setItem(key, kept);
    } catch {
      // a browser that keeps nothing starts with the standard next time
    }
  });
}
