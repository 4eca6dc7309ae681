// All of beams that is loaded once one is selected, drafted or moved.
import { beamBlock, keptBlock } from './beam_block.js';
import { curveBlock } from './curve_block.js';

export { draftBar } from './beam_bar.js';
export { startMoving } from './beam_move.js';

export const blocks = { beam: beamBlock, kept: keptBlock, curve: curveBlock };
