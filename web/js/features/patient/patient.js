// The patient, in the banner and in the Plan tab: masked, for everybody. The card that shows the full identity to one person is loaded when it is opened.
import { html, nothing } from '../../../lib/lit-html.js';
import { approvalOf, dateWords, shownPatient, shownTreatmentPlan, unknownWords } from '../../room/identity.js';
import { listed } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { later } from '../../parts/lazy.js';
import { say } from './words.js';

const card = later(() => import('./patient_card.js'), 'js/features/fits/fit.css');

const unknown = html`<span class="patient-unknown dim" title=${say.unknownWhy({ why: unknownWords })}>${icon('note', 12)} <span>${say.unknown}</span></span>`;

/** The patient: "A. V. …417"; PHANTOM; identity unknown. */
export function patientButton(world) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan) return nothing;
  if (plan.isPhantom) return html`<span class="patient"><span class="tag phantom">${say.phantom}</span></span><i class="rule"></i>`;
  const patient = shownPatient(plan, scene);
  if (!patient) return html`<span class="patient">${unknown}</span><i class="rule"></i>`;
  // without the right nothing opens
  if (!room.seesIdentity.value)
    return html`<span class="patient masked"><b class="patient-name">${patient.masked}</b></span><i class="rule"></i>`;
  const shown = card.loaded.value?.shownIdentity(world);
  const idBorn = shown ? html`<span class="dim">${say.idBorn({ id: shown.id, date: dateWords(shown.birth) })}</span>` : nothing;
  return html`<span class="patient masked anchor"><button class="patient-button" aria-expanded=${ui.popover.value === 'patient'}
      title=${say.thePatient} @click=${() => ui.toggle('patient')}>
      <b>${shown?.name ?? patient.masked}</b> ${icon(shown ? 'eye' : 'eyeOff', 12)}${idBorn}</button>
      ${ui.popover.value === 'patient' ? card.draw(({ patientCard }) => patientCard(world)) : nothing}</span><i class="rule"></i>`;
}

const planIs = { ok: say.planApproved, warn: say.planUnapproved, err: say.planRejected, dim: say.planNotStated };

/** The approval of the shown treatment plan, beside its name; nothing for plans without RTPLAN. */
export function approval({ room }) {
  const treatment = shownTreatmentPlan(room.plan.value, room.scene.value);
  if (!treatment) return nothing;
  const [word, kind, picture] = approvalOf(treatment);
  const title = listed(planIs[kind]({ plan: treatment.label }), dateWords(treatment.review_date), treatment.reviewer);
  return html`<span class=${`pill approval ${kind}`} title=${title}>${picture ? icon(picture, 12) : nothing}<span>${word}</span></span>`;
}

/** Patient and plan, at the top of the Plan tab. */
export function patientBlock({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const patient = shownPatient(plan, scene);
  const treatment = shownTreatmentPlan(plan, scene);
  const rows = [
    [say.patient, patient?.masked ?? (plan.isPhantom ? say.isPhantom : unknownWords)],
    treatment && [say.plan, listed(treatment.label, dateWords(treatment.date) && say.ofDate({ date: dateWords(treatment.date) }))],
    treatment && [say.approval, listed(approvalOf(treatment)[0], dateWords(treatment.review_date), treatment.reviewer)],
    plan.treatmentPlans.length > 1 && [say.plans, plan.treatmentPlans.map(({ label }) => label).join(', ')],
  ].filter(Boolean);
  return html`<section class="block"><h3>${say.patientAndPlan}</h3><dl>${rows.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl></section>`;
}
