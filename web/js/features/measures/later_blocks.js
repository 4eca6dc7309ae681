// Measures in panes and in the tree; the blocks of Selection for a measure, and for measuring.
import { measureBlock, measuresBlock } from './measure.js';

export const blocks = { measure: measureBlock, measures: measuresBlock };
export { measureRows } from './measure_rows.js';
export { PaneMeasures } from './pane_measures.js';
