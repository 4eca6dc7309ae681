// Beams: shown, chosen, drafted, kept; panes along a beam; presets of beam, dose and volume.
import { isOfBeam } from '../../room/kinds.js';
import { known, later } from '../../parts/lazy.js';
import { beamKey, fitBeamEye, leaveBeam, toggleBeamEye } from './beam_view.js';
import { presetMenu } from './preset_menu.js';
import { say } from './words.js';

const rows = later(() => import('./beam_rows.js'));
const editing = later(() => import('./later_editing.js'), 'js/features/beams/beam_draft.css');

/** True where beams can be shown or drafted. */
const hasBeams = (plan) => plan.beams.length + plan.curves.length + plan.images.length + plan.regions.length;

/** Exports of beam_rows.js; null for a plan without beams, and until they are loaded. */
const ofBeams = ({ plan, scene }) => (plan.value && scene.value?.beam && hasBeams(plan.value) ? known(rows) : null);

/** Turns the tool on that moves a beam, or off again. It is on at once: a drag before its code is there moves nothing else. */
export async function toggleMove(world) {
  const { ui } = world;
  if (ui.tool.value === 'beam') return void (ui.tool.value = 'crosshair');
  ui.choose('beam', '');
  ui.tool.value = 'beam';
  await editing.load();
  if (ui.tool.peek() !== 'beam') return; // left meanwhile
  if (editing.loaded.peek()) editing.loaded.peek().startMoving(world);
  else ui.tool.value = 'crosshair';
}

/** @type {import('../index.js').Feature} */
export const beams = {
  sections: [
    {
      id: 'beams',
      name: say.section,
      icon: 'target',
      place: 5,
      has: hasBeams,
      note: (world) => ofBeams(world.room)?.beamNote(world) ?? '',
      rows: (world) => ofBeams(world.room)?.beamRows(world),
    },
  ],
  kinds: { beam: 'beams', kept: 'beams', preset: 'beams', curve: 'beams' },
  blocks: editing,
  keys: { beamEye: ({ room, ui }) => toggleBeamEye(room, ui) },
  key: beamKey,
  bar: (world) => (editing.loaded.value || world.room.scene.value?.beam?.draft.enabled ? known(editing)?.draftBar(world) : null),
  lateTools: ['beam'],
  strip: { mode: (world) => ofBeams(world.room)?.moveTool(world) },
  panesMenu: presetMenu,
  panesOf: {
    has: isOfBeam,
    isLocked: (kind) => kind === 'beam',
    code: later(() => import('./beam_panes.js'), 'js/features/beams/beam.css'),
  },
  start: (world) => {
    const stops = [leaveBeam(world), fitBeamEye(world)];
    return () => {
      for (const stop of stops) stop();
    };
  },
};
