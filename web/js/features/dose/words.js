// The words of dose on every page.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('dose', {
  noDose: 'This plan has no dose.',
  section: 'Doses',
  dvh: 'DVH',
  pinIs: 'Pin these values',
  pin: 'Pin these values',
  isodose: 'Isodose',
  isodoseIs: 'Isodose lines',
  wash: 'Wash',
  washIs: 'Wash of dose',
});
