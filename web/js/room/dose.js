// The dose that a scene shows: its quantities, its basis in words, the patches that change it. Pure.
import { number, unitText } from '../parts/format.js';
import { unitFactor, unitPatch } from './dose_units.js';
import { say } from './words.js';

const names = {
  weighted: [say.weighted, say.weightedWithin],
  total: [say.total, say.totalWithin],
  boron: [say.boron, say.boronWithin],
  nitrogen: [say.nitrogen, say.nitrogenWithin],
  fast: [say.fast, say.fastWithin],
  gamma: [say.gamma, say.gammaWithin],
  other: [say.other, say.otherWithin],
  'blood-boron': [say.bloodBoron, say.bloodBoronWithin],
  'weighted-total': [say.weightedTotal, say.weightedTotalWithin],
  isoeffective: [say.isoeffective, say.isoeffectiveWithin],
  'fast-fluence': [say.fastFluence, say.fastFluenceWithin],
  'epithermal-fluence': [say.epithermalFluence, say.epithermalFluenceWithin],
  'thermal-fluence': [say.thermalFluence, say.thermalFluenceWithin],
};
/** Summands of physical and weighted totals; a complete dose has the first four. */
const summands = ['boron', 'nitrogen', 'fast', 'gamma', 'other'];
const sums = ['weighted', 'total', 'isoeffective'];

export const quantityName = (quantity) => names[quantity]?.[0] ?? quantity;
/** Within a sentence, or behind a comma. */
export const quantityWithin = (quantity) => names[quantity]?.[1] ?? quantity.toLowerCase();
export const isFluence = (quantity) => quantity.endsWith('fluence');

/** The dose that the scene shows; null: the plan has none. */
export const shownDose = (plan, scene) => plan?.doses.find(({ id }) => id === scene?.dose.id) ?? plan?.doses[0] ?? null;
export const doseName = (dose) => dose.name || dose.id;
const componentOf = (dose, quantity) => dose.components.find((part) => part.quantity === quantity);
const hasSummands = (dose) => dose.components.some(({ quantity }) => summands.includes(quantity));

/** Quantities of a dose that can be shown, in the order of the list: sums only where there is something to sum. */
export function quantitiesOf(dose) {
  const has = (quantity) =>
    quantity === 'weighted' || quantity === 'isoeffective'
      ? hasSummands(dose)
      : quantity === 'total'
        ? hasSummands(dose) || Boolean(componentOf(dose, 'total'))
        : Boolean(componentOf(dose, quantity));
  return Object.keys(names).filter(has);
}

/** Summands that a sum of this dose lacks: ["nitrogen"]. */
export function missingOf(dose, quantity) {
  if (!sums.includes(quantity) || (quantity === 'total' && componentOf(dose, 'total'))) return [];
  return summands.slice(0, 4).filter((part) => !componentOf(dose, part));
}

/** "without nitrogen, fast neutrons"; '' when nothing is missing. */
export const missingWords = (missing) => (missing.length ? say.without({ quantities: missing.map(quantityWithin).join(', ') }) : '');

/** The unit of a quantity of a dose, for people. */
export function unitOf(dose, quantity) {
  const unit = unitText(
    componentOf(dose, quantity)?.unit ?? dose.components.find((part) => summands.includes(part.quantity))?.unit ?? dose.unit,
  );
  const [, gray] = /^(\w*Gy)/.exec(unit) ?? [];
  if (quantity === 'weighted' && gray) return `${gray}(w)`;
  return quantity === 'isoeffective' ? 'Gy(IsoE)' : unit;
}

/** True if the value depends on the boron in blood. */
export const dependsOnBlood = (dose, quantity) =>
  dose.components.some(
    (part) =>
      part.per_ppm &&
      (part.quantity === quantity ||
        (sums.includes(quantity) && part.quantity === 'boron' && !(quantity === 'total' && componentOf(dose, 'total')))),
  );
/** True if biological weights are in it. */
export const isWeighted = (quantity) => quantity === 'weighted';

/** The quantity that a dose is shown with: the one until now if it has it. */
export function quantityFor(scene, dose) {
  const all = quantitiesOf(dose);
  const { quantity, weights } = scene.dose;
  if (all.includes(quantity)) return quantity;
  if (dose.components.some((part) => part.per_ppm) && Object.keys(weights).length) return 'weighted';
  return ['total', 'weighted-total'].find((other) => componentOf(dose, other)) ?? all[0];
}

/** The doses of a sum, the shown one first. */
export const summedDoses = (plan, scene) => {
  const shown = shownDose(plan, scene);
  return [shown, ...plan.doses.filter((dose) => dose !== shown && dose.id in scene.dose.sum)].filter(Boolean);
};
/** The number of a treatment plan's beams, where the doses shown are those of all, once each; else 0. */
function beamsSummed(plan, scene) {
  const parts = summedDoses(plan, scene);
  const all = plan.treatmentPlans?.[parts[0]?.plan]?.beam_doses ?? [];
  const isOnce = ({ id }, n) => all.includes(id) && (n === 0 || scene.dose.sum[id].factor === scene.dose.factor);
  return parts.length > 1 && parts.length === all.length && parts.every(isOnce) ? all.length : 0;
}

