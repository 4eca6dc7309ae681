// Words of plots of dose, the same in drawer, tables, files and print.
import { ofFits } from '../../fits/feature.js';
import { significant, unitText } from '../../../parts/format.js';
import { say } from './words.js';

const names = {
  weighted: say.weighted,
  total: say.total,
  boron: say.boron,
  nitrogen: say.nitrogen,
  fast: say.fast,
  gamma: say.gamma,
  other: say.other,
  'blood-boron': say.bloodBoron,
  'weighted-total': say.weightedTotal,
  isoeffective: say.isoeffective,
  'fast-fluence': say.fastFluence,
  'epithermal-fluence': say.epithermalFluence,
  'thermal-fluence': say.thermalFluence,
};
export const quantityName = (quantity) => names[quantity] ?? quantity.replaceAll('-', ' ');

export const doseName = (plan, id) =>
  plan.doses.find((dose) => dose.id === id)?.name || id || plan.doses[0]?.name || plan.doses[0]?.id || '';
export const regionOf = (plan, id) => plan.regions.find((region) => region.id === id);
export const regionName = (plan) => (id) => regionOf(plan, id)?.name ?? id;

/** "own weights", "as brain"; '' for a quantity without weights. */
export function weightWords(plan, { quantity, tissue }) {
  if (!['weighted', 'isoeffective'].includes(quantity)) return '';
  return tissue ? say.asRegion({ region: regionName(plan)(tissue) }) : say.ownWeights;
}

export const row = (id, name, ...values) => ({ id, name, values });

/** The basis of the numbers, as rows of a file. of: figures of regions: whose weights count, and which univels. @param {{basis: string, population: string}} [of]
 *  @returns {{id: string, name: string, values: unknown[]}[]} id: its name in a JSON file */
export function basisRows({ room }, quantity, answer, of) {
  const [plan, { dose }] = [room.plan.value, room.scene.value];
  const perPpm = plan.doses.some(({ components }) => components.some((part) => part.per_ppm));
  const weights = weightRows(plan, dose);
  const whose = of ? of.basis : weightWords(plan, { ...dose, quantity });
  return [
    row('plan', say.rowPlan, plan.name, room.planId.value),
    row('revision', say.rowRevision, room.revision.value),
    row(
      'dose',
      say.rowDose,
      doseName(plan, dose.id),
      ...Object.keys(dose.sum ?? {}).map((id) => say.withDose({ dose: doseName(plan, id) })),
    ),
    row('quantity', say.rowQuantity, quantityName(quantity)),
    row('unit', say.rowUnit, unitPer(answer)),
    ...(dose.factor === 1 || dose.factor === undefined ? [] : [row('factor', say.rowFactor, dose.factor)]),
    ...(perPpm ? [row('boron_in_blood_(ppm)', say.rowBoron, dose.blood_ppm)] : []),
    ...(whose ? [row('weights', say.rowWeights, whose, dose.weights_name || say.edited), ...weights] : []),
    ...(of?.population ? [row('univels_of_a_region', say.rowUnivels, of.population)] : []),
    ...(answer?.missing?.length ? [row('without', say.rowWithout, ...answer.missing)] : []),
    ...(ofFits(room)?.usedRows({ room }) ?? []).map((used) => row('used_though_it_does_not_fit', ...used)),
    ...(answer?.method ? [row('method', say.rowMethod, answer.method)] : []),
    row('use', say.rowUse, say.notForTreatment),
  ];
}

/** Regions with the same weights share a row. */
function weightRows(plan, dose) {
  const groups = new Map();
  for (const [id, weights] of Object.entries(dose.weights ?? {})) {
    const key = Object.entries(weightWordsOf)
      .map(([name, words]) => words({ value: weights[name] }))
      .join('|');
    groups.set(key, [...(groups.get(key) ?? []), regionName(plan)(id)]);
  }
  return [...groups].map(([key, regions]) =>
    row(
      `weights_of_${regions.join('_and_').replaceAll(' ', '_')}`,
      say.weightsOf({ regions: regions.reduce((one, two) => say.and({ one, two })) }),
      ...key.split('|'),
    ),
  );
}
const weightWordsOf = {
  boron_ratio: say.weightBoron,
  cbe: say.weightCbe,
  nitrogen: say.weightNitrogen,
  fast: say.weightFast,
  gamma: say.weightGamma,
  other: say.weightOther,
};

/** "Gy(w) per minute": what stands beside the plot and in its files. */
export const unitPer = (answer) =>
  answer?.per
    ? say.unitPer({ unit: unitText(answer.unit ?? ''), per: unitText(answer.per.replace(/^per /, '')) })
    : unitText(answer?.unit ?? '');

export const inUnit = (value, unit) => `${significant(value)} ${unitText(unit)}`;
