// Measures: distances, angles, polylines and ellipses in slices. The code is loaded before the first click, or with the first measure.
import { known, later, laterPart } from '../../parts/lazy.js';
import { Ellipses } from './ellipses.js';
import { say } from './words.js';

const blocks = later(() => import('./later_blocks.js'), 'js/features/image/image.css'); // the sheet of images has the style of measures

const hasMeasures = (scene) => Object.keys(scene?.measures ?? {}).length > 0;

/** @type {import('../index.js').Feature} */
export const measures = {
  make(world) {
    world.ellipses = new Ellipses(world.api.ellipse, world.clock);
  },
  sections: [
    {
      id: 'measures',
      name: say.section,
      icon: 'measure',
      place: 8,
      has: (plan, scene) => hasMeasures(scene),
      note: () => '',
      rows: (world) => known(blocks)?.measureRows(world),
    },
  ],
  kinds: { measure: 'measures', measures: '' },
  blocks,
  isSoon: true,
  pane({ room, ui, ellipses, box, pointAt }, view) {
    const part = laterPart(
      () => ui.tool.value === 'measure' || hasMeasures(room.scene.value),
      blocks,
      ({ PaneMeasures }) => new PaneMeasures({ room, ui, ellipses }, view, box, pointAt),
    );
    const isComing = ({ key }) => ui.tool.value === 'measure' && !known(blocks) && ['Enter', 'Backspace'].includes(key);
    const once = (event, at) => () => blocks.load().then(() => part.key(event, at)?.()); // a quick hand is not maximising the pane
    return { ...part, key: (event, at) => part.key(event, at) ?? (isComing(event) ? once(event, at) : null) };
  },
};
