// The blocks of Selection for a dose, how it is drawn, and one of its levels.
import { doseBlock, levelBlock } from './dose_block.js';

export const blocks = { dose: doseBlock, quantity: doseBlock, dosing: doseBlock, level: levelBlock };
