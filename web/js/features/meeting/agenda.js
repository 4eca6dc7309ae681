// The agenda of the meeting in the chip's card: cases with their states, going on, the end, the minutes.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { signal } from '../../../lib/signals-core.js';
import { keyMark } from '../../parts/fields.js';
import { inviteBlock } from './invite.js';
import { say } from './later_words.js';

const isSure = signal(false); // "End the meeting" was pressed once

const clockTime = (ms) => new Date(ms).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });

function stateOf({ state, decided_ms }) {
  if (state === 'decided') return say.decided({ time: clockTime(decided_ms) });
  return { open: say.open, now: say.now, left: say.left, closed: say.closed }[state];
}

function row(one, index, { told, mayAdvance, next }) {
  const mayGo = mayAdvance() && !told.value.over && one.state !== 'closed' && one.state !== 'now';
  const n = index + 1;
  const words = html`<span class="case-n">${n}</span><span class="case-words"><b>${one.patient ?? (one.state === 'closed' ? '' : say.noIdentity)}</b> <span class="dim">${one.label ?? ''}</span></span>
    <span class="case-state" data-state=${one.state}>${stateOf(one)}</span><span class="dim case-time">${one.spent_ms >= 30000 ? say.spent({ min: Math.max(1, Math.round(one.spent_ms / 60000)) }) : ''}</span>`;
  return html`<li data-case=${one.id}>${mayGo ? html`<button class="case-row" title=${say.goTo({ n })} @click=${() => next(one.id)}>${words}</button>` : html`<span class="case-row">${words}</span>`}</li>`;
}

/** Where the meeting is, and the way there or on. */
function standing({ meeting, ui }, told) {
  const { along, mayAdvance, next } = meeting.peek();
  if (told.over) return html`<p class="dim">${say.meetingOver}</p>`;
  if (!told.n_now) return html`<p class="dim">${say.notBegun}</p>`;
  if (told.now !== told.here)
    return html`<p class="case-standing"><span>${say.meetingAt({ n: told.n_now })}</span>${told.open ? html`<button @click=${along}>${say.goAlong}</button>` : nothing}</p>`;
  if (!mayAdvance() || told.n_now === told.of) return nothing;
  return html`<p class="case-standing"><button title=${say.nextIs} @click=${() => next()}>${say.next}${keyMark(ui.keys.text('nextCase'))}</button></p>`;
}

export function agenda(world) {
  const meeting = world.meeting.value;
  const told = meeting.told.value;
  const list = meeting.list.value;
  const mayEnd = list?.may.edit && list.state === 'running';
  return html`<h2>${told.name}</h2>
    ${standing(world, told)}
    <ol class="cases">${repeat(
      list?.cases ?? [],
      ({ id }) => id,
      (one, index) => row(one, index, meeting),
    )}</ol>
    ${list?.may.edit ? inviteBlock(meeting, Boolean(world.session?.value?.facts.value.guest_links)) : nothing}
    <div class="room-actions">${meeting.isGuest() ? nothing : html`<a class="button" href=${`/meetings/${told.meeting}/minutes`} target="_blank" title=${say.minutesIs}>${say.minutes}</a>`}
    ${
      mayEnd
        ? html`<button title=${say.endIs} @click=${() => {
            if (isSure.value) meeting.end();
            isSure.value = !isSure.value;
          }}>${isSure.value ? say.endSure : say.end}</button>`
        : nothing
    }</div>`;
}
