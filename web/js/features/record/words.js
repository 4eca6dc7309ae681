// The words of the record before its tab is opened.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('record', {
  tab: 'Record',
});
