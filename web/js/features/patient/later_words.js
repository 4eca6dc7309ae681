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
  alone: 'To you alone, until you leave the room, at most {n} min. The audit keeps who, when and from where.',
});
