// Images: window, colours, the second image over the first, the image as a volume; Selection of the 3-D picture.
import { nothing } from '../../../lib/lit-html.js';
import { isInSpace } from '../../room/kinds.js';
import { later } from '../../parts/lazy.js';
import { Histograms } from './histograms.js';
import { imageRows } from './image_rows.js';
import { imageLegend } from './window_fields.js';

const words = {
  window: 'window',
  low_values: 'greys of low values',
  interpolation: 'values between voxels',
  color_map: 'colours',
  looks: 'window of another image',
  clipped: 'clipping of slices',
  obliques: 'oblique plane',
};
const volumeWords = {
  visible: 'visibility of the volume',
  points: 'transfer function',
  cull_below: 'threshold of the volume',
  steps: 'slices of the volume',
  clipped: 'clipping of the volume',
};
const blendWords = { id: 'second image', opacity: 'opacity of the second image' };

/** @type {import('../index.js').Feature} */
export const image = {
  make(world) {
    world.histograms = new Histograms(world.api.histogram);
  },
  sections: [{ id: 'images', name: 'Images', icon: 'image', place: 1, has: (plan) => plan.images.length, note: () => '', rows: imageRows }],
  kinds: { view: '', image: 'images', volume: 'images' },
  blocks: later(() => import('./later_blocks.js')),
  isSoon: true,
  pane: (world, { kind, number }) => ({ legend: () => (isInSpace(kind) ? nothing : imageLegend(world, number)) }),
  undo: {
    image(name, inner) {
      if (name === 'slices') return inner.at(-1) === 'position_mm' ? 'crosshair' : 'slices in 3-D';
      if (name === 'volume') return volumeWords[inner[0]] ?? 'volume';
      if (name === 'blend') return blendWords[inner[0]] ?? 'second image';
      return words[name];
    },
  },
};
