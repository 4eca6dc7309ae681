// Why an answer of the server does not come at present, in a sentence: so that nothing waits for ever without a word. Pure.

import { say } from './later_words.js';
/** '' where answers come: then it is being worked out. @param {import('./room.js').RoomState} room */
export function waitReason({ link, renderer, plan }) {
  const { state: linked, reason = '' } = link.value;
  if (linked === 'ended') return reason ? say.endedAs({ reason }) : say.ended;
  if (linked === 'lost') return say.lost;
  const { state, problem } = renderer.value;
  if (state === 'failed' || state === 'closed')
    return problem?.detail ? say.notKnown({ reason: problem.detail.replace(/\.$/, '') }) : say.notShown;
  if (state === 'restarting') return say.restarting;
  if (state !== 'ready' || !plan.value) return say.opening;
  return '';
}

/** Like waitReason, for numbers of dose. */
export const doseWaitReason = (room) => waitReason(room) || (room.plan.value.doses.length ? '' : say.noDose);
