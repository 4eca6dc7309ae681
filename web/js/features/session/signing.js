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
const unproved = signal(''); // the room for whose record a fresh sign-in at the hospital is wanted; the signature itself stays in the form
const notice = signal('');

/** Nobody of the room that is left waits for a proof any more. */
export function forgetSigning() {
  unproved.value = '';
  notice.value = '';
}

/** Writes what the form holds at this moment; the server may want a fresh proof first. */
async function sign(element, name, { room, write }) {
  const { meaning, corrects = '' } = Object.fromEntries(new FormData(element));
  const done = await write({ name, meaning, corrects });
  unproved.value = done === 'confirm' ? room : '';
  if (done === true) element.reset();
}

/** @param {import('./session.js').Session} session @param {{room: string, isGuest: boolean, fields: unknown, note: unknown, write: (body: object) => Promise<true|string>}} form room: its id; write tells the code of a refusal */
export function signing(session, form) {
  if (!session.isOn) return html`<p class="note">${say.openDoorIs}</p>`;
  const person = session.person.value;
  if (!person || form.isGuest) return html`<p class="note">${say.noSigning}</p>`;
  const name = person.name || person.user;
  const byPassword = person.source !== 'proxy';
  const submit = async (event) => {
    event.preventDefault();
    const element = event.target;
    notice.value = '';
    if (byPassword && !(await state.send('POST', 'session/confirm', { password: new FormData(element).get('password') }))) return;
    await sign(element, name, form);
  };
  const atHospital = ({ currentTarget: { form: element } }) => {
    const before = person.proved_ms ?? 0;
    const signedIn = (facts) => {
      session.waiting.value = null;
      const wrong = session.goOn(facts);
      notice.value = wrong ? say.notYou(wrong) : '';
      if (wrong || unproved.peek() !== form.room) return;
      if (element.isConnected) void sign(element, name, form);
      else unproved.value = ''; // nobody saw what would be signed
    };
    session.waiting.peek()?.();
    const stop = openWindow(signedIn, ({ identity }) => identity?.proved_ms > before);
    session.waiting.value = stop;
    notice.value = stop ? '' : say.windowBlocked;
  };
  return html`<form class="record-form signing" method="post" @submit=${submit}>
    <div class="again-who"><span class="avatar own" aria-hidden="true">${initials(name)}</span><span><b>${name}</b><br><span class="dim">${person.user}, ${sourceWords(person)}</span></span></div>
    <p class="dim">${say.signAs}</p>${form.fields}
    ${byPassword ? html`<div class="sign-in-form"><input class="hidden" type="text" name="user" autocomplete="username" tabindex="-1" aria-hidden="true" readonly .value=${person.user}>${passwordField(state, { id: 'sign-password', label: say.oncePassword })}</div>${passwordError(state, 'sign-password')}` : nothing}
    ${form.note}
    ${
      unproved.value === form.room && !byPassword
        ? html`<p class="note">${say.onceHospital}</p><button type="button" class="primary" @click=${atHospital}>${icon('hospital')} ${say.hospital}</button>`
        : html`<div class="note-buttons"><button ?disabled=${state.isBusy.value || state.leftS.value > 0}>${say.sign}</button></div>`
    }
    ${notice.value ? html`<p class="sign-in-error" role="alert">${icon('error')} <span>${notice.value}</span></p>` : nothing}</form>`;
}
