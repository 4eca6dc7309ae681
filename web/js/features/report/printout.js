// The report to print: chosen snapshots with captions, facts of the plan, figures of regions and warnings of loading, as
// sheets of paper (js/features/report/printout.css).
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { live } from '../../../lib/directives/live.js';
import { isDrafted } from '../beams/beams.js';
import { beamWords, crosshair, doseWords, reportSummary, shownImage } from '../../room/plan.js';
import { volumeDifference } from '../regions/shapes.js';
import { draftBelongs, draftWords } from '../beams/beam_words.js';
import { hasCharts } from '../dose/plots/chart_loader.js';
import { printable } from '../../room/exports.js';
import { ofFits } from '../fits/feature.js';
import { count, number, signed, significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { measureName, valueText } from '../measures/measure_words.js';

const kinds = {
  '3d': '3-D',
  axial: 'Axial',
  coronal: 'Coronal',
  sagittal: 'Sagittal',
  oblique: 'Oblique',
  beam: "Beam's-eye view",
  'beam-slice': 'Beam slice',
};
const research = 'For research and plan review. Not a medical device; not for diagnosis or treatment decisions.';

let measured = null; // what the figures were measured for: the list of entries

export function printoutDialog(world) {
  const { room, ui, printout } = world;
  if (ui.popover.value !== 'printout') {
    if (measured) printout.stop();
    measured = null;
    return nothing;
  }
  const plan = room.plan.value;
  const records = printout.entries.value.map(({ record }) => record);
  if (plan && !(measured && measured.length === records.length && records.every((record) => measured.includes(record)))) {
    measured = records;
    queueMicrotask(() => printout.measure(room.planId.peek(), plan));
  }
  const close = () => {
    ui.popover.value = '';
  };
  return html`<section class="printout" role="dialog" aria-modal="true" tabindex="-1" aria-label="Report to print">
    <div class="printout-bar"><b>Report to print</b><span class="note" role="status">${printout.isComplete.value ? '' : 'Measuring surfaces …'}</span><span class="grow"></span>
      <button class="primary" ?disabled=${!plan || !printout.isComplete.value} @click=${printable(world, 'printed-report', `report on plan ${room.planId.value}`)}>${icon('print')}<span>Print or save as PDF</span></button>
      <button class="icon-button" aria-label="Close" @click=${close}>${icon('close')}</button></div>
    ${printout.isKept.value ? nothing : html`<p class="note bar-note">These pictures are too large to be kept when the page is loaded again: print before that.</p>`}
    ${plan ? sheet(world, plan) : html`<p class="empty">The plan is being loaded.</p>`}</section>`;
}

/** A table of layout: its foot stands on every printed page. */
const sheet = (
  world,
  plan,
) => html`<article class="sheet"><div class="sheet-body">${head(world, plan)}${pictures(world, plan)}${figures(world)}${hasCharts(plan) ? world.charts.draw('printed') : nothing}${ofFits(world.room)?.usedSheet(world) ?? nothing}${measures(world)}${warnings(plan)}</div>
  <footer class="sheet-foot"><div>${plan.name} · printed ${new Date().toISOString().slice(0, 16).replace('T', ' ')} UTC · revision ${world.room.revision.value}<br><b>${research}</b></div></footer></article>`;

function head({ room }, plan) {
  const images = plan.images.map(
    ({ id, modality, size, stepMm }) =>
      `${modality} ${id}, ${size.join(' × ')} voxels, ${stepMm.map((mm) => number(mm, 2)).join(' × ')} mm`,
  );
  const rows = [
    ['Plan', html`${plan.name} <code>${room.planId.value}</code>${plan.isPhantom ? ' (phantom)' : ''}`],
    ['Images', images.join('; ') || 'none'],
    ['Regions', `${count(plan.regions.length, 'region')}`],
    ['Doses', plan.doses.map((dose) => `${dose.name || dose.id}: ${unitText(doseWords(dose))}`).join('; ') || 'none'],
    ['Beams', plan.beams.map((beam) => [beam.name || beam.id, beamWords(beam)].filter(Boolean).join(', ')).join('; ') || 'none'],
    ...(plan.note ? [['Note', plan.note]] : []),
    ['Load report', reportSummary(plan.report)],
  ];
  return html`<h1>${plan.name}</h1><table class="facts"><tbody>${rows.map(([name, value]) => html`<tr><th scope="row">${name}</th><td>${value}</td></tr>`)}</tbody></table>`;
}

function pictures({ printout }, plan) {
  const entries = printout.entries.value;
  if (!entries.length)
    return html`<p class="empty on-screen">No picture yet. Close this, choose a pane, and use “Add it to the report to print” under the camera.</p>`;
  return repeat(
    entries,
    ({ key }) => key,
    (entry, at) => {
      const { key, record } = entry;
      const name = `Figure ${at + 1}`;
      return html`<figure data-entry=${key}><img src=${entry.url} alt=${`${name}: ${kinds[record.view.kind]} of ${record.plan.name}`}>
      <figcaption><b>${name}.</b> <span class="on-paper">${entry.caption}</span>
        <span class="on-screen edit"><input name="caption" aria-label=${`Caption of ${name}`} placeholder="Caption" maxlength="500" .value=${live(entry.caption)} @input=${(event) => printout.describe(key, event.target.value)} @change=${() => printout.keep()}>
          <button class="small" ?disabled=${at === 0} aria-label=${`${name} earlier`} @click=${() => printout.move(key, -1)}>Up</button>
          <button class="small" ?disabled=${at === entries.length - 1} aria-label=${`${name} later`} @click=${() => printout.move(key, 1)}>Down</button>
          <button class="small" aria-label=${`Remove ${name}`} @click=${() => printout.remove(key)}>Remove</button></span></figcaption>
      ${draft(entry, plan)}${values(entry, plan)}</figure>`;
    },
  );
}

/** Says whose dose the picture shows, if a beam was drafted. */
function draft({ record: { scene } }, plan) {
  return isDrafted(plan, scene)
    ? html`<p class="values"><b>Draft beam:</b> ${[draftBelongs(plan, scene), draftWords(plan, scene)].filter(Boolean).join(', ')}.</p>`
    : nothing;
}

/** The values at the picture's crosshair. */
function values({ record, probe }, plan) {
  const point = crosshair(record.scene);
  const place = html`Crosshair at ${['L', 'P', 'S'].map((letter, axis) => `${letter} ${number(point[axis], 1)}`).join(', ')} mm`;
  if (!probe) return html`<p class="values">${place}: values are not known.</p>`;
  const image = shownImage(plan, record.scene);
  const value = probe.images?.find((other) => other.id === image?.id);
  const inside = (probe.regions ?? []).map((id) => plan.regions.find((region) => region.id === id)?.name).filter(Boolean);
  const doses = plan.doses
    .map((dose) => [dose, (probe.doses ?? []).filter((row) => row.id === dose.id && row.value !== null)])
    .filter(([, rows]) => rows.length);
  return html`<p class="values">${place}${value && value.value !== null ? `, ${image.modality} ${significant(value.value)}${value.unit ? ` ${value.unit}` : ''}` : ''}${inside.length ? `, in ${inside.join(', in ')}` : ', outside every region'}.
    ${doses.map(
      ([dose, rows]) =>
        html`<br>${dose.name || dose.id}${rows[0].per ? `, per ${unitText(rows[0].per.replace(/^per /, ''))}` : ''}: ${rows
          .map(
            (row) => `${row.quantity.replaceAll('-', ' ')}${row.per_ppm ? ' per ppm' : ''} ${significant(row.value)} ${unitText(row.unit)}`,
          )
          .join(', ')}.`,
    )}</p>`;
}

function figures({ printout }) {
  const rows = printout.figures.value;
  if (!rows.length) return nothing;
  const cells = ({ result, error }) =>
    result
      ? html`<td>${result.triangles ? number(result.triangles) : '–'}</td><td>${result.area_mm2 ? number(result.area_mm2 / 100, 1) : '–'}</td><td>${result.volume_mm3 ? number(result.volume_mm3 / 1000, 2) : '–'}</td>
    <td>${result.volume_mm3 ? `${signed(volumeDifference(result), 2)}` : '–'}</td><td>${Number.isFinite(result.distance_max_mm) ? number(result.distance_max_mm, 2) : '–'}</td>`
      : html`<td colspan="5">${error || '…'}</td>`;
  return html`<h2>Regions</h2><div class="numbers-scroll" role="group" tabindex="0" aria-label="Figures of the regions"><table class="numbers-table"><thead><tr><th scope="col">Region</th><th scope="col">Univels</th><th scope="col">Volume, cm³</th><th scope="col">Surface</th><th scope="col">Triangles</th><th scope="col">Area, cm²</th><th scope="col">Encloses, cm³</th><th scope="col">to univels, %</th><th scope="col">Off at most, mm</th></tr></thead>
    <tbody>${rows.map((row) => html`<tr><th scope="row">${row.region.name}</th><td>${number(row.region.voxels)}</td><td>${number(row.region.volume_cm3, 2)}</td><td>${row.method}</td>${cells(row)}</tr>`)}</tbody></table></div>
    <p class="values">Univels and volume are the region's own; surfaces enclose all regions inside it as well. Off: distance from the univels' border.</p>`;
}

/** The measures of the newest picture; without one, of the room as it is now. */
function measures(world) {
  const { room, printout } = world;
  const list = Object.entries(printout.entries.value.at(-1)?.record.scene.measures ?? room.scene.value?.measures ?? {});
  if (!list.length) return nothing;
  const place = (at) => `(${at.map((mm) => number(mm, 1)).join(', ')})`;
  return html`<h2>Measures</h2><div class="numbers-scroll" role="group" tabindex="0" aria-label="Measures"><table class="numbers-table"><thead><tr><th scope="col">Measure</th><th scope="col">Value</th><th scope="col">Points, mm L P S</th></tr></thead>
    <tbody>${list.map(([id, measure]) => html`<tr><th scope="row">${measureName(id, measure)}</th><td>${valueText(world, id, measure)}</td><td>${measure.points.map(({ at_mm: at }) => place(at)).join(' ')}</td></tr>`)}</tbody></table></div>`;
}

function warnings(plan) {
  const lines = plan.report.lines.filter(({ severity }) => severity !== 'note');
  if (!lines.length) return nothing;
  return html`<h2>Noticed while loading</h2><ul class="noticed">${lines.map(({ severity, code, sentence, where }) => html`<li><b>${severity === 'error' ? 'Error' : 'Warning'}</b> <code>${code}</code> ${sentence}${where ? html` <span class="place">${where}</span>` : nothing}</li>`)}</ul>
    ${plan.report.dropped ? html`<p class="values">${count(plan.report.dropped, 'line')} more are not kept.</p>` : nothing}`;
}
