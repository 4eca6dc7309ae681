// The table of limits of the inspector's Plan: each with its value and whether it is met; added, edited, removed, read from and saved as CSV.
import { html, nothing } from '../../../../lib/lit-html.js';
import { live } from '../../../../lib/directives/live.js';
import { repeat } from '../../../../lib/directives/repeat.js';
import { enums } from '../../../../gen/wire.js';
import { boundsWords } from '../dose_dvh.js';
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
import { count, significant, unitText } from '../../../parts/format.js';
import { icon } from '../../../parts/icons.js';

const icons = { met: ['check', 'ok'], 'not met': ['error', 'err'], 'not known': ['warning', 'warn'] };
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

export const verdictSign = ({ word }) => html`<span class=${`chart-verdict ${icons[word][1]}`}>${icon(icons[word][0], 12)} ${word}</span>`;

/** "tumor", "D95 % ≥ 20 Gy(w)" */
export const limitWords = (world, { constraint }) => [
  regionName(world.room.plan.value)(constraint.region),
  `${metricWords(constraint.metric, unitOfQuantity(world, constraint.quantity))} ${sides[constraint.side]} ${significant(constraint.limit)} ${limitUnit(world, constraint)}`,
];

export function valueWords({ verdict }) {
  const words = boundsWords(verdict.bounds, significant);
  return Number.isFinite(verdict.bounds[0]) && words !== 'not known' ? `${words} ${unitText(verdict.unit)}` : words;
}

