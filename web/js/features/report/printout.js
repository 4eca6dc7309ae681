// The report to print: chosen snapshots with captions, facts of the plan, figures of regions and warnings of loading, as
// sheets of paper (js/features/report/printout.css).
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { live } from '../../../lib/directives/live.js';
import { isDrafted } from '../beams/beams.js';
import { beamWords, crosshair, doseWords, reportSummary, shownImage } from '../../room/plan.js';
import { approvalOf, dateWords, shownPatient, shownTreatmentPlan, unknownWords } from '../../room/identity.js';
import { volumeDifference } from '../regions/shapes.js';
import { draftBelongs, draftWords } from '../beams/beam_words.js';
import { hasCharts } from '../dose/plots/chart_loader.js';
import { printable } from '../../room/exports.js';
import { ofFits } from '../fits/feature.js';
import { statedBy } from '../../room/stated.js';
import { listed, number, signed, significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { measureName, valueText } from '../measures/measure_words.js';
import { say } from './printout_words.js';

const kinds = {
  '3d': say.space,
  axial: say.axial,
  coronal: say.coronal,
  sagittal: say.sagittal,
  oblique: say.oblique,
  beam: say.beam,
  'beam-slice': say.beamSlice,
};

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
  const print = printable(world, 'printed-report', `report on plan ${room.planId.value}`); // in the audit's language
  return html`<section class="printout" role="dialog" aria-modal="true" tabindex="-1" aria-label=${say.report}>
    <div class="printout-bar"><b>${say.report}</b><span class="note" role="status">${printout.isComplete.value ? '' : say.measuring}</span>
      <span class="grow"></span>
      <button class="primary" ?disabled=${!plan || !printout.isComplete.value} @click=${print}>${icon('print')}<span>${say.print}</span></button>
      <button class="icon-button" aria-label=${say.close} @click=${close}>${icon('close')}</button></div>
    ${printout.isKept.value ? nothing : html`<p class="note bar-note">${say.tooLarge}</p>`}
    ${plan ? sheet(world, plan) : html`<p class="empty">${say.loading}</p>`}</section>`;
}

/** A table of layout: its foot stands on every printed page. */
function sheet(world, plan) {
  const patient = patientWords(world, plan);
  return html`<article class="sheet"><div class="sheet-body">${head(world, plan)}
    ${hasCharts(plan) ? world.charts.draw('basis') : nothing}${pictures(world, plan)}${figures(world)}
    ${hasCharts(plan) ? world.charts.draw('printed') : nothing}${ofFits(world.room)?.usedSheet(world) ?? nothing}
    ${measures(world)}${warnings(plan)}</div>
  <footer class="sheet-foot"><div>${say.foot({ patient, plan: plan.name, time: printedAt(new Date()), revision: world.room.revision.value })}<br><b>${say.research}</b></div></footer></article>`;
}

/** "2026-11-27 14:36 UTC+2": of this computer. */
function printedAt(date) {
  const ahead = -date.getTimezoneOffset();
  const [hours, minutes] = [Math.floor(Math.abs(ahead) / 60), Math.abs(ahead) % 60];
  const local = new Date(date.getTime() + ahead * 60000).toISOString().slice(0, 16).replace('T', ' ');
  return `${local} UTC${ahead < 0 ? '−' : '+'}${hours}${minutes ? `:${String(minutes).padStart(2, '0')}` : ''}`;
}

/** Masked: a report is never of a full name. */
function patientWords({ room }, plan) {
  const patient = shownPatient(plan, room.scene.value);
  return patient ? listed(patient.masked, statedBy(plan)) : plan.isPhantom ? say.isPhantom : unknownWords;
}

/** The treatment plan that is shown, its approval and prescription; [] where the files have none. */
function treatmentRows({ room }, plan) {
  const treatment = shownTreatmentPlan(plan, room.scene.value);
  if (!treatment) return [];
  const { label, date, review_date: reviewed, reviewer, prescription_gy: gy, fractions } = treatment;
  return [
    [say.treatment, listed(label, dateWords(date))],
    [say.approval, listed(approvalOf(treatment)[0], dateWords(reviewed), reviewer)],
    [
      say.prescription,
      listed(
        Number.isFinite(gy) ? say.prescribed({ gy: significant(gy) }) : say.notStated,
        Number.isFinite(fractions) && say.nFractions({ n: fractions }),
      ),
    ],
  ];
}

