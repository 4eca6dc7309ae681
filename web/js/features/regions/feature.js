// Regions: how they are shown, their figures and shapes.
import { nothing } from '../../../lib/lit-html.js';
import { computed, signal } from '../../../lib/signals-core.js';
import { ownRegions } from '../../room/identity.js';
import { later } from '../../parts/lazy.js';
import { askComparison, askRefusals, liveShape, shapeNow } from './asking.js';
import { Comparison } from './comparison.js';
import { Refusals } from './refusals.js';
import { regionRows, regionTools } from './region_rows.js';

const blocks = later(() => import('./later_blocks.js'));
const hierarchyWords = { file: 'hierarchy from file', derived: 'hierarchy derived', none: '' };

/** @type {import('../index.js').Feature} */
export const regions = {
  make(world) {
    const { api, room } = world;
    world.shape = liveShape(world);
    world.shaped = computed(() => shapeNow(world.shape));
    world.comparison = new Comparison(api, signal([]));
    world.refusals = new Refusals(api, signal({}));
    world.refused = computed(() => ({ ...world.refusals.reasons.value, ...room.view(1).missing.value.reasons }));
  },
  start(world) {
    const stops = [world.shape.start(), askComparison(world), askRefusals(world)];
    return () => stops.forEach((stop) => stop());
  },
  sections: [
    {
      id: 'regions',
      name: 'Regions',
      icon: 'layers',
      place: 3,
      has: (plan, scene) => (scene ? ownRegions(plan, scene) : plan.regions).length,
      note: ({ room }) => hierarchyWords[room.plan.value.hierarchy] ?? '',
      rows: regionRows,
      tools: regionTools,
    },
  ],
  kinds: { region: 'regions' },
  blocks,
  isSoon: true,
  dialogs: ['figures'],
  dialog: (world) => blocks.loaded.value?.figuresDialog(world) ?? nothing,
};
