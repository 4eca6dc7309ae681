// Oblique planes; the lines in which they and clip planes cut the slices of panes.
import { later } from '../../parts/lazy.js';
import { hasClips } from '../clip/clip_rows.js';
import { obliqueNote, obliqueRows } from './oblique_rows.js';
import { PaneLines } from './pane_lines.js';
import { say } from './words.js';

/** @type {import('../index.js').Feature} */
export const planes = {
  sections: [{ id: 'planes', name: say.section, icon: 'plane', place: 2, has: hasClips, note: obliqueNote, rows: obliqueRows }],
  kinds: { oblique: 'planes' },
  blocks: later(() => import('./later_blocks.js')),
  isSoon: true,
  pane: ({ room, ui, place }, view) => {
    const lines = new PaneLines(room, ui, view, place);
    return { lines: () => lines.draw() };
  },
};
