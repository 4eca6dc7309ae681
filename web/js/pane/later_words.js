// The words in the menu of a camera.
import { sentences } from '../parts/sentences.js';

export const say = sentences('pane.later', {
  camera: 'Camera',
  lookFrom: 'Look from',
  fitIs: 'Fit to the selected region or measure',
  fit: 'Fit',
  resetIs: 'Reset this view',
  reset: 'Reset',
  rollLeftIs: 'Roll to the left by 5° (,)',
  rollLeft: 'Roll to the left',
  rollRightIs: 'Roll to the right by 5° (.)',
  rollRight: 'Roll to the right',
  projection: 'Projection',
  perspective: 'Perspective',
  parallel: 'Parallel',
  axes: 'Patient axes',
  axesIs: 'Lines through the middle of the plan, for everybody',
  linkCamerasHow: 'For two 3-D panes: put 3-D 2 into a pane by its name',
  onlyTargets: 'Only targets here',
  onlyTargetsIs: 'In this picture alone, for everybody who sees it',
});
