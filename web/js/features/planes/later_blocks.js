// The block of Selection for an oblique plane, and the lines in panes.
import { obliqueBlock } from './oblique_plane.js';

export const blocks = { oblique: obliqueBlock };
export { PaneLines } from './pane_lines.js';
