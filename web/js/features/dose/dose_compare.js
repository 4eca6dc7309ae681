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
import { say } from './later_words.js';

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const modes = [
  ['none', say.compareOff],
  ['lines', say.compareLines, say.compareLinesIs],
  ['difference', say.difference, say.differenceIs],
  ['gamma', say.gamma, say.gammaIndexIs],
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
  return html`<section class="block"><h3>${say.compare} <span class="dim">${second && compare.mode !== 'none' ? say.compareWith({ dose: doseName(second) }) : ''}</span></h3>
    <div class="shown-as">${segment(say.comparison, modes, compare.mode, isDisabled, choose)}</div>
    <dl class="dose-list"><dt>${say.secondDose}</dt><dd><select class="dose-select" aria-label=${say.secondDose} ?disabled=${isDisabled} @change=${(event) => change({ id: event.target.value, ...(!event.target.value && { mode: 'none' }) }, event)}>
        <option value="" ?selected=${!second} .selected=${live(!second)}>${say.none}</option>${others.map((dose) => html`<option value=${dose.id} ?disabled=${Boolean(why(dose))} title=${why(dose)?.reason ?? nothing} ?selected=${dose === second} .selected=${live(dose === second)}>${listed(doseName(dose), why(dose)?.words ?? unitOf(dose, scene.dose.quantity))}</option>`)}</select></dd>
      ${compare.mode === 'difference' ? field('span_percent', say.strongest, '%', 0.01, 1000) : nothing}
      ${
        compare.mode === 'gamma'
          ? html`${field('dose_percent', say.doseDifference, '%', 0.01, 100)}${field('distance_mm', say.agreement, 'mm', 0.01, 50)}
        <dt>${say.differenceOf}</dt><dd>${segment(
          say.normalization,
          [
            ['global', say.ofReference],
            ['local', say.ofPoint],
          ],
          compare.normalization,
          isDisabled,
          (normalization, event) => change({ normalization }, event),
        )}</dd>`
          : nothing
      }
      ${
        ['gamma', 'difference'].includes(compare.mode)
          ? html`${field('threshold_percent', say.leaveOut, '%', 0, 100)}<dt>${say.comparedIn}</dt><dd>${segment(
              say.domain,
              [
                ['body', say.theBody, say.theBodyIs],
                ['grid', say.theGrid],
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
  if (!result) return html`<p class="note">${doseWaitReason(room) || say.comparing}</p>`;
  if (result.comparison_reason) return html`<p class="note why">${icon('warning', 12)} ${result.comparison_reason}</p>`;
  const { difference, unit } = result;
  const { domain } = result;
  const where = domain
    ? (domain.kind === 'body' ? say.voxelsInBody : say.voxelsOfGrid)({
        n: number(domain.voxels),
        all: number(domain.all_voxels),
        region: domain.words,
        percent: number(compare.threshold_percent, compare.threshold_percent % 1 ? 1 : 0),
      })
    : '';
  const rate = html`<b>${number(result.pass_percent, 1)} %</b>`;
  const gammas = { mean: significant(result.mean), most: significant(result.max) };
  const range = () => ({
    low: signed(difference.low, 3),
    high: signed(difference.high, 3),
    unit: difference.unit || unit,
    rms: significant(difference.root_mean_square),
  });
  return html`<div class=${`dose-result${isOld ? ' old' : ''}`}>${
    compare.mode === 'gamma'
      ? html`<p>${say.passRate({ rate, count: number(result.voxels) })}</p><p class="note">${(result.max >= 2 ? say.gammasOrMore : say.gammas)(gammas)}</p>`
      : html`<p>${say.meanDifference({ mean: html`<b>${signed(difference.mean, 3)} ${difference.unit || unit}</b>` })}</p><p class="note">${say.differences(range())}</p>`
  }
    ${where ? html`<p class="note">${where}</p>` : nothing}${result.method ? html`<p class="note">${result.method}</p>` : nothing}</div>`;
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
    coverage.tissue && say.weightsOf({ region: plan.regions.find(({ id }) => id === coverage.tissue)?.name ?? coverage.tissue }),
  ].filter(Boolean); // as of the histogram it was chosen in
  const [low, high] = [coverage.low ?? null, coverage.high ?? null]; // a merge patch with null takes the field away
  const isBelow = low === null;
  const level = (isBelow ? high : low) ?? 95;
  const limits = (below, value) => (below ? { low: null, high: value } : { low: value, high: null });
  const toggle = (visible, event) => change({ visible, ...(low === null && high === null && limits(true, level)) }, event);
  const target = ownRegions(plan, scene).find(({ is_target: is }) => is) ?? regions[0];
  const of = plan.regions.find(({ id }) => id === coverage.region) ?? target;
  return html`<section class="block"><h3>${say.coverage} <span class="dim">${say.coverageOf({ region: of.name })}</span></h3>
    <div class="checks dose-checks">${checkbox(say.highlight, coverage.visible, isDisabled, toggle, say.highlightIs)}</div>
    <dl class="dose-list"><dt>${say.region}</dt><dd><select class="dose-select" aria-label=${say.coverageRegion} ?disabled=${isDisabled} @change=${(event) => change({ region: event.target.value }, event)}>
        ${regions.map(({ id, name }) => html`<option value=${id} ?selected=${id === of.id} .selected=${live(id === of.id)}>${name}</option>`)}</select></dd>
      ${others.length ? html`<dt>${say.of}</dt><dd>${others.join(', ')} <button class="small" ?disabled=${isDisabled} @click=${(event) => change({ quantity: '', tissue: '' }, event)}>${say.asShown}</button></dd>` : nothing}
      <dt>${say.doseIs}</dt><dd>${segment(
        say.coverageSide,
        [
          [true, say.below],
          [false, say.atLeastSide],
        ],
        isBelow,
        isDisabled,
        (below, event) => change(limits(below, level), event),
      )}</dd>
      <dt>${say.levelField}</dt><dd class="dose-pair">${numberField(say.coverageLevel, Number(level.toPrecision(6)), '', isDisabled, (value, event) => value >= 0 && change(limits(isBelow, value), event))}
        ${segment(
          say.coverageUnit,
          [
            ['percent', '%'],
            ['dose', unit],
          ],
          coverage.unit,
          isDisabled,
          (id, event) => change({ unit: id }, event),
        )}</dd>
      <dt>${say.colour}</dt><dd><input type="color" class="dose-swatch" .value=${live(coverage.color)} aria-label=${say.coverageColour} ?disabled=${isDisabled} @input=${(event) => change({ color: event.target.value }, event)}></dd></dl>
    ${coverage.visible ? coverageWords(world) : nothing}</section>`;
}

function coverageWords({ room, doses }) {
  const { result, error, isOld } = doses.coverage.value;
  if (error) return html`<p class="note err">${error}</p>`;
  if (!result) return html`<p class="note">${doseWaitReason(room) || say.counting}</p>`;
  if (result.coverage_reason) return html`<p class="note why">${icon('warning', 12)} ${result.coverage_reason}</p>`;
  const isKnown = Number.isFinite(result.share);
  const percent = (part) => number(part * 100, 1);
  const share = isKnown
    ? `${percent(result.share)} %`
    : say.shares({ least: percent(result.share_least), most: percent(result.share_most) });
  const part = isKnown ? volume(result.volume_cm3) : say.atLeast({ volume: volume(result.volume_cm3) });
  return html`<p class=${`dose-result${isOld ? ' old' : ''}`}>${say.covered({ share: html`<b>${share}</b>`, volume: html`<b>${part}</b>` })}</p>
    <p class="note">${[populationWords(result.population), result.basis].filter(Boolean).join(', ')}. ${result.missing_cm3 > 0 ? say.withoutDose({ volume: volume(result.missing_cm3) }) : ''}</p>`;
}
