// The patient, in the banner and in the Plan tab: masked, for everybody. The card that shows the full identity to one person is loaded when it is opened.
import { html, nothing } from '../../../lib/lit-html.js';
import { approvalOf, dateWords, shownPatient, shownTreatmentPlan, unknownWords } from '../../room/identity.js';
import { listed } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { known, later } from '../../parts/lazy.js';
import { say } from './words.js';

const card = later(() => import('./patient_card.js'), 'js/features/fits/fit.css');

const unknown = html`<span class="patient-unknown dim" title=${say.unknownWhy({ why: unknownWords })}>${icon('note', 12)} <span>${say.unknown}</span></span>`;

/** The mark of a patient whom a person has named, as the files do not. */
function pencil(plan) {
  const said = plan.statement;
  if (said?.state !== 'used' || said.kind !== 'identity') return nothing;
  return html` <span class="dim" title=${known(statement)?.statedBy(plan) || say.statedBy({ by: said.by })}>${icon('pencil', 12)}</span>`;
}

/** True where nobody signs in, and the one person at the server has it so: it is shown as soon as the room is there. */
function isAtOnce({ room, session, storage }) {
  return room.seesIdentity.value && !session.value && storage?.getItem('identity.at-once') === 'yes';
}

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
    return html`<span class="patient masked"><b class="patient-name">${patient.masked}${pencil(plan)}</b></span><i class="rule"></i>`;
  if (isAtOnce(world)) known(card)?.showAtOnce(world);
  const shown = card.loaded.value?.shownIdentity(world);
  const idBorn = shown ? html`<span class="dim">${say.idBorn({ id: shown.id, date: dateWords(shown.birth) })}</span>` : nothing;
  return html`<span class="patient masked anchor"><button class="patient-button" aria-expanded=${ui.popover.value === 'patient'}
      title=${say.thePatient} @click=${() => ui.toggle('patient')}>
      <b>${shown?.name ?? patient.masked}${pencil(plan)}</b> ${icon(shown ? 'eye' : 'eyeOff', 12)}${idBorn}</button>
      ${ui.popover.value === 'patient' ? card.draw(({ patientCard }) => patientCard(world)) : nothing}</span><i class="rule"></i>`;
}

const plans = later(() => import('./plan_switch.js'), 'js/features/fits/fit.css');
const several = (plan) => (plan?.treatmentPlans.length ?? 0) > 1;

/** The name of the plan: of a folder with RTPLAN that of the shown one, which is the switch where there are several; null: the folder's own. */
export function planName({ room, ui }) {
  const plan = room.plan.value;
  const treatment = shownTreatmentPlan(plan, room.scene.value);
  if (!treatment?.label) return null;
  if (!several(plan) || ui.arrangement.value.size === 'phone') return { name: treatment.label, place: '' }; // there the Plan tab has the switch
  const isOpen = ui.popover.value === 'plans';
  const place = say.planOf({ n: plan.treatmentPlans.indexOf(treatment) + 1, all: plan.treatmentPlans.length });
  const name = html`<button class="plan-button" title=${say.switchPlan} aria-haspopup="menu" aria-expanded=${isOpen} aria-label=${listed(treatment.label, place)}
    @click=${() => ui.toggle('plans')}><span>${treatment.label}</span>${icon('chevronDown', 12)}</button>`;
  return { name, place, menu: isOpen ? plans.draw(({ planMenu }) => planMenu({ room, ui })) : nothing };
}

const statement = later(() => import('./statement.js'), 'js/features/fits/fit.css');
const isRejected = (treatment) => approvalOf(treatment)[1] === 'err';

/** At first, where there are several; always where the shown one was rejected, or somebody has stated of whom the plan is. */
export function planBar(world) {
  const plan = world.room.plan.value;
  const bar = several(plan) || plan?.treatmentPlans.some(isRejected) ? known(plans)?.plansBar(world) : nothing;
  return html`${plan?.statement ? known(statement)?.statementBar(world) : nothing}${bar}`;
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

const block = later(() => import('./plan_block.js'), 'js/features/fits/fit.css');

/** Patient and plan, at the top of the Plan tab. */
export const patientBlock = (world) => block.draw(({ planBlock }) => planBlock(world));
