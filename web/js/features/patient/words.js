// The words of the patient in the banner and in the Plan tab.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('patient', {
  unknownWhy: 'Identity unknown: {why}',
  unknown: 'identity unknown',
  phantom: 'PHANTOM',
  thePatient: 'The patient',
  idBorn: 'id {id} · born {date}',
  planApproved: 'Plan {plan}: approved',
  planUnapproved: 'Plan {plan}: unapproved',
  planRejected: 'Plan {plan}: rejected',
  planNotStated: 'Plan {plan}: approval not stated',
  planOf: 'plan {n} of {all}',
  switchPlan: 'Show another treatment plan',
  statedBy: 'stated by {by}',
});
