// Washes other than levels: a difference, a gamma index, a statistical error; with their colours, the ends of these, and their subject. Pure.
import { dosePresets } from '../../../gen/dose_presets.js';
import { doseName, shownDose, unitOf } from '../../room/dose.js';
import { say } from './drawn_words.js';

const tidy = (value) => String(Number(value.toPrecision(6)));

/** 'levels', or what takes their place: 'difference', 'gamma', 'error'; '': there is no wash. As core/render/visible/draw_wash.c has it. */
export function washKind(plan, { dose: { wash, compare, error } }) {
  const isCompared = ['difference', 'gamma'].includes(compare.mode) && plan.doses.some(({ id }) => id === compare.id);
  if (isCompared) return compare.mode;
  return !wash.visible ? '' : error ? 'error' : 'levels';
}

/** Whether lines of levels are drawn, of the dose shown or dashed of the second. */
export const hasLines = (plan, { dose: { lines, compare } }) =>
  lines.visible || (['lines', 'difference'].includes(compare.mode) && plan.doses.some(({ id }) => id === compare.id));

/** A CSS gradient of the scale, as strong as the picture has it beside its opacity. */
export function gradientOf(kind) {
  const stops = dosePresets.scales[kind];
  const [low, high] = [stops[0].at, stops.at(-1).at];
  const part = (value) => Math.round(((value - low) / (high - low)) * 1000) / 10;
  const hex = (opacity) =>
    Math.round(opacity * 255)
      .toString(16)
      .padStart(2, '0');
  return `linear-gradient(90deg, ${stops.map(({ at, color, opacity }) => `${color}${hex(opacity)} ${part(at)}%`).join(', ')})`;
}

/**
 * @param {number|null} reference the dose of 100 %
 * @param {(value: number) => string} significant
 * @returns {{kind: string, title: string, ends: string[], about: string, more: string}|null} more: the whole of it, for a tooltip; null: levels, or no wash
 */
export function shownScale(plan, scene, reference, significant) {
  const kind = washKind(plan, scene);
  if (kind === 'error') return { kind, title: say.error, ends: ['0', '10', '≥ 20'], about: '', more: '' };
  if (kind !== 'difference' && kind !== 'gamma') return null;
  const { compare, quantity } = scene.dose;
  const [first, second] = [shownDose(plan, scene), plan.doses.find(({ id }) => id === compare.id)].map(doseName);
  const isInBody = (compare.domain ?? 'body') === 'body' && plan.regions.length > 0;
  const least = tidy(compare.threshold_percent);
  const where = (isInBody ? say.fromInBody : say.from)({ percent: least });
  const whole = (isInBody ? say.wholeInBody : say.whole)({ dose: first, percent: least });
  if (kind === 'gamma') {
    const about = compare.normalization === 'local' ? say.gammaOfPoint : say.gamma;
    return {
      kind,
      title: say.gammaOf({ dose: second }),
      ends: ['0', say.passes, '≥ 2'],
      about: about({ percent: tidy(compare.dose_percent), mm: tidy(compare.distance_mm), where }),
      more: say.gammaIs({ second, first, where: whole }),
    };
  }
  const isKnown = Number.isFinite(reference);
  const end = isKnown ? significant((reference * compare.span_percent) / 100) : `${tidy(compare.span_percent)} %`;
  return {
    kind,
    title: `${second} − ${first}, ${isKnown ? unitOf(shownDose(plan, scene), quantity) : say.percentUnit}`,
    ends: [`≤ −${end}`, '0', `≥ +${end}`],
    about: say.span({ percent: tidy(compare.span_percent), where }),
    more: say.differenceIs({ second, first, where: whole, percent: tidy(compare.span_percent) }),
  };
}
