// The meetings of today on the start page: each with its agenda, which its people put in order, and the way into it.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { later } from '../../parts/lazy.js';
import { when } from '../../parts/when.js';
import { say } from './later_words.js';
import { patientOf, titleOf } from './plan_row.js';

/** The value of a field datetime-local, by the clock of this browser. */
const fieldTime = (ms) => (ms ? new Date(ms - new Date(ms).getTimezoneOffset() * 60000).toISOString().slice(0, 16) : '');

const closesByEscape = (meetings) => (event) => {
  if (event.key === 'Escape') meetings.form.value = null;
};

function meetingForm(meetings, { id = '', name = '', starts_ms = null } = {}) {
  const save = (event) => {
    event.preventDefault();
    const fields = new FormData(event.target);
    const starts = Date.parse(fields.get('starts'));
    if (fields.get('name').trim()) void meetings.save(id, { name: fields.get('name').trim(), starts_ms: starts || null });
  };
  return html`<form class="meeting-form" @submit=${save} @keydown=${closesByEscape(meetings)}>
    <label>${say.meetingName}<input name="name" required maxlength="80" autocomplete="off" .value=${name}></label>
    <label>${say.meetingStarts}<input name="starts" type="datetime-local" .value=${fieldTime(starts_ms)}></label>
    <div class="buttons"><button class="primary">${id ? say.save : say.makeMeeting}</button><button type="button" @click=${() => {
      meetings.form.value = null;
    }}>${say.cancel}</button></div><p class="note">${say.meetingNameIsSeen}</p></form>`;
}

/** A plan of all that this person may see, found by what is typed here. */
function caseForm(meetings, { id, cases }) {
  const taken = new Set(cases.map(({ plan }) => plan));
  const { list, total, hasFailed } = meetings.plans.value;
  const plans = (list ?? []).filter((plan) => !taken.has(plan.id) && plan.state !== 'unreadable');
  const add = (event) => {
    event.preventDefault();
    const plan = new FormData(event.target).get('plan');
    if (plan) void meetings.add(id, plan);
  };
  const n = plans.length;
  const found = n ? say.plansFound({ n: number(n), total: number(total - (list.length - n)) }) : hasFailed ? '' : say.noneFits;
  return html`<form class="case-form" @submit=${add} @keydown=${closesByEscape(meetings)}><label>${say.findCase}<input type="search" name="text" autocomplete="off" @input=${(event) => meetings.find(event.target.value, true)}></label>
    <label>${say.planOfCase}<select name="plan">${repeat(
      plans,
      ({ id: plan }) => plan,
      (plan) => html`<option value=${plan.id}>${[patientOf(plan), titleOf(plan), plan.id].filter(Boolean).join(' · ')}</option>`,
    )}</select></label>
    <button class="primary" ?disabled=${!plans.length}>${say.addIt}</button><p class="note" role="status">${list ? found : say.looking}</p></form>`;
}

function stateOf(one) {
  if (one.state === 'now')
    return html`<span class="now">${say.nowSince({ word: html`<b>${say.now}</b>`, time: when(one.since_ms) })}</span>`;
  if (one.state === 'decided') return html`<span class="ok">${icon('check', 12)} ${say.decidedAt({ time: when(one.decided_ms) })}</span>`;
  if (one.does_not_fit) return html`<span class="warn">${icon('warning', 12)} ${say.doseDoesNotFit}</span>`;
  return html`<span class="dim">${{ left: say.leftOpen, closed: say.closedToYou }[one.state] ?? say.open_}</span>`;
}

const approvals = { APPROVED: say.approved, UNAPPROVED: say.unapproved, REJECTED: say.rejected };

/** The room of a case: before it was entered to save views there, which the meeting then begins with; afterwards to look at it again. */
function roomAct(meetings, id, one, name) {
  if (one.state === 'closed' || !one.plan) return nothing;
  if (one.state === 'open')
    return html`<button class="ghost small" aria-label=${say.prepareCase({ name })} title=${say.prepareIs} @click=${() => void meetings.prepare(id, one.id)}>${say.prepare}</button>`;
  return one.room
    ? html`<a class="button ghost small" href=${`/rooms/${one.room}`} aria-label=${say.openCase({ name })}>${say.open}</a>`
    : nothing;
}

