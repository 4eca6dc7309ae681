// The panels of beams: no part of what a first visit loads.
import { known, Lazy, styled } from '../../parts/lazy.js';

const rows = new Lazy(() => import('./beam_rows.js'));
const panels = new Lazy(async () => (await Promise.all([import('./later_editing.js'), styled('js/features/beams/beam_draft.css')]))[0]);

/** True where beams can be shown or drafted. */
export const hasBeams = (plan) => plan.beams.length + plan.curves.length + plan.images.length + plan.regions.length;

/** Exports of beam_rows.js; null for a plan without beams, and until they are loaded. */
export const ofBeams = ({ plan, scene }) => (plan.value && scene.value?.beam && hasBeams(plan.value) ? known(rows) : null);

/** Draws parts of later_editing.js in Selection. */
export const drawBeam = (use) => panels.draw(use);

/** Above the panes while a beam is drafted. */
export const draftBar = (world) =>
  panels.loaded.value || world.room.scene.value?.beam?.draft.enabled ? known(panels)?.draftBar(world) : null;

/** Turns the tool on that moves a beam, or off again. */
export async function toggleMove(world) {
  const { ui } = world;
  if (ui.tool.value === 'beam') return void (ui.tool.value = 'crosshair');
  ui.choose('beam', '');
  await panels.load();
  panels.loaded.peek()?.startMoving(world);
}
