// Words of plots of dose, the same in drawer, tables, files and print.
import { ofFits } from '../../fits/feature.js';
import { significant, unitText } from '../../../parts/format.js';

const names = { weighted: 'weighted total', 'weighted-total': 'weighted total of the file', isoeffective: 'photon-isoeffective' };
export const quantityName = (quantity) => names[quantity] ?? quantity.replaceAll('-', ' ');

export const doseName = (plan, id) =>
  plan.doses.find((dose) => dose.id === id)?.name || id || plan.doses[0]?.name || plan.doses[0]?.id || '';
export const regionOf = (plan, id) => plan.regions.find((region) => region.id === id);
export const regionName = (plan) => (id) => regionOf(plan, id)?.name ?? id;

/** "own weights", "as brain"; '' for a quantity without weights. */
export function weightWords(plan, { quantity, tissue }) {
  if (!['weighted', 'isoeffective'].includes(quantity)) return '';
  return tissue ? `as ${regionName(plan)(tissue)}` : 'own weights';
}

/** The basis of the numbers, as rows of a file: [name, value, ...]. of: figures of regions: whose weights count, and which univels. @param {{basis: string, population: string}} [of] */
export function basisRows({ room }, quantity, answer, of) {
  const [plan, { dose }] = [room.plan.value, room.scene.value];
  const perPpm = plan.doses.some(({ components }) => components.some((part) => part.per_ppm));
  const weights = weightRows(plan, dose);
  const whose = of ? of.basis : weightWords(plan, { ...dose, quantity });
  return [
    ['plan', plan.name, room.planId.value],
    ['revision', room.revision.value],
    ['dose', doseName(plan, dose.id), ...Object.keys(dose.sum ?? {}).map((id) => `with ${doseName(plan, id)}`)],
    ['quantity', quantityName(quantity)],
    ['unit', unitPer(answer)],
    ...(dose.factor === 1 || dose.factor === undefined ? [] : [['factor', dose.factor]]),
    ...(perPpm ? [['boron in blood (ppm)', dose.blood_ppm]] : []),
    ...(whose ? [['weights', whose, dose.weights_name || 'edited'], ...weights] : []),
    ...(of?.population ? [['univels of a region', of.population]] : []),
    ...(answer?.missing?.length ? [['without', ...answer.missing]] : []),
    ...(ofFits(room)?.usedRows({ room }) ?? []),
    ...(answer?.method ? [['method', answer.method]] : []),
    ['use', 'for research and plan review, not for treatment decisions'],
  ];
}

/** Regions with the same weights share a row. */
function weightRows(plan, dose) {
  const groups = new Map();
  for (const [id, row] of Object.entries(dose.weights ?? {})) {
    const key = Object.entries(weightNames)
      .map(([name, words]) => `${words} ${row[name]}`)
      .join('|');
    groups.set(key, [...(groups.get(key) ?? []), regionName(plan)(id)]);
  }
  return [...groups].map(([key, names]) => [`weights of ${names.join(' and ')}`, ...key.split('|')]);
}
const weightNames = { boron_ratio: 'boron to blood', cbe: 'CBE', nitrogen: 'nitrogen', fast: 'fast', gamma: 'gamma', other: 'other' };

/** "Gy(w) per minute": what stands beside the plot and in its files. */
export const unitPer = (answer) =>
  `${unitText(answer?.unit ?? '')}${answer?.per ? ` per ${unitText(answer.per.replace(/^per /, ''))}` : ''}`;

export const inUnit = (value, unit) => `${significant(value)} ${unitText(unit)}`;
