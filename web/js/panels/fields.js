// Small controls that several panels use.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { live } from '../../lib/directives/live.js';
import { roving } from './roving.js';

/** A field for a number, with its unit inside. */
export function numberField(label, value, unit, isDisabled, change) {
  return html`<span class="field"><input type="number" step="any" .value=${live(String(value))} aria-label=${label} ?disabled=${isDisabled}
    @change=${(event) => Number.isFinite(event.target.valueAsNumber) && change(event.target.valueAsNumber, event)}>${unit ? html`<span>${unit}</span>` : nothing}</span>`;
}

/** Buttons to choose one of a few words. An option is [word, name] or [word, name, tooltip]. */
export function segment(label, options, chosen, isDisabled, choose) {
  return html`<div class="segment" role="radiogroup" aria-label=${label} @keydown=${roving}>${options.map(([id, name, about]) => html`<button role="radio" aria-checked=${id === chosen}
    tabindex=${id === chosen ? 0 : -1} class=${classMap({ on: id === chosen })} title=${about ?? nothing} ?disabled=${isDisabled} @click=${(event) => choose(id, event)}>${name}</button>`)}</div>`;
}

export function checkbox(name, isOn, isDisabled, change, about) {
  return html`<label title=${about ?? nothing}><input type="checkbox" .checked=${live(isOn)} ?disabled=${isDisabled} @change=${(event) => change(event.target.checked, event)}>${name}</label>`;
}
