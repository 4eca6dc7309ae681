// The blocks of Selection for a dose, how it is drawn, one of its levels, and the legend.
import { doseBlock, levelBlock } from './dose_block.js';
import { legendBlock } from './legend_block.js';

export const blocks = { dose: doseBlock, quantity: doseBlock, dosing: doseBlock, level: levelBlock, legend: legendBlock };
