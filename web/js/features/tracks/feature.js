// Particle tracks.
import { known, later } from '../../parts/lazy.js';
import { say } from './words.js';

const rows = later(() => import('./track_rows.js'), 'js/features/tracks/track.css');

/** Exports of track_rows.js; null for a plan without tracks, and until they are loaded. */
const ofTracks = ({ plan, scene }) => (plan.value?.nTracks && scene.value?.tracks ? known(rows) : null);

/** Key T: tracks on or off. */
export function toggleTracks({ room, ui }, at) {
  if (!room.plan.value?.nTracks) return void ui.notify('ok', say.none, 'tracks');
  room.patchScene({ tracks: { visible: !room.scene.value.tracks.visible } }, { view: ui.active.value, at });
}

/** @type {import('../index.js').Feature} */
export const tracks = {
  sections: [
    {
      id: 'tracks',
      name: say.section,
      icon: 'tracks',
      place: 6,
      has: (plan) => plan.nTracks,
      note: (world) => ofTracks(world.room)?.trackNote(world) ?? '',
      rows: (world) => ofTracks(world.room)?.trackRows(world),
    },
  ],
  kinds: { tracks: 'tracks', track: 'tracks' },
  blocks: later(() => import('./track_block.js')),
  keys: { tracks: toggleTracks },
  pane: (world) => ({ layer: ({ plane, header, box }) => (plane ? null : ofTracks(world.room)?.chosenTrack(world, { header, box })) }),
};
