// The block of Selection for a clip plane.
import { clipBlock } from './clip_plane.js';

export const blocks = { clip: clipBlock };
