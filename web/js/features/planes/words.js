// What a person reads of oblique planes in the tree and in panes.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('planes', {
  section: 'Planes',
  faces: '{plane}: faces {direction}',
  show: 'Show {plane} in 3-D',
  showOrHide: 'Show or hide in 3-D',
  paneOf: 'Show {plane} in a pane',
  pane: 'Show in a pane',
  newPlane: 'New plane',
  addPlane: 'New plane …',
  ways: 'By angles, by points, by a line, along a beam',
  onOneLine: 'That is no plane: the points lie on one line.',
  full: 'There are {n} planes already; delete one first.',
});
