// All of beams that is loaded once one is selected, drafted or moved.
export { draftBar } from './beam_bar.js';
export { beamBlock, keptBlock } from './beam_block.js';
export { startMoving } from './beam_move.js';
