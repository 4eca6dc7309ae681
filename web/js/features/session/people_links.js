// Links to a room in the people panel: making one, the list of those that let people in, ending one.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { dayTime } from '../../parts/format.js';
import { errorOf, roleOptions } from './people_parts.js';
import { say } from './people_words.js';

const day = 86400;
const times = [
  [3600, say.hour],
  [day, say.day],
  [7 * day, say.week],
  [30 * day, say.month],
];
const year = 365 * day; // of a wall alone

/** The link that a form asks for. A display that comes back after a loss of the connection comes by its link again: that is never for one use. @param {FormData} data */
export function linkOf(data) {
  const [role, name] = [data.get('role'), data.get('name').trim()];
  const isOne = role !== 'wall' && data.has('one');
  return { role, expires_s: Number(data.get('expires')), one_use: isOne, guests: data.has('guests'), ...(name && { name }) };
}

function makePart(state, room, hasGuests) {
  const { url, isCopied } = state.made.value;
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    if (await state.makeLink(linkOf(new FormData(form)))) form.reset();
  };
  return html`<section><h3>${say.makeLink} <span class="dim">${say.forThisRoom}</span></h3><form class="people-link" @submit=${submit}>
    <label>${say.linkName}<input name="name" type="text" maxlength="40" autocomplete="off"></label>
    <label>${say.linkAs}<select name="role" title=${say.onlyUpTo}>${roleOptions(room)}<option value="wall">${say.wall}</option></select></label>
    <label>${say.linkUntil}<select name="expires">${times.map(([value, words]) => html`<option value=${value} ?selected=${value === day}>${words}</option>`)}<option value=${year}>${say.year} (${say.wall})</option></select></label>
    <div class="people-checks">${hasGuests ? html`<label class="check"><input type="checkbox" name="guests"> ${say.alsoGuests}</label>` : nothing}
      <label class="check"><input type="checkbox" name="one"> ${say.oneUse}</label></div>
    <button>${say.makeAndCopy}</button></form>
    ${url ? html`<p class="people-made"><input readonly aria-label=${say.madeLink} .value=${url} @focus=${(event) => event.target.select()}><span class="note" role="status">${isCopied ? say.copied : say.copyIt}</span></p>` : nothing}
    ${errorOf(state, 'link')}</section>`;
}

function linkRow(link, state) {
  const name = link.name || say.unnamed;
  const key = `end:${link.id}`;
  const role = say[link.role] ?? link.role;
  const ask = () => {
    if (link.came) state.asking.value = key;
    else void state.end(link);
  };
  const stateWords = [
    link.came ? say.usedBy({ n: link.came }) : link.one_use ? say.forOne : '',
    say.until({ time: dayTime(Date.now() + link.expires_s * 1000) }),
  ].filter(Boolean);
  return html`<tr data-link=${link.id}><th scope="row"><b>${name}</b><span class="dim">${link.by}</span></th><td>${link.guests ? say.asGuest({ role }) : role}</td><td>${stateWords.join(', ')}</td>
    <td>${
      state.asking.value === key
        ? html`<span class="people-asks">${say.endAsks({ n: link.came })}</span><button class="bad" @click=${() => void state.end(link)}>${say.endNow}</button>`
        : html`<button aria-label=${say.endOf({ name })} @click=${ask}>${say.end}</button>`
    }</td></tr>`;
}

/** @param {import('./people_state.js').PeopleState} state */
export function linksPart(state, room, hasGuests) {
  const links = state.links.value;
  return html`${makePart(state, room, hasGuests)}<section><h3>${say.links} <span class="dim">${links.length}</span></h3>
    ${
      links.length
        ? html`<table class="people-links"><thead><tr><th scope="col">${say.linkHead}</th><th scope="col">${say.asHead}</th><th scope="col">${say.stateHead}</th><td></td></tr></thead>
      <tbody>${repeat(
        links,
        ({ id }) => id,
        (link) => linkRow(link, state),
      )}</tbody></table><p class="note">${say.endNote}</p>`
        : html`<p class="note">${say.noLinks}</p>`
    }${errorOf(state, 'links')}</section>`;
}
