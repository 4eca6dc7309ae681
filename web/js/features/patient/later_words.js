// The words on the card of the patient.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('patient.later', {
  changed: 'The files have changed since this page opened them. Open the plan again to read whose it is.',
  patient: 'Patient',
  id: 'Id',
  born: 'Born',
  notGiven: 'not given',
  mask: 'Mask it again',
  masked: 'Masked, as for everybody.',
  show: 'Show to me',
  onWall: 'On the wall …',
  walls: 'Walls of this room',
  noWall: 'No wall is in this room: People, Make a link, as wall.',
  nameOnWall: 'Show the name there',
  maskOnWall: 'Mask it there',
  everybodyReads: 'Everybody in the room will read the name. The next case is masked again.',
  alone: 'To you alone, until you leave the room, at most {n} min. The audit keeps who, when and from where.',
});
