// The table of limits of the inspector's Plan: each with its value and whether it is met; added, edited, removed, read from and saved as CSV.
import { html, nothing } from '../../../../lib/lit-html.js';
import { live } from '../../../../lib/directives/live.js';
import { repeat } from '../../../../lib/directives/repeat.js';
import { enums } from '../../../../gen/wire.js';
import { boundsWords, isOpen } from '../dose_dvh.js';
import { populationWords } from '../dose_population.js';
import {
  byState,
  constraintsCsv,
  constraintsFromCsv,
  freeConstraintId,
  measureOf,
  metricWords,
  mostConstraints,
  readConstraint,
  readMetric,
  verdictOf,
} from '../dose_constraints.js';
import { ownRegions } from '../../../room/identity.js';
import { doubtMark } from './chart_parts.js';
import { quantityName, regionName } from './chart_words.js';
import { exportFile } from '../../../room/exports.js';
import { number, significant, unitText } from '../../../parts/format.js';
import { icon } from '../../../parts/icons.js';
import { say } from './limit_words.js';

/** States of a verdict: icon, class, name, how many there are. */
const states = {
  met: ['check', 'ok', say.met, say.nMet],
  unmet: ['error', 'err', say.unmet, say.nUnmet],
  unknown: ['warning', 'warn', say.unknown, say.nUnknown],
};
const sides = { 'at-most': '≤', 'at-least': '≥' };
/** The unit of a quantity of the dose shown, as its file has it: a dose in cGy has limits in cGy. */
function unitOfQuantity({ room }, quantity) {
  const { doses } = room.plan.value;
  const shown = doses.find(({ id }) => id === room.scene.value.dose.id) ?? doses[0];
  const part = shown.components.find((component) => component.quantity === quantity);
  if (part?.unit) return unitText(part.unit);
  const base = shown.unit || 'Gy';
  return { weighted: `${base.replace(/\(w\)$/, '')}(w)`, isoeffective: `${base}(IsoE)` }[quantity] ?? base;
}
const limitUnit = (world, { metric, quantity }) => ({ dose: unitOfQuantity(world, quantity), percent: '%', cm3: 'cm³' })[measureOf(metric)];

/** All of the scene with what is known of them. */
export function limitRows({ room, curves }) {
  const { result, error } = curves.limits.value;
  return byState(
    Object.entries(room.scene.value.constraints ?? {}).map(([id, constraint]) => ({
      id,
      constraint,
      verdict: verdictOf(
        result?.constraints?.find((row) => row.id === id),
        error,
      ),
    })),
  );
}

export const verdictWord = ({ state }) => states[state][2];

export function verdictSign({ state }) {
  const [picture, style, word] = states[state];
  return html`<span class=${`chart-verdict ${style}`}>${icon(picture, 12)} ${word}</span>`;
}

/** "tumor", "D95 % ≥ 20 Gy(w)" */
export const limitWords = (world, { constraint }) => [
  regionName(world.room.plan.value)(constraint.region),
  `${metricWords(constraint.metric, unitOfQuantity(world, constraint.quantity))} ${sides[constraint.side]} ${significant(constraint.limit)} ${limitUnit(world, constraint)}`,
];

export function valueWords({ verdict }) {
  const words = boundsWords(verdict.bounds, significant);
  return Number.isFinite(verdict.bounds[0]) && !isOpen(verdict.bounds) ? `${words} ${unitText(verdict.unit)}` : words;
}

/** Names the weights that count: "each region's own weights", "weights of brain"; '' none. */
export function limitBasis({ room }, { constraint, verdict }) {
  const { tissue = '', quantity } = constraint;
  if (verdict.basis) return verdict.basis;
  return ['weighted', 'isoeffective'].includes(quantity)
    ? tissue
      ? say.weightsOf({ region: regionName(room.plan.value)(tissue) })
      : say.eachOwnWeights
    : '';
}

/** Which univels count in all limits. */
export const limitPopulation = ({ curves }) =>
  populationWords(curves.limits.value.result?.constraints?.find(({ population }) => population)?.population ?? '');

