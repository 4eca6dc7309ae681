// The notes of a room as a text for people: what remains of them where the room was deleted. Loaded when it is asked for.
import { say } from './later_words.js';
import { threadsOf } from './threads.js';

const placeOf = (anchor, plan) => {
  const region = anchor?.region && (plan?.regions.find(({ id }) => id === anchor.region)?.name ?? anchor.region);
  const point =
    anchor?.point_mm &&
    ['L', 'P', 'S']
      .map((letter, axis) => `${letter} ${anchor.point_mm[axis].toFixed(1)}`)
      .join('  ')
      .concat(' mm');
  return [region, point].filter(Boolean).join(', ') || say.wholePlan;
};
const headOf = ({ author_name: name, created_ms: ms }) =>
  say.byAt({ name, time: new Date(ms).toISOString().slice(0, 16).replace('T', ' ') });
const indented = (text, by) =>
  text
    .split('\n')
    .map((line) => `${by}${line}`)
    .join('\n');

/** @param {object} room {id, planId, plan, rows: item rows of kind note} */
export const notesText = ({ id, planId, plan, rows }) =>
  [
    say.notesOfRoom({ room: id, plan: plan?.name ?? planId }),
    ...threadsOf(rows).map(({ note, number, replies }) =>
      [
        (note.body.resolved ? say.noteAtResolved : say.noteAt)({ number, head: headOf(note), place: placeOf(note.body.anchor, plan) }),
        indented(note.body.text, '   '),
        ...replies.flatMap((reply) => [`   ${headOf(reply)}`, indented(reply.body.text, '      ')]),
      ].join('\n'),
    ),
  ]
    .join('\n\n')
    .concat('\n');
