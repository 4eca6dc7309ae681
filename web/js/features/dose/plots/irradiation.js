// How long to irradiate: what is given, when each limit is reached, and what the targets have then. In the inspector's Plan, and on paper.
import { html, nothing } from '../../../../lib/lit-html.js';
import { live } from '../../../../lib/directives/live.js';
import { enums } from '../../../../gen/wire.js';
import { boundsWords } from '../dose_dvh.js';
import { doubtMark } from './chart_parts.js';
import { doseName, quantityName, regionName } from './chart_words.js';
import { limitWords } from './chart_limits.js';
import { typed } from '../../../parts/fields.js';
import { number, significant, unitText } from '../../../parts/format.js';
import { icon } from '../../../parts/icons.js';
import { say } from './irradiation_words.js';

const [highestPpm, mostFields] = [1000, 16]; // proto/scene.json
const bounds = (row, name) => [row[`${name}_least`] ?? row[name] ?? NaN, row[`${name}_most`] ?? row[name] ?? Infinity];
const isThere = (row, name) => Number.isFinite(row[`${name}_least`] ?? row[name]);

/** Limits in the order in which they end an irradiation; then those that it has to reach, and those that are not known. */
const inOrder = (limits) =>
  [...limits].sort((a, b) => place(a) - place(b) || (a.units ?? a.units_least ?? 0) - (b.units ?? b.units_least ?? 0));
const place = (row) => (row.units === null ? 2 : row.side === 'at-most' ? 0 : 1) + (row.is_never ? 1 : 0);

export function timeWords(result, units, minutes) {
  const words = { units: significant(units), output: unitText(result.output), minutes: significant(minutes) };
  return Number.isFinite(minutes) && !result.output.startsWith('min') ? say.timeIs(words) : say.timeOf(words);
}

const limitName = (world, row) => limitWords(world, { constraint: row }).join(' ');

/** Says when a limit is reached: "up to 38.2", "never", or why it is not known. */
function reached(row) {
  if (row.is_never) return say.never;
  if (!isThere(row, 'units')) return say.notKnown({ reason: row.reason ?? say.noAnswer });
  const words = boundsWords(bounds(row, 'units'), significant);
  if (row.units === null) return `${words} (${row.reason})`;
  return (row.side === 'at-most' ? say.upTo : say.from)({ units: words });
}

export function basisOf({ fields }) {
  const ppms = [...new Set(fields.map((field) => `${field.is_measured}|${significant(field.blood_ppm)}`))].map((key) => key.split('|'));
  const boron = ppms.map(([isMeasured, ppm]) => (isMeasured === 'true' ? say.measured : say.notMeasured)({ ppm })).join('; ');
  return say.basis({ boron });
}

export function irradiationBlock(world) {
  const { room, curves } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan?.doses.length || !scene?.dose) return nothing;
  const { result, error, isOld } = curves.irradiation.value;
  const isDisabled = !room.canChange.value;
  const hasLimits = Object.keys(scene.constraints ?? {}).length > 0;
  return html`<section class="block chart-irradiation" aria-label=${say.title}><h3>${say.title} ${hasLimits && result ? doubtMark(world) : nothing}${isOld && hasLimits ? html` <span class="chart-stale warn">${icon('stale', 12)}</span>` : nothing}</h3>
    ${hasLimits ? html`${given(world, result, isDisabled)}${error ? html`<p class="refusal" role="alert">${icon('error', 16)}<span>${error}</span></p>` : result ? answer(world, result) : html`<p class="empty">${say.noAnswer}</p>`}` : html`<p class="empty">${say.addLimits}</p>`}</section>`;
}

/* ---- what is given --------------------------------------------------------------------------------------------------- */

const patch = ({ room, ui }, irradiation, event) => room.patchScene({ irradiation }, { view: ui.active.value, at: event?.timeStamp });

/** An empty field is none. */
const valueOf = (event, low, high) => {
  const text = event.target.value.trim();
  const value = Number(text);
  return text === '' ? null : Number.isFinite(value) && value >= low ? Math.min(value, high) : undefined;
};

function numberOrNone(label, value, none, unit, isDisabled, range, change) {
  const enter = (event) => {
    const entered = valueOf(event, ...range);
    if (entered !== undefined) change(entered, event);
  };
  return html`<span class="field"><input inputmode="decimal" aria-label=${label} placeholder=${none} .value=${typed(value === null || value === undefined ? '' : String(value))} ?disabled=${isDisabled} @change=${enter}>${unit ? html`<span>${unit}</span>` : nothing}</span>`;
}

function given(world, result, isDisabled) {
  const { room } = world;
  const { irradiation = {}, dose } = room.scene.value;
  const asShown = say.asShown({ ppm: number(dose.blood_ppm, 1) });
  const needsRate = /^m[WA]-min/i.test(result?.output ?? '');
  return html`<div class="chart-form"><label for="irradiation-blood">${say.blood}</label>${numberOrNone(say.blood, irradiation.blood_ppm, asShown, 'ppm', isDisabled, [0, highestPpm], (ppm, event) => patch(world, { blood_ppm: ppm }, event))}
    ${
      needsRate
        ? html`<span>${say.source}</span><span class="pair">${numberOrNone(say.source, irradiation.rate, say.noRate, '', isDisabled, [1e-9, 1e9], (rate, event) => patch(world, { rate }, event))}<select aria-label=${say.rateUnit} ?disabled=${isDisabled} @change=${(event) => patch(world, { rate_unit: event.target.value }, event)}>${enums.source_rate_unit.map((unit) => html`<option value=${unit} .selected=${live(unit === (irradiation.rate_unit ?? 'MW'))}>${unit}</option>`)}</select></span>`
        : nothing
    }</div>${room.plan.value.doses.length > 1 ? fieldsTable(world, isDisabled, asShown) : nothing}`;
}

