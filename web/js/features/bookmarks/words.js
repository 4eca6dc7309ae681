// The words of saved views while the room has none.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('bookmarks', {
  section: 'Saved views',
  save: 'Save this view',
  saveMore: 'Save this view …',
  keeps: 'Keeps scene, cameras and panes as they are now',
});