/** Names the weights that count: "each region's own weights", "weights of brain"; '' none. */
export function limitBasis({ room }, { constraint, verdict }) {
  const { tissue = '', quantity } = constraint;
  if (verdict.basis) return verdict.basis;
  return ['weighted', 'isoeffective'].includes(quantity)
    ? tissue
      ? `weights of ${regionName(room.plan.value)(tissue)}`
      : "each region's own weights"
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
  const tally = Object.keys(icons)
    .map((word) => [word, rows.filter(({ verdict }) => verdict.word === word).length])
    .filter(([, n]) => n)
    .map(([word, n]) => `${n} ${word}`)
    .join(', ');
  const start = (id, values) => {
    curves.editing.value = { id, values, error: '' };
  };
  return html`<section class="block chart-limits" aria-label="Limits of dose"><h3>Limits of dose <span class="dim">${tally}</span> ${rows.length ? doubtMark(world) : nothing}${isOld ? html` <span class="chart-stale warn">${icon('stale', 12)} old</span>` : nothing}</h3>
    ${rows.length && limitPopulation(world) ? html`<p class="note">Univels: ${limitPopulation(world)}.</p>` : nothing}
    ${
      rows.length
        ? html`<ul>${repeat(
            rows,
            ({ id }) => id,
            (row) => one(world, row, isDisabled, start),
          )}</ul>`
        : html`<p class="empty">None. A limit says, for example, that the brain may have at most 10 Gy(w).</p>`
    }
    ${
      editing
        ? form(world, isDisabled)
        : html`<div class="buttons"><button ?disabled=${isDisabled || rows.length >= mostConstraints || !ownRegions(plan, room.scene.value).length} @click=${() => start('', { region: ownRegions(plan, room.scene.value)[0].id, quantity: room.scene.value.dose.quantity, metric: 'D95%', side: 'at-least', limit: '', tissue: '' })}>Add a limit</button>
      <button ?disabled=${isDisabled} title="Columns: region, quantity, metric, side, limit" @click=${(event) => event.currentTarget.nextElementSibling.click()}>${icon('upload', 12)}<span>Import CSV</span></button><input class="hidden" type="file" accept=".csv,text/csv" tabindex="-1" aria-hidden="true" @change=${(event) => read(world, event)}>
      <button ?disabled=${!rows.length} @click=${() => exportFile(world, 'limits', `${room.planId.value}-limits.csv`, constraintsCsv(rows, plan), 'text/csv')}>${icon('download', 12)}<span>CSV</span></button></div>`
    }
    ${
      curves.importError.value
        ? html`<div class="refusal" role="alert">${icon('error', 16)}<p>${curves.importError.value}</p><button class="icon-button small" aria-label="Dismiss" @click=${() => {
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
  return html`<li class="chart-limit" data-limit=${id}><b title=${constraint.author ? `${region}, by ${constraint.author}` : region}>${region}</b>${verdictSign(verdict)}<span><button class="icon-button small" title="Edit" aria-label=${`Edit the limit ${region} ${words}`} ?disabled=${isDisabled} @click=${() => start(id, { ...constraint })}>${icon('sliders', 12)}</button><button
      class="icon-button small" title="Remove" aria-label=${`Remove the limit ${region} ${words}`} ?disabled=${isDisabled} @click=${remove}>${icon('trash', 12)}</button></span>
    <span>${words} <span class="note">${[quantityName(constraint.quantity), limitBasis(world, row)].filter(Boolean).join(', ')}${constraint.author && constraint.author !== room.identity?.name ? `, by ${constraint.author}` : ''}</span></span><b class="chart-value">${valueWords(row)} ${doubtMark(world)}</b>${verdict.reason ? html`<span class="dim">${verdict.word === 'not known' ? `not known: ${verdict.reason}` : verdict.reason}</span>` : nothing}</li>`;
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
  return html`<form class="chart-form" aria-label=${id ? 'Edit a limit' : 'A new limit'} @submit=${keep}>
    ${choice(
      'region',
      'Region',
      regions.map((region) => [region.id, region.name]),
    )}${choice(
      'quantity',
      'Quantity',
      enums.dose_quantity.map((quantity) => [quantity, quantityName(quantity)]),
    )}
    ${choice('tissue', 'Weights', [['', "the region's own"], ...regions.map((region) => [region.id, `of ${region.name}`])])}
    <label for="limit-metric">Figure</label><input id="limit-metric" maxlength="24" list="limit-metrics" title="mean, min, max, D95%, D2cc, V20, V20cc" .value=${live(values.metric)} @input=${set('metric')}><datalist id="limit-metrics">${['mean', 'min', 'max', 'D98%', 'D95%', 'D50%', 'D2%', 'D0.03cc', 'V20'].map((metric) => html`<option value=${metric}></option>`)}</datalist>
    ${choice('side', 'Keeps it', [
      ['at-most', 'at most'],
      ['at-least', 'at least'],
    ])}
    <label for="limit-limit">Limit</label><span class="pair"><input id="limit-limit" inputmode="decimal" .value=${live(String(values.limit))} @input=${set('limit')}><span class="dim">${readMetric(values.metric) ? limitUnit(world, { ...values, metric: readMetric(values.metric) }) : ''}</span></span>
    ${error ? html`<div class="refusal" role="alert">${icon('error', 16)}<p>${error}</p></div>` : nothing}
    <span></span><div class="buttons"><button class="primary" type="submit" ?disabled=${isDisabled}>${id ? 'Change it' : 'Add it'}</button><button type="button" @click=${() => {
      curves.editing.value = null;
    }}>Cancel</button></div></form>`;
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
      throw new Error(
        `With the ${Object.keys(now).length} that are there, there would be ${Object.keys(now).length + added.length} limits; a scene has at most ${mostConstraints}.`,
      );
    const patched = {};
    for (const constraint of added) patched[freeConstraintId(now, Object.keys(patched), room.markSuffix)] = constraint;
    if (added.length) patch(world, patched);
    ui.notify(
      'ok',
      `${count(added.length, 'limit')} added${found.length > added.length ? `, ${found.length - added.length} there already` : ''}.`,
      'limits',
    );
  } catch (error) {
    curves.importError.value = `${file.name} was not read. ${error.message}`;
  }
}

const isSame = (a, b) => ['region', 'quantity', 'metric', 'side', 'limit', 'tissue'].every((name) => (a[name] ?? '') === (b[name] ?? ''));
