// The list behind the plan's name in the banner, where a folder has several treatment plans; and what the bar says of them at first.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { approvalOf, dateWords, shownTreatmentPlan } from '../../room/identity.js';
import { listed } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { menuKeys } from '../../parts/roving.js';
import { say } from './later_words.js';
import { dosesOf, planPatch } from './plan_choice.js';

const barMs = 10000;

/** Shows this treatment plan of the folder. */
export function choosePlan({ room, ui }, treatment, at) {
  const [plan, scene] = [room.plan.peek(), room.scene.peek()];
  const shown = shownTreatmentPlan(plan, scene);
  if (treatment !== shown) room.patchScene(planPatch(plan, scene, shown, treatment), { view: ui.active.value, at });
}

function choose(world, treatment, event) {
  event.currentTarget.closest('.plan-name').querySelector('button').focus(); // the item goes
  world.ui.popover.value = '';
  choosePlan(world, treatment, event.timeStamp);
}

/** @param {object} world {room, ui} */
export function planMenu(world) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const shown = shownTreatmentPlan(plan, scene);
  const item = (treatment) => {
    const [word, kind, picture] = approvalOf(treatment);
    const hasDose = dosesOf(plan, treatment).length > 0;
    const reason = hasDose ? '' : say.noDose;
    return html`<button role="menuitemradio" aria-checked=${treatment === shown} ?disabled=${!hasDose || !room.canChange.value}
      @click=${(event) => choose(world, treatment, event)}>${treatment === shown ? icon('check') : html`<i></i>`}<span><b>${treatment.label}</b>
      <span class=${kind}>${picture ? icon(picture, 12) : nothing} ${word}</span> <span class="dim">${listed(dateWords(treatment.date), reason)}</span></span></button>`;
  };
  return html`<div class="popover plan-switch"><div class="menu" role="menu" aria-label=${say.plansHere} @keydown=${menuKeys}>${plan.treatmentPlans.map(item)}</div>
    <p class="note">${say.switchIs}</p></div>`;
}

const seen = new WeakMap(); // by plan: a signal, true while the bar stands

/** Says for a while which plan is shown, later the Plan tab alone says it; and as long as it is shown that it was rejected. */
export function plansBar({ room, clock }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan || !scene) return nothing;
  if (!seen.has(plan)) {
    const isOn = signal(true);
    seen.set(plan, isOn);
    clock.setTimeout(() => {
      isOn.value = false;
    }, barMs);
  }
  const shown = shownTreatmentPlan(plan, scene);
  const rejected = approvalOf(shown)[1] === 'err' ? rejectedBar(shown) : nothing;
  if (!seen.get(plan).value || plan.treatmentPlans.length < 2) return rejected;
  return html`${rejected}<div class="fit-bar plain" role="status">${icon('note')}<p>${plansWords(plan, scene)}</p></div>`;
}

function rejectedBar({ review_date: date, reviewer: name }) {
  const words = date && name ? say.rejectedOn : date ? say.rejectedAt : name ? say.rejectedBy : () => say.rejected;
  return html`<div class="fit-bar" role="alert"><span class="warn">${icon('warning')}</span><p><b>${words({ date: dateWords(date), name })}</b></p></div>`;
}

/** "2 plans in this folder. Shown: BNCT-2, approved 2026-11-12." */
export function plansWords(plan, scene) {
  const shown = shownTreatmentPlan(plan, scene);
  const [, , , within] = approvalOf(shown);
  const approval = [within, dateWords(shown.review_date)].filter(Boolean).join(' ');
  return html`<b>${say.nPlans({ n: plan.treatmentPlans.length })}</b> ${say.shownPlan({ plan: shown.label, approval })}`;
}
