// Usual colours of tissues, for regions: our own, in the manner of Sera3d's list of presets. Pure.
import { say } from './later_words.js';

/** Name and colour. */
export const tissueColours = [
  [say.tissueSkin, '#e8b796'],
  [say.tissueBone, '#efe6cc'],
  [say.tissueBrain, '#d99a9a'],
  [say.tissueStem, '#c98fb0'],
  [say.tissueEye, '#9fd0e8'],
  [say.tissueNerve, '#f0d56a'],
  [say.tissueVessel, '#c8443c'],
  [say.tissueAir, '#6fb7c9'],
  [say.tissueMuscle, '#b4624f'],
  [say.tissueGland, '#d8b04c'],
  [say.tissueTarget, '#f2c62e'],
  [say.tissueTumour, '#3fc25a'],
];
