// Why an answer of the server does not come at present, in a sentence: so that nothing waits for ever without a word. Pure.

/** '' where answers come: then it is being worked out. @param {import('./room.js').RoomState} room */
export function waitReason({ link, renderer, plan }) {
  const { state: linked, reason = '' } = link.value;
  if (linked === 'ended') return `Not known: the room has ended${reason ? `, ${reason}` : ''}.`;
  if (linked === 'lost') return 'Not known yet: the connection to the server is lost. It is asked when that is back.';
  const { state, problem } = renderer.value;
  if (state === 'failed' || state === 'closed') return `Not known: ${problem?.detail ?? 'the plan cannot be shown'}.`.replace('..', '.');
  if (state === 'restarting') return 'Not known yet: the renderer is being started again.';
  if (state !== 'ready' || !plan.value) return 'Not known yet: the plan is being opened.';
  return '';
}

/** Like waitReason, for numbers of dose. */
export const doseWaitReason = (room) => waitReason(room) || (room.plan.value.doses.length ? '' : 'This plan has no dose.');
