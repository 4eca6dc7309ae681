// Answers to the questions about dose that have a closed form: in each region the dose is spread evenly between two values, so that its
// cumulative histogram is a straight line; along the beam it is a hyperbola. The page gets them in place of the server's.

/** Lowest and highest dose in Gy(w) and volume in cm3, by region of the demo plan. */
export const evenly = { scalp: [0, 4, 455], cranium: [0, 5, 847], brain: [0.5, 8, 1437], target: [20, 40, 27.6], tumour: [30, 50, 5.51] };

const bins = 100;

/** The curve of a region of which half has no dose: a histogram of the other half, and bounds. */
function halved(curve) {
  const { min, mean, max, metrics } = curve;
  const none = Object.fromEntries(Object.keys(metrics).map((name) => [name, null]));
  return {
    ...curve,
    missing_cm3: curve.volume_cm3 / 2,
    is_partial: true,
    min: null,
    mean: null,
    max: null,
    metrics: none,
    counts_cm3: curve.counts_cm3.map((cm3) => cm3 / 2),
    least: { min: 0, mean: mean / 2, max, metrics: { ...none, 'D98%': 0, 'D50%': 0, HI: 0 } },
    most: { min, mean: null, max: null, metrics: { ...none, 'D98%': max } },
  };
}

/** @param {string} partial region of which half has no dose */
export function dvhAnswer(regions, quantity = '', partial = '') {
  const common = { dose: 'goorley', quantity: quantity || 'weighted', unit: 'Gy(w)' };
  return {
    id: 'goorley',
    ...common,
    method: 'Each univel at its centre, in closed form.',
    missing: [],
    reason: null,
    fit: 'same',
    accepted: false,
    without_curves: [],
    body_cm3: 2772,
    curves: regions
      .map((region) => [region, ...evenly[region]])
      .map(([region, low, high, cm3]) =>
        (region === partial ? halved : (curve) => curve)({
          ...common,
          region,
          volume_cm3: cm3,
          n_univels: Math.round(cm3 * 1000),
          missing_cm3: 0,
          is_partial: false,
          population: 'own',
          basis: "each region's own weights",
          min: low,
          mean: (low + high) / 2,
          max: high,
          metrics: {
            ...Object.fromEntries(
              [
                ['D98%', 98],
                ['D50%', 50],
                ['D2%', 2],
                ['D0.03cc', 3 / cm3],
              ].map(([name, percent]) => [name, high - ((high - low) * percent) / 100]),
            ),
            HI: (0.96 * (high - low)) / ((low + high) / 2),
          },
          ...(region === 'tumour'
            ? {
                conformity: [
                  { level: '90', value: 36, isodose_cm3: 8, covered_cm3: 0.7 * cm3, paddick: (0.7 * cm3) ** 2 / (cm3 * 8), rtog: 8 / cm3 },
                ],
              }
            : {}),
          bin_from: 0,
          bin_width: high / bins,
          counts_cm3: Array.from(
            { length: bins },
            (_, bin) => (cm3 * Math.max(0, Math.min(high, ((bin + 1) * high) / bins) - Math.max(low, (bin * high) / bins))) / (high - low),
          ),
        }),
      ),
  };
}

export function profileAnswer() {
  const depths = Array.from({ length: 81 }, (_, at) => at * 2 - 10);
  const curve = (quantity, high, unit = 'Gy(w)') => ({
    quantity,
    unit,
    physical: null,
    physical_unit: null,
    values: depths.map((depth) => (depth < 0 ? null : high / (1 + ((depth - 30) / 25) ** 2))),
  });
  return {
    unit: 'Gy(w)',
    quantity: 'weighted',
    method: 'Trilinear every 2 mm, in closed form.',
    missing: [],
    per: '',
    reason: null,
    depths_mm: depths,
    curves: [
      curve('weighted', 40),
      curve('boron', 25),
      curve('gamma', 8),
      curve('nitrogen', 4),
      curve('fast', 3),
      curve('total', 12, 'Gy'),
      curve('thermal-fluence', 1e10, '1/cm2'),
    ],
    bands: [
      ['scalp', 0, 6],
      ['cranium', 6, 14],
      ['brain', 14, 40],
      ['tumour', 40, 60],
      ['brain', 60, 140],
    ].map(([region, from_mm, to_mm]) => ({ region, from_mm, to_mm })),
    entry_mm: 0,
    peak: { depth_mm: 30, from_entry_mm: 30, value: 40 },
    advantage_mm: 70,
    advantage: { target: 'tumour', unit: 'Gy(w)', normal_high: 8, depth_mm: 70, from_entry_mm: 70, reason: null },
    notes: ['Reference curves were computed in a phantom.'],
    references: [
      ['boron', 'Gy per ppm'],
      ['gamma', 'Gy'],
      ['fast', 'Gy'],
    ].map(([quantity, unit]) => ({
      id: 'water',
      name: 'water phantom',
      quantity,
      unit,
      per: '',
      radius_mm: 0,
      depths_mm: [0, 50, 100, 150],
      values: [10, 20, 8, 1],
    })),
  };
}

export function constraintsAnswer(constraints) {
  return {
    constraints: Object.entries(constraints).map(([id, { region, metric, side, limit, quantity }]) => {
      const [low, high] = evenly[region];
      const value = { mean: (low + high) / 2, min: low, max: high }[metric] ?? null;
      if (quantity !== 'weighted' || value === null)
        return { id, value: null, met: null, reason: `The dose has no ${metric} of ${quantity}.` };
      return { id, value, unit: 'Gy(w)', met: side === 'at-most' ? value <= limit : value >= limit };
    }),
  };
}

/** @param {import('playwright-core').Page} page @returns {Promise<{question: string}[]>} what was asked, growing */
export async function stubDose(page, { dose = 42, constraints = {}, partial = '' } = {}) {
  const asked = [];
  const answers = {
    dvh: ({ regions, quantity }) => dvhAnswer(regions.split(','), quantity, partial),
    profile: profileAnswer,
    constraints: () => constraintsAnswer(constraints),
  };
  await page.route(/\/plans\/[^/]+\/dose\/probe\?/, async (route) => {
    try {
      const response = await route.fetch();
      await route.fulfill({ response, json: { ...(await response.json()), value: dose, unit: 'Gy(w)' } });
    } catch (error) {
      if (!/disposed|closed/.test(error.message)) throw error; // else the page went away while it asked
    }
  });
  await page.route(/\/plans\/[^/]+\/(dvh|profile|constraints)\?/, (route) => {
    const url = new URL(route.request().url());
    const question = url.pathname.split('/').at(-1);
    const parameters = Object.fromEntries(url.searchParams);
    asked.push({ question, ...parameters });
    return route.fulfill({ json: answers[question](parameters) });
  });
  return asked;
}
