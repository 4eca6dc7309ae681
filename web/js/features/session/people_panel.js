// The people of a room: who is here, who may come in without a link, links.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { initials } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { linksPart } from './people_links.js';
import { errorOf, roleOptions } from './people_parts.js';
import { say } from './people_words.js';

const avatar = (member) =>
  html`<span class="avatar member small" aria-hidden="true" ${variables({ '--member': member.color ?? '#929ba6' })}>${initials(member.name)}</span>`;

/** Two of one name are told apart by their user ids. */
function nameOf(member, members) {
  const isTwice = members.some((other) => other.id !== member.id && other.name === member.name && other.user !== member.user);
  return isTwice && member.user ? `${member.name} (${member.user})` : member.name;
}

function doing(member, { following, control }) {
  if (member.connected === false) return say.away;
  if (member.presenting) return say.presents;
  if (control.requested.value.includes(member.id)) return say.asksForControl;
  const presenter = following.presenter.value;
  return member.following && presenter ? say.follows({ name: presenter.name }) : say.ownView;
}

function row(member, state, room) {
  const members = room.members.value;
  const name = nameOf(member, members);
  const isMe = member.id === room.member.value;
  const canGive =
    room.following.isPresenting.value && !member.presenting && member.connected !== false && room.control.may('scene', member);
  const key = `remove:${member.id}`;
  return html`<li data-member=${member.id} data-away=${member.connected === false}>${avatar(member)}
    <span class="people-who"><span>${isMe ? say.you({ name }) : name} ${member.is_guest ? html`<span class="tag">${say.guest}</span>` : nothing}</span>
      <span class="dim">${say[member.role] ?? member.role} · ${doing(member, room)}</span></span>
    ${canGive ? html`<button aria-label=${say.giveTo({ name })} @click=${() => room.control.give(member.id)}>${say.giveControl}</button>` : nothing}
    ${
      state.mayManage && !isMe && state.asking.value !== key
        ? html`<button class="bad" aria-label=${say.removeOf({ name })} @click=${() => {
            state.asking.value = key;
          }}>${say.remove}</button>`
        : nothing
    }
    ${state.asking.value === key ? removeForm(member, name, state) : nothing}</li>`;
}

function removeForm(member, name, state) {
  const submit = (event) => {
    event.preventDefault();
    void state.remove(member, new FormData(event.target).get('reason').trim());
  };
  return html`<form class="people-remove" @submit=${submit}><label for="people-reason">${say.reason({ name })}</label>
    <input id="people-reason" name="reason" type="text" maxlength="120"><button class="bad">${say.removeNow}</button>
    <button type="button" class="ghost" @click=${() => {
      state.asking.value = '';
    }}>${say.keep}</button></form>`;
}

function withoutLink(state) {
  const people = state.people.value;
  if (!people)
    return html`<p class="empty" role="status">${state.error.value.people ? nothing : say.reading}</p>${errorOf(state, 'people')}`;
  const choice = (value, words) =>
    html`<button class=${people.is_open === value ? 'on' : ''} aria-pressed=${people.is_open === value} @click=${() => void state.setOpen(value)}>${words}</button>`;
  return html`<h3>${say.whoMay}</h3><div class="segment">${choice(false, say.named)}${choice(true, say.allOfPlan)}</div>${errorOf(state, 'open')}
    <ul class="people-named" aria-label=${say.namedList}>${people.owner ? html`<li><b>${people.owner}</b> <span class="dim">${say.owner}</span></li>` : nothing}
      ${people.people.map(
        ({ who, role }) => html`<li><b>${who}</b> <span class="dim">${say[role] ?? ''}</span>
        <button class="icon-button small" aria-label=${say.takeOff({ who })} title=${say.takeOff({ who })} @click=${() => void state.takeOff(who)}>${icon('close', 12)}</button></li>`,
      )}</ul>
    ${people.removed.length ? html`<p class="note">${say.removed({ names: people.removed.map(({ name, user }) => name || user).join(', ') })}</p>` : nothing}`;
}

function askPart(state, room) {
  const submit = async (event) => {
    event.preventDefault();
    const form = event.target;
    const { who, role } = Object.fromEntries(new FormData(form));
    if (!(await state.askIn(who.trim(), role))) return;
    state.words.value = say.asked({ who: who.trim() });
    form.reset();
  };
  return html`<section><h3>${say.askIn}</h3><form class="people-ask" @submit=${submit}>
    <input name="who" type="text" required maxlength="65" pattern="\\s*@?[^\\s@]+\\s*" title=${say.notAWho} aria-label=${say.askWhoIs} placeholder=${say.askWho} autocomplete="off" autocapitalize="none" spellcheck="false">
    <select name="role" aria-label=${say.askAs} title=${say.onlyUpTo}>${roleOptions(room)}</select><button class="primary" ?disabled=${!state.people.value}>${say.ask}</button></form>
    ${errorOf(state, 'ask')}<p class="note" role="status">${state.words.value}</p></section>`;
}

/** @param {import('./people_state.js').PeopleState} state @param {object} world {room} @param {boolean} hasGuests whether the server admits guests */
export function peoplePanel(state, { room }, hasGuests) {
  if (!state.isOpen.value) return nothing;
  const members = room.members.value;
  const close = () => {
    state.close();
    document.querySelector('.people-button')?.focus();
  };
  const onKey = (event) => {
    event.stopPropagation(); // single keys act on panes
    if (event.key === 'Escape') close();
  };
  return html`<section class=${`card people ${state.mayManage ? '' : 'narrow'}`} role="dialog" tabindex="-1" aria-labelledby="people-head" @keydown=${onKey}>
    <div class="people-head"><h2 id="people-head">${say.peopleIn}</h2><span class="dim">${say.room({ room: room.id })}</span>
      <button class="icon-button" aria-label=${say.close} title=${say.close} @click=${close}>${icon('close')}</button></div>
    <div class="people-columns"><div><h3>${say.here} <span class="dim">${members.length}</span></h3>
      <ul class="people-here">${repeat(
        members,
        ({ id }) => id,
        (member) => row(member, state, room),
      )}</ul>${errorOf(state, 'here')}
      ${state.mayManage ? html`<p class="note">${say.roleNote}</p>${withoutLink(state)}` : nothing}</div>
    ${state.mayManage ? html`<div>${askPart(state, room)}${linksPart(state, room, hasGuests)}</div>` : nothing}</div></section>`;
}
