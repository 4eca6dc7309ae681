// The dose in the Probe: what is shown first and in full, with the weights that were used beside each number; other doses folded.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { doseName, isFluence, missingWords, quantityName, referenceWords, shownDose } from '../../room/dose.js';
import { number, significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './row_words.js';

const totalsFirst = ['weighted', 'isoeffective', 'total', 'weighted-total'];
const order = ['boron', 'gamma', 'nitrogen', 'fast', 'other'];

const componentWords = { boron: say.boron, nitrogen: say.nitrogen, fast: say.fast, gamma: say.gamma, other: say.other };
/** "Boron", "nitrogen", ...: the physical components of a dose, for a sentence. */
export const componentNames = (dose) =>
  ['boron', 'nitrogen', 'fast', 'gamma', 'other']
    .filter((quantity) => dose.components.some((part) => part.quantity === quantity))
    .map((quantity, index) => (index ? componentWords[quantity] : quantityName(quantity)));

/** The value of the shown quantity at a point as words: "4.82 Gy(w)", "outside the dose grid"; '' before there is an answer. */
export function valueWords(answer) {
  if (!answer) return '';
  if (Number.isFinite(answer.value)) return `${significant(answer.value)} ${unitText(answer.unit)}`;
  return answer.value_reason ?? answer.reason ?? '';
}

/** The dose at the crosshair for status and captions: "4.82 Gy(w)"; nothing where there is none. */
export function doseHere({ doses }) {
  const { result, isOld } = doses.here.value;
  return result && !isOld && doses.isOfScene(result) && Number.isFinite(result.value) ? valueWords(result) : '';
}

/** The block of the Probe. @param {object} world {room, doses, probed} */
export function doseAtCrosshair({ room, doses, probed }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const dose = shownDose(plan, scene);
  if (!dose) return nothing;
  const { result, error, isOld } = doses.here.value;
  const others = plan.doses.filter((other) => other !== dose);
  const raw = probed.value.result?.doses ?? [];
  return html`<section class="block"><h3>${say.dose} <span class="dim">${doseName(dose)}</span></h3>
      ${error ? html`<p class="err">${icon('error')} ${error}</p>` : doses.isOfScene(result) ? table(plan, scene, result, isOld) : html`<p class="dim">…</p>`}${marks(plan, scene, result)}</section>
    ${
      others.length && probed.value.result
        ? html`<details class="block more"><summary>${icon('chevronDown', 12)}<span>${others.length === 1 ? say.oneMore({ dose: doseName(others[0]) }) : say.moreDoses({ n: others.length, count: number(others.length) })}</span></summary>
      ${others.map((other) => html`${others.length > 1 ? html`<h3>${say.dose} <span class="dim">${doseName(other)}</span></h3>` : nothing}${rawTable(raw.filter(({ id }) => id === other.id))}`)}</details>`
        : nothing
    }`;
}

function table(plan, scene, answer, isOld) {
  const parts = answer.components.filter(({ quantity }) => !isFluence(quantity));
  const fluences = answer.components.filter(({ quantity }) => isFluence(quantity));
  const everywhere =
    answer.components.length && answer.components.every(({ value, reason }) => value === null && reason === answer.components[0].reason);
  if (everywhere) return html`<p class="outside">${answer.components[0].reason}</p>`;
  const totals = answer.totals.filter(({ quantity }) => !parts.some((part) => part.quantity === quantity));
  const isShown = ({ quantity }) => quantity === answer.quantity;
  const sums = [...totals].sort(
    (a, b) => Number(isShown(b)) - Number(isShown(a)) || totalsFirst.indexOf(a.quantity) - totalsFirst.indexOf(b.quantity),
  );
  const hasWeights = parts.some(({ weight }) => Number.isFinite(weight));
  return html`${valueLine(plan, scene, answer)}${componentTable(answer, sums, parts, hasWeights, isShown, isOld)}
    ${
      fluences.length
        ? html`<details class="more" ?open=${isFluence(answer.quantity)}><summary>${icon('chevronDown', 12)}<span>${say.nFluences({ n: fluences.length, count: number(fluences.length) })}</span></summary>
      <table><thead><tr><th scope="col">${say.fluence}</th><th scope="col">${unitText(fluences[0].unit)}</th></tr></thead>
      <tbody>${fluences.map((part) => html`<tr><td>${quantityName(part.quantity)}</td><td>${part.value === null ? part.reason : significant(part.value)}</td></tr>`)}</tbody></table></details>`
        : nothing
    }
    <p class="note">${noteWords(plan, answer, hasWeights)}</p>`;
}

/** % of the reference and the statistical error, of the shown quantity. */
function valueLine(plan, scene, answer) {
  const rows = [
    [quantityName(answer.quantity), html`<b>${valueWords(answer) || '–'}</b>`],
    Number.isFinite(answer.percent) && [
      say.of({ reference: referenceWords(plan, scene.dose.reference) }),
      `${number(answer.percent, 1)} %`,
    ],
    Number.isFinite(answer.error_percent) && [say.statisticalError, `${significant(answer.error_percent)} %`],
  ];
  return html`<dl class="dose-value-list">${rows.filter(Boolean).map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>`;
}

const cell = (value) => (Number.isFinite(value) ? significant(value) : '–');

function componentTable(answer, sums, parts, hasWeights, isShown, isOld) {
  const unit = unitText(parts.find(({ quantity }) => order.includes(quantity))?.unit ?? parts[0]?.unit ?? answer.unit);
  const weightedUnit = unitText(sums.find(({ quantity }) => quantity === 'weighted')?.unit ?? '');
  const sorted = [...parts].sort((a, b) => (order.indexOf(a.quantity) + 1 || 9) - (order.indexOf(b.quantity) + 1 || 9));
  const sumRow = (sum) => {
    const isLast = hasWeights && sum.quantity === 'weighted';
    const text = sum.value === null ? sum.reason : significant(sum.value);
    const own = !isLast && unitText(sum.unit) !== unit ? ` ${unitText(sum.unit)}` : '';
    return html`<tr class=${classMap({ total: isShown(sum) || sum.quantity === 'weighted' })}><td>${quantityName(sum.quantity)}</td>${
      sum.value === null && hasWeights
        ? html`<td colspan="3">${text}</td>`
        : hasWeights
          ? html`<td>${isLast ? '' : `${text}${own}`}</td><td></td><td>${isLast ? text : ''}</td>`
          : html`<td>${text}${own}</td>`
    }</tr>`;
  };
  const partRow = (
    part,
  ) => html`<tr class=${classMap({ total: isShown(part) })}><td>${quantityName(part.quantity)}${Number.isFinite(part.boron_ppm) ? `, ${number(part.boron_ppm, part.boron_ppm < 99.95 ? 1 : 0)} ppm` : ''}</td>
    ${part.value === null ? html`<td colspan=${hasWeights ? 3 : 1}>${part.reason}</td>` : html`<td>${cell(part.value)}${unitText(part.unit) === unit ? '' : ` ${unitText(part.unit)}`}</td>${hasWeights ? html`<td>${Number.isFinite(part.weight) ? number(part.weight, (part.weight * 10) % 1 ? 2 : 1) : '–'}</td><td>${cell(part.weighted)}</td>` : nothing}`}</tr>`;
  return html`<table class="dose-table"><thead><tr><th scope="col">${say.component}</th><th scope="col">${unit}</th>${hasWeights ? html`<th scope="col">${say.weight}</th><th scope="col">${weightedUnit}</th>` : nothing}</tr></thead>
    <tbody class=${classMap({ old: isOld })}>${sums.map(sumRow)}${sorted.map(partRow)}</tbody></table>`;
}

function noteWords(plan, answer, hasWeights) {
  const region = plan.regions.find(({ id }) => id === answer.weighted_by);
  const [{ factor }, ...added] = answer.parts;
  const others = added.map((part) => {
    const name = plan.doses.find((dose) => dose.id === part.id)?.name || part.id;
    return part.factor === 1 ? name : `${part.factor} × ${name}`;
  });
  const hasWeighted = answer.totals.some(({ quantity }) => quantity === 'weighted');
  const weights = { region: region?.name, set: answer.weights_name || say.edited };
  return [
    answer.per && perWords(answer.per),
    factor !== 1 && say.times({ factor: number(factor, factor % 1 ? 2 : 0) }),
    added.length && say.withDoses({ doses: others.join(', ') }),
    region && hasWeights && (answer.tissue ? say.usedEverywhere : say.used)(weights),
    !hasWeights && hasWeighted && say.noWeights,
  ]
    .filter(Boolean)
    .join(' ');
}

const perWords = (per) => say.per({ unit: unitText(per.replace(/^per /, '')) });

/** Warnings without which a number must not be read. */
function marks(plan, scene, answer) {
  const missing = missingWords(answer?.missing ?? []);
  const words = [
    missing && say.totalIs({ missing }),
    answer?.accepted && say.usedBy({ name: answer.accepted.by, words: answer.accepted.words }),
    answer && !answer.drawn && answer.reason,
  ].filter(Boolean);
  return words.map((text) => html`<p class="note why">${icon('warning', 12)} ${text}</p>`);
}

function componentName({ quantity, per_ppm: isPerPpm, boron_ppm: ppm }) {
  const name = isPerPpm ? say.perPpm({ component: quantityName(quantity) }) : quantityName(quantity);
  return Number.isFinite(ppm) ? say.boronAt({ component: name, ppm }) : name;
}

/** Another dose, as its file has it. */
function rawTable(rows) {
  if (!rows.length) return html`<p class="outside">${say.outside}</p>`;
  const units = [...new Set(rows.map(({ unit }) => unit))];
  const [{ per }] = rows;
  return html`${units.map(
    (unit) =>
      html`<table><thead><tr><th scope="col">${say.component}</th><th scope="col">${unitText(unit)}</th></tr></thead><tbody>${rows
        .filter((row) => row.unit === unit)
        .map(
          (row) => html`<tr><td>${componentName(row)}</td>
      <td>${row.value === null ? say.notKnownHere : significant(row.value)}</td></tr>`,
        )}</tbody></table>`,
  )}<p class="note">${per ? perWords(per) : ''} ${say.asInFile}</p>`;
}
