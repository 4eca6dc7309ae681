// Limits on doses, scene.constraints: their checks, their files, and what the server says of them.
import { enums } from '../../../gen/wire.js';
import { csvRows, csvText } from '../../parts/csv.js';
import { visibleText } from '../../parts/visible_text.js';
import { boundsWords, figureWords } from './dose_dvh.js';
import { populationWords } from './dose_population.js';
import { freeNumber } from '../../room/marks.js';
import { say } from './data_words.js';

export const mostConstraints = 64;
const mostCharacters = 200000;
const needed = ['region', 'quantity', 'metric', 'side', 'limit'];
const told = ['value', 'unit', 'met', 'reason', 'region name', 'weights', 'population']; // columns of our own files that say what came out
const metricPattern = /^(mean|min|max|D(\d+(?:\.\d+)?)(%|cc)|V(\d+(?:\.\d+)?)(cc)?)$/;

/** @typedef {{region: string, quantity: string, metric: string, side: 'at-most'|'at-least', limit: number}} Constraint */

/** The metric in the form of the scene: "d95 %" is "D95%", "V20%" is "V20". '' if it is none, also with a
 *  unit of dose: V20Gy would be read as 20 cGy where the dose is in cGy. */
export function readMetric(text) {
  const bare = String(text)
    .replace(/\s+/g, '')
    .replace(/cm(3|³)$/i, 'cc')
    .replace(/^V([\d.]+)%$/i, 'V$1');
  const metric = /^(mean|min|max)$/i.test(bare) ? bare.toLowerCase() : bare.replace(/^d/, 'D').replace(/^v/, 'V').replace(/cc$/i, 'cc');
  const parts = metricPattern.exec(metric);
  if (!parts || metric.length > 24) return '';
  return parts[3] === '%' && !(Number(parts[2]) <= 100) ? '' : metric;
}

/** The kind of a metric's unit: the quantity's unit, % or cm3. @returns {'dose'|'percent'|'cm3'} */
export const measureOf = (metric) => (!metric.startsWith('V') ? 'dose' : metric.endsWith('cc') ? 'cm3' : 'percent');

/** "D95 %", "V20 Gy(w)", "mean", for people. */
export function metricWords(metric, unit) {
  const [, , size, of, level, cc] = metricPattern.exec(metric) ?? [];
  if (size) return `D${size}${of === '%' ? ' %' : ' cm³'}`;
  return level ? `V${level} ${unit}${cc ? ', cm³' : ''}` : figureWords(metric);
}

/** Where the limit stands in a cumulative histogram: a dose, and the share or volume there; what is null is the whole axis. */
export function limitAt({ metric, limit }) {
  const [, , size, of, level, cc] = metricPattern.exec(metric) ?? [];
  if (size) return { dose: limit, [of === '%' ? 'percent' : 'cm3']: Number(size) };
  return level ? { dose: Number(level), [cc ? 'cm3' : 'percent']: limit } : { dose: limit };
}

/** An id that none of them has. suffix: of the ids of who does not present, so that two people's do not meet. */
export const freeConstraintId = (constraints, taken = [], suffix = '') =>
  `limit-${freeNumber([...Object.keys(constraints ?? {}), ...taken], 'limit-')}${suffix}`;

const regionOf = (plan, word) =>
  plan.regions.find(({ id }) => id === word) ?? plan.regions.find(({ name }) => name === word || visibleText(name) === word); // as a file of ours has it

/** Checks one by the rules of the scene. Throws an Error with a sentence. @returns {Constraint} */
export function readConstraint({ region, quantity, metric, side, limit, tissue = '' }, plan) {
  const found = regionOf(plan, region);
  if (!region) throw new Error(say.noRegion);
  if (!found) throw new Error(say.unknownRegion({ region }));
  const weighing = tissue && regionOf(plan, tissue);
  if (tissue && !weighing) throw new Error(say.unknownTissue({ region: tissue }));
  if (!enums.dose_quantity.includes(quantity)) throw new Error(say.noQuantity({ quantity, all: enums.dose_quantity.join(', ') }));
  const known = readMetric(metric);
  if (!known) throw new Error(say.noFigure({ figure: metric }));
  if (!enums.limit_side.includes(side)) throw new Error(say.noSide({ side, all: enums.limit_side.join(', ') }));
  const text = String(limit).trim();
  const value = Number(text);
  if (text === '' || !Number.isFinite(value) || value < 0 || value > 1e30) throw new Error(say.noNumber({ limit }));
  if (measureOf(known) === 'percent' && value > 100) throw new Error(say.overHundred({ percent: value }));
  return { region: found.id, quantity, metric: known, side, limit: value, ...(weighing && { tissue: weighing.id }) };
}

