// The notice that a room has ended or does not exist, with ways on: a room on the same plan, the list of plans. Loaded when somebody begins to use the page.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { icon } from '../parts/icons.js';
import { whoIn } from '../features/start/who_in.js';
import { say } from './later_words.js';
import { say as sayAtOnce } from './words.js';

const closed = 'the room is closed'; // the server says it of a room that is not there, too
const sentence = (text) => (text ? `${text[0].toUpperCase()}${text.slice(1)}.` : say.noReason);

/** The notes are in this page alone by now, when the room was deleted. */
async function saveNotes(world) {
  const { room } = world;
  const [{ notesText }, { exportFile }] = await Promise.all([import('../features/notes/notes_file.js'), import('../room/exports.js')]);
  const text = notesText({ id: room.id, planId: room.planId.peek(), plan: room.plan.peek(), rows: room.items.notes.peek() });
  await exportFile(world, 'notes', `${room.planId.peek()}-notes.txt`, text, 'text/plain');
}

/** After a room that this tab was in, the last pictures stay visible. */
export function endedCard(world) {
  const { room, after } = world;
  const wasIn = room.member.value !== '';
  const plan = after.plan.value;
  const rooms = after.rooms.value.slice(0, 3);
  return html`<section class=${classMap({ card: true, ended: true, unknown: !wasIn })} role="alert">${icon('disconnected')}
    <div>${wasIn ? html`<b>${say.youLeft}</b>` : html`<h1>${room.link.value.isRefused ? say.refused : say.noRoom}</h1>`}<p>${sentence(room.link.value.reason)}</p>
      ${!wasIn && world.session.value && room.link.value.reason === closed ? html`<p>${say.orNotAsked}</p>` : nothing}
      ${after.isPlanGone.value ? html`<p>${say.planGone}</p>` : nothing}
      ${after.error.value ? html`<p class="err">${icon('error')} ${after.error.value}</p>` : nothing}
      ${wasIn && room.lostAtEnd.value ? html`<p class="err">${icon('error')} ${say.changesLost}</p>` : nothing}
      <div class="buttons">${wasIn && room.items.notes.value.length ? html`<button @click=${() => void saveNotes(world)}>${say.saveNotes}</button>` : nothing}${rooms.map((other) => html`<button @click=${() => after.join(other)}>${say.join({ room: other.id, who: whoIn(other) })}</button>`)}
        ${plan ? html`<button class="primary" ?disabled=${after.isBusy.value} @click=${() => after.reopen()}>${say.openNew({ plan: plan.name })}</button>` : nothing}
        <a class="button" href="/">${sayAtOnce.allPlans}</a></div></div></section>`;
}
