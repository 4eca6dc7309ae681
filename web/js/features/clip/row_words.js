// The words of clip planes in the tree.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('clip.row', {
  withCap: 'with cap',
  withoutCap: 'without cap',
  at: '{plane}: {position}',
  clipPlane: 'Clip plane {plane}',
  uncut: 'Do not cut here',
  cut: 'Cut here; at first through the crosshair',
  positionOf: 'Position of {plane} in mm',
  capOf: 'Cap of {plane}',
  leaveOpen: 'The cut is closed with a cap; leave it open',
  close: 'Close the cut with a cap',
  caps: 'Caps show',
  capsShow: 'Caps show {what}',
  allOff: 'All off',
  onAgain: 'On again',
  allToCrosshair: 'All to crosshair',
});