/** Whether a draft beam stands in the room, whose dose is never shown. */
function draftRow({ room }, plan) {
  const scene = room.scene.value;
  if (!plan.beams.length && !isDrafted(plan, scene)) return [];
  return [[say.draftNow, isDrafted(plan, scene) ? listed(draftBelongs(plan, scene), draftWords(plan, scene)) : say.noDraft]];
}

function head(world, plan) {
  const { room } = world;
  const images = plan.images.map(({ id, modality, size, stepMm }) =>
    say.imageIs({ image: `${modality} ${id}`, size: size.join(' × '), step: stepMm.map((mm) => number(mm, 2)).join(' × ') }),
  );
  const name = html`${plan.name} <code>${room.planId.value}</code>`;
  const nRegions = plan.regions.length;
  const doses = plan.doses.map((dose) => say.doseIs({ dose: dose.name || dose.id, words: unitText(doseWords(dose)) }));
  const rows = [
    [say.plan, plan.isPhantom ? say.phantom({ plan: name }) : name],
    [say.patient, patientWords(world, plan)],
    ...treatmentRows(world, plan),
    [say.images, images.join('; ') || say.none],
    [say.regions, say.nRegions({ count: number(nRegions), n: nRegions })],
    [say.doses, doses.join('; ') || say.none],
    [say.beams, plan.beams.map((beam) => listed(beam.name || beam.id, beamWords(beam))).join('; ') || say.none],
    ...draftRow(world, plan),
    ...(room.accepted.value.size ? [] : [[say.used, say.none]]),
    ...(plan.note ? [[say.note, plan.note]] : []),
    [say.loadReport, reportSummary(plan.report)],
  ];
  const line = ([word, value]) => html`<tr><th scope="row">${word}</th><td>${value}</td></tr>`;
  return html`<h1>${plan.name}</h1><table class="facts"><tbody>${rows.map(line)}</tbody></table>`;
}

function pictures({ printout }, plan) {
  const entries = printout.entries.value;
  if (!entries.length) return html`<p class="empty on-screen">${say.noPicture}</p>`;
  return repeat(
    entries,
    ({ key }) => key,
    (entry, at) => {
      const { key, record } = entry;
      const n = at + 1;
      return html`<figure data-entry=${key}><img src=${entry.url} alt=${say.figureIs({ n, view: kinds[record.view.kind], plan: record.plan.name })}>
      <figcaption><b>${say.figure({ n })}</b> <span class="on-paper">${entry.caption}</span>
        <span class="on-screen edit"><input name="caption" aria-label=${say.captionOf({ n })} placeholder=${say.caption} maxlength="500"
          .value=${live(entry.caption)} @input=${(event) => printout.describe(key, event.target.value)} @change=${() => printout.keep()}>
          <button class="small" ?disabled=${at === 0} aria-label=${say.earlier({ n })} @click=${() => printout.move(key, -1)}>${say.up}</button>
          <button class="small" ?disabled=${n === entries.length} aria-label=${say.later({ n })} @click=${() => printout.move(key, 1)}>${say.down}</button>
          <button class="small" aria-label=${say.removeFigure({ n })} @click=${() => printout.remove(key)}>${say.remove}</button></span></figcaption>
      ${draft(entry, plan)}${values(entry, plan)}</figure>`;
    },
  );
}

/** Says whose dose the picture shows, if a beam was drafted. */
function draft({ record: { scene } }, plan) {
  if (!isDrafted(plan, scene)) return nothing;
  const facts = listed(draftBelongs(plan, scene), draftWords(plan, scene));
  return html`<p class="values">${say.draftIs({ draft: html`<b>${say.draftBeam}</b>`, facts })}</p>`;
}

