// Links of a meeting, in its card and on the start page: one that leads to whatever case is now is made, those that let people in are listed and ended.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { signal } from '../../../lib/signals-core.js';
import { say } from './later_words.js';

const roles = ['observer', 'reviewer', 'presenter', 'wall'];
const day = 86400;
const year = 365 * day; // of a wall

const words = { observer: say.isObserver, reviewer: say.isReviewer, presenter: say.isPresenter, planner: say.isPlanner, wall: say.wall };
const links = signal([]);
const made = signal(''); // the address of the newest link, which is told once
const trouble = signal('');
let nLooks = 0; // an older answer is not shown
let nOpened = 0; // nor is the answer to what was asked of another meeting

/** @param {(method: string, path: string, body?: object) => Promise<object>} call of the meeting */
async function look(call) {
  const n = ++nLooks;
  const answer = await call('GET', '/links').catch((error) => {
    if (n === nLooks) trouble.value = error.message;
  });
  if (answer && n === nLooks) links.value = answer.links;
}

async function act(call, method, path, body) {
  const mine = nOpened;
  trouble.value = '';
  const [answer, error] = await call(method, path, body).then(
    (given) => [given, null],
    (reason) => [null, reason],
  );
  if (mine !== nOpened) return;
  made.value = answer?.url ? `${location.origin}${answer.url}` : '';
  trouble.value = error?.message ?? '';
  await look(call);
}

function make(event, call) {
  event.preventDefault();
  const data = new FormData(event.target);
  const role = data.get('role');
  void act(call, 'POST', '/links', { role, expires_s: role === 'wall' ? year : day, guests: data.has('guests') });
}

const row = (
  { id, role, guests, came },
  call,
) => html`<li data-link=${id}><span>${guests ? say.asGuest({ role: words[role] }) : words[role]}</span>
  <span class="dim">${came ? say.cameBy({ n: came }) : ''}</span><button aria-label=${say.endLinkOf({ role: words[role] })} title=${say.endLinkIs} @click=${() => void act(call, 'DELETE', `/links/${id}`)}>${say.endLink}</button></li>`;

/** Begins with the links of this meeting. @param {(method: string, path: string, body?: object) => Promise<object>} call of the meeting */
export function beginInvite(call) {
  nOpened += 1;
  links.value = [];
  made.value = trouble.value = '';
  void look(call);
}

/** @param {boolean} hasGuests the server lets in who has not signed in */
export const inviteForm = (call, hasGuests) => html`<p class="note">${say.inviteIs}</p>
    <form @submit=${(event) => make(event, call)}><label>${say.linkAs} <select name="role">${roles.map((role) => html`<option value=${role} ?selected=${role === 'reviewer'}>${words[role]}</option>`)}</select></label>
      ${hasGuests ? html`<label class="check"><input type="checkbox" name="guests"> ${say.alsoGuests}</label>` : nothing}<button>${say.makeLink}</button></form>
    ${made.value ? html`<input readonly aria-label=${say.madeLink} .value=${made.value} @focus=${(event) => event.target.select()}>` : nothing}
    ${trouble.value ? html`<p class="error" role="alert">${trouble.value}</p>` : nothing}
    <ul class="case-links">${repeat(
      links.value,
      ({ id }) => id,
      (link) => row(link, call),
    )}</ul>`;

/** @param {object} meeting of later.js @param {boolean} hasGuests the server lets in who has not signed in */
export function inviteBlock({ call, isInviting }, hasGuests) {
  const open = (event) => {
    isInviting.value = event.target.open;
    made.value = '';
    if (event.target.open) beginInvite(call);
  };
  return html`<details class="case-invite" ?open=${isInviting.value} @toggle=${open}><summary>${say.invite}</summary>${inviteForm(call, hasGuests)}</details>`;
}
