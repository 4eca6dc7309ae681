// Clip planes: what is cut off in the pictures.
import { known, later } from '../../parts/lazy.js';
import { clipNote, hasClips, toggleCaps, toggleClips } from './clip_switch.js';
import { say } from './words.js';

const blocks = later(() => import('./later_blocks.js'), 'js/features/clip/clip.css');

/** @type {import('../index.js').Feature} */
export const clip = {
  sections: [
    {
      id: 'clip',
      name: say.section,
      icon: 'clip',
      place: 7,
      has: hasClips,
      note: clipNote,
      rows: (world) => known(blocks)?.clipRows(world),
    },
  ],
  kinds: { clip: 'clip' },
  blocks,
  isSoon: true,
  keys: { clips: ({ room, ui }, at) => toggleClips(room, ui, at), caps: ({ room, ui }, at) => toggleCaps(room, ui, at) },
};
