// Absolute values of a scene when a dose in another unit is shown: 30 Gy stays 30 Gy and becomes 3000 where the dose is in cGy. Pure.

const isFluence = (quantity) => quantity.endsWith('fluence');
const grays = { Gy: 1, cGy: 0.01, mGy: 0.001 };
const volumeMetric = /^V(\d+(?:\.\d+)?)(cc)?$/;

/** Factor that converts a value from one unit to the other; 1 where they do not convert. */
export const unitFactor = (from, to) => (grays[from] && grays[to] ? Number((grays[from] / grays[to]).toPrecision(12)) : 1);

const scaled = (value, factor) => Number((value * factor).toPrecision(12));

function scaledLimit({ metric, limit }, factor) {
  const [, level, cc = ''] = volumeMetric.exec(metric) ?? [];
  return level ? { metric: `V${scaled(Number(level), factor)}${cc}` } : { limit: scaled(limit, factor) };
}

/** The patch that keeps levels, coverage, reference and limits what they are. Fluences have a unit of their own. */
export function unitPatch({ dose: { quantity, levels = {}, coverage, reference }, constraints = {} }, factor) {
  if (factor === 1) return {};
  const isOfDose = !isFluence(quantity);
  const changed = (map, is, change) =>
    Object.fromEntries(
      Object.entries(map)
        .filter(([, value]) => is(value))
        .map(([id, value]) => [id, change(value)]),
    );
  const dose = {
    ...(isOfDose && {
      levels: changed(
        levels,
        ({ unit }) => unit === 'dose',
        ({ value }) => ({ value: scaled(value, factor) }),
      ),
    }),
    ...(isOfDose &&
      coverage?.unit === 'dose' && {
        coverage: changed(
          { low: coverage.low, high: coverage.high },
          (value) => typeof value === 'number',
          (value) => scaled(value, factor),
        ),
      }),
    ...(isOfDose && reference?.kind === 'value' && { reference: { value: scaled(reference.value, factor) } }),
  };
  return {
    dose,
    constraints: changed(
      constraints,
      (limit) => !isFluence(limit.quantity),
      (limit) => scaledLimit(limit, factor),
    ),
  };
}
