// Measures: distances, angles, polylines and ellipses in slices.
import { later } from '../../parts/lazy.js';
import { Ellipses } from './ellipses.js';
import { hasMeasures, measureRows } from './measure_rows.js';
import { PaneMeasures } from './pane_measures.js';
import { say } from './words.js';

/** @type {import('../index.js').Feature} */
export const measures = {
  make(world) {
    world.ellipses = new Ellipses(world.api.ellipse, world.clock);
  },
  sections: [{ id: 'measures', name: say.section, icon: 'measure', place: 8, has: hasMeasures, note: () => '', rows: measureRows }],
  kinds: { measure: 'measures', measures: '' },
  blocks: later(() => import('./later_blocks.js')),
  isSoon: true,
  pane: ({ room, ui, ellipses, box, pointAt }, view) => new PaneMeasures({ room, ui, ellipses }, view, box, pointAt),
};
