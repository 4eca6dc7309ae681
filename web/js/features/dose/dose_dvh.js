// Dose-volume histograms as the page needs them: what is read off a curve, and the files that carry them.
import { csvText } from '../../parts/csv.js';
import { populationWords } from './dose_population.js';
import { say } from './data_words.js';

/**
 * One histogram. counts are the cm3 of the region in bins of equal width, the first one from `from`.
 * @typedef {object} DvhCurve
 * @property {string} region its id @property {string} dose its id @property {number} of 0: of the dose shown, 1: of the one it is compared with
 * @property {number} volume cm3 of the whole region: 100 % @property {number} cm3 of its univels that have a value @property {number} missing cm3 of those without @property {number} univels
 * @property {boolean} isPartial so much is missing that figures are said as bounds, and the curve is a band from `above` to `above` and the missing
 * @property {'own'|'whole'} population @property {string} basis whose weights count, in words; '' none
 * @property {number} high the largest value that is known
 * @property {Record<string, [number, number]>} figures of the server, by min, mean, max and figureNames: least and most; alike where it is known, NaN: none, Infinity: no bound
 * @property {{level: string, value: number, isodose_cm3: number, covered_cm3: number, paddick: number, rtog: number}[]} conformity of a target, for each level
 * @property {number} from @property {number} width @property {number[]} counts @property {number[]} above cm3 with at least the lower edge of each bin
 */

/** Columns of the table, in its order. HI: homogeneity, (D2% - D98%) / D50% (ICRU Report 83). */
export const figureNames = ['D98%', 'D50%', 'D2%', 'D0.03cc', 'HI'];
/** The name of a figure for people: D98% and the like are international. */
export const figureWords = (name) => ({ min: say.min, mean: say.mean, max: say.max })[name] ?? name;

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
export const shareOf = (curve, cm3, unit) => (unit === 'cm3' ? cm3 : curve.volume > 0 ? (100 * cm3) / curve.volume : 0);

/** The part of a region without a dose, that may be anywhere in its histogram; 0 for so little that nothing is said of it. */
export const openOf = (curve) => (curve.isPartial ? curve.missing : 0);

/**
 * A figure of which two bounds are known, as people read it: "6.73", "≥ 6.73", "≤ 1.2", "3 to 8", "not known", "–" for none.
 * @param {number} least @param {number} most Infinity: no bound @param {(value: number) => string} words of a value
 */
export function boundsWords([least, most], words) {
  if (!Number.isFinite(least)) return '–';
  if (least === most) return words(least);
  if (isOpen([least, most])) return say.notKnown;
  if (!Number.isFinite(most)) return `≥ ${words(least)}`;
  return least > 0 ? say.range({ least: words(least), most: words(most) }) : `≤ ${words(most)}`;
}

/** True for bounds that say nothing: from 0 on. */
export const isOpen = ([least, most]) => least !== most && !Number.isFinite(most) && !(least > 0);

/** The share of a region with at least a dose, in words: "25.0 %", "18.0 to 99.9 %". */
export function shareWords(curve, cm3, words) {
  const [least, most] = [cm3, cm3 + openOf(curve)].map((part) => shareOf(curve, part, 'percent'));
  return least === most ? `${words(least)} %` : say.percentRange({ least: words(least), most: words(most) });
}

/** The largest value of some curves, rounded up to a number that ends an axis. */
export function axisEnd(curves) {
  const high = Math.max(0, ...curves.map((curve) => curve.high));
  if (!(high > 0)) return 1;
  const step = 10 ** Math.floor(Math.log10(high)) / 4;
  return Math.ceil((high * 1.001) / step) * step;
}

/**
 * The points of the plot: doses, and one list of values for each curve; tops: of a curve that is a band its upper edge, else null.
 * @param {{isDifferential: boolean, unit: 'percent'|'cm3', nPoints?: number}} how
 */
