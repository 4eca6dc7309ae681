// A signature in the record of a review: in the name of who is signed in, who proves it once more by password or at the hospital.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { initials } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { openWindow } from './hospital.js';
import { PasswordState, passwordError, passwordField } from './password_form.js';
import { sourceWords } from './session_menu.js';
import { say } from './later_words.js';

const state = new PasswordState();
const unproved = signal(null); // what is signed after a sign-in at the hospital
const notice = signal('');

/** Writes it; where the server wants a fresh proof, keeps it for after that. */
async function sign(body, write) {
  const done = await write(body);
  unproved.value = done === 'confirm' ? body : null;
  return done === true;
}

/** @param {import('./session.js').Session} session @param {{isGuest: boolean, fields: unknown, note: unknown, write: (body: object) => Promise<true|string>}} form write tells the code of a refusal */
export function signing(session, { isGuest, fields, note, write }) {
  const person = session.person.value;
  if (!person || isGuest) return html`<p class="note">${say.noSigning}</p>`;
  const name = person.name || person.user;
  const byPassword = person.source !== 'proxy';
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const { password, meaning, corrects = '' } = Object.fromEntries(new FormData(form));
    notice.value = '';
    if (byPassword && !(await state.send('POST', 'session/confirm', { password }))) return;
    if (await sign({ name, meaning, corrects }, write)) form.reset();
  };
  const atHospital = () => {
    session.waiting.peek()?.();
    const stop = openWindow((facts) => {
      session.waiting.value = null;
      const wrong = session.goOn(facts);
      notice.value = wrong ? say.notYou(wrong) : '';
      if (!wrong) void sign(unproved.peek(), write);
    });
    session.waiting.value = stop;
    notice.value = stop ? '' : say.windowBlocked;
  };
  return html`<form class="record-form signing" method="post" @submit=${submit}>
    <div class="again-who"><span class="avatar own" aria-hidden="true">${initials(name)}</span><span><b>${name}</b><br><span class="dim">${person.user}, ${sourceWords(person)}</span></span></div>
    <p class="dim">${say.signAs}</p>${fields}
    ${byPassword ? html`<div class="sign-in-form"><input class="hidden" type="text" name="user" autocomplete="username" tabindex="-1" aria-hidden="true" readonly .value=${person.user}>${passwordField(state, { id: 'sign-password', label: say.oncePassword })}</div>${passwordError(state, 'sign-password')}` : nothing}
    ${note}
    ${
      unproved.value && !byPassword
        ? html`<p class="note">${say.onceHospital}</p><button type="button" class="primary" @click=${atHospital}>${icon('hospital')} ${say.hospital}</button>`
        : html`<div class="note-buttons"><button ?disabled=${state.isBusy.value || state.leftS.value > 0}>${say.sign}</button></div>`
    }
    ${notice.value ? html`<p class="sign-in-error" role="alert">${icon('error')} <span>${notice.value}</span></p>` : nothing}</form>`;
}
