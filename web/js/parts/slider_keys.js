// Keys of a slider of our own: where its value goes. Pure.

/**
 * Arrows 1, with Shift 10 as Page up and Page down; Home and End the ends.
 * @param {{key: string, shiftKey?: boolean}} event @param {{low: number, high: number}} range @returns {number|null} null: a key of something else
 */
export function sliderKey({ key, shiftKey = false, ctrlKey = false, altKey = false, metaKey = false }, value, { low, high }) {
  if (ctrlKey || altKey || metaKey) return null;
  if (key === 'Home') return low;
  if (key === 'End') return high;
  const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[key];
  if (!steps) return null;
  return Math.min(Math.max(value + steps * (shiftKey && key.startsWith('Arrow') ? 10 : 1), low), high);
}
