// All of dose that stands on the page while nothing of it is drawn or selected, loaded at once.
export { doseBasis } from './dose_bar.js';
export { doseAtCrosshair, doseHere } from './dose_probe.js';
export { doseNote, doseRows, toggleDose } from './dose_rows.js';
