// Regions: how they are shown, their figures and shapes.
import { nothing } from '../../../lib/lit-html.js';
import { computed, effect, signal, untracked } from '../../../lib/signals-core.js';
import { ownRegions } from '../../room/identity.js';
import { known, later } from '../../parts/lazy.js';
import { askRefusals, liveShape, shapeNow } from './asking.js';
import { Refusals } from './refusals.js';
import { regionRows, regionTools } from './region_rows.js';
import { say } from './words.js';

const blocks = later(() => import('./later_blocks.js'));
const strips = later(() => import('./picture_strips.js'), 'js/parts/strip.css');
const hierarchyWords = { file: say.fromFile, derived: say.derived, none: '' };

/** Comparing representations begins with what is loaded for it. @returns {() => void} stops */
function compareLater(world) {
  let stop = null;
  const wait = effect(() => {
    const parts = blocks.loaded.value;
    if (parts) stop ??= untracked(() => parts.startComparison(world));
  });
  return () => {
    wait();
    stop?.();
  };
}

/** The strips of the check, and of regions that a picture leaves out; most rooms have neither. */
function stripsOf(world) {
  const { room, refused } = world;
  const isLeftOut = () =>
    [refused.value, ...room.views.map((view) => view.missing.value.reasons)].some((reasons) => Object.keys(reasons).length);
  if (!room.scene.value || !room.plan.value || !(room.scene.value.check.visible || isLeftOut())) return nothing;
  return known(strips)?.pictureStrips(world) ?? nothing;
}

/** @type {import('../index.js').Feature} */
export const regions = {
  make(world) {
    const { api, room } = world;
    world.shape = liveShape(world);
    world.shaped = computed(() => shapeNow(world.shape));
    world.refusals = new Refusals(api, signal({}));
    world.refused = computed(() => ({ ...world.refusals.reasons.value, ...room.view(1).missing.value.reasons }));
  },
  start(world) {
    const stops = [world.shape.start(), askRefusals(world), compareLater(world)];
    return () => stops.forEach((stop) => stop());
  },
  sections: [
    {
      id: 'regions',
      name: say.section,
      icon: 'layers',
      place: 3,
      has: (plan, scene) => (scene ? ownRegions(plan, scene) : plan.regions).length,
      note: ({ room }) => hierarchyWords[room.plan.value.hierarchy] ?? '',
      rows: regionRows,
      tools: regionTools,
    },
  ],
  kinds: { region: 'regions' },
  legend: stripsOf,
  blocks,
  isSoon: true,
  dialogs: ['figures'],
  dialog: (world) => blocks.loaded.value?.figuresDialog(world) ?? nothing,
};