export function limitsBlock(world) {
  const { room, curves } = world;
  const plan = room.plan.value;
  const rows = limitRows(world);
  const isDisabled = !room.canChange.value;
  const editing = curves.editing.value;
  const isOld = curves.limits.value.isOld && rows.length > 0;
  const tally = Object.entries(states)
    .map(([state, [, , , words]]) => [words, rows.filter(({ verdict }) => verdict.state === state).length])
    .filter(([, n]) => n)
    .map(([words, n]) => words({ n }))
    .join(', ');
  const start = (id, values) => {
    curves.editing.value = { id, values, error: '' };
  };
  return html`<section class="block chart-limits" aria-label=${say.limits}><h3>${say.limits} <span class="dim">${tally}</span> ${rows.length ? doubtMark(world) : nothing}${isOld ? html` <span class="chart-stale warn">${icon('stale', 12)} ${say.old}</span>` : nothing}</h3>
    ${rows.length && limitPopulation(world) ? html`<p class="note">${say.univels({ population: limitPopulation(world) })}</p>` : nothing}
    ${
      rows.length
        ? html`<ul>${repeat(
            rows,
            ({ id }) => id,
            (row) => one(world, row, isDisabled, start),
          )}</ul>`
        : html`<p class="empty">${say.none}</p>`
    }
    ${
      editing
        ? form(world, isDisabled)
        : html`<div class="buttons"><button ?disabled=${isDisabled || rows.length >= mostConstraints || !ownRegions(plan, room.scene.value).length} @click=${() => start('', { region: ownRegions(plan, room.scene.value)[0].id, quantity: room.scene.value.dose.quantity, metric: 'D95%', side: 'at-least', limit: '', tissue: '' })}>${say.add}</button>
      <button ?disabled=${isDisabled} title=${say.columns} @click=${(event) => event.currentTarget.nextElementSibling.click()}>${icon('upload', 12)}<span>${say.importCsv}</span></button><input class="hidden" type="file" accept=".csv,text/csv" tabindex="-1" aria-hidden="true" @change=${(event) => read(world, event)}>
      ${room.control.mayExport ? html`<button ?disabled=${!rows.length} @click=${() => exportFile(world, 'limits', `${room.planId.value}-limits.csv`, constraintsCsv(rows, plan), 'text/csv')}>${icon('download', 12)}<span>CSV</span></button>` : nothing}</div>`
    }
    ${
      curves.importError.value
        ? html`<div class="refusal" role="alert">${icon('error', 16)}<p>${curves.importError.value}</p><button class="icon-button small" aria-label=${say.dismiss} @click=${() => {
            curves.importError.value = '';
          }}>${icon('close', 12)}</button></div>`
        : nothing
    }</section>`;
}

function one(world, row, isDisabled, start) {
  const { room } = world;
  const { id, constraint, verdict } = row;
  const [region, words] = limitWords(world, row);
  const remove = (event) => patch(world, { [id]: null }, event);
  const other = constraint.author && constraint.author !== room.identity?.name ? say.by({ author: constraint.author }) : '';
  return html`<li class="chart-limit" data-limit=${id}><b title=${constraint.author ? say.regionBy({ region, author: constraint.author }) : region}>${region}</b>${verdictSign(verdict)}<span><button class="icon-button small" title=${say.edit} aria-label=${say.editLimit({ region, limit: words })} ?disabled=${isDisabled} @click=${() => start(id, { ...constraint })}>${icon('sliders', 12)}</button><button
      class="icon-button small" title=${say.remove} aria-label=${say.removeLimit({ region, limit: words })} ?disabled=${isDisabled} @click=${remove}>${icon('trash', 12)}</button></span>
    <span>${words} <span class="note">${[quantityName(constraint.quantity), limitBasis(world, row), other].filter(Boolean).join(', ')}</span></span><b class="chart-value">${valueWords(row)} ${doubtMark(world)}</b>${verdict.reason ? html`<span class="dim">${verdict.state === 'unknown' ? say.unknownFor({ reason: verdict.reason }) : verdict.reason}</span>` : nothing}</li>`;
}

/** On one's own, a limit of the room is not taken away by leaving it out of the override, but by null there. */
function patch({ room, ui }, constraints, event) {
  room.patchScene({ constraints }, { view: ui.active.value, at: event?.timeStamp });
}

