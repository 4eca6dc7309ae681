// The panels of dose: no part of what a first visit loads, as the start page and many plans do without.
import { known, Lazy } from '../../parts/lazy.js';

const panels = new Lazy(() => import('./later_rows.js'));
const drawn = new Lazy(() => import('./later_drawn.js'));

/** Exports of later_rows.js; null for a plan without doses, and until it is loaded. */
export const ofDose = (room) => (room.plan.value?.doses.length ? known(panels) : null);

/** Pins the values at the crosshair. */
export async function pinHere(world, at) {
  if (!drawn.loaded.peek()) await drawn.load();
  drawn.loaded.peek()?.pinHere(world, at);
}

/** Exports of later_drawn.js; null while nothing of a dose is switched on and nothing is pinned, and until it is loaded. */
export function ofDrawnDose(room) {
  const scene = room.scene.value;
  if (!room.plan.value?.doses.length || !scene?.dose) return null;
  const { wash, lines, surfaces, coverage, compare } = scene.dose;
  const isOn =
    wash.visible ||
    lines.visible ||
    surfaces.visible ||
    coverage.visible ||
    compare.mode !== 'none' ||
    Object.keys(scene.probes).length > 0;
  return isOn ? known(drawn) : null;
}
