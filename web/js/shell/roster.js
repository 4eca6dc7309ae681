// The members of a room: who presents, follows or waits; what can be done about control; the own name. Loaded when it is first opened.
import { initials } from '../parts/format.js';
import { html, nothing } from '../../lib/lit-html.js';
import { repeat } from '../../lib/directives/repeat.js';
import { maxName } from '../room/own_name.js';
import { icon } from '../parts/icons.js';
import { recordings } from '../features/recordings/recordings.js';
import { variables } from '../parts/mount.js';

const topic = 'following';
const lags = {
  link: { word: 'slow link', about: 'Pictures are not acknowledged within a second: the link is slow, or the page is in the background' },
  renderer: { word: 'waits for pictures', about: 'The server does not draw the pictures within a second' },
};

function doing({ presenting, following, connected }, presenter) {
  if (presenting) return connected === false ? 'presents, is away' : 'presents';
  if (connected === false) return 'is away';
  if (!following) return 'on their own';
  return presenter ? `follows ${presenter.name}` : 'follows';
}

export const avatar = (member, size = 'small') =>
  html`<span class=${`avatar member ${size}`} aria-hidden="true" ${variables({ '--member': member.color ?? '#929ba6' })}>${initials(member.name)}</span>`;

/** Buttons of the presenter for another member. */
function buttonsFor(member, { following, control }) {
  if (!following.isPresenting.value || member.presenting || member.connected === false || !control.may('scene', member.role))
    return nothing;
  const isAsking = control.requested.value.includes(member.id);
  return html`<span class="roster-buttons"><button aria-label=${`Give control to ${member.name}`} @click=${() => control.give(member.id)}>Give control</button>
    ${isAsking ? html`<button aria-label=${`Refuse control to ${member.name}`} @click=${() => control.refuse(member.id)}>Refuse</button>` : nothing}</span>`;
}

function row(member, room) {
  const { control, following } = room;
  const lag = member.connected === false ? null : lags[member.lag];
  const isAsking = control.requested.value.includes(member.id);
  return html`<li data-member=${member.id} data-away=${member.connected === false}>${avatar(member)}
    <span class="roster-who"><span class="clipped" title=${member.name}>${member.name}${member.id === room.member.value ? ' (you)' : ''}</span>
      <span class="dim">${[member.role, doing(member, following.presenter.value)].filter(Boolean).join(' · ')}</span>
      ${isAsking ? html`<span class="roster-mark">${icon('people', 12)} requests control</span>` : nothing}
      ${lag ? html`<span class="roster-mark warn" title=${lag.about}>${icon('phase', 12)} ${lag.word}</span>` : nothing}
      ${member.tabs > 1 ? html`<span class="roster-mark dim" title="The same browser has this room open more than once">${icon('layers', 12)} one of ${member.tabs} tabs of the same person</span>` : nothing}</span>
    ${buttonsFor(member, room)}</li>`;
}

const actions = ({ following, control, recording: { replay } }, watching) =>
  [
    following.isPresenting.value && { word: 'Show everyone', about: 'Everybody follows you again', do: () => following.showEveryone() },
    following.isPresenting.value &&
      control.may('control') &&
      (control.isLocked.value
        ? { word: 'Unlock', about: 'Presenters may take control again', do: () => control.lock(false) }
        : { word: 'Lock control', about: 'Nobody takes control: you can only give it', do: () => control.lock(true) }),
    !replay.value &&
      control.canTake.value && {
        word: following.presenter.value ? 'Take control' : 'Take over',
        about: following.presenter.value ? 'You present what the room shows now' : "Your view becomes the room's",
        do: () => control.take(),
      },
    control.canRequest.value &&
      (control.isRequesting.value
        ? { word: 'Withdraw request', about: 'You do not want control any more', do: () => control.withdraw() }
        : { word: 'Request control', about: 'The presenter is asked to give you control', do: () => control.request() }),
    !following.isFollowing.value &&
      watching?.isClosed.value && {
        word: "Show presenter's picture",
        about: 'What the presenter works in, small, in a corner of your panes',
        do: () => {
          watching.isClosed.value = false;
        },
      },
    !following.isFollowing.value && { word: 'Return', about: 'Follow with all panes again', do: () => following.return() },
    following.isFollowing.value &&
      !following.isPresenting.value && {
        word: 'Look for yourself',
        about: 'Your panes alone, from what they show now',
        do: () => following.leave(),
      },
  ].filter(Boolean);

/** The own name, which can be given or changed at any time. */
function nameForm({ room, ui, ownName }) {
  const save = (event) => {
    event.preventDefault();
    const before = ownName.value.value;
    const name = new FormData(event.target).get('name');
    if (!name.trim()) return;
    const main = event.target.closest('.room-chip').querySelector('.chip-main');
    ownName.set(name);
    ui.popover.value = '';
    main.focus();
    if (ownName.value.value === before && room.identity.name === before) return;
    room.rename(ownName.value.value);
    ui.notify('ok', `The others see you as ${ownName.value.value}.`, topic);
  };
  return html`<form class="own-name" @submit=${save}><label for="room-name">Your name</label>
    <input id="room-name" name="name" required maxlength=${maxName} autocomplete="name" placeholder=${room.identity.name} .value=${ownName.value.value}><button>Save</button></form>`;
}

/** Contents of the room chip's popover. @param {object} world {room, ui, ownName, api, watching} */
export function roster({ room, ui, ownName, api, watching }) {
  const act = (event, what) => {
    const main = event.target.closest('.room-chip').querySelector('.chip-main');
    ui.popover.value = '';
    main.focus(); // the button that was pressed is gone
    what();
  };
  const locked = room.control.isLocked.value;
  return html`<ul>${repeat(
    room.members.value,
    ({ id }) => id,
    (member) => row(member, room),
  )}</ul>
    ${locked ? html`<p class="dim roster-locked">Control is locked: it can only be given.</p>` : nothing}
    <div class="room-actions">${actions(room, watching).map((action) => html`<button title=${action.about} @click=${(event) => act(event, action.do)}>${action.word}</button>`)}</div>
    ${recordings({ room, ui, api }, avatar)}
    ${nameForm({ room, ui, ownName })}`;
}

/** For the presenter, above the toasts: the oldest requests for control, one line each. */
export function requestLines({ room: { control } }) {
  const asking = control.requests.value;
  return html`${repeat(
    asking.slice(0, 2),
    ({ id }) => id,
    (member) => html`<div class="request-line" role="status">${avatar(member)}<span class="clipped">${member.name} requests control</span>
    <button @click=${() => control.give(member.id)} aria-label=${`Give control to ${member.name}`}>Give</button><button class="ghost" @click=${() => control.refuse(member.id)} aria-label=${`Refuse control to ${member.name}`}>Refuse</button></div>`,
  )}
    ${asking.length > 2 ? html`<div class="request-line" role="status">${asking.length - 2} more request control: see the members</div>` : nothing}`;
}