function form(world, isDisabled) {
  const { room, curves } = world;
  const { id, values, error } = curves.editing.value;
  const plan = room.plan.value;
  const set = (name) => (event) => {
    curves.editing.value = { id, values: { ...values, [name]: event.target.value }, error: '' };
  };
  const keep = (event) => {
    event.preventDefault();
    try {
      const constraint = readConstraint(curves.editing.value.values, plan);
      patch(world, { [id || freeConstraintId(room.scene.value.constraints, [], room.markSuffix)]: constraint }, event);
      curves.editing.value = null;
    } catch (problem) {
      curves.editing.value = { ...curves.editing.value, error: problem.message };
    }
  };
  const choice = (name, label, options) =>
    html`<label for=${`limit-${name}`}>${label}</label><select id=${`limit-${name}`} @change=${set(name)}>${options.map(([value, words]) => html`<option value=${value} .selected=${live(value === values[name])}>${words}</option>`)}</select>`;
  const regions = ownRegions(plan, room.scene.value);
  return html`<form class="chart-form" aria-label=${id ? say.editOne : say.newOne} @submit=${keep}>
    ${choice(
      'region',
      say.region,
      regions.map((region) => [region.id, region.name]),
    )}${choice(
      'quantity',
      say.quantity,
      enums.dose_quantity.map((quantity) => [quantity, quantityName(quantity)]),
    )}
    ${choice('tissue', say.weights, [['', say.regionsOwn], ...regions.map((region) => [region.id, say.ofRegion({ region: region.name })])])}
    <label for="limit-metric">${say.figure}</label><input id="limit-metric" maxlength="24" list="limit-metrics" title=${say.figures} .value=${live(values.metric)} @input=${set('metric')}><datalist id="limit-metrics">${['mean', 'min', 'max', 'D98%', 'D95%', 'D50%', 'D2%', 'D0.03cc', 'V20'].map((metric) => html`<option value=${metric}></option>`)}</datalist>
    ${choice('side', say.keepsIt, [
      ['at-most', say.atMost],
      ['at-least', say.atLeast],
    ])}
    <label for="limit-limit">${say.limit}</label><span class="pair"><input id="limit-limit" inputmode="decimal" .value=${live(String(values.limit))} @input=${set('limit')}><span class="dim">${readMetric(values.metric) ? limitUnit(world, { ...values, metric: readMetric(values.metric) }) : ''}</span></span>
    ${error ? html`<div class="refusal" role="alert">${icon('error', 16)}<p>${error}</p></div>` : nothing}
    <span></span><div class="buttons"><button class="primary" type="submit" ?disabled=${isDisabled}>${id ? say.change : say.addIt}</button><button type="button" @click=${() => {
      curves.editing.value = null;
    }}>${say.cancel}</button></div></form>`;
}

/** Reads a file whole or not at all: limits that are there already stay, and those of the file are added. */
async function read(world, event) {
  const { room, curves, ui } = world;
  const [file] = event.target.files;
  event.target.value = '';
  if (!file) return;
  curves.importError.value = '';
  try {
    const now = room.scene.value.constraints ?? {};
    const found = constraintsFromCsv(await file.text(), room.plan.value);
    const added = found.filter((constraint) => !Object.values(now).some((other) => isSame(other, constraint)));
    if (Object.keys(now).length + added.length > mostConstraints)
      throw new Error(say.tooMany({ n: Object.keys(now).length, all: Object.keys(now).length + added.length, most: mostConstraints }));
    const patched = {};
    for (const constraint of added) patched[freeConstraintId(now, Object.keys(patched), room.markSuffix)] = constraint;
    if (added.length) patch(world, patched);
    ui.notify(
      'ok',
      (found.length > added.length ? say.addedSome : say.added)({
        n: added.length,
        count: number(added.length),
        others: found.length - added.length,
      }),
      'limits',
    );
  } catch (error) {
    curves.importError.value = say.notRead({ file: file.name, reason: error.message });
  }
}

const isSame = (a, b) => ['region', 'quantity', 'metric', 'side', 'limit', 'tissue'].every((name) => (a[name] ?? '') === (b[name] ?? ''));
