// The words of beams on every page.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('beams', {
  section: 'Beams',
  noBeam: 'This plan has no beam.',
  beamGone: 'The beam of this pane is gone: it shows something else now.',
  noBeamNow: 'There is no beam: the pane shows something else now.',
  together: 'Show together',
});
