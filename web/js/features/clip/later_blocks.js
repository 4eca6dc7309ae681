// The rows of clip planes, and the block of Selection for one.
import { clipBlock } from './clip_plane.js';

export const blocks = { clip: clipBlock };
export { clipRows } from './clip_rows.js';
