// The words of particle tracks before their rows are loaded.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('tracks', {
  section: 'Tracks',
  none: 'This plan has no particle tracks.',
});
