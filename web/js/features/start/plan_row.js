// One plan on the start page: thumbnail, whom it is of, label, approval, parts, one button; below it the last room on it, with the way to others.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { isOfServer } from '../../room/plans.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { dicomDay, roomName, statedWords, when } from '../../parts/when.js';
import { say } from './later_words.js';
import { whoWasIn } from './who_in.js';

/** True for a plan that could not be loaded for want of a place on the server. */
const isWaiting = (plan) => plan.state === 'failed' && isOfServer(plan.problem);

/** Why the plan cannot be opened, if known. */
export const refusalOf = (state, plan) =>
  state.refusals.value[plan.id] || (['failed', 'unreadable'].includes(plan.state) && !isWaiting(plan) ? plan.reason : '');

/** The masked patient of a plan, and who has stated that where the files do not; '' where nobody has. */
export const patientOf = (plan) => (plan?.stated ? `${plan.patient}, ${statedWords(plan.stated)}` : (plan?.patient ?? ''));

/** The title of a plan in lists: its label, else its name. */
export const titleOf = (plan) => plan.label || plan.name;

export function planRow(state, plan, { thumbnails, ownName }) {
  const job = state.jobs.value[plan.id];
  const refusal = refusalOf(state, plan);
  const isChosen = state.chosen.value === plan.id;
  const older = state.unfolded.value === plan.id ? plan.rooms.slice(1) : [];
  return html`<li class=${classMap({ plan: true, chosen: isChosen })} data-plan=${plan.id} @click=${() => state.choose(plan.id)}>
    <div class="plan-row">${thumbnail(thumbnails.of(plan), refusal)}${person(plan)}
      <div class="title"><button class="as-text" aria-pressed=${isChosen} title=${say.showReport}
        @click=${() => state.choose(plan.id)}>${titleOf(plan)}</button><span class="dim">${about(plan)}</span><code>${plan.id}</code>
        <div class="parts">${(plan.parts ?? []).map((part) => html`<span class="tag">${part}</span>`)}</div></div>
      <div class="states">${approval(plan)}<div class="plan-state">${stateWords(plan, job, refusal)}</div></div>
      <div class="end buttons-of">${action(state, plan, job, isChosen)}</div></div>
    ${!job && plan.rooms.length ? lastRoom(state, plan, ownName) : nothing}
    ${older.length ? html`<ul class="older-rooms">${older.map((room) => olderRoom(state, plan, room, ownName))}</ul>` : nothing}
    ${job ? progress(job) : nothing}
    ${refusal && !job ? html`<div class="refusal">${icon('error')}<div><p>${refusal}</p><p class="place">${say.nothingLoaded}</p></div></div>` : nothing}</li>`;
}

const thumbnail = (url, refusal) =>
  html`<span class="thumb">${url ? html`<img src=${url} alt="" width="96" height="58">` : icon(refusal ? 'error' : 'image')}</span>`;

function person(plan) {
  if (plan.is_phantom) return html`<div class="person"><span class="tag phantom">${say.phantom}</span></div>`;
  if (!plan.patient) return html`<div class="person unknown"><b>${say.unknown}</b><span>${say.notInFiles}</span></div>`;
  if (plan.stated) {
    return html`<div class="person"><b>${plan.patient}</b><span class="stated">${statedWords(plan.stated)}</span></div>`;
  }
  return html`<div class="person"><b>${plan.patient}</b>${plan.n_patients > 1 ? html`<span class="err">${say.nPatients({ n: plan.n_patients })}</span>` : html`<span>${say.bornHidden}</span>`}</div>`;
}

/** The date of the treatment plan, how many others there are, and the plan's name where its label is another. */
const about = (plan) =>
  [
    dicomDay(plan.date),
    plan.n_plans > 1 && say.withOthers({ n: plan.n_plans - 1 }),
    plan.label && plan.label !== plan.name && plan.name !== plan.id && plan.name,
  ]
    .filter(Boolean)
    .join(' · ');

const approvals = {
  APPROVED: () => html`<span class="ok">${icon('check')} ${say.approved}</span>`,
  UNAPPROVED: () => html`<span class="warn">${icon('warning')} ${say.unapproved}</span>`,
  REJECTED: () => html`<span class="err">${icon('error')} ${say.rejected}</span>`,
};

