// The words of pointing while nobody else is in the room.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('pointers', {
  alone: 'You are alone in this room: nobody sees where you point.',
  observer: 'You are here as an observer: observers do not point.',
});