/** True if anything of the dose is switched on. */
export const isOn = ({ dose }) =>
  dose.wash.visible || dose.lines.visible || dose.surfaces.visible || dose.coverage.visible || dose.compare.mode !== 'none';

// ---- patches ------------------------------------------------------------------------------------------------------------

/** Shows another dose, with a quantity that it has; one that is chosen from among those of all beams stands alone. What stands in a unit of dose
 * keeps its worth: a level of 30 Gy is not 30 cGy then. */
export function choosePatch(plan, scene, dose) {
  const shown = shownDose(plan, scene);
  const patch = unitPatch(scene, unitFactor(shown?.unit, dose.unit));
  const left = dose !== shown && beamsSummed(plan, scene) ? Object.keys(scene.dose.sum) : [dose.id].filter((id) => id in scene.dose.sum);
  return {
    ...patch,
    dose: {
      ...patch.dose,
      id: dose.id,
      quantity: quantityFor(scene, dose),
      ...(left.length && { sum: Object.fromEntries(left.map((id) => [id, null])) }),
    },
  };
}

/** Switches lines, wash and surfaces off, or wash and lines on. */
export function toggledPatch(plan, scene, dose, isShown) {
  const { lines, wash, surfaces } = scene.dose;
  const isAny = isShown && (lines.visible || wash.visible || surfaces.visible);
  const chosen = choosePatch(plan, scene, dose);
  return {
    ...chosen,
    dose: {
      ...chosen.dose,
      ...(isAny
        ? { lines: { visible: false }, wash: { visible: false }, surfaces: { visible: false } }
        : { lines: { visible: true }, wash: { visible: true } }),
    },
  };
}

// ---- words --------------------------------------------------------------------------------------------------------------

const regionName = (plan, id) =>
  plan.regions.find((region) => region.id === id)?.name ?? plan.regions.find(({ is_target: is }) => is)?.name ?? say.region;

/** "brain max", "body max", "prescription": what 100 % is, in a few words. */
export function referenceWords(plan, { kind, region }) {
  return {
    body: () => say.bodyMax,
    point: () => say.valueAtPoint,
    'region-max': () => say.maxOf({ region: regionName(plan, region) }),
    'region-mean': () => say.meanOf({ region: regionName(plan, region) }),
    value: () => say.prescription,
    file: () => say.ofFile,
  }[kind]();
}

/** " per fraction"; with a factor " for 30 × fraction". */
function perWords(per, factor) {
  const what = unitText(per.replace(/^per /, ''));
  if (factor === 1) return what ? ` ${say.per({ what })}` : '';
  const n = number(factor, factor % 1 ? 2 : 0);
  return ` ${what ? say.forTimes({ n, what }) : say.forTimesFile({ n })}`;
}

/** "sum of the doses of 2 beams", "dose of beam 1 of 2", "sum of 3 doses". */
function partsWords(plan, parts, ofBeams) {
  if (parts.length > 1) return ofBeams ? say.sumOfBeams({ n: ofBeams }) : say.sumOf({ n: parts.length });
  const all = plan.treatmentPlans?.[parts[0].plan]?.beams;
  return parts[0].beam && all ? say.doseOfBeam({ n: parts[0].beam, all }) : '';
}

/** "Gy(w) per 250 kW-min · blood 15 ppm · weights: BPA example · isodose as brain": what stands behind every number of dose. */
export function basisParts(plan, scene) {
  const dose = shownDose(plan, scene);
  if (!dose) return null;
  const { quantity, factor, blood_ppm: ppm, weights_name: set, tissue } = scene.dose;
  const parts = summedDoses(plan, scene);
  const missing = [...new Set(parts.flatMap((part) => missingOf(part, quantity)))];
  const ofBeams = beamsSummed(plan, scene);
  const ofParts = partsWords(plan, parts, ofBeams);
  const isOfBeams = ofBeams > 0 || (parts.length === 1 && Boolean(ofParts));
  return {
    unit: unitOf(dose, quantity),
    rest: [
      perWords(isOfBeams ? '' : dose.per, factor),
      quantity === 'weighted' ? '' : quantityWithin(quantity),
      dependsOnBlood(dose, quantity) ? say.bloodPpm({ n: number(ppm, ppm % 1 ? 1 : 0) }) : '',
      isWeighted(quantity) ? (set ? say.weightsOf({ name: set }) : say.weightsEdited) : '',
      tissue && (isWeighted(quantity) || dependsOnBlood(dose, quantity)) ? say.isodoseAs({ region: regionName(plan, tissue) }) : '',
      ofParts,
      missingWords(missing),
    ],
  };
}

export function basisWords(plan, scene) {
  const parts = basisParts(plan, scene);
  return parts ? [`${parts.unit}${parts.rest[0]}`, ...parts.rest.slice(1)].filter(Boolean).join(' · ') : '';
}
