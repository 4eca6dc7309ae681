// The words of the connection and of calls of the API.
import { sentences } from '../parts/sentences.js';

export const say = sentences('net', {
  noReason: 'The server refused without a reason.',
  noAnswer: 'The server does not answer.',
  answered: 'The server answered {status}.',
  gone: 'the room is no longer there; it ends with a restart of the server, and when nobody has been in it for long',
  tooManyFiles: 'More than {n} files; drop one plan.',
  broke: 'The connection broke before the plan was there.',
  cancelled: 'The upload was cancelled.',
});