export const approval = (plan) =>
  html`<div class="approval">${approvals[plan.approval]?.() ?? html`<span class="dim">${say.notStated}</span>`}</div>`;

function stateWords(plan, job, refusal) {
  if (job || ['loading', 'starting', 'restarting'].includes(plan.state)) return html`<b>${say.loading}</b>`;
  if (refusal) return html`<span class="err">${icon('error')} ${say.refused}</span>`;
  if (isWaiting(plan)) return html`<span class="warn" title=${plan.reason}>${icon('stale')} ${say.waitingForPlace}</span>`;
  if (plan.state !== 'ready') return html`<span class="dim">${say.notLoaded}</span>`;
  const n = plan.n_warnings;
  const warnings = () => html`<span class="warn">${icon('warning')} ${say.nWarnings({ count: number(n), n })}</span>`;
  return html`<span class="ok">${icon('check')} ${say.ready}</span>${n ? warnings() : nothing}`;
}

const act = (run) => (event) => {
  event.stopPropagation();
  run();
};

function action(state, plan, job, isChosen) {
  if (job)
    return html`<button ?disabled=${!job.id} aria-label=${say.cancelLoading({ plan: plan.name })}
      @click=${act(() => state.cancel(plan.id))}>${icon('close')}<span>${say.cancel}</span></button>`;
  const remove = plan.uploaded
    ? html`<button class="icon-button" title=${say.deleteUploaded} aria-label=${say.deletePlan({ plan: plan.name })}
        @click=${act(() => state.askToRemove(plan.id))}>${icon('trash')}</button>`
    : nothing;
  if (plan.state === 'unreadable') return remove;
  const [last] = plan.rooms;
  const open = () => state.open(plan.id);
  const [word, ofPlan, run] = last
    ? [say.goOn, say.goOnPlan, () => state.goOn(last)]
    : plan.state === 'failed'
      ? [say.again, say.againPlan, open]
      : [say.open, say.openPlan, open];
  return html`${remove}<button class=${classMap({ primary: isChosen })} aria-label=${ofPlan({ plan: plan.name })} @click=${act(run)}>${word}</button>`;
}

/** The line about a room: when somebody was last in it, notes, who. */
export const roomFacts = (room, ownName) =>
  [when(room.used_ms), room.n_notes > 0 && say.nNotes({ n: room.n_notes }), whoWasIn(room, ownName.value.value)].filter(Boolean).join(', ');

function lastRoom(state, plan, ownName) {
  const [last] = plan.rooms;
  const n = plan.n_rooms - 1;
  const isUnfolded = state.unfolded.value === plan.id;
  const unfold = () => {
    state.unfolded.value = isUnfolded ? '' : plan.id;
  };
  return html`<p class="last-room"><span class="last-words">${icon('people', 14)}<span>${say.lastRoom({ room: html`<b>${roomName(last, titleOf(plan))}</b>`, facts: roomFacts(last, ownName) })}</span></span>
    <button class="as-text" aria-label=${say.newRoomOn({ plan: plan.name })} @click=${act(() => state.open(plan.id))}>${say.newRoom}</button>
    ${n > 0 ? html`<button class="as-text" aria-expanded=${isUnfolded} @click=${act(unfold)}>${say.olderRooms({ count: n >= 9 ? say.nineAndMore : number(n), n })}</button>` : nothing}</p>`;
}

const olderRoom = (
  state,
  plan,
  room,
  ownName,
) => html`<li><b>${roomName(room, titleOf(plan))}</b><span class="dim">${roomFacts(room, ownName)}</span>
  <button aria-label=${say.goInOf({ room: roomName(room, titleOf(plan)) })} @click=${act(() => state.goOn(room))}>${say.goIn}</button></li>`;

const progress = (
  job,
) => html`<div class="progress"><i class="bar" role="progressbar" aria-label=${say.loading} aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(job.percent ?? 0)}
  ${variables({ '--fill': `${job.percent ?? 0}%` })}></i><b>${number(job.percent ?? 0)} %</b><span class="phase">${icon('phase')} ${job.phase || say.waiting}</span></div>`;
