// The person who is signed in, in the banner: signing out, and before the end of the sign-in the way to stay.
import { html, nothing } from '../../../lib/lit-html.js';
import { initials } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';
import { say as sayPeople } from './people_words.js';

export const timeWords = (ms) => new Date(ms).toLocaleTimeString([], { hour: '2-digit', minute: '2-digit' });
export const sourceWords = ({ source }) => (source === 'proxy' ? say.ofHospital : say.account);

/** The last minutes: input keeps a sign-in that ends for want of it; at the end of its whole time the password does. */
function chip(session) {
  if (!session.isEnding) return nothing;
  const { idle_ends_ms: idle, ends_ms: end } = session.facts.value;
  const stay = () => {
    if (idle && (!end || idle < end)) void session.stay();
    else session.isStaying.value = true;
  };
  return html`<span class="session-chip" role="status"><span>${say.ends({ time: timeWords(session.endsAt) })}</span> <button class="link" @click=${stay}>${say.stay}</button></span>`;
}

/** The button of the people panel. @param {import('./people_state.js').PeopleState} people */
export function invites(people) {
  const isOpen = people.isOpen.value;
  const toggle = () => {
    if (isOpen) return void people.close();
    people.open();
    queueMicrotask(() => document.querySelector('.card.people')?.focus());
  };
  return html`<button class="people-button invite-button" aria-haspopup="dialog" aria-expanded=${isOpen} aria-label=${sayPeople.people} @click=${toggle}>${icon('people')}<span>${sayPeople.people}</span></button>`;
}

export function menu(session) {
  const person = session.person.value;
  const name = person.name || person.user;
  const isOpen = session.isMenuOpen.value;
  const set = (value) => () => {
    session.isMenuOpen.value = value;
  };
  const onKey = (event) => {
    if (event.key !== 'Escape' || !isOpen) return;
    event.stopPropagation();
    session.isMenuOpen.value = false;
    event.currentTarget.querySelector('button').focus();
  };
  return html`${chip(session)}<span class="anchor session-menu" @keydown=${onKey}><button class="ghost session-person" aria-haspopup="true" aria-expanded=${isOpen} title=${say.signedIn({ name })} @click=${set(!isOpen)}>
      <span class="avatar own small" aria-hidden="true">${initials(name)}</span><span class="hidden">${say.signedIn({ name })}</span><span class="session-name" aria-hidden="true">${name}</span>${icon('chevronDown', 12)}</button>
    ${
      isOpen
        ? html`<div class="popover session-about"><p><b>${name}</b></p><p class="dim">${person.user}, ${sourceWords(person)}</p>
      <button @click=${() => void session.signOut()}>${say.out}</button><p class="note">${say.outIs}</p>
      ${session.error.value ? html`<p class="err" role="alert">${say.notOut({ why: session.error.value })}</p>` : nothing}</div>`
        : nothing
    }</span>`;
}
