// A slider over the plan's box with one thumb, or with two for the low and the high plane of an axis; the part between them is kept.
import { html } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { variables } from '../../parts/mount.js';
import { sliderKey } from '../../parts/slider_keys.js';

const percent = (value, { low, high }) => Math.min(Math.max((value - low) / Math.max(high - low, 1e-9), 0), 1) * 100;

/**
 * @param {{low: number, high: number}} range
 * @param {{label: string, value: number, text: string, isOn: boolean, isChosen: boolean, move: (mm: number, event: Event) => void}[]} thumbs from low to high
 * @param {[number, number]} kept the part that is kept, mm
 */
export function clipRange(range, thumbs, kept, isDisabled) {
  const from = percent(kept[0], range);
  return html`<div class="clip-range" ${variables({ '--from': `${from}%`, '--kept': `${Math.max(percent(kept[1], range) - from, 0)}%` })}>${thumbs.map(
    (thumb) => html`<i
    class=${classMap({ 'clip-thumb': true, off: !thumb.isOn, chosen: thumb.isChosen })} role="slider" tabindex=${isDisabled ? -1 : 0} aria-label=${thumb.label} aria-disabled=${isDisabled}
    aria-valuemin=${range.low} aria-valuemax=${range.high} aria-valuenow=${thumb.value} aria-valuetext=${thumb.text} ${variables({ '--at': `${percent(thumb.value, range)}%` })}
    @pointerdown=${(event) => !isDisabled && hold(event)} @pointermove=${(event) => event.currentTarget.hasPointerCapture(event.pointerId) && thumb.move(valueAt(event, range), event)}
    @keydown=${(event) => !isDisabled && step(event, thumb, range)}></i>`,
  )}</div>`;
}

function hold(event) {
  event.currentTarget.setPointerCapture(event.pointerId);
  event.currentTarget.focus();
  event.preventDefault();
}

function valueAt({ currentTarget, clientX }, { low, high }) {
  const { left, width } = currentTarget.parentElement.getBoundingClientRect();
  return low + Math.min(Math.max((clientX - left) / width, 0), 1) * (high - low);
}

function step(event, thumb, range) {
  const value = sliderKey(event, thumb.value, range);
  if (value === null) return;
  event.preventDefault();
  thumb.move(value, event);
}
