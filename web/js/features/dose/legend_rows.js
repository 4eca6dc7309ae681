// The dose legend of a room as data: a row for levels, one for the scale of a comparison or an error. Pure.
import { doseName, isOn, isWeighted, missingWords, quantityName, referenceWords, shownDose, unitOf } from '../../room/dose.js';
import { doseOf, levelsOf, percentOf } from './level_list.js';
import { gradientOf, hasLines, shownScale, washKind } from './dose_scales.js';
import { listed, number, signed, significant } from '../../parts/format.js';
import { say } from './drawn_words.js';

/**
 * @typedef {object} LegendRow
 * @property {'levels'|'difference'|'gamma'|'error'} kind @property {string} quantity @property {string} weights @property {string} reference
 * @property {string} more what is left out first @property {string} whole all words, for a tooltip @property {string} warn @property {boolean} isOld
 * @property {string} unit of the values @property {{id, color, isArea, percent, value}[]} levels highest first
 * @property {{gradient: string, ends: string[]}|null} scale @property {string} domain where it is counted, and how many @property {string} figures
 */

/**
 * @param {object} plan @param {object} scene @param {{scale: object, gamma: object, reference: number|null, isKnown: boolean}} answers of dose_facts.js;
 *   isKnown: the scale is that of the dose and the quantity of the scene
 * @returns {LegendRow[]} [] while nothing of the dose is drawn
 */
export function legendRows(plan, scene, { scale, gamma, reference, isKnown }) {
  const dose = shownDose(plan, scene);
  if (!dose || !isOn(scene)) return [];
  if (isKnown && scale.result && !scale.result.drawn) return [];
  const isPending = !isKnown || !scale.result;
  const rows = [levelRow(plan, scene, dose, isPending, scale, reference), scaleRow(plan, scene, scale, gamma, reference)];
  return rows.filter(Boolean);
}

const isWhole = (value) => Math.abs(value - Math.round(value)) < 0.05;
const percentText = (value) => number(value, isWhole(value) ? 0 : 1);

function levelRow(plan, scene, dose, isPending, scale, reference) {
  const { surfaces, compare } = scene.dose;
  const [isWash, isLines] = [washKind(plan, scene) === 'levels', hasLines(plan, scene)];
  const isUsed = (level) => level.visible && ((level.wash && isWash) || (level.line && isLines) || (level.surface && surfaces.visible));
  const levels = levelsOf(scene, reference).filter(isUsed);
  if (!levels.length) return null;
  const unit = unitOf(dose, scene.dose.quantity);
  const quantity = quantityName(scene.dose.quantity);
  const weights = weightWords(plan, scene);
  const of = referenceWords(plan, scene.dose.reference);
  const full =
    isPending || !Number.isFinite(reference)
      ? say.hundredOf({ reference: of })
      : say.hundred({ value: significant(reference), unit, reference: of });
  const second = plan.doses.find(({ id }) => id === compare.id);
  const isDashed = second && (compare.mode === 'lines' || compare.mode === 'difference');
  const more = isDashed ? say.dashed({ dose: doseName(second) }) : '';
  return {
    kind: 'levels',
    quantity,
    weights,
    reference: full,
    more,
    whole: listed(quantity, weights, full, more),
    warn: isPending ? '' : missingWords(scale.result.missing ?? []),
    isOld: isPending || Boolean(scale.isOld),
    unit,
    levels: levels.map((level) => ({
      id: level.id,
      color: level.color,
      isArea: level.wash && isWash,
      percent: percentText(percentOf(level, reference)),
      value: significant(isPending ? NaN : doseOf(level, reference)),
    })),
    scale: null,
    domain: '',
    figures: '',
  };
}

/** "as brain", "BPA example"; '' for a physical dose. */
function weightWords(plan, { dose: { quantity, tissue, weights_name: set } }) {
  if (!isWeighted(quantity)) return '';
  const region = tissue && plan.regions.find(({ id }) => id === tissue)?.name;
  return region ? say.asRegion({ region }) : set || say.editedWeights;
}

function scaleRow(plan, scene, scale, gamma, reference) {
  const shown = shownScale(plan, scene, reference, significant);
  if (!shown) return null;
  const { kind, title, ends, about, more } = shown;
  const { result, error, isOld } = gamma;
  const isCounted = kind !== 'error';
  const why = isCounted ? error || (!isOld && result?.comparison_reason) || '' : '';
  const known = isCounted && !isOld && !why ? result : null;
  const domain = known?.domain ? say.counted({ about, n: number(known.domain.voxels), all: number(known.domain.all_voxels) }) : about;
  const figures = known ? figuresOf(kind, known) : '';
  return {
    kind,
    quantity: title,
    weights: kind === 'difference' ? weightWords(plan, scene) : '',
    reference: '',
    more: '',
    whole: [more || title, domain, figures].filter(Boolean).join('; '),
    warn: why && say.notCompared({ reason: why }),
    isOld: isCounted && Boolean(isOld),
    unit: '',
    levels: [],
    scale: why ? null : { gradient: gradientOf(kind), ends },
    domain,
    figures,
  };
}

function figuresOf(kind, { difference, pass_percent: passes }) {
  if (kind === 'gamma') return Number.isFinite(passes) ? say.passing({ percent: number(passes, 1) }) : '';
  if (!difference || !Number.isFinite(difference.mean)) return '';
  const { mean, root_mean_square: rms, low, high } = difference;
  return say.differs({ mean: signed(mean, 2), rms: significant(rms), low: signed(low, 2), high: signed(high, 2) });
}
