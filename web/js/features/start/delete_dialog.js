// The question before an uploaded plan is deleted, with the people who are looking at it: the only modal dialog.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect } from '../../../lib/signals-core.js';
import { present } from '../../room/plans.js';
import { count } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { whoIn } from './lobby.js';

/** Always in the page, empty and closed until a deletion is asked for: so the browser gives the focus back afterwards. */
export function deleteDialog(state, ownName) {
  const asked = state.deleting.value;
  const cancel = (event) => {
    event.preventDefault();
    state.deleting.value = null;
  };
  return html`<dialog class="card modal" role="alertdialog" aria-labelledby="delete-head" aria-describedby="delete-text" @cancel=${cancel}>${
    asked
      ? html`
    <h2 id="delete-head">Delete ${asked.plan.name}?</h2><div id="delete-text">${asked.records ? html`<p class="warn">${icon('warning')}<b>${asked.records.split(';')[0]}.</b> Their records stay on the server.</p>` : looking(asked.rooms)}<p>The plan <code>${asked.plan.id}</code> and all its files are deleted from this server for good.</p></div>
    <div class="buttons"><button autofocus @click=${() => {
      state.deleting.value = null;
    }}>Keep</button><span class="grow"></span><button class="danger" ?disabled=${!asked.rooms} @click=${() => state.remove(asked.plan.id, { keepsRecords: Boolean(asked.records), by: ownName.value.value })}>${asked.records ? 'Delete, keep the records' : 'Delete for good'}</button></div>`
      : nothing
  }</dialog>`;
}

function looking(rooms) {
  if (!rooms) return html`<p class="dim">Looking who is in its rooms</p>`;
  const taken = rooms.filter((room) => present(room).length);
  const n = taken.reduce((sum, room) => sum + present(room).length, 0);
  if (!n)
    return rooms.length
      ? html`<p>${count(rooms.length, 'room')} on it, with nobody in ${rooms.length === 1 ? 'it' : 'them'}.</p>`
      : html`<p>Nobody is looking at it.</p>`;
  return html`<p class="warn">${icon('warning')}<b>${n === 1 ? '1 person is' : `${n} people are`} looking at it. Their ${taken.length === 1 ? 'room ends' : 'rooms end'}.</b></p>
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
