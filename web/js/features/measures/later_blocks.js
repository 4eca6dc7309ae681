// The blocks of Selection for a measure, and for measuring.
import { measureBlock, measuresBlock } from './measure.js';

export const blocks = { measure: measureBlock, measures: measuresBlock };
