// A second dose beside the one shown, and the part of a region within limits: in Selection.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { doseName, quantityName, shownDose, unitOf } from '../../room/dose.js';
import { populationWords } from './dose_population.js';
import { joinReason } from '../fits/fits.js';
import { ownRegions } from '../../room/identity.js';
import { doseWaitReason } from '../../room/waits.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { listed, number, signed, significant, volume } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const modes = [
  ['none', 'Off'],
  ['lines', 'Lines', 'Its isodoses, dashed'],
  ['difference', 'Difference', 'Second less first, as a wash'],
  ['gamma', 'Gamma', 'Gamma index, as a wash'],
];

export function compareBlock(world, isDisabled, changeScene) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const shown = shownDose(plan, scene);
  const others = plan.doses.filter((dose) => dose !== shown);
  const { compare } = scene.dose;
  const second = others.find(({ id }) => id === compare.id);
  const change = (patch, event) => changeScene({ dose: { compare: patch } }, event);
  const why = (dose) => joinReason(plan, scene, shown, dose, false, room.accepted.value);
  const choose = (mode, event) =>
    change({ mode, ...(!second && mode !== 'none' && { id: (others.find((dose) => !why(dose)) ?? others[0]).id }) }, event);
  const field = (name, words, unit, low, high) =>
    html`<dt>${words}</dt><dd>${numberField(words, compare[name], unit, isDisabled, (value, event) => change({ [name]: clamp(value, low, high) }, event))}</dd>`;
  return html`<section class="block"><h3>Compare <span class="dim">${second && compare.mode !== 'none' ? `with ${doseName(second)}` : ''}</span></h3>
    <div class="shown-as">${segment('Comparison', modes, compare.mode, isDisabled, choose)}</div>
    <dl class="dose-list"><dt>Second dose</dt><dd><select class="dose-select" aria-label="Second dose" ?disabled=${isDisabled} @change=${(event) => change({ id: event.target.value, ...(!event.target.value && { mode: 'none' }) }, event)}>
        <option value="" ?selected=${!second} .selected=${live(!second)}>none</option>${others.map((dose) => html`<option value=${dose.id} ?disabled=${Boolean(why(dose))} title=${why(dose)?.reason ?? nothing} ?selected=${dose === second} .selected=${live(dose === second)}>${listed(doseName(dose), why(dose)?.words ?? unitOf(dose, scene.dose.quantity))}</option>`)}</select></dd>
      ${compare.mode === 'difference' ? field('span_percent', 'Strongest colour at ±', '%', 0.01, 1000) : nothing}
      ${
        compare.mode === 'gamma'
          ? html`${field('dose_percent', 'Dose difference', '%', 0.01, 100)}${field('distance_mm', 'Distance to agreement', 'mm', 0.01, 50)}
        <dt>Difference is of</dt><dd>${segment(
          'Normalization of gamma',
          [
            ['global', 'reference'],
            ['local', 'point'],
          ],
          compare.normalization,
          isDisabled,
          (normalization, event) => change({ normalization }, event),
        )}</dd>`
          : nothing
      }
      ${
        ['gamma', 'difference'].includes(compare.mode)
          ? html`${field('threshold_percent', 'Leave out below', '%', 0, 100)}<dt>Compared in</dt><dd>${segment(
              'Domain of the comparison',
              [
                ['body', 'the body', 'The largest region of the label layer with those inside it'],
                ['grid', 'the whole grid'],
              ],
              compare.domain,
              isDisabled,
              (domain, event) => change({ domain }, event),
            )}</dd>`
          : nothing
      }</dl>
    ${['gamma', 'difference'].includes(compare.mode) && second ? comparedWords(world) : nothing}</section>`;
}

/** The figures of the comparison: how much passes, or how large the difference is. */
function comparedWords({ room, doses }) {
  const { compare } = room.scene.value.dose;
  const { result, error, isOld } = doses.gamma.value;
  if (error) return html`<p class="note err">${error}</p>`;
  if (!result) return html`<p class="note">${doseWaitReason(room) || 'Comparing …'}</p>`;
  if (result.comparison_reason) return html`<p class="note why">${icon('warning', 12)} ${result.comparison_reason}</p>`;
  const { difference, unit } = result;
  const { domain } = result;
  const where = domain
    ? html`<p class="note">${number(domain.voxels)} of ${number(domain.all_voxels)} voxels ${domain.kind === 'body' ? `in the body (${domain.words})` : 'of the whole grid'} have at least ${number(compare.threshold_percent, compare.threshold_percent % 1 ? 1 : 0)} % of the reference.${domain.kind === 'body' ? ' Outside the body nothing is compared.' : ''}</p>`
    : nothing;
  return html`<div class=${`dose-result${isOld ? ' old' : ''}`}>${
    compare.mode === 'gamma'
      ? html`<p>Pass rate <b>${number(result.pass_percent, 1)} %</b> of ${number(result.voxels)} voxels</p><p class="note">γ ≤ 1 passes; mean ${significant(result.mean)}, largest ${significant(result.max)}${result.max >= 2 ? ' or more' : ''}.</p>`
      : html`<p>Mean difference <b>${signed(difference.mean, 3)} ${difference.unit || unit}</b></p><p class="note">From ${signed(difference.low, 3)} to ${signed(difference.high, 3)} ${difference.unit || unit}, root mean square ${significant(difference.root_mean_square)}.</p>`
  }
    ${where}${result.method ? html`<p class="note">${result.method}</p>` : nothing}</div>`;
}

