// The panels of particle tracks: no part of what a first visit loads.
import { known, Lazy, styled } from '../../parts/lazy.js';

const rows = new Lazy(async () => (await Promise.all([import('./track_rows.js'), styled('js/features/tracks/track.css')]))[0]);
const panels = new Lazy(() => import('./track_block.js'));

/** Exports of track_rows.js; null for a plan without tracks, and until they are loaded. */
export const ofTracks = ({ plan, scene }) => (plan.value?.nTracks && scene.value?.tracks ? known(rows) : null);

/** Draws parts of track_block.js in Selection. */
export const drawTracks = (use) => panels.draw(use);

/** Key T: tracks on or off. */
export function toggleTracks({ room, ui }, at) {
  if (!room.plan.value?.nTracks) return void ui.notify('ok', 'This plan has no particle tracks.', 'tracks');
  room.patchScene({ tracks: { visible: !room.scene.value.tracks.visible } }, { view: ui.active.value, at });
}
