// The inspector's Probe: values of image, regions and doses at the crosshair.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { crosshair, frameWords, shownImage } from '../state/plan.js';
import { count, number, significant, unitText } from './format.js';
import { icon } from './icons.js';

export function probe({ room, ui, probed }) {
  const plan = room.plan.value;
  const scene = room.scene.value;
  const image = shownImage(plan, scene);
  const { result, error, isOld } = probed.value;
  const value = result?.images?.find((other) => other.id === image?.id);
  const point = crosshair(scene);
  return html`<section class="block"><h3>Probe at crosshair</h3>
      <div class="numbers">${['L', 'P', 'S'].map((letter, axis) => html`<div><span class="dim">${letter}</span><b>${number(point[axis], 1)}${axis === 2 ? ' mm' : ''}</b></div>`)}
        ${image ? html`<div class=${classMap({ end: true, old: isOld })}><span class="dim">${image.modality}</span><b>${value && value.value !== null ? `${significant(value.value)} ${value.unit}` : '–'}</b></div>` : nothing}</div>
      <div class=${classMap({ inside: true, old: isOld })}>${error ? html`<span class="err">${icon('error')} ${error}</span>` : inside(plan, scene, result, ui)}</div></section>
    ${result ? doses(plan, scene, result, isOld) : nothing}`;
}

export const swatch = (color) => html`<svg class="swatch" viewBox="0 0 12 12" width="12" height="12" aria-hidden="true"><rect width="12" height="12" rx="2.5" fill=${color}/></svg>`;

function inside(plan, scene, result, ui) {
  if (!result) return html`<span class="dim">…</span>`;
  const regions = result.regions.map((id) => plan.regions.find((region) => region.id === id)).filter(Boolean);
  if (!regions.length) return plan.regions.length ? html`<span class="dim">outside every region</span>` : nothing;
  const [first, ...outer] = regions;
  return html`${swatch(scene.regions[first.id]?.color ?? first.color)}
    <button class="link" title="Select this region" @click=${() => ui.choose('region', first.id)}>${first.name}</button><span class="dim">${outer.map((region) => `in ${region.name}`).join(', ')}</span>`;
}

/** The shown dose in full, the others folded. */
function doses(plan, scene, result, isOld) {
  if (!plan.doses.length) return nothing;
  const shown = plan.doses.find(({ id }) => id === scene.dose.id) ?? plan.doses[0];
  const others = plan.doses.filter((dose) => dose !== shown);
  const rowsOf = (dose) => result.doses.filter(({ id }) => id === dose.id);
  return html`<section class="block"><h3>Dose <span class="dim">${shown.name || shown.id}</span></h3>${table(rowsOf(shown), isOld)}</section>
    ${others.length ? html`<details class="block more"><summary>${icon('chevronDown', 12)}<span>${others.length === 1 ? `1 more dose, ${others[0].name || others[0].id}` : count(others.length, 'more dose')}</span></summary>
      ${others.map((dose) => html`${others.length > 1 ? html`<h3>Dose <span class="dim">${dose.name || dose.id}</span></h3>` : nothing}${table(rowsOf(dose), isOld)}`)}</details>` : nothing}`;
}

const isFluence = ({ quantity }) => quantity.endsWith('fluence');

function table(rows, isOld) {
  if (!rows.length) return html`<p class="outside">outside the dose grid</p>`;
  const fluences = rows.filter(isFluence);
  const parts = rows.filter((row) => !isFluence(row));
  const [{ per }] = rows;
  return html`${byUnit(parts, isOld)}
    ${fluences.length ? html`<details class="more"><summary>${icon('chevronDown', 12)}<span>${count(fluences.length, 'fluence')}</span></summary>${byUnit(fluences, isOld)}</details>` : nothing}
    <p class="note">${per ? `Per ${unitText(per.replace(/^per /, ''))}. ` : ''}${parts.length ? `Physical, no weights${parts.some(({ quantity }) => hasWeights.has(quantity)) ? ', but for weighted total and blood boron: there the file has put them in' : ''}.` : ''}${boronNote(parts)}</p>
    ${frameWords(rows[0]) ? html`<p class="note why">${icon('warning', 12)} ${frameWords(rows[0])}</p>` : nothing}`;
}

const totalsFirst = (a, b) => Number(b.quantity.includes('total')) - Number(a.quantity.includes('total'));

/** A table for each unit, so that the unit stands once, in the head. */
function byUnit(rows, isOld) {
  const units = [...new Set(rows.map((row) => row.unit))];
  return units.map((unit) => html`<table class=${classMap({ old: isOld })}><thead><tr><th scope="col">${isFluence(rows[0]) ? 'Fluence' : 'Component'}</th><th scope="col">${unitText(unit)}</th></tr></thead>
    <tbody>${rows.filter((row) => row.unit === unit).sort(totalsFirst).map((row) => html`<tr class=${classMap({ total: row.quantity.includes('total') })}><td>${componentName(row)}</td><td>${row.value === null ? 'not known here' : significant(row.value)}</td></tr>`)}</tbody></table>`);
}

export const componentName = ({ quantity, per_ppm: perPpm, boron_ppm: ppm }) =>
  `${quantity[0].toUpperCase()}${quantity.slice(1).replaceAll('-', ' ').replace(/ fluence$/, '')}${perPpm ? ', per ppm' : ''}${Number.isFinite(ppm) ? `, boron at ${ppm} ppm` : ''}`;

/** The boron that a total includes; it cannot be taken out, so it is shown beside the value. */
function boronNote(rows) {
  const total = rows.find(({ boron_ppm: ppm }) => Number.isFinite(ppm));
  return total ? ` The ${total.quantity.replaceAll('-', ' ')} is with boron at ${total.boron_ppm} ppm in blood.` : '';
}
const hasWeights = new Set(['weighted-total', 'blood-boron']);
