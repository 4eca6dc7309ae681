// Patient and plan, at the top of the Plan tab: whom it is of, which treatment plan is shown, its approval, what this room decided.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { approvalOf, dateWords, shownPatient, shownTreatmentPlan, unknownWords } from '../../room/identity.js';
import { statedBy } from '../../room/stated.js';
import { listed } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';
import { choosePlan } from './plan_switch.js';
import { dosesOf } from './plan_choice.js';
import { identityForm, statedRow } from './statement.js';

function approvalCell(treatment) {
  const [word, kind, picture] = approvalOf(treatment);
  return html`<span class=${kind}>${picture ? icon(picture, 12) : nothing} ${listed(word, dateWords(treatment.review_date), treatment.reviewer)}</span>`;
}

/** Where the banner has no place for the plan's name: on a phone. */
function planSelect(world, plan, shown) {
  const { room } = world;
  const change = (event) => choosePlan(world, plan.treatmentPlans[Number(event.target.value)], event.timeStamp);
  return html`<select aria-label=${say.plans} ?disabled=${!room.canChange.value} @change=${change}>${plan.treatmentPlans.map(
    (one, n) =>
      html`<option value=${n} ?disabled=${!dosesOf(plan, one).length} ?selected=${one === shown} .selected=${live(one === shown)}>${listed(one.label, approvalOf(one)[3])}</option>`,
  )}</select>`;
}

/** The newest decision of this room that no later one corrects: it never changes the plan's approval, and stands beside it. */
function decisionOf({ room }) {
  const all = [...room.items.rows.value.values()].filter(({ kind }) => kind === 'decision');
  const corrected = new Set(all.map(({ body }) => body.corrects));
  const row = all.findLast(({ id }) => !corrected.has(id));
  if (!row) return '';
  const date = new Date(row.created_ms).toLocaleDateString([], { day: 'numeric', month: 'short' });
  return say.decidedOn({ date, decision: say[row.body.decision] ?? row.body.decision });
}

export function planBlock(world) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const patient = shownPatient(plan, scene);
  const treatment = shownTreatmentPlan(plan, scene);
  const decision = decisionOf(world);
  const rows = [
    [say.patient, patient?.masked ?? (plan.isPhantom ? say.isPhantom : unknownWords)],
    treatment && [say.plan, listed(treatment.label, dateWords(treatment.date) && say.ofDate({ date: dateWords(treatment.date) }))],
    treatment && [say.approval, approvalCell(treatment)],
    decision && [say.decided, decision],
    plan.treatmentPlans.length > 1 && [say.plans, planSelect(world, plan, treatment)],
    patient && [say.identityFrom, statedBy(plan) ? statedRow(world) : say.fromFiles],
  ].filter(Boolean);
  return html`<section class="block"><h3>${say.patientAndPlan}</h3><dl>${rows.map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>${patient || plan.isPhantom ? nothing : identityForm(world)}</section>`;
}
