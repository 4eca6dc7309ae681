// The words of measures that are there at once.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('measures', {
  section: 'Measures',
});
