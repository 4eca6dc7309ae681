// Selection of a reference curve: what its file says of it.
import { html, nothing } from '../../../lib/lit-html.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const facts = (rows) => html`<dl>${rows.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>`;

export function curveBlock({ room, ui }) {
  const shown = room.plan.value.curves.find(({ id }) => id === ui.selection.value.id);
  return shown
    ? html`<section class="block"><h3>${icon('curve')} ${say.referenceCurve({ curve: shown.name || shown.id })}</h3>
    ${facts(
      Object.entries(shown)
        .filter(([name, value]) => !['id', 'name'].includes(name) && ['number', 'string'].includes(typeof value) && value !== '')
        .map(([name, value]) => [name.replaceAll('_', ' '), String(value)]),
    )}</section>`
    : nothing;
}
