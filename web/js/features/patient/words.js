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
  patientAndPlan: 'Patient and plan',
  patient: 'Patient',
  isPhantom: 'phantom',
  plan: 'Plan',
  ofDate: 'of {date}',
  approval: 'Approval',
  plans: 'Plans in this folder',
});
