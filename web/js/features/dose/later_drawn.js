// Modules for a page on which dose is drawn or values are pinned, loaded together.
export { doseLegend } from './dose_legend.js';
export { lineLabels } from './dose_lines.js';
export { pinHere } from './dose_pin.js';
export { pinMarks, pinsBlock } from './dose_pins.js';
