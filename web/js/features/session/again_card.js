// The card over a room in which the sign-in has ended, or is about to: the same person signs in again, and the room goes on.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { initials } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { openWindow } from './hospital.js';
import { passwordError, passwordField } from './password_form.js';
import { sourceWords, timeWords } from './session_menu.js';
import { say } from './later_words.js';

const notice = signal(''); // why nothing came of the window, or of the person who signed in

function goOn(session, facts) {
  const wrong = session.goOn(facts);
  notice.value = wrong ? say.notYou(wrong) : '';
}

function atHospital(session) {
  notice.value = '';
  session.waiting.peek()?.();
  session.waiting.value = openWindow((facts) => {
    session.waiting.value = null;
    goOn(session, facts);
  });
  if (!session.waiting.peek()) notice.value = say.windowBlocked;
}

function waits({ room }, session) {
  const n = room.items.nPending.value + Number(room.isScenePending.value);
  const leave = html`<button class="link" @click=${() => void session.leave()}>${say.leave}</button>`;
  return html`<p class="note">${n ? say.waits({ n, leave }) : leave}</p>`;
}

/** Nothing as long as the sign-in lasts. @param {import('./session.js').Session} session @param {object} world of the room's page */
export function againCard(session, world) {
  const isPaused = world.room.link.value.state === 'paused';
  if (!isPaused && !session.isStaying.value) return nothing;
  const person = session.person.value;
  if (!person) return nothing;
  const { state } = session;
  const name = person.name || person.user;
  const { presenter } = world.room.following;
  const isOther = presenter.value && presenter.value.id !== world.room.member.value;
  const [isLocal, hasProxy] = ['local', 'proxy'].map((way) => session.facts.value.sign_in.includes(way));
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const facts = await state.send('POST', 'session', { user: person.user, password: new FormData(form).get('password') });
    if (!facts) form.elements.password.focus();
    form.elements.password.value = '';
    if (facts) goOn(session, facts);
  };
  const isHeld = state.isBusy.value || state.leftS.value > 0;
  const time = timeWords(isPaused ? session.endedAt.value : session.endsAt);
  const onKey = (event) => {
    if (event.key === 'Escape' && !isPaused) session.isStaying.value = false;
    event.stopPropagation(); // keys of the room have no effect
  };
  return html`<div class="again-cover" ?data-paused=${isPaused}><section class="card again" role="dialog" aria-modal="true" aria-labelledby="again-head" @keydown=${onKey}>
    ${icon('lock', 20)}<div><h2 id="again-head">${say.again}</h2>
    <p class="sign-in-about">${(isPaused ? say.endedAt : say.endsAt)({ time })} ${isPaused && isOther ? say.presents({ name: presenter.value.name }) : nothing}</p>
    <div class="again-who"><span class="avatar own" aria-hidden="true">${initials(name)}</span><span><b>${name}</b><br><span class="dim">${person.user}, ${sourceWords(person)}</span></span>
      ${hasProxy ? html`<button class="primary" @click=${() => atHospital(session)}>${icon('hospital')} ${say.hospital}</button>` : nothing}</div>
    ${
      isLocal
        ? html`<form class="sign-in-form" method="post" @submit=${submit}><input class="hidden" type="text" name="user" autocomplete="username" tabindex="-1" aria-hidden="true" readonly .value=${person.user}>
      <label class="hidden" for="again-password">${say.passwordOf({ name })}</label>
      <div class="again-pair">${passwordField(state, { id: 'again-password', placeholder: hasProxy ? say.orPassword : say.yourPassword })}<button class=${hasProxy ? '' : 'primary'} ?disabled=${isHeld}>${say.signIn}</button></div>
      ${passwordError(state, 'again-password')}</form>`
        : nothing
    }
    ${notice.value ? html`<p class="sign-in-error" role="alert">${icon('error')} <span>${notice.value}</span></p>` : nothing}
    ${
      isPaused
        ? waits(world, session)
        : html`<button class="ghost" @click=${() => {
            session.isStaying.value = false;
          }}>${say.close}</button>`
    }</div></section></div>`;
}
