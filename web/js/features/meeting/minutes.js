// The minutes of a meeting as sheets of paper, with the style of the report to print: each case with what was decided and how long it took, then who was there
// for which case. Masked, as the server gives it.
import { html, nothing } from '../../../lib/lit-html.js';
import { icon } from '../../parts/icons.js';
import { approvalOf } from '../../room/identity.js';
import { say } from './later_words.js';

const two = (n) => String(n).padStart(2, '0');
const day = (ms) => {
  const at = new Date(ms);
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
};
const time = (ms) => `${two(new Date(ms).getHours())}:${two(new Date(ms).getMinutes())}`;
/** "UTC+1" of this moment here. */
function zone(ms) {
  const min = -new Date(ms).getTimezoneOffset();
  const rest = Math.abs(min) % 60;
  return `UTC${min < 0 ? '−' : '+'}${Math.floor(Math.abs(min) / 60)}${rest ? `:${two(rest)}` : ''}`;
}
const span = ({ from_ms, to_ms }) => `${time(from_ms)}–${to_ms ? time(to_ms) : '…'}`;
const minutesOf = (ms) => (ms < 60000 ? say.lessThanMinute : say.spent({ min: Math.round(ms / 60000) }));

const roles = { observer: say.isObserver, reviewer: say.isReviewer, presenter: say.isPresenter, planner: say.isPlanner };
const decisions = { accept: say.accept, 'accept-with-changes': say.acceptWithChanges, reject: say.reject, defer: say.defer };

function decided({ decision, decided_ms, decided_by, began_ms }) {
  if (decision)
    return html`<b>${decisions[decision] ?? decision}</b><br>${say.decidedBy({ name: decided_by ?? '', time: time(decided_ms) })}`;
  return began_ms ? say.leftOpen : say.notReached;
}

const caseRow = (one) => html`<tr><td>${one.n}</td><td>${
  one.is_open
    ? html`<b>${one.patient ?? say.noIdentity}</b><br>${one.label ?? ''}${one.label ? html` · ${approvalOf(one)[0]}` : nothing}`
    : html`<i>${say.closed}</i>`
}</td><td>${one.visits.map(span).join(', ') || '–'}</td><td>${one.began_ms ? minutesOf(one.spent_ms) : '–'}</td><td>${one.is_open ? decided(one) : '–'}</td>
  <td class="no-print">${one.room ? html`<a href=${`/rooms/${one.room}`}>${one.room_name || say.toRoom}</a>` : nothing}</td></tr>`;

const personRow = ({ name, user, role, is_guest, cases }) =>
  html`<tr><td><b>${name}</b>${user && user !== name ? html` <span class="dim">${user}</span>` : nothing}${
    is_guest ? html` (${say.guest})` : nothing
  }</td><td>${roles[role] ?? role}</td><td>${cases.map(({ n, stays }) => html`<span class="case-stay">${say.inCase({ n, times: stays.map(span).join(', ') })}</span>`)}</td></tr>`;

/** @param {object} minutes as GET /meetings/{meeting}/minutes gives them */
export function minutesSheet(minutes) {
  const { name, began_ms, ended_ms, made_ms, cases, people } = minutes;
  const when = began_ms
    ? say.minutesWhen({ day: day(began_ms), from: time(began_ms), to: ended_ms ? time(ended_ms) : say.stillRuns, zone: zone(began_ms) })
    : say.notBegun;
  return html`<main class="printout minutes-print" aria-label=${say.minutes}>
    <div class="printout-bar"><b>${say.minutes}</b><span class="grow"></span><a class="button" href="/">${say.toPlans}</a>
      <button class="primary" @click=${() => print()}>${icon('print')}<span>${say.print}</span></button></div>
    <article class="sheet"><div class="sheet-body"><header><h1>${say.minutesOf({ name })}</h1><p>${when}</p></header>
      <h2>${say.cases}</h2><table><thead><tr><th>${say.nr}</th><th>${say.patientAndPlan}</th><th>${say.when}</th><th>${say.took}</th><th>${say.decision}</th><th class="no-print">${say.room}</th></tr></thead>
        <tbody>${cases.map(caseRow)}</tbody></table>
      <h2>${say.present}</h2>${people.length ? html`<table><thead><tr><th>${say.who}</th><th>${say.role}</th><th>${say.cases}</th></tr></thead><tbody>${people.map(personRow)}</tbody></table>` : html`<p>${say.nobody}</p>`}
      <p class="note">${say.masked}</p></div>
    <footer class="sheet-foot"><div>${say.minutesFoot({ meeting: minutes.meeting, day: day(made_ms), time: time(made_ms), zone: zone(made_ms) })}<br><b>${say.research}</b></div></footer></article></main>`;
}
