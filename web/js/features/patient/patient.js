// The patient, in the banner and in the Plan tab: masked, for everybody. The card that shows the full identity to one person is loaded when it is opened.
import { html, nothing } from '../../../lib/lit-html.js';
import { approvalOf, dateWords, shownPatient, shownTreatmentPlan, unknownWords } from '../../room/identity.js';
import { icon } from '../../parts/icons.js';
import { later } from '../../parts/lazy.js';

const card = later(() => import('./patient_card.js'), 'js/features/fits/fit.css');

const unknown = html`<span class="patient-unknown dim" title=${`Identity unknown: ${unknownWords}`}>${icon('note', 12)} <span>identity unknown</span></span>`;

/** The patient: "A. V. …417"; PHANTOM; identity unknown. */
export function patientButton(world) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan) return nothing;
  if (plan.isPhantom) return html`<span class="patient"><span class="tag phantom">PHANTOM</span></span><i class="rule"></i>`;
  const patient = shownPatient(plan, scene);
  if (!patient) return html`<span class="patient">${unknown}</span><i class="rule"></i>`;
  const shown = card.loaded.value?.shownIdentity(world);
  return html`<span class="patient masked anchor"><button class="patient-button" aria-expanded=${ui.popover.value === 'patient'} title="The patient" @click=${() => ui.toggle('patient')}>
      <b>${shown?.name ?? patient.masked}</b> ${icon(shown ? 'eye' : 'eyeOff', 12)}${shown ? html`<span class="dim">id ${shown.id} · born ${dateWords(shown.birth)}</span>` : nothing}</button>
      ${ui.popover.value === 'patient' ? card.draw(({ patientCard }) => patientCard(world)) : nothing}</span><i class="rule"></i>`;
}

/** The approval of the shown treatment plan, beside its name; nothing for plans without RTPLAN. */
export function approval({ room }) {
  const treatment = shownTreatmentPlan(room.plan.value, room.scene.value);
  if (!treatment) return nothing;
  const [word, kind, picture] = approvalOf(treatment);
  return html`<span class=${`pill approval ${kind}`} title=${`Plan ${treatment.label}: ${word.toLowerCase()}${treatment.review_date ? `, ${dateWords(treatment.review_date)}` : ''}${treatment.reviewer ? `, ${treatment.reviewer}` : ''}`}>${picture ? icon(picture, 12) : nothing}<span>${word}</span></span>`;
}

/** Patient and plan, at the top of the Plan tab. */
export function patientBlock({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const patient = shownPatient(plan, scene);
  const treatment = shownTreatmentPlan(plan, scene);
  const rows = [
    ['Patient', patient?.masked ?? (plan.isPhantom ? 'phantom' : unknownWords)],
    treatment && ['Plan', [treatment.label, dateWords(treatment.date) && `of ${dateWords(treatment.date)}`].filter(Boolean).join(', ')],
    treatment && ['Approval', [approvalOf(treatment)[0], dateWords(treatment.review_date), treatment.reviewer].filter(Boolean).join(', ')],
    plan.treatmentPlans.length > 1 && ['Plans in this folder', plan.treatmentPlans.map(({ label }) => label).join(', ')],
  ].filter(Boolean);
  return html`<section class="block"><h3>Patient and plan</h3><dl>${rows.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl></section>`;
}
