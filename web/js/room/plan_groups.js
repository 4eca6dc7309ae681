// Doses and beams by their treatment plan: the groups in the tree. Pure.
import { isOfOther, shownTreatmentPlan } from './identity.js';
import { say } from './later_words.js';

const approvals = { APPROVED: say.groupApproved, UNAPPROVED: say.groupUnapproved, REJECTED: say.groupRejected };
const planWords = ({ label, approval }) => (approvals[(approval ?? '').toUpperCase()] ?? say.groupNotStated)({ plan: label });

/** Whether a part belongs to another treatment plan than the one that is shown: it may be compared. */
export function isOfOtherPlan(plan, scene, part) {
  const of = plan.treatmentPlans[part.plan];
  return of !== undefined && of !== shownTreatmentPlan(plan, scene);
}

/**
 * The parts of a list that are not of another patient, in groups with their heads: the shown plan's first, those without a plan last; of a folder with one
 * treatment plan or none in one group without head.
 * @returns {{head: string, parts: object[]}[]}
 */
export function planGroups(plan, scene, list) {
  const own = list.filter((part) => !isOfOther(plan, scene, part));
  if (plan.treatmentPlans.length < 2) return [{ head: '', parts: own }];
  const first = shownTreatmentPlan(plan, scene);
  return [first, ...plan.treatmentPlans.filter((one) => one !== first), undefined]
    .map((treatment) => ({
      head: treatment ? planWords(treatment) : say.groupNoPlan,
      parts: own.filter((part) => plan.treatmentPlans[part.plan] === treatment),
    }))
    .filter(({ parts }) => parts.length);
}
