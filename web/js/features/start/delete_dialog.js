// The question before an uploaded plan is deleted, with the people who are looking at it: the only modal dialog.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect } from '../../../lib/signals-core.js';
import { present } from '../../room/plans.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';
import { whoIn } from './who_in.js';

/** Always in the page, empty and closed until a deletion is asked for: so the browser gives the focus back afterwards. */
export function deleteDialog(state, ownName) {
  const asked = state.deleting.value;
  const cancel = (event) => {
    event.preventDefault();
    state.deleting.value = null;
  };
  const remove = () => state.remove(asked.plan.id, { keepsRecords: Boolean(asked.records), by: ownName.value.value });
  return html`<dialog class="card modal" role="alertdialog" aria-labelledby="delete-head" aria-describedby="delete-text" @cancel=${cancel}>${
    asked
      ? html`
    <h2 id="delete-head">${say.deleteAsk({ plan: asked.plan.name })}</h2>
    <div id="delete-text">${asked.records ? recorded(asked) : looking(asked.rooms)}<p>${say.deleteIs({ plan: html`<code>${asked.plan.id}</code>` })}</p></div>
    <div class="buttons"><button autofocus @click=${() => {
      state.deleting.value = null;
    }}>${say.keep}</button><span class="grow"></span>
      <button class="danger" ?disabled=${!asked.rooms} @click=${remove}>${asked.records ? say.deleteKeep : say.deleteForGood}</button></div>`
      : nothing
  }</dialog>`;
}

const recorded = ({ records }) => html`<p class="warn">${icon('warning')}<b>${records.split(';')[0]}.</b> ${say.recordsStay}</p>`;

function looking(rooms) {
  if (!rooms) return html`<p class="dim">${say.lookingWho}</p>`;
  const taken = rooms.filter((room) => present(room).length);
  const n = taken.reduce((sum, room) => sum + present(room).length, 0);
  if (!n)
    return rooms.length
      ? html`<p>${say.emptyRooms({ count: number(rooms.length), n: rooms.length })}</p>`
      : html`<p>${say.nobodyLooks}</p>`;
  return html`<p class="warn">${icon('warning')}<b>${say.peopleLook({ n })} ${say.roomsEnd({ n: taken.length })}</b></p>
    <ul>${taken.map((room) => html`<li><code>${room.id}</code> ${whoIn(room)}</li>`)}</ul>`;
}

/** Opens and closes the dialog with the state. @returns {() => void} stops */
export const watchDialog = (host, state) =>
  effect(() => {
    const isAsked = state.deleting.value !== null;
    queueMicrotask(() => {
      // after it is drawn
      const dialog = host.querySelector('dialog.modal');
      if (!dialog || dialog.open === isAsked) return;
      if (isAsked) dialog.showModal();
      else dialog.close();
    });
  });
