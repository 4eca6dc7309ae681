// Transfer functions to begin with, of proto/volume_presets.json: those that fit an image, in its own values.
import { volumePresets as described } from '../../../gen/volume_presets.js';

/**
 * All presets: {name, modality, unit, points}. unit 'HU': the points' values are Hounsfield units; 'window': parts of the
 * window, 0 its lower end, 1 its upper end.
 */
export const volumePresets = described;

/** The points of a preset in the values of an image shown with this window. @param {{center: number, width: number}} window */
export function presetPoints({ unit, points }, { center, width }) {
  if (unit === 'HU') return points;
  return points.map((point) => ({ ...point, value: center + (point.value - 0.5) * width }));
}

/** The presets that fit an image: those in HU for an image in HU, else those in parts of its window. */
export const presetsOfImage = (image) => volumePresets.filter(({ unit }) => (unit === 'HU') === (image.unit === 'HU'));
