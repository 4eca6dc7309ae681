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

/** Those who are or were in it: "you and Ben Roth"; '' for nobody. @param {{were_in: string[]}} room @param {string} own the own name */
export function whoWasIn({ were_in }, own) {
  const others = were_in.filter((name) => name !== own);
  return nameSome(others.length < were_in.length ? [say.you, ...others] : others, 4);
}