/** The values at the picture's crosshair. */
function values({ record, probe }, plan) {
  const point = crosshair(record.scene);
  const at = say.crosshair({ place: ['L', 'P', 'S'].map((letter, axis) => `${letter} ${number(point[axis], 1)}`).join(', ') });
  if (!probe) return html`<p class="values">${say.notKnown({ crosshair: at })}</p>`;
  const image = shownImage(plan, record.scene);
  const value = probe.images?.find((other) => other.id === image?.id);
  const inside = (probe.regions ?? []).map((id) => plan.regions.find((region) => region.id === id)?.name).filter(Boolean);
  const doses = plan.doses
    .map((dose) => [dose, (probe.doses ?? []).filter((row) => row.id === dose.id && row.value !== null)])
    .filter(([, rows]) => rows.length);
  const imageValue =
    value && value.value !== null && [image.modality, significant(value.value), unitText(value.unit)].filter(Boolean).join(' ');
  const regions = inside.length ? inside.map((region) => say.inRegion({ region })) : [say.outside];
  return html`<p class="values">${say.valuesAre({ values: listed(at, imageValue, ...regions) })}
    ${doses.map((row) => html`<br>${doseValues(...row)}`)}</p>`;
}

function doseValues(dose, rows) {
  const values = rows.map(({ quantity, per_ppm: perPpm, value, unit }) =>
    (perPpm ? say.valuePerPpm : say.valueIs)({ quantity: quantity.replaceAll('-', ' '), value: significant(value), unit: unitText(unit) }),
  );
  const { per } = rows[0];
  const facts = { dose: dose.name || dose.id, per: unitText((per ?? '').replace(/^per /, '')), values: values.join(', ') };
  return (per ? say.dosePerValues : say.doseValues)(facts);
}

function figures({ printout }) {
  const rows = printout.figures.value;
  if (!rows.length) return nothing;
  const cells = ({ result, error }) =>
    result
      ? html`<td>${result.triangles ? number(result.triangles) : '–'}</td><td>${result.area_mm2 ? number(result.area_mm2 / 100, 1) : '–'}</td><td>${result.volume_mm3 ? number(result.volume_mm3 / 1000, 2) : '–'}</td>
    <td>${result.volume_mm3 ? `${signed(volumeDifference(result), 2)}` : '–'}</td><td>${Number.isFinite(result.distance_max_mm) ? number(result.distance_max_mm, 2) : '–'}</td>`
      : html`<td colspan="5">${error === null ? say.notMeasured : error || '…'}</td>`;
  const columns = [say.region, say.univels, say.volume, say.surface, say.triangles, say.area, say.encloses, say.toUnivels, say.off];
  const line = (row) => html`<tr><th scope="row">${row.region.name}</th><td>${number(row.region.voxels)}</td>
      <td>${number(row.region.volume_cm3, 2)}</td><td>${row.method}</td>${cells(row)}</tr>`;
  return html`<h2>${say.regions}</h2>${table(say.figures, columns, rows.map(line))}
    <p class="values">${say.figuresAre}</p>`;
}

const table = (label, columns, lines) =>
  html`<div class="numbers-scroll" role="group" tabindex="0" aria-label=${label}><table class="numbers-table">
    <thead><tr>${columns.map((word) => html`<th scope="col">${word}</th>`)}</tr></thead><tbody>${lines}</tbody></table></div>`;

/** The measures of the newest picture; without one, of the room as it is now. */
function measures(world) {
  const { room, printout } = world;
  const list = Object.entries(printout.entries.value.at(-1)?.record.scene.measures ?? room.scene.value?.measures ?? {});
  if (!list.length) return nothing;
  const place = (at) => `(${at.map((mm) => number(mm, 1)).join(', ')})`;
  const line = ([id, measure]) => html`<tr><th scope="row">${measureName(id, measure)}</th><td>${valueText(world, id, measure)}</td>
      <td>${measure.points.map(({ at_mm: at }) => place(at)).join(' ')}</td></tr>`;
  return html`<h2>${say.measures}</h2>${table(say.measures, [say.measure, say.value, say.points], list.map(line))}`;
}

function warnings(plan) {
  const lines = plan.report.lines.filter(({ severity }) => severity !== 'note');
  if (!lines.length) return nothing;
  const line = ({
    severity,
    code,
    sentence,
    where,
  }) => html`<li><b>${severity === 'error' ? say.error : say.warning}</b> <code>${code}</code>
      ${sentence}${where ? html` <span class="place">${where}</span>` : nothing}</li>`;
  const { dropped } = plan.report;
  return html`<h2>${say.noticed}</h2><ul class="noticed">${lines.map(line)}</ul>
    ${dropped ? html`<p class="values">${say.notKept({ count: number(dropped), n: dropped })}</p>` : nothing}`;
}
