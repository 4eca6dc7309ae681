// The people in a room, in words.
import { present } from '../../room/plans.js';
import { nameSome } from '../../parts/format.js';
import { say } from './words.js';

/** "Dr A, Dr B and 2 more"; "nobody in it now" */
export const whoIn = (room) =>
  nameSome(
    present(room).map(({ name }) => name),
    4,
  ) || say.nobody;
