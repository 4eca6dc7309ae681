// Rooms that exist and the own name, on the start page.
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { maxName } from '../../room/own_name.js';
import { present } from '../../room/plans.js';
import { initials, number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { roomName } from '../../parts/when.js';
import { say } from './later_words.js';
import { patientOf, roomFacts, titleOf } from './plan_row.js';
import { whoIn } from './who_in.js';

/** Rooms of this person: theirs, those they were in or were asked to, asleep ones too; those with people in them first. */
export function roomsList(state, ownName) {
  const rooms = state.rooms.value.filter((room) => room.is_mine);
  if (!rooms.length) return nothing;
  rooms.sort((a, b) => present(b).length - present(a).length || b.used_ms - a.used_ms);
  const planOf = (id) => state.plans.value?.find((plan) => plan.id === id);
  return html`<section class="rooms" aria-labelledby="rooms-head"><div class="list-head"><h2 id="rooms-head">${say.rooms}</h2>
      <span class="dim">${say.nRooms({ count: number(rooms.length), n: rooms.length })}</span></div>
    <ul>${repeat(
      rooms.slice(0, 20),
      ({ id }) => id,
      (room) => {
        const members = present(room);
        const plan = planOf(room.plan);
        const title = plan ? titleOf(plan) : room.plan;
        const name = roomName(room, title);
        const facts = members.length ? whoIn(room) : roomFacts(room, ownName);
        const avatar = (who, index) => html`<span class=${`avatar small tint-${index % 4}`}>${initials(who)}</span>`;
        const names = members.length ? members.map((member) => member.name) : room.were_in;
        return html`<li class="room-row" data-room=${room.id}>
      <span class="avatars" aria-hidden="true">${names.slice(0, 3).map(avatar)}${names.length ? nothing : icon('people')}</span>
      <span class="title"><b>${name}</b><span class="dim">${[patientOf(plan), room.name && title].filter(Boolean).join(', ')}</span></span><span class="who">${facts}</span>
      <button aria-label=${say.joinOf({ room: name, who: facts })} @click=${() => state.goOn(room)}>${say.goIn}</button></li>`;
      },
    )}</ul></section>`;
}

const field = (ownName, id, buttons) => {
  const keep = (event) => {
    event.preventDefault();
    ownName.set(new FormData(event.target).get('name'));
  };
  return html`<form class="own-name" @submit=${keep}><label for=${id}>${say.nameIs}</label>
    <input id=${id} name="name" maxlength=${maxName} autocomplete="name" .value=${ownName.value.value}>${buttons}</form>`;
};

/** Asks for the name once; any answer ends it. */
export const askName = (ownName) =>
  ownName.isAsked.value
    ? field(
        ownName,
        'first-name',
        html`<button>${say.saveName}</button><button type="button" class="ghost" @click=${() => ownName.set('')}>${say.notNow}</button>`,
      )
    : nothing;

/** The name in the banner, and the way to change it. */
export function nameButton(state, ownName) {
  if (ownName.isAsked.value) return nothing;
  const name = ownName.value.value;
  const close = (event) => {
    if (event.type === 'submit' || event.key === 'Escape') state.isNaming.value = false;
  };
  const save = html`<button class="primary">${say.saveName}</button>`;
  return html`<span class="anchor"><button class="ghost" aria-expanded=${state.isNaming.value} title=${say.changeName} @click=${() => {
    state.isNaming.value = !state.isNaming.value;
  }}>
      ${name ? html`<span class="avatar own small" aria-hidden="true">${initials(name)}</span>` : icon('people')}<span>${name || say.yourName}</span></button>
    ${state.isNaming.value ? html`<div class="popover" @submit=${close} @keydown=${close}>${field(ownName, 'change-name', save)}</div>` : nothing}</span>`;
}
