// The block of Selection for an oblique plane.
import { obliqueBlock } from './oblique_plane.js';

export const blocks = { oblique: obliqueBlock };
