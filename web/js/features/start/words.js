// The words of a room's members on the start page, and of a room that has ended.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('start', {
  nobody: 'nobody in it now',
  you: 'you',
});
