// The words of pointers once somebody else is in the room.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('pointers.later', {
  point: 'Point',
  pointIs: 'Point: the others see where',
  isOn: 'The others see where you point',
  pointers: 'Pointers',
  pointersMore: 'Look here, pointers of the others',
  ask: 'Ask everybody to look here',
  askIs: 'Asks everybody to look where you point, else at the crosshair',
  comeTo: 'Come to {name}’s point',
  askNoMore: 'Ask no more',
  ofOthers: 'Pointers of the others',
  ofOthersIs: 'Whether you see them; kept in this browser',
  notAsked: 'Not asked: the server does not answer.',
  youAsk: 'You ask to look here: {n} of {all} came',
  end: 'End',
  asksYou: '{name} asks you to look here',
  come: 'Come',
  you: 'You',
  lookHere: '{name}: look here',
  youLookHere: 'You: look here',
  behind: 'behind',
});
