// The person who has stated whom a plan is of where its files name nobody: stands beside the masked patient wherever that is shown.
import { day } from '../parts/when.js';
import { say } from './later_words.js';

/** "stated by Anna Weiss, 27 Nov". @param {{by: string, time_ms: number}} said */
export const statedWords = ({ by, time_ms: ms }) => say.statedBy({ by, date: day(ms) });

/** These words of a plan; '' where its files name the patient, and where what was stated does not count. */
export const statedBy = (plan) =>
  plan?.statement?.state === 'used' && plan.statement.kind === 'identity' ? statedWords(plan.statement) : '';