/** Reads a file whole or not at all: throws an Error with one sentence for each line that is wrong. @returns {Constraint[]} */
export function constraintsFromCsv(text, plan) {
  if (text.length > mostCharacters) throw new Error(say.fileTooLong({ n: mostCharacters }));
  const [head, ...rows] = csvRows(text);
  const columns = head?.cells.map((name) => name.toLowerCase()) ?? [];
  const missing = needed.filter((name) => !columns.includes(name));
  if (missing.length) throw new Error(say.columnsMissing({ columns: needed.join(', '), missing: missing.join(', '), n: missing.length }));
  const unknown = columns.filter((name) => !needed.includes(name) && !told.includes(name) && name !== 'tissue');
  if (unknown.length) throw new Error(say.unknownColumn({ column: unknown[0] }));
  const twice = columns.find((name, index) => columns.indexOf(name) !== index);
  if (twice) throw new Error(say.columnTwice({ column: twice }));
  if (!rows.length) throw new Error(say.noLimits);
  if (rows.length > mostConstraints) throw new Error(say.tooManyLimits({ n: rows.length, most: mostConstraints }));
  const errors = [];
  const constraints = rows.map(({ line, cells }) => {
    try {
      if (cells.length !== columns.length) throw new Error(say.fields({ n: cells.length, wanted: columns.length }));
      return readConstraint(Object.fromEntries(columns.map((name, index) => [name, cells[index]])), plan);
    } catch (error) {
      errors.push(say.inLine({ line, reason: error.message }));
      return null;
    }
  });
  if (errors.length)
    throw new Error([...errors.slice(0, 5), ...(errors.length > 5 ? [say.moreWrong({ n: errors.length - 5 })] : [])].join(' '));
  return constraints;
}

/** @param {{id: string, constraint: Constraint, verdict: Verdict}[]} rows */
export const constraintsCsv = (rows, plan) =>
  csvText([
    [...needed, 'value', 'unit', 'met', 'reason', 'region name', 'tissue', 'weights', 'population'],
    ...rows.map(({ constraint: { region, quantity, metric, side, limit, tissue = '' }, verdict }) => [
      region,
      quantity,
      metric,
      side,
      limit,
      verdict.value ??
        (Number.isFinite(verdict.bounds[0]) ? boundsWords(verdict.bounds, (value) => String(Number(value.toPrecision(9)))) : ''),
      verdict.unit,
      { met: say.yes, unmet: say.no }[verdict.state] ?? say.notKnown,
      verdict.reason,
      plan.regions.find(({ id }) => id === region)?.name ?? '',
      tissue,
      verdict.basis,
      populationWords(verdict.population),
    ]),
  ]);

/**
 * The verdict on a limit. @typedef {{state: 'met'|'unmet'|'unknown', value: number|null, bounds: [number, number], unit: string, reason: string, basis: string, population: string}} Verdict
 * bounds of the figure, as in dose_dvh.js; value null unless they are one. basis: whose weights count, '' none.
 * @param {object|undefined} row of the server's answer
 */
export function verdictOf(row, error = '') {
  const none = { value: null, bounds: [NaN, NaN], unit: '', basis: '', population: '' };
  if (!row) return { ...none, state: 'unknown', reason: error || say.noAnswer };
  const isNumber = Number.isFinite(row.value);
  const bounds = isNumber ? [row.value, row.value] : Number.isFinite(row.least) ? [row.least, row.most ?? Infinity] : none.bounds;
  const isKnown = typeof row.met === 'boolean' && Number.isFinite(bounds[0]);
  return {
    state: isKnown ? (row.met ? 'met' : 'unmet') : 'unknown',
    value: isNumber ? row.value : null,
    bounds,
    unit: row.unit ?? '',
    basis: row.basis ?? '',
    population: row.population ?? '',
    reason: isKnown ? '' : row.reason || say.noReason,
  };
}

const order = ['unmet', 'unknown', 'met'];
/** Limits in the order in which people need them: not met, not known, met. @param {{verdict: Verdict}[]} rows */
export const byState = (rows) => [...rows].sort((a, b) => order.indexOf(a.verdict.state) - order.indexOf(b.verdict.state));
