// The words of saved views that are merged, of files, and of answers that do not come.
import { sentences } from '../parts/sentences.js';

export const say = sentences('room.later', {
  notSaved: 'Not saved: {reason}',
  noSnapshot: 'No snapshot: {reason}',
  measures: '{n} {n|measure|measures}',
  probes: '{n} {n|pinned probe|pinned probes}',
  limits: '{n} {n|limit|limits}',
  drafts: '{n} {n|kept draft|kept drafts}',
  planes: '{n} {n|oblique plane|oblique planes}',
  levels: '{n} {n|isodose level|isodose levels}',
  draftBeam: 'the draft beam',
  hidden: 'Hidden, not deleted: {what}.',
  changed: 'Changed since, and left so: {what}.',
  left: 'No place is left for {what} of it.',
  ended: 'Not known: the room has ended.',
  endedAs: 'Not known: the room has ended, {reason}.',
  lost: 'Not known yet: the connection to the server is lost. It is asked when that is back.',
  notKnown: 'Not known: {reason}.',
  notShown: 'Not known: the plan cannot be shown.',
  restarting: 'Not known yet: the renderer is being started again.',
  opening: 'Not known yet: the plan is being opened.',
  noDose: 'This plan has no dose.',
});