export function coverageBlock(world, isDisabled, changeScene) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const regions = ownRegions(plan, scene).filter(({ voxels }) => voxels > 0);
  if (!regions.length) return nothing;
  const { coverage } = scene.dose;
  const unit = unitOf(shownDose(plan, scene), coverage.quantity || scene.dose.quantity);
  const change = (patch, event) => changeScene({ dose: { coverage: patch } }, event);
  const others = [
    coverage.quantity && quantityName(coverage.quantity),
    coverage.tissue && `weights of ${plan.regions.find(({ id }) => id === coverage.tissue)?.name ?? coverage.tissue}`,
  ].filter(Boolean); // as of the histogram it was chosen in
  const [low, high] = [coverage.low ?? null, coverage.high ?? null]; // a merge patch with null takes the field away
  const isBelow = low === null;
  const level = (isBelow ? high : low) ?? 95;
  const limits = (below, value) => (below ? { low: null, high: value } : { low: value, high: null });
  const toggle = (visible, event) => change({ visible, ...(low === null && high === null && limits(true, level)) }, event);
  const target = ownRegions(plan, scene).find(({ is_target: is }) => is) ?? regions[0];
  const of = plan.regions.find(({ id }) => id === coverage.region) ?? target;
  return html`<section class="block"><h3>Coverage <span class="dim">of ${of.name}</span></h3>
    <div class="checks dose-checks">${checkbox('Highlight the part', coverage.visible, isDisabled, toggle, 'Univels of the region within the limits, on slices and in 3-D')}</div>
    <dl class="dose-list"><dt>Region</dt><dd><select class="dose-select" aria-label="Region of the coverage" ?disabled=${isDisabled} @change=${(event) => change({ region: event.target.value }, event)}>
        ${regions.map(({ id, name }) => html`<option value=${id} ?selected=${id === of.id} .selected=${live(id === of.id)}>${name}</option>`)}</select></dd>
      ${others.length ? html`<dt>Of</dt><dd>${others.join(', ')} <button class="small" ?disabled=${isDisabled} @click=${(event) => change({ quantity: '', tissue: '' }, event)}>As the dose shown</button></dd>` : nothing}
      <dt>Dose is</dt><dd>${segment(
        'Side of the coverage',
        [
          [true, 'below'],
          [false, 'at least'],
        ],
        isBelow,
        isDisabled,
        (below, event) => change(limits(below, level), event),
      )}</dd>
      <dt>Level</dt><dd class="dose-pair">${numberField('Level of the coverage', Number(level.toPrecision(6)), '', isDisabled, (value, event) => value >= 0 && change(limits(isBelow, value), event))}
        ${segment(
          'Unit of the coverage',
          [
            ['percent', '%'],
            ['dose', unit],
          ],
          coverage.unit,
          isDisabled,
          (id, event) => change({ unit: id }, event),
        )}</dd>
      <dt>Colour</dt><dd><input type="color" class="dose-swatch" .value=${live(coverage.color)} aria-label="Colour of the coverage" ?disabled=${isDisabled} @input=${(event) => change({ color: event.target.value }, event)}></dd></dl>
    ${coverage.visible ? coverageWords(world) : nothing}</section>`;
}

function coverageWords({ room, doses }) {
  const { result, error, isOld } = doses.coverage.value;
  if (error) return html`<p class="note err">${error}</p>`;
  if (!result) return html`<p class="note">${doseWaitReason(room) || 'Counting …'}</p>`;
  if (result.coverage_reason) return html`<p class="note why">${icon('warning', 12)} ${result.coverage_reason}</p>`;
  const share = Number.isFinite(result.share)
    ? number(result.share * 100, 1)
    : [result.share_least, result.share_most].map((part) => number(part * 100, 1)).join(' to ');
  return html`<p class=${`dose-result${isOld ? ' old' : ''}`}><b>${share} %</b> of the region, <b>${Number.isFinite(result.share) ? '' : 'at least '}${volume(result.volume_cm3)}</b></p>
    <p class="note">${[populationWords(result.population), result.basis].filter(Boolean).join(', ')}.${result.missing_cm3 > 0 ? ` ${volume(result.missing_cm3)} of it have no dose.` : ''}</p>`;
}
