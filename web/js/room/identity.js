// Identity of a plan: the masked patient, the shown treatment plan and its approval. The full name is never here. Pure.
import { shownDose } from './dose.js';
import { shownImage } from './plan.js';
import { say } from './words.js';

export const unknownWords = say.noIdentity;

/** "A. V. …417" of a number of the plan's patients; '' where the files do not say. */
export const patientOf = (plan, index) => plan.patients[index]?.masked ?? '';

/** The patient whose parts are shown; null: the files name nobody. */
export function shownPatient(plan, scene) {
  if (!plan?.patients.length) return null;
  const index = plan.shownPatient ?? shownDose(plan, scene)?.patient ?? shownImage(plan, scene)?.patient ?? 0;
  return plan.patients[index] ?? null;
}

/** True for a part of another patient than the one shown: it is never used. */
export function isOfOther(plan, scene, part) {
  const of = plan.patients[part.patient];
  return Boolean(of) && plan.patients.length > 1 && of !== shownPatient(plan, scene);
}

/** The regions without those of another patient: what lists and choices offer. */
export const ownRegions = (plan, scene) =>
  plan.patients.length > 1 ? plan.regions.filter((region) => !isOfOther(plan, scene, region)) : plan.regions;

/** The shown patient in the server's list of identities, which has the plan's order; null where the list is of other files than the plan. */
export function identityOf(plan, scene, identities) {
  const patient = shownPatient(plan, scene);
  const found = identities[plan?.patients.indexOf(patient)];
  const isSame = identities.length === plan?.patients.length && found?.masked === patient?.masked;
  return isSame && found ? found : null;
}

/** Parts of other patients than the one shown: [{kind, id, name, masked}]. */
export function partsOfOthers(plan, scene) {
  const shown = shownPatient(plan, scene);
  if (!shown || plan.patients.length < 2) return [];
  const lists = [
    ['image', plan.images],
    ['dose', plan.doses],
    ['beam', plan.beams],
    ['region', plan.regions],
  ];
  return lists.flatMap(([kind, list]) =>
    list
      .filter(({ patient }) => plan.patients[patient] && plan.patients[patient] !== shown)
      .map(({ id, name, modality, patient }) => ({ kind, id, name: name || modality || id, masked: plan.patients[patient].masked })),
  );
}

/** The treatment plan that the shown dose belongs to, else the first; null: none. */
export function shownTreatmentPlan(plan, scene) {
  return plan?.treatmentPlans[shownDose(plan, scene)?.plan] ?? plan?.treatmentPlans[plan.shownPlan ?? 0] ?? null;
}

const approvals = {
  APPROVED: [say.approved, 'ok', 'check', say.approvedWithin],
  UNAPPROVED: [say.unapproved, 'warn', 'warning', say.unapprovedWithin],
  REJECTED: [say.rejected, 'err', 'error', say.rejectedWithin],
};
/** [word, class, icon, word within a sentence] */
export const approvalOf = (treatment) => approvals[(treatment?.approval ?? '').toUpperCase()] ?? [say.notStated, 'dim', '', say.notStated];

/** "20261112" as 2026-11-12. */
export const dateWords = (date) => (/^\d{8}$/.test(date ?? '') ? `${date.slice(0, 4)}-${date.slice(4, 6)}-${date.slice(6)}` : (date ?? ''));
