// The words of the text in a picture that cannot be read.
import { sentences } from '../parts/sentences.js';

export const say = sentences('net.later', {
  tooLong: 'The text in the picture is too long.',
  damaged: 'The text in the picture is damaged.',
  cutOff: 'The picture is cut off.',
});
