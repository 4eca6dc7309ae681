// The words in the plots on paper.
import { sentences } from '../../../parts/sentences.js';

export const say = sentences('dose.plots.printed', {
  basis: 'Basis of the dose',
  basisIs: 'As the room is now; below each figure stands its own.',
  notKnown: 'not known',
  irradiation: 'irradiation',
  minutes: '{n} min',
  curves: 'Curves',
  histogramError: 'Histograms: {reason}',
  histogram: 'Dose-volume histogram',
  figures: 'Figures of the histograms',
  region: 'Region',
  withoutDose: 'without dose, cm³',
  univels: 'Univels',
  band: '{region} {from} to {to} mm',
  profileOf: 'Depth profile, {line}',
  profile: 'Depth profile',
  limits: 'Limits of dose',
  univelsOfEach: 'Univels of each region: {population}.',
  limit: 'Limit',
  quantity: 'Quantity',
  weights: 'Weights',
  value: 'Value',
  met: 'Met',
});
