// What is on the page once dose is drawn or values are pinned, loaded at once.
export { doseLegend } from './dose_legend.js';
export { lineLabels } from './dose_lines.js';
export { pinHere } from './dose_pin.js';
export { pinMarks, pinsBlock } from './dose_pins.js';
