// Invites others by a link that gives a role. Loaded when it is first opened.
import { html, nothing } from '../../lib/lit-html.js';
import { signal } from '../../lib/signals-core.js';
import { roomPath } from '../net/address.js';
import { say } from './later_words.js';
import { say as sayAtOnce } from './words.js';

const kinds = [
  ['reviewer', say.reviewer],
  ['observer', say.observer],
  ['presenter', say.presenter],
];
const times = [
  [3600, say.forHour],
  [86400, say.forDay],
  [604800, say.forWeek],
];
const made = signal({ url: '', words: '', error: '', isBusy: false });

/** The page's address of this room with the link in it. */
const addressOf = (room, token) => new URL(roomPath(room.id, token), location.href).href;

/** The address of this room for a screen that everybody looks at: short, as somebody types it there. */
const displayOf = (room) => new URL(`/display/${room.id}`, location.href).href;

async function copy(text) {
  const field = document.querySelector('#invite-made');
  field?.select();
  try {
    await navigator.clipboard.writeText(text); // a page not served securely has no clipboard
    made.value = { ...made.peek(), words: say.copied };
  } catch {
    made.value = { ...made.peek(), words: sayAtOnce.pressCopy };
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
  const display = displayOf(world.room);
  const address = html`<a href=${display} target="_blank" rel="noopener">${display.replace(/^https?:\/\//, '')}</a>`;
  return html`<form class="invite-form" @submit=${(event) => make(event, world)}>
    <label for="invite-role">${say.linkWithRole}</label><select id="invite-role" name="role">${kinds.map(([value, text]) => html`<option value=${value}>${text}</option>`)}</select>
    <div class="pair"><label for="invite-expires">${say.lasts}</label><select id="invite-expires" name="expires">${times.map(([value, text]) => html`<option value=${value} ?selected=${value === 86400}>${text}</option>`)}</select></div>
    <label class="invite-one"><input type="checkbox" name="one"> ${say.forOne}</label>
    <button class="primary" ?disabled=${isBusy}>${say.makeLink}</button>
    ${url ? html`<div class="pair"><input id="invite-made" readonly aria-label=${say.linkWithRole} .value=${url}><button type="button" @click=${() => copy(url)}>${sayAtOnce.copy}</button></div>` : nothing}
    <p class="dim">${say.onScreen({ address })}</p>
    <p role="status" class="dim">${words}</p>${error ? html`<p role="alert" class="err">${error}</p>` : nothing}</form>`;
}
