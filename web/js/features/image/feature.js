// Images: window, colours, the second image over the first, the image as a volume; Selection of the 3-D picture.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { known, later } from '../../parts/lazy.js';
import { Histograms } from './histograms.js';
import { imageRows } from './image_rows.js';
import { say } from './words.js';

const legend = later(() => import('./image_legend.js'), 'js/parts/strip.css');

/** In the header of a picture that turns by itself. */
function turnBadge({ turning }, number) {
  const { view, stop, words, how } = turning.value ?? {};
  return view === number
    ? html`<button class="badge turning" title=${how} @click=${stop}>${icon('rollLeft', 12)}<span>${words}</span></button>`
    : nothing;
}

/** The legend of an image in colours, and of one blended over another; most plans show neither. */
function legendOf(world) {
  const { color_map, blend } = world.room.scene.value?.image ?? {};
  return (color_map && color_map !== 'grey') || blend?.id ? (known(legend)?.imageLegend(world) ?? nothing) : nothing;
}

/** @type {import('../index.js').Feature} */
export const image = {
  make(world) {
    world.turning = signal(null); // while a picture turns by itself: {view, stop, words, how}
    world.histograms = new Histograms(world.api.histogram);
  },
  sections: [
    { id: 'images', name: say.section, icon: 'image', place: 1, has: (plan) => plan.images.length, note: () => '', rows: imageRows },
  ],
  kinds: { view: '', image: 'images', volume: 'images' },
  blocks: later(() => import('./later_blocks.js'), 'js/features/image/image.css'),
  isSoon: true,
  legend: legendOf,
  pane: (world, { number }) => ({
    head: () => turnBadge(world, number),
  }),
};
