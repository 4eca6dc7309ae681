// Images: window, colours, the second image over the first, the image as a volume; Selection of the 3-D picture.
import { nothing } from '../../../lib/lit-html.js';
import { isInSpace } from '../../room/kinds.js';
import { later } from '../../parts/lazy.js';
import { Histograms } from './histograms.js';
import { imageRows } from './image_rows.js';
import { imageLegend } from './image_legend.js';
import { say } from './words.js';

/** @type {import('../index.js').Feature} */
export const image = {
  make(world) {
    world.histograms = new Histograms(world.api.histogram);
  },
  sections: [
    { id: 'images', name: say.section, icon: 'image', place: 1, has: (plan) => plan.images.length, note: () => '', rows: imageRows },
  ],
  kinds: { view: '', image: 'images', volume: 'images' },
  blocks: later(() => import('./later_blocks.js'), 'js/features/image/image.css'),
  isSoon: true,
  pane: (world, { kind, number }) => ({ legend: () => (isInSpace(kind) ? nothing : imageLegend(world, number)) }),
};
