// The person who has stated whom a plan is of where its files name nobody: stands beside the masked patient wherever that is shown.
import { statedWords } from '../parts/when.js';

/** "stated by Anna Weiss, 27 Nov" of a plan; '' where its files name the patient, and where what was stated does not count. */
export const statedBy = (plan) =>
  plan?.statement?.state === 'used' && plan.statement.kind === 'identity' ? statedWords(plan.statement) : '';