export function plotPoints(curves, { isDifferential, unit, nPoints = 500 }) {
  const end = axisEnd(curves);
  const doses = Array.from({ length: nPoints + 1 }, (_, index) => (index * end) / nPoints);
  const step = end / nPoints;
  const values = curves.map((curve) =>
    doses.map((dose) => {
      const cm3 = isDifferential ? (volumeFrom(curve, dose) - volumeFrom(curve, dose + step)) / step : volumeFrom(curve, dose);
      return shareOf(curve, cm3, unit);
    }),
  );
  const tops = curves.map((curve, at) =>
    openOf(curve) > 0 && !isDifferential ? values[at].map((value) => value + shareOf(curve, openOf(curve), unit)) : null,
  );
  return { doses, values, end, tops };
}

/** The curves under a dose: name, share and volume that have at least it. */
export const readAt = (curves, dose) =>
  curves.map((curve) => {
    const cm3 = volumeFrom(curve, dose);
    return { curve, cm3, percent: shareOf(curve, cm3, 'percent') };
  });

/** The figures and the curves of histograms, with what they depend on in its first lines. @param {{words: {id: string, name: string, values: unknown[]}[], regionName: (id: string) => string, unit: string}} about */
export function dvhCsv(curves, { words, regionName, unit }) {
  const { doses, values, tops } = plotPoints(curves, { isDifferential: false, unit: 'percent', nPoints: 200 });
  const name = (curve) => `${regionName(curve.region)}${curve.of ? ` (${curve.dose})` : ''}`;
  const cell = (bounds) => (bounds[0] === bounds[1] ? bounds[0] : boundsWords(bounds, (value) => String(Number(value.toPrecision(9)))));
  const rows = curves.map((curve) => [
    name(curve),
    curve.volume,
    curve.univels,
    curve.missing,
    ...['min', 'mean', 'max', ...figureNames].map((figure) => cell(curve.figures[figure])),
    populationWords(curve.population),
    curve.basis,
  ]);
  const columns = curves.flatMap((curve, at) =>
    tops[at]
      ? [
          [say.csvLeast({ curve: name(curve) }), values[at]],
          [say.csvMost({ curve: name(curve) }), tops[at]],
        ]
      : [[say.csvShare({ curve: name(curve) }), values[at]]],
  );
  return csvText([
    ...words.map(({ name: about, values }) => [about, ...values]),
    [],
    [
      say.csvRegion,
      'cm3',
      say.csvUnivels,
      'missing_cm3',
      ...['min', 'mean', 'max', ...figureNames].map((figure) => (figure === 'HI' ? figure : `${figureWords(figure)} (${unit})`)),
      say.csvPopulation,
      say.csvWeights,
    ],
    ...rows,
    [],
    ...conformityRows(curves, { name, unit }),
    [say.csvDose({ unit }), ...columns.map(([head]) => head)],
    ...doses.map((dose, index) => [dose, ...columns.map(([, list]) => list[index])]),
  ]);
}

/** How well the isodose of each level fits the targets. paddick: covered² / (target x isodose), rtog: isodose / target, in cm3. */
function conformityRows(curves, { name, unit }) {
  const rows = curves.flatMap((curve) =>
    curve.conformity.map((row) => [name(curve), row.value, row.isodose_cm3, row.covered_cm3, row.paddick, row.rtog]),
  );
  return rows.length
    ? [[say.csvTarget, say.csvLevel({ unit }), say.csvIsodose, say.csvCovered, say.csvPaddick, say.csvRtog], ...rows, []]
    : [];
}

export const dvhJson = (curves, { words, regionName, unit }) =>
  JSON.stringify(
    {
      ...Object.fromEntries(words.map(({ id, values }) => [id, values.join(', ')])),
      unit,
      histograms: curves.map(({ above, of, missing, isPartial, figures, ...curve }) => ({
        ...curve,
        missing_cm3: missing,
        is_partial: isPartial,
        region_name: regionName(curve.region),
        compared: of > 0,
        figures: Object.fromEntries(Object.entries(figures).map(([figure, [least, most]]) => [figure, { least, most }])), // null: no bound
      })),
    },
    null,
    1,
  );
