// The words in the tree of parts that are never drawn.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('fits', {
  section: 'Not this patient',
  neverDrawn: '{count} {n|part|parts}, never drawn',
});
