// The words of measures in the tree and in panes.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('measures.drawn', {
  distance: 'Distance',
  angle: 'Angle',
  polyline: 'Polyline',
  ellipse: 'Ellipse',
  distanceNumber: 'Distance {n}',
  angleNumber: 'Angle {n}',
  polylineNumber: 'Polyline {n}',
  ellipseNumber: 'Ellipse {n}',
  outside: 'outside the image',
  show: 'Show {measure}',
  showOrHide: 'Show or hide',
  full: 'There are {n} measures already: delete one first.',
});