/** A case of the agenda; who may edit drags it, moves it by its buttons, or takes it off. */
function caseRow(meetings, meeting, one, index) {
  const { id, cases, may } = meeting;
  const canMove = may.edit && cases.length > 1;
  const entered = ['now', 'decided', 'left'].includes(one.state);
  const drop = (event) => {
    event.preventDefault();
    const moved = meetings.dragged.value;
    meetings.dragged.value = '';
    const from = cases.findIndex((other) => other.id === moved);
    if (from >= 0 && from !== index) void meetings.move(id, moved, from > index ? one.id : (cases[index + 1]?.id ?? null));
  };
  const title = one.label || one.plan;
  const facts = [title, approvals[one.approval]].filter(Boolean).join(' · ');
  const name = one.patient || title || say.caseN({ n: index + 1 });
  return html`<li class="case" data-case=${one.id} data-state=${one.state} draggable=${canMove ? 'true' : 'false'} @dragstart=${(event) => {
    meetings.dragged.value = one.id;
    event.dataTransfer.effectAllowed = 'move';
  }} @dragend=${() => {
    meetings.dragged.value = '';
  }} @dragover=${(event) => meetings.dragged.value && event.preventDefault()} @drop=${drop}>
    <span class="n">${index + 1}</span><b class="whom">${one.state === 'closed' ? say.caseN({ n: index + 1 }) : one.patient || say.unknown}</b><span class="dim about">${facts}</span><span class="case-state">${stateOf(one)}</span>
    ${
      may.edit
        ? html`<span class="case-acts">${roomAct(meetings, id, one, name)}<button class="icon-button small" ?disabled=${!canMove || index === 0} aria-label=${say.moveUp({ name })} title=${say.moveUp({ name })} @click=${() => meetings.step(meeting, index, -1)}>${arrow(true)}</button>
      <button class="icon-button small" ?disabled=${!canMove || index === cases.length - 1} aria-label=${say.moveDown({ name })} title=${say.moveDown({ name })} @click=${() => meetings.step(meeting, index, 1)}>${arrow(false)}</button>
      <button class="icon-button small" ?disabled=${entered} aria-label=${say.takeOff({ name })} title=${say.takeOff({ name })} @click=${() => meetings.remove(id, one.id)}>${icon('close', 12)}</button></span>`
        : nothing
    }</li>`;
}

const arrow = (isUp) => html`<span class=${isUp ? 'turned' : ''}>${icon('chevronDown', 12)}</span>`;

const states = { running: say.runs, over: say.isOver };

/** The buttons of a meeting that is not over, for whoever may edit it. */
function acts({ state, may }, form, open) {
  if (!may.edit || state === 'over') return nothing;
  return html`<div class="meeting-acts"><button aria-expanded=${form === 'case'} @click=${open('case')}>${icon('plus', 12)}<span>${say.addCase}</span></button>
    <button class="ghost" aria-expanded=${form === 'links'} @click=${open('links')}>${say.invite}</button>
    <button class="ghost" aria-expanded=${form === 'meeting'} @click=${open('meeting')}>${say.nameAndTime}</button><span class="note">${say.nextTakesAlong}</span></div>`;
}

/** The way to the minutes of a meeting that has begun. */
const minutesLink = ({ id, name, state }) =>
  state === 'planned'
    ? nothing
    : html`<a class="button ghost" href=${`/meetings/${id}/minutes`} aria-label=${say.minutesOf({ name })}>${say.minutes}</a>`;

/** Meetings of other days: their minutes, and the agendas of those that are still to come. */
function otherMeetings(meetings) {
  const others = meetings.others.value;
  if (!others.length) return nothing;
  const facts = ({ starts_ms, ended_ms, n_cases, state }) =>
    [ended_ms ? when(ended_ms) : starts_ms && when(starts_ms), say.nCases({ n: n_cases }), states[state]].filter(Boolean).join(' · ');
  const row = (meeting) => {
    const { id, name } = meeting;
    const isOpen = meetings.opened.value.includes(id);
    const word = (isOpen ? say.foldMeeting : say.showMeeting)({ name });
    return html`<li data-meeting-row=${id}><b>${name}</b><span class="dim">${facts(meeting)}</span>
      <button class="ghost" aria-expanded=${isOpen} aria-label=${word} @click=${() => meetings.fold(id)}>${isOpen ? say.fold : say.agenda}</button>${minutesLink(meeting)}</li>`;
  };
  return html`<details class="other-meetings"><summary>${say.otherMeetings} <span class="dim">${number(others.length)}</span></summary><ul>${repeat(
    others,
    ({ id }) => id,
    row,
  )}</ul></details>`;
}

