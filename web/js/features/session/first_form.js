// The first administrator of a server, made with the token of the address that its log shows once.
import { html } from '../../../lib/lit-html.js';
import { passwordError, passwordField } from './password_form.js';
import { say } from './later_words.js';

/** Takes the token out of the address, before it stays in the history. */
export function takeToken() {
  const token = location.hash.slice(1);
  if (token) history.replaceState(null, '', location.pathname);
  return token;
}

/** @param {import('./password_form.js').PasswordState} state @param {string} token */
export function firstCard(state, token) {
  const submit = async (event) => {
    event.preventDefault();
    const { user, name, password, again } = Object.fromEntries(new FormData(event.target));
    if (password !== again) {
      state.error.value = say.differ;
      return;
    }
    const person = { user: user.trim(), name: name.trim(), password };
    if (!(await state.send('POST', 'session/first', { token, ...person }))) return;
    if (await state.send('POST', 'session', { user: person.user, password })) location.replace('/');
    else location.replace('/signin');
  };
  const form = html`<form class="sign-in-form" method="post" @submit=${submit}>
    <label for="first-user">${say.user}</label>
    <input id="first-user" name="user" type="text" required maxlength="64" autocomplete="username" autocapitalize="none" spellcheck="false" placeholder=${say.userLike}>
    <label for="first-name">${say.firstName}</label><input id="first-name" name="name" type="text" required maxlength="40" autocomplete="name">
    ${passwordField(state, { id: 'first-password', label: say.newPassword, autocomplete: 'new-password', least: 8 })}
    ${passwordField(state, { id: 'first-again', label: say.onceMore, autocomplete: 'new-password', name: 'again', least: 8 })}
    ${passwordError(state, 'first-password')}
    <button class="primary" ?disabled=${state.isBusy.value || state.leftS.value > 0}>${state.isBusy.value ? say.checking : say.makeFirst}</button></form>`;
  return html`<section class="card sign-in" aria-labelledby="first-head"><h1 id="first-head">${say.first}</h1>
    <p class="sign-in-about">${say.firstIs}</p>${token ? form : html`<p class="err" role="alert">${say.notWhole}</p>`}</section>`;
}
