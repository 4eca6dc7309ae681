// The words of oblique planes in the tree and in panes.
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
  clipHandle: 'Clip plane {plane}, {keeps}',
  clipHandleAny: 'Clip plane {plane}, in any direction',
  planeHandle: 'Plane {plane}',
  handleIs: '{plane}: {position} (drag, arrow keys)',
  turnFree: 'Turn the free clip plane',
  turn: 'Turn {plane}',
  turnIs: 'Turn {plane} (drag, arrow keys)',
  turnedBy: '{n}° in this pane',
  full: 'There are {n} planes already; delete one first.',
});
