// Dose-volume histograms as the page needs them: what is read off a curve, and the files that carry them.
import { csvText } from './dose_csv.js';

/**
 * One histogram. counts are the cm3 of the region in bins of equal width, the first one from `from`.
 * @typedef {object} DvhCurve
 * @property {string} region its id @property {string} dose its id @property {number} of 0: of the dose shown, 1: of the one it is compared with
 * @property {number} volume cm3 of the region @property {number} cm3 of its univels that have a value: 100 % @property {number} missing cm3 of those without @property {number} univels
 * @property {number} low @property {number} mean @property {number} high
 * @property {Record<string, number>} figures of the server, by figureNames
 * @property {{level: string, value: number, isodose_cm3: number, covered_cm3: number, paddick: number, rtog: number}[]} conformity of a target, for each level
 * @property {number} from @property {number} width @property {number[]} counts @property {number[]} above cm3 with at least the lower edge of each bin
 */

/** Columns of the table, in its order. HI: homogeneity, (D2% - D98%) / D50% (ICRU Report 83). */
export const figureNames = ['D98%', 'D50%', 'D2%', 'D0.03cc', 'HI'];

export function withSums(curve) {
  const above = new Array(curve.counts.length + 1).fill(0);
  for (let bin = curve.counts.length - 1; bin >= 0; bin--) above[bin] = above[bin + 1] + curve.counts[bin];
  return { ...curve, above };
}

/** The cm3 that have at least this value; within a bin they are spread evenly. */
export function volumeFrom({ from, width, above, cm3 }, value) {
  const at = (value - from) / width;
  if (!(at > 0)) return cm3;
  const bin = Math.floor(at);
  if (bin >= above.length - 1) return 0;
  return above[bin] + (at - bin) * (above[bin + 1] - above[bin]);
}

/** The cm3 for each unit of dose at a value. */
export function densityAt({ from, width, counts }, value) {
  return (counts[Math.floor((value - from) / width)] ?? 0) / width;
}

/** @param {'percent'|'cm3'} unit */
export const shareOf = (curve, cm3, unit) => (unit === 'cm3' ? cm3 : curve.cm3 > 0 ? (100 * cm3) / curve.cm3 : 0);

/** The largest value of some curves, rounded up to a number that ends an axis. */
export function axisEnd(curves) {
  const high = Math.max(0, ...curves.map((curve) => curve.high));
  if (!(high > 0)) return 1;
  const step = 10 ** Math.floor(Math.log10(high)) / 4;
  return Math.ceil((high * 1.001) / step) * step;
}

/**
 * The points of the plot: doses, and one list of values for each curve.
 * @param {{isDifferential: boolean, unit: 'percent'|'cm3', nPoints?: number}} how
 */
export function plotPoints(curves, { isDifferential, unit, nPoints = 500 }) {
  const end = axisEnd(curves);
  const doses = Array.from({ length: nPoints + 1 }, (_, index) => (index * end) / nPoints);
  const step = end / nPoints;
  const values = curves.map((curve) => doses.map((dose) => {
    const cm3 = isDifferential ? (volumeFrom(curve, dose) - volumeFrom(curve, dose + step)) / step : volumeFrom(curve, dose);
    return shareOf(curve, cm3, unit);
  }));
  return { doses, values, end };
}

/** The curves under a dose: name, share and volume that have at least it. */
export const readAt = (curves, dose) => curves.map((curve) => {
  const cm3 = volumeFrom(curve, dose);
  return { curve, cm3, percent: shareOf(curve, cm3, 'percent') };
});

/** The figures and the curves of histograms, with what they depend on in its first lines. @param {{words: string[][], regionName: (id: string) => string, unit: string}} about */
export function dvhCsv(curves, { words, regionName, unit }) {
  const { doses, values } = plotPoints(curves, { isDifferential: false, unit: 'percent', nPoints: 200 });
  const name = (curve) => `${regionName(curve.region)}${curve.of ? ` (${curve.dose})` : ''}`;
  const rows = curves.map((curve) => [name(curve), curve.volume, curve.univels, curve.missing, curve.low, curve.mean, curve.high, ...figureNames.map((figure) => curve.figures[figure])]);
  return csvText([
    ...words, [],
    ['region', 'cm3', 'univels', 'cm3 without a dose', ...['min', 'mean', 'max', ...figureNames].map((figure) => (figure === 'HI' ? figure : `${figure} (${unit})`))], ...rows, [],
    ...conformityRows(curves, { name, unit }),
    [`dose (${unit})`, ...curves.map((curve) => `${name(curve)}: % of volume with at least it`)], ...doses.map((dose, index) => [dose, ...values.map((list) => list[index])]),
  ]);
}

/** How well the isodose of each level fits the targets. paddick: covered² / (target x isodose), rtog: isodose / target, in cm3. */
function conformityRows(curves, { name, unit }) {
  const rows = curves.flatMap((curve) => curve.conformity.map((row) => [name(curve), row.value, row.isodose_cm3, row.covered_cm3, row.paddick, row.rtog]));
  return rows.length ? [['target', `level (${unit})`, 'isodose (cm3)', 'covered (cm3)', 'Paddick: covered^2 / (target x isodose)', 'RTOG: isodose / target'], ...rows, []] : [];
}

export const dvhJson = (curves, { words, regionName, unit }) => JSON.stringify({
  ...Object.fromEntries(words.map(([name, ...value]) => [name.replaceAll(' ', '_'), value.join(', ')])), unit,
  histograms: curves.map(({ above, of, ...curve }) => ({ ...curve, region_name: regionName(curve.region), compared: of > 0 })),
}, null, 1);
