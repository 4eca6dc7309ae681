// Small controls that several panels use.
import { html, noChange, nothing } from '../../lib/lit-html.js';
import { Directive, directive } from '../../lib/directive.js';
import { classMap } from '../../lib/directives/class-map.js';
import { live } from '../../lib/directives/live.js';
import { roving } from './roving.js';

class Typed extends Directive {
  render(value) {
    return value;
  }

  update({ element }, [value]) {
    if (!this.isKnown) {
      this.isKnown = true;
      element.addEventListener('input', () => {
        this.isTyping = true;
      });
      element.addEventListener('change', () => {
        this.isTyping = false;
      });
    }
    if (this.isTyping && element === document.activeElement) return noChange;
    this.isTyping = false;
    if (element.value !== value) element.value = value;
    return noChange;
  }
}

/** The value of a field, as live(); but what a person is typing stays until it is entered, whatever is drawn again meanwhile. */
export const typed = directive(Typed);

/** A field for a number, with its unit inside. */
export function numberField(label, value, unit, isDisabled, change) {
  return html`<span class="field"><input type="number" step="any" .value=${typed(String(value))} aria-label=${label} ?disabled=${isDisabled}
    @change=${(event) => Number.isFinite(event.target.valueAsNumber) && change(event.target.valueAsNumber, event)}>${unit ? html`<span>${unit}</span>` : nothing}</span>`;
}

/** Buttons to choose one of a few words. An option is [word, name] or [word, name, tooltip]. */
export function segment(label, options, chosen, isDisabled, choose) {
  const stop = Math.max(
    0,
    options.findIndex(([id]) => id === chosen),
  ); // the first one where none is chosen
  return html`<div class="segment" role="radiogroup" aria-label=${label} @keydown=${roving}>${options.map(
    ([id, name, about], index) => html`<button role="radio" aria-checked=${id === chosen}
    tabindex=${index === stop ? 0 : -1} class=${classMap({ on: id === chosen })} title=${about ?? nothing} ?disabled=${isDisabled} @click=${(event) => choose(id, event)}>${name}</button>`,
  )}</div>`;
}

export function checkbox(name, isOn, isDisabled, change, about) {
  return html`<label title=${about ?? nothing}><input type="checkbox" .checked=${live(isOn)} ?disabled=${isDisabled} @change=${(event) => change(event.target.checked, event)}>${name}</label>`;
}

/** A key as a mark behind words; nothing for a command without a key. @param {string} text */
export const keyMark = (text) => (text ? html` <kbd>${text}</kbd>` : nothing);
