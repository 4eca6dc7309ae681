// Oblique planes; the lines in which they and clip planes cut the slices of panes.
import { later, laterPart } from '../../parts/lazy.js';
import { hasClips, isClipped } from '../clip/clip_switch.js';
import { obliqueNote, obliqueRows, obliquesOf } from './oblique_rows.js';
import { say } from './words.js';

const blocks = later(() => import('./later_blocks.js'), 'js/features/clip/clip.css');

/** Whether a slice may be cut by a line, or one is being drawn. */
const hasLines = (world) => Boolean(world.ui.picking.value || Object.keys(obliquesOf(world)).length || isClipped(world));

/** @type {import('../index.js').Feature} */
export const planes = {
  sections: [{ id: 'planes', name: say.section, icon: 'plane', place: 2, has: hasClips, note: obliqueNote, rows: obliqueRows }],
  kinds: { oblique: 'planes' },
  blocks,
  isSoon: true,
  pane: (world, view) => {
    const { room, ui, place } = world;
    return laterPart(
      () => hasLines(world),
      blocks,
      ({ PaneLines }) => {
        const lines = new PaneLines(room, ui, view, place);
        return { lines: () => lines.draw(), head: () => lines.head() };
      },
    );
  },
};
