// Parts that both plots of dose have: head, what is said instead of a plot, buttons for files.
import { html, nothing } from '../../../../lib/lit-html.js';
import { classMap } from '../../../../lib/directives/class-map.js';
import { exportFile } from '../../../room/exports.js';
import { ofFits } from '../../fits/feature.js';
import { icon } from '../../../parts/icons.js';
import { say } from './words.js';

/** @param {'dvh'|'profile'} id @param {{csv: () => string, json: () => string}|null} files null: there is nothing to save */
export function downloads(world, id, files) {
  if (!world.room.control.mayExport) return nothing;
  const name = `${world.room.planId.value}-${id}`;
  return html`<div class="chart-files" role="group" aria-label=${say.save}><button class="small" ?disabled=${!files} title=${say.saveCsv} @click=${() => exportFile(world, id, `${name}.csv`, files.csv(), 'text/csv')}>${icon('download', 12)} CSV</button>
    <button class="small" ?disabled=${!files} title=${say.saveJson} @click=${() => exportFile(world, id, `${name}.json`, files.json(), 'application/json')}>${icon('download', 12)} JSON</button></div>`;
}

/** A button that opens the choices of a plot above its head. */
export function options({ ui }, id, words, content) {
  const name = `chart-${id}`;
  const isOpen = ui.popover.value === name;
  return html`<span class="anchor"><button class=${classMap({ 'icon-button': true, small: true, on: isOpen })} title=${words} aria-label=${words} aria-haspopup="dialog" aria-expanded=${isOpen} @click=${() => ui.toggle(name)}>${icon('sliders', 12)}</button>
    ${isOpen ? html`<div class="popover chart-options" role="dialog" aria-label=${words}>${content}</div>` : nothing}</span>`;
}

export function tableButton({ curves }, id, words) {
  const isOn = curves.isTable.value[id];
  return html`<button class=${classMap({ 'icon-button': true, small: true, on: isOn })} title=${isOn ? say.showPlot : say.showTable} aria-label=${words} aria-pressed=${isOn}
    @click=${() => {
      curves.isTable.value = { ...curves.isTable.value, [id]: !isOn };
    }}>${icon('table', 12)}</button>`;
}

/** Says why there is no plot; null where there is one. @param {{result: object|null, error: string, isOld: boolean}} state @param {{empty: string, idle: string}} words empty: of an answer
 *  without curves; idle: why nothing is asked, '' where an answer will come */
export function instead(state, { empty, idle }) {
  if (state.error) return html`<p class="chart-note refusal" role="alert">${icon('error', 16)}<span>${state.error}</span></p>`;
  if (!state.result) return html`<p class="chart-note empty">${idle || say.computed}</p>`;
  return empty ? html`<p class="chart-note empty">${empty}</p>` : null;
}

export const staleMark = (isOld) =>
  isOld ? html`<span class="chart-stale warn" title=${say.computedAnew}>${icon('stale', 12)} ${say.old}</span>` : nothing;
export const withoutMark = (missing) =>
  missing?.length
    ? html`<span class="chart-without warn">${icon('warning', 12)} ${say.without({ parts: missing.join(', ') })}</span>`
    : nothing;

/** Mark beside the numbers of parts that do not fit and are used by a person's word. */
export const doubtMark = ({ room }) => ofFits(room)?.numberMark({ room }) ?? nothing;
