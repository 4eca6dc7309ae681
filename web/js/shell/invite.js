// Invites others by a link that gives a role. Loaded when it is first opened.
import { html, nothing } from '../../lib/lit-html.js';
import { signal } from '../../lib/signals-core.js';

const kinds = [
  ['reviewer', 'Reviewer: points, writes notes, requests control'],
  ['observer', 'Observer: looks and follows'],
  ['presenter', 'Presenter: takes control, invites'],
];
const times = [
  [3600, 'for an hour'],
  [86400, 'for a day'],
  [604800, 'for a week'],
];
const made = signal({ url: '', words: '', error: '', isBusy: false });

/** The page's address of this room with the link in it. */
const addressOf = (room, token) => Object.assign(new URL(location.href), { search: '', hash: `#/rooms/${room.id}?link=${token}` }).href;

/** The address of this room for a screen that everybody looks at: short, as somebody types it there. */
const displayOf = (room) => new URL(`display/${room.id}`, Object.assign(new URL(location.href), { search: '', hash: '' })).href;

async function copy(text) {
  const field = document.querySelector('#invite-made');
  field?.select();
  try {
    await navigator.clipboard.writeText(text); // a page not served securely has no clipboard
    made.value = { ...made.peek(), words: 'Copied.' };
  } catch {
    made.value = { ...made.peek(), words: 'Press Ctrl+C to copy the selected link.' };
  }
}

async function make(event, { room, api }) {
  event.preventDefault();
  const data = new FormData(event.target);
  made.value = { url: '', words: '', error: '', isBusy: true };
  try {
    const { token } = await api.makeLink(room.id, room.identity, {
      role: data.get('role'),
      expires_s: Number(data.get('expires')),
      one_use: data.has('one'),
    });
    made.value = { url: addressOf(room, token), words: '', error: '', isBusy: false };
    queueMicrotask(() => void copy(made.peek().url)); // after it is drawn
  } catch (error) {
    made.value = { url: '', words: '', error: error.message, isBusy: false };
  }
}

/** @param {object} world {room, api} */
export function inviteForm(world) {
  const { url, words, error, isBusy } = made.value;
  return html`<form class="invite-form" @submit=${(event) => make(event, world)}>
    <label for="invite-role">Link with a role</label><select id="invite-role" name="role">${kinds.map(([value, text]) => html`<option value=${value}>${text}</option>`)}</select>
    <div class="pair"><label for="invite-expires">Lets people in</label><select id="invite-expires" name="expires">${times.map(([value, text]) => html`<option value=${value} ?selected=${value === 86400}>${text}</option>`)}</select></div>
    <label class="invite-one"><input type="checkbox" name="one"> For one person only</label>
    <button class="primary" ?disabled=${isBusy}>Make link</button>
    ${url ? html`<div class="pair"><input id="invite-made" readonly aria-label="Link with a role" .value=${url}><button type="button" @click=${() => copy(url)}>Copy</button></div>` : nothing}
    <p class="dim">On the screen of a meeting room open <a href=${displayOf(world.room)} target="_blank" rel="noopener">${displayOf(world.room).replace(/^https?:\/\//, '')}</a>: the presenter's 3-D view, for whoever knows this address.</p>
    <p role="status" class="dim">${words}</p>${error ? html`<p role="alert" class="err">${error}</p>` : nothing}</form>`;
}