/** Before the form is drawn: it would show the links of another meeting. */
async function openLinks(meetings, id) {
  const form = { meeting: id, kind: 'links' };
  const begin = () => invite.loaded.peek()?.beginInvite((method, path, body) => meetings.call(id, method, path, body));
  const isThere = Boolean(invite.loaded.peek());
  begin();
  meetings.form.value = form;
  if (isThere) return;
  await invite.load();
  if (meetings.form.peek() === form) begin();
}

const invite = later(() => import('../meeting/invite.js'), 'js/features/meeting/invite.css');

/** Links of this meeting, as its card in a room has them. */
function linksForm(meetings, { id }, hasGuests) {
  const call = (method, path, body) => meetings.call(id, method, path, body);
  return html`<section class="case-form case-invite" aria-label=${say.invite} @keydown=${closesByEscape(meetings)}>${invite.draw(({ inviteForm }) => inviteForm(call, hasGuests))}</section>`;
}

function meetingCard(meetings, meeting, { hasGuests }) {
  const { id, name, cases, may, n_in, starts_ms } = meeting;
  const form = meetings.form.value?.meeting === id ? meetings.form.value.kind : '';
  const open = (kind) => () => {
    if (form !== kind && kind === 'links') return void openLinks(meetings, id);
    meetings.form.value = form === kind ? null : { meeting: id, kind };
    if (form !== kind && kind === 'case') meetings.find('');
  };
  const about = [starts_ms && when(starts_ms), states[meeting.state], n_in > 0 && say.nIn({ n: n_in })].filter(Boolean).join(' · ');
  const canGoIn = meeting.state !== 'over' && cases.length > 0 && (meeting.state === 'running' || may.advance);
  return html`<section class="meeting" data-meeting=${id} aria-labelledby=${`meeting-${id}`}><div class="list-head"><h2 id=${`meeting-${id}`}>${name}</h2><span class="dim">${about}</span><span class="grow"></span>
      ${minutesLink(meeting)}
      ${canGoIn ? html`<button class="primary" @click=${() => meetings.goIn(id)}>${meeting.state === 'running' ? say.goIn : say.begin}</button>` : nothing}</div>
    ${cases.length ? html`<ol class="agenda">${cases.map((one, index) => caseRow(meetings, meeting, one, index))}</ol>` : html`<p class="empty">${say.noCases}</p>`}
    ${acts(meeting, form, open)}
    ${form === 'case' ? caseForm(meetings, meeting) : form === 'meeting' ? meetingForm(meetings, meeting) : form === 'links' ? linksForm(meetings, meeting, hasGuests) : nothing}</section>`;
}

/** @param {import('./meetings.js').MeetingsState} meetings @param {{hasGuests: boolean}} server hasGuests: it lets in who has not signed in */
export function meetingsToday(meetings, server) {
  const shown = meetings.shown.value.map(({ id }) => meetings.agendas.value[id]).filter(Boolean);
  const isNew = meetings.form.value?.meeting === '';
  return html`<div class="meetings">${repeat(
    shown,
    ({ id }) => id,
    (meeting) => meetingCard(meetings, meeting, server),
  )}
    ${meetings.error.value ? html`<p class="err" role="alert">${icon('error')} ${meetings.error.value}</p>` : nothing}<p class="as-status" role="status">${meetings.said.value}</p>
    ${
      isNew
        ? meetingForm(meetings)
        : html`<button class="ghost new-meeting" @click=${() => {
            meetings.form.value = { meeting: '', kind: 'meeting' };
          }}>${icon('plus', 12)}<span>${say.newMeeting}</span></button>`
    }${otherMeetings(meetings)}</div>`;
}
