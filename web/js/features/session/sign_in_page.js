// The page on which people sign in, or come in as a guest by a link that admits guests.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { maxName } from '../../room/own_name.js';
import { placeOf } from '../../net/address.js';
import { icon } from '../../parts/icons.js';
import { styled } from '../../parts/lazy.js';
import { mount } from '../../parts/mount.js';
import { firstCard, takeToken } from './first_form.js';
import { proxyPath, tellDone } from './hospital.js';
import { PasswordState, passwordError, passwordField, send } from './password_form.js';
import { ownPath } from './return_path.js';
import { say } from './later_words.js';

/** @param {HTMLElement} host @param {string} id "first": the first administrator; "done": the small window @param {object} world {api, ownName, remembered, remember} @returns {() => void} leaves the page */
export function signInPage(host, id, world) {
  const path = ownPath(new URLSearchParams(location.search).get('return'));
  const isFirst = id === 'first';
  const page = {
    isFirst,
    token: isFirst ? takeToken() : '',
    facts: signal(undefined),
    why: signal(''), // there are no facts
    version: signal(''),
    state: new PasswordState(),
    path: path + keptFragment(),
    world,
  };
  const unmount = mount(host, () => draw(page));
  document.title = `${say.signIn} – Beamroom`;
  void styled('js/features/session/session.css').catch(() => {});
  if (id === 'done') finish();
  else void begin(page, host);
  return () => {
    page.state.stop();
    unmount();
    document.title = 'Beamroom';
  };
}

/** A proxy that answers itself who has not signed in there. */
const ofProxy = { sign_in: ['proxy'], identity: null, guest_links: false };

/** A permalink's token, which came behind "#". */
const keptFragment = () => (location.hash.startsWith('#/p/') ? location.hash : '');

function finish() {
  tellDone();
  window.close();
}

async function begin(page, host) {
  const { status, answer } = await send('GET', 'session');
  const facts = status === 200 ? answer : status === 401 ? ofProxy : null;
  const isAsked = new URLSearchParams(location.search).has('return');
  const isIn = facts?.identity && (isAsked || (facts.identity.source !== 'proxy' && !page.isFirst)); // out of a proxy's sign-in leads only the proxy
  if (facts && (!facts.sign_in.length || isIn)) return void location.replace(page.path);
  if (!facts) page.why.value = answer.detail || answer.title || say.noAnswer;
  page.facts.value = facts;
  queueMicrotask(() => host.querySelector('.sign-in input, .sign-in button')?.focus());
  page.version.value = (await page.world.api.version().catch(() => null))?.version ?? '';
}

/** The words on what opens after the sign-in. */
function opens(path) {
  const { pathname, hash } = new URL(path, location.origin);
  const { place, id } = placeOf({ pathname, hash });
  if (place === 'rooms') return say.asked({ room: html`<b>${id}</b>` });
  return place === 'p' ? say.viewOpens : say.plansOpen;
}

function draw(page) {
  const facts = page.facts.value;
  return html`<div class="sign-in-page"><header class="banner"><span class="brand">${icon('logo', 20)}<b>Beamroom</b></span><span class="dim">${location.host}</span></header>
    <main>${location.pathname.endsWith('/done') ? html`<p>${say.done}</p>` : facts === undefined ? nothing : cards(page, facts)}</main>
    <footer class="status"><span class="dim">${page.version.value ? `Beamroom ${page.version.value}` : nothing}</span><span class="grow"></span><b class="research">${say.research}</b></footer></div>`;
}

function cards(page, facts) {
  if (!facts)
    return html`<section class="card sign-in" role="alert"><h1>${say.signIn}</h1><p>${page.why.value}</p>
      <button class="primary" @click=${() => location.reload()}>${say.tryAgain}</button></section>`;
  if (page.isFirst) return firstCard(page.state, page.token);
  if (facts.identity)
    return html`<section class="card sign-in"><h1>${say.signIn}</h1><p>${say.stillProxy({ name: html`<b>${facts.identity.name || facts.identity.user}</b>` })}</p>
      <a class="button" href=${page.path}>${say.goOn}</a></section>`;
  return html`${signInCard(page, facts)}${guestCard(page, facts)}`;
}

function signInCard(page, facts) {
  const isLocal = facts.sign_in.includes('local');
  const hasProxy = facts.sign_in.includes('proxy');
  return html`<section class="card sign-in" aria-labelledby="sign-in-head"><h1 id="sign-in-head">${say.signIn}</h1><p class="sign-in-about">${opens(page.path)}</p>
    ${hasProxy ? html`<button class="primary hospital" @click=${() => location.assign(proxyPath(page.path))}>${icon('hospital')} ${say.hospital}</button>` : nothing}
    ${hasProxy && isLocal ? html`<p class="sign-in-or"><span>${say.orHere}</span></p>` : nothing}
    ${isLocal ? localForm(page, hasProxy) : nothing}</section>`;
}

function localForm({ state, path }, hasProxy) {
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const { user, password } = Object.fromEntries(new FormData(form));
    if (await state.send('POST', 'session', { user: user.trim(), password })) return void location.replace(path);
    form.elements.password.value = '';
    form.elements.password.focus();
  };
  const isHeld = state.isBusy.value || state.leftS.value > 0;
  return html`<form class="sign-in-form" method="post" @submit=${submit}>
    <label for="sign-in-user">${say.user}</label>
    <input id="sign-in-user" name="user" type="text" required maxlength="64" autocomplete="username" autocapitalize="none" spellcheck="false">
    ${passwordField(state, { id: 'sign-in-password', label: say.password })}
    ${passwordError(state, 'sign-in-password')}
    <button class=${hasProxy ? '' : 'primary'} ?disabled=${isHeld}>${state.isBusy.value ? say.checking : say.signIn}</button>
    <p class="note">${say.forgotten}</p></form>`;
}

/** A guest has a link to a room, and no account. */
function guestCard({ path, world }, facts) {
  const { place, id } = placeOf({ pathname: path, hash: '' });
  const { link, isGuest, user, isNew } = place === 'rooms' ? world.remembered(id) : {};
  if (!facts.guest_links || !link || (user && !isNew)) return nothing; // the link by which a person came in is that person's
  if (isGuest) return html`<section class="card sign-in" role="status"><p>${say.noGuest}</p></section>`;
  const submit = (event) => {
    event.preventDefault();
    world.ownName.set(new FormData(event.target).get('name'));
    world.remember(id, { isGuest: true, member: '', secret: '', user: '' });
    location.replace(path);
  };
  return html`<section class="card sign-in" aria-labelledby="guest-head"><h2 id="guest-head">${say.guest}</h2><p class="sign-in-about">${say.guestIs({ room: html`<b>${id}</b>` })}</p>
    <form class="sign-in-form" @submit=${submit}><label for="guest-name">${say.guestName}</label>
    <input id="guest-name" name="name" type="text" required maxlength=${maxName} autocomplete="name" .value=${world.ownName.value.peek()}>
    <button>${icon('chevronRight', 12)} ${say.guest}</button><p class="note">${say.guestNote}</p></form></section>`;
}
