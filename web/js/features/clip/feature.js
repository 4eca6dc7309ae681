// Clip planes: what is cut off in the pictures.
import { later } from '../../parts/lazy.js';
import { clipNote, clipRows, hasClips, toggleCaps, toggleClips } from './clip_rows.js';
import { say } from './words.js';

/** @type {import('../index.js').Feature} */
export const clip = {
  sections: [{ id: 'clip', name: say.section, icon: 'clip', place: 7, has: hasClips, note: clipNote, rows: clipRows }],
  kinds: { clip: 'clip' },
  blocks: later(() => import('./later_blocks.js'), 'js/features/clip/clip.css'),
  isSoon: true,
  keys: { clips: ({ room, ui }, at) => toggleClips(room, ui, at), caps: ({ room, ui }, at) => toggleCaps(room, ui, at) },
};