function fieldsTable(world, isDisabled, asShown) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const fields = scene.irradiation?.fields ?? {};
  const shown = scene.dose.id || plan.doses[0].id;
  const isGiven = (id) => (Object.keys(fields).length ? id in fields : id === shown);
  const toggle = (id, isOn, event) => {
    const others = Object.keys(fields).length ? {} : { [shown]: {} };
    patch(world, { fields: { ...others, [id]: isOn ? {} : null } }, event);
  };
  const set = (id, change, event) => patch(world, { fields: { [id]: { ...fields[id], ...change } } }, event);
  const isFull = Object.keys(fields).length >= mostFields;
  return html`<table class="numbers-table chart-fields"><caption class="note">${say.shareIs}</caption><thead><tr><th scope="col">${say.field}</th><th scope="col">${say.share}</th><th scope="col">ppm</th></tr></thead><tbody>${plan.doses.map(
    ({ id }) => {
      const name = doseName(plan, id);
      return html`<tr><th scope="row"><label><input type="checkbox" aria-label=${say.give({ dose: name })} .checked=${live(isGiven(id))} ?disabled=${isDisabled || (isFull && !isGiven(id))} @change=${(event) => toggle(id, event.target.checked, event)}> ${name}</label></th>
      <td>${isGiven(id) ? numberOrNone(say.shareOf({ dose: name }), fields[id]?.share ?? 1, '1', '', isDisabled, [1e-6, 1e6], (share, event) => set(id, { share: share ?? 1 }, event)) : nothing}</td>
      <td>${isGiven(id) ? numberOrNone(say.bloodOf({ dose: name }), fields[id]?.blood_ppm, scene.irradiation?.blood_ppm === null || scene.irradiation?.blood_ppm === undefined ? asShown : number(scene.irradiation.blood_ppm, 1), '', isDisabled, [0, highestPpm], (ppm, event) => set(id, { blood_ppm: ppm }, event)) : nothing}</td></tr>`;
    },
  )}</tbody></table>`;
}

/* ---- what follows ---------------------------------------------------------------------------------------------------- */

/** The sentence that counts, and what it leaves open. */
export function headline(world, result) {
  const first = result.limits.find(({ is_first: isFirst }) => isFirst);
  if (!first) return { words: result.reason ? say.notKnown({ reason: result.reason }) : say.noFirst, doubt: '' };
  return {
    words: say.ends({ limit: limitName(world, first), time: timeWords(result, result.units, result.minutes) }),
    doubt: result.is_certain ? '' : say.mayComeBefore,
  };
}

function answer(world, result) {
  const { words, doubt } = headline(world, result);
  return html`<p class="chart-ends"><b>${words}</b>${doubt ? html` <span class="warn">${icon('warning', 12)} ${doubt}</span>` : nothing}</p>
    ${tables(world, result)}<p class="note">${basisOf(result)}</p>`;
}

/** Limits, fields and targets, also on paper. */
export function tables(world, result) {
  const plan = world.room.plan.value;
  const hasMinutes = result.limits.some(({ minutes }) => Number.isFinite(minutes)) && !result.output?.startsWith('min');
  const cell = (row, name) => html`<td>${isThere(row, name) ? boundsWords(bounds(row, name), significant) : '–'}</td>`;
  return html`<table class="numbers-table"><thead><tr><th scope="col">${say.limit}</th><th scope="col">${result.output ? unitText(result.output) : say.output}</th>${hasMinutes ? html`<th scope="col">${say.minutes}</th>` : nothing}</tr></thead>
      <tbody>${inOrder(result.limits).map((row) => html`<tr data-until=${row.id} class=${row.is_first ? 'on' : ''}><th scope="row">${limitName(world, row)}${row.quantity === 'weighted' ? nothing : html` <span class="dim">${quantityName(row.quantity)}</span>`}${row.is_first ? html` <span class="warn">${icon('warning', 12)} ${say.first}</span>` : nothing}</th><td>${reached(row)}</td>${hasMinutes ? html`<td>${significant(row.minutes)}</td>` : nothing}</tr>`)}</tbody></table>
    ${
      result.fields.length > 1 && Number.isFinite(result.units)
        ? html`<table class="numbers-table"><thead><tr><th scope="col">${say.field}</th><th scope="col">${unitText(result.output)}</th>${hasMinutes ? html`<th scope="col">${say.minutes}</th>` : nothing}<th scope="col">ppm</th></tr></thead>
      <tbody>${result.fields.map((row) => html`<tr><th scope="row">${doseName(plan, row.dose)}</th><td>${significant(row.units)}</td>${hasMinutes ? html`<td>${significant(row.minutes)}</td>` : nothing}<td>${significant(row.blood_ppm)}</td></tr>`)}</tbody></table>`
        : nothing
    }
    ${
      result.targets.length && Number.isFinite(result.units)
        ? html`<table class="numbers-table"><thead><tr><th scope="col">${say.targets}, ${unitText(result.targets[0].unit)}</th><th scope="col">D95 %</th><th scope="col">${say.mean}</th><th scope="col">${say.least}</th></tr></thead>
      <tbody>${result.targets.map((row) => html`<tr data-target=${row.region}><th scope="row">${regionName(plan)(row.region)}${row.reason ? html` <span class="dim">${row.reason}</span>` : nothing}</th>${cell(row, 'd95')}${cell(row, 'mean')}${cell(row, 'min')}</tr>`)}</tbody></table>`
        : nothing
    }`;
}
