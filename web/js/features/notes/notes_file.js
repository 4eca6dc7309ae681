// The notes of a room as a text for people: what remains of them where the room was deleted. Loaded when it is asked for.
import { threadsOf } from './threads.js';

const placeOf = (anchor, plan) => {
  const region = anchor?.region && (plan?.regions.find(({ id }) => id === anchor.region)?.name ?? anchor.region);
  const point =
    anchor?.point_mm &&
    ['L', 'P', 'S']
      .map((letter, axis) => `${letter} ${anchor.point_mm[axis].toFixed(1)}`)
      .join('  ')
      .concat(' mm');
  return [region, point].filter(Boolean).join(', ') || 'the plan as a whole';
};
const headOf = ({ author_name: name, created_ms: ms }) => `${name}, ${new Date(ms).toISOString().slice(0, 16).replace('T', ' ')} UTC`;
const indented = (text, by) =>
  text
    .split('\n')
    .map((line) => `${by}${line}`)
    .join('\n');

/** @param {object} room {id, planId, plan, rows: item rows of kind note} */
export const notesText = ({ id, planId, plan, rows }) =>
  [
    `Notes of the room ${id} on ${plan?.name ?? planId}`,
    ...threadsOf(rows).map(({ note, number, replies }) =>
      [
        `${number}. ${headOf(note)}, at ${placeOf(note.body.anchor, plan)}${note.body.resolved ? ', resolved' : ''}`,
        indented(note.body.text, '   '),
        ...replies.flatMap((reply) => [`   ${headOf(reply)}`, indented(reply.body.text, '      ')]),
      ].join('\n'),
    ),
  ]
    .join('\n\n')
    .concat('\n');
