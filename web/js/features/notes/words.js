// The words of notes before the first one.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('notes', {
  tab: 'Notes',
});
