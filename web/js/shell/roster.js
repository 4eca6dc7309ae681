// The members of a room: who presents, follows or waits; what can be done about control; the own name. Loaded when it is first opened.
import { initials } from '../parts/format.js';
import { html, nothing } from '../../lib/lit-html.js';
import { effect, signal, untracked } from '../../lib/signals-core.js';
import { repeat } from '../../lib/directives/repeat.js';
import { ofMember } from '../net/api.js';
import { roomCalled } from '../room/room_called.js';
import { maxName } from '../room/own_name.js';
import { icon } from '../parts/icons.js';
import { recordings } from '../features/recordings/recordings.js';
import { variables } from '../parts/mount.js';
import { say } from './later_words.js';
import { say as sayAtOnce } from './words.js';

const topic = 'following';
const roles = { planner: say.isPlanner, presenter: say.isPresenter, reviewer: say.isReviewer, observer: say.isObserver, wall: say.isWall };
const lags = {
  link: { word: say.slowLink, about: say.slowLinkIs },
  renderer: { word: say.waitsForPictures, about: say.waitsForPicturesIs },
};

function doing({ presenting, following, connected }, presenter) {
  if (presenting) return connected === false ? say.presentsAway : say.presents;
  if (connected === false) return say.isAway;
  if (!following) return say.onTheirOwn;
  return presenter ? say.follows(presenter) : say.followsNobody;
}

export const avatar = (member, size = 'small') =>
  html`<span class=${`avatar member ${size}`} aria-hidden="true" ${variables({ '--member': member.color ?? '#929ba6' })}>${initials(member.name)}</span>`;

/** Buttons of the presenter for another member. */
function buttonsFor(member, { following, control }) {
  if (!following.isPresenting.value || member.presenting || member.connected === false || !control.may('scene', member)) return nothing;
  const isAsking = control.requested.value.includes(member.id);
  return html`<span class="roster-buttons"><button aria-label=${say.giveTo(member)} @click=${() => control.give(member.id)}>${say.giveControl}</button>
    ${isAsking ? html`<button aria-label=${say.refuseTo(member)} @click=${() => control.refuse(member.id)}>${say.refuse}</button>` : nothing}</span>`;
}

const isEnding = signal(''); // the wall that is to be ended, once this is pressed again
const sureMs = 5000;
let disarm = () => {};

/** For some seconds, and no longer than the popover is open. */
function arm(id, { ui, clock }) {
  disarm();
  const opened = ui.popover.peek();
  const timer = clock.setTimeout(() => disarm(), sureMs);
  const stop = effect(() => {
    if (ui.popover.value !== opened) untracked(disarm);
  });
  isEnding.value = id;
  disarm = () => {
    disarm = () => {};
    clock.clearTimeout(timer);
    stop();
    isEnding.value = '';
  };
}

/** Ends a wall: who presents does, or who may remove people; asked once. */
export function wallButton({ id, name }, { room, ui, clock, connection }) {
  if (!room.control.may('control')) return nothing;
  const isSure = isEnding.value === id;
  return html`<span class="roster-buttons"><button class=${isSure ? 'bad' : ''} aria-label=${(isSure ? say.endWallSureOf : say.endWallOf)({ name })} title=${say.endWallIs} @click=${() => {
    if (!isSure) return arm(id, { ui, clock });
    disarm();
    connection.send({ type: 'member.remove', member: id, reason: '' });
  }}>${isSure ? say.endWallSure : say.endWall}</button></span>`;
}

function row(member, world) {
  const { room } = world;
  const { control, following } = room;
  const lag = member.connected === false ? null : lags[member.lag];
  const isAsking = control.requested.value.includes(member.id);
  return html`<li data-member=${member.id} data-away=${member.connected === false}>${avatar(member)}
    <span class="roster-who"><span class="clipped" title=${member.name}>${member.id === room.member.value ? sayAtOnce.you(member) : member.name}${member.is_guest ? html` <span class="tag">${say.guest}</span>` : nothing}</span>
      <span class="dim">${[roles[member.role], doing(member, following.presenter.value)].filter(Boolean).join(' · ')}</span>
      ${isAsking ? html`<span class="roster-mark">${icon('people', 12)} ${say.requests}</span>` : nothing}
      ${lag ? html`<span class="roster-mark warn" title=${lag.about}>${icon('phase', 12)} ${lag.word}</span>` : nothing}
      ${member.tabs > 1 ? html`<span class="roster-mark dim" title=${say.tabsIs}>${icon('layers', 12)} ${say.tabs({ n: member.tabs })}</span>` : nothing}</span>
    ${member.role === 'wall' ? wallButton(member, world) : buttonsFor(member, room)}</li>`;
}

const actions = ({ following, control, recording: { replay } }, watching) =>
  [
    following.isPresenting.value && { word: say.showEveryone, about: say.showEveryoneIs, do: () => following.showEveryone() },
    following.isPresenting.value &&
      control.may('control') &&
      (control.isLocked.value
        ? { word: say.unlock, about: say.unlockIs, do: () => control.lock(false) }
        : { word: say.lock, about: say.lockIs, do: () => control.lock(true) }),
    !replay.value &&
      control.canTake.value && {
        word: following.presenter.value ? say.take : sayAtOnce.takeOver,
        about: following.presenter.value ? say.takeIs : say.takeOverIs,
        do: () => control.take(),
      },
    control.canRequest.value &&
      (control.isRequesting.value
        ? { word: say.withdraw, about: say.withdrawIs, do: () => control.withdraw() }
        : { word: say.request, about: say.requestIs, do: () => control.request() }),
    !following.isFollowing.value &&
      watching?.isClosed.value && {
        word: say.watch,
        about: say.watchIs,
        do: () => {
          watching.isClosed.value = false;
        },
      },
    !following.isFollowing.value && { word: sayAtOnce.return, about: say.returnIs, do: () => following.return() },
    following.isFollowing.value &&
      !following.isPresenting.value && {
        word: say.leave,
        about: say.leaveIs,
        do: () => following.leave(),
      },
  ].filter(Boolean);

const wallLayouts = [
  ['four', say.wallFour, say.wallFourIs],
  ['worked-in', say.wallOne, say.wallOneIs],
  ['presenter', say.wallPresenter, say.wallPresenterIs],
];

/** For the presenter, what walls show, where there is one or was. */
function walls(room) {
  const now = room.wall.value?.layout ?? 'four';
  const isThere = room.members.value.some(({ role, connected }) => role === 'wall' && connected !== false);
  if (!room.following.isPresenting.value || room.recording.replay.value || !(isThere || now !== 'four')) return nothing;
  return html`<div class="roster-wall" role="group" aria-label=${say.wallShows}><span class="dim">${say.wall}</span><div class="segment">${wallLayouts.map(
    ([layout, word, about]) =>
      html`<button class=${now === layout ? 'on' : ''} aria-pressed=${now === layout} title=${about} @click=${() => room.layOutWalls(layout)}>${word}</button>`,
  )}</div></div>`;
}

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
    ui.notify('ok', say.seenAs({ name: ownName.value.value }), topic);
  };
  return html`<form class="own-name" @submit=${save}><label for="room-name">${say.yourName}</label>
    <input id="room-name" name="name" required maxlength=${maxName} autocomplete="name" placeholder=${room.identity.name} .value=${ownName.value.value}><button>${say.save}</button></form>`;
}

const isNaming = signal(false);

/** The name of the room; who has the right changes it in place. */
function roomTitle(world) {
  const { room, ui, api } = world;
  const name = roomCalled(world);
  if (!room.control.may('control')) return html`<p class="room-title"><b>${name}</b></p>`;
  const end = (event) => {
    const chip = event.target.closest('.room-members');
    isNaming.value = false;
    queueMicrotask(() => chip.querySelector('.room-title button')?.focus());
  };
  const save = (event) => {
    event.preventDefault();
    const given = new FormData(event.target).get('title').trim();
    end(event);
    if (given !== room.name.value)
      api
        .call('PATCH', `rooms/${room.id}`, { body: { name: given || null }, more: ofMember(room.identity) })
        .catch((error) => ui.notify('err', error.message));
  };
  const begin = (event) => {
    const chip = event.target.closest('.room-members');
    isNaming.value = true;
    queueMicrotask(() => chip.querySelector('#room-title')?.select());
  };
  return isNaming.value
    ? html`<form class="own-name room-title" @submit=${save} @keydown=${(event) => {
        if (event.key !== 'Escape') return;
        event.stopPropagation();
        end(event);
      }}><label for="room-title">${say.roomName}</label>
    <input id="room-title" name="title" maxlength="80" autocomplete="off" placeholder=${name} aria-describedby="room-title-note" .value=${room.name.value}><button>${say.save}</button><p class="dim" id="room-title-note">${say.roomNameIsSeen}</p></form>`
    : html`<p class="room-title"><button class="as-text" title=${say.renameRoom} aria-label=${say.renameOf({ name })} @click=${begin}><b>${name}</b></button></p>`;
}

/** Contents of the room chip's popover. @param {object} world {room, ui, ownName, api, watching} */
export function roster(world) {
  const { room, ui, ownName, api, watching } = world;
  const act = (event, what) => {
    const main = event.target.closest('.room-chip').querySelector('.chip-main');
    ui.popover.value = '';
    main.focus(); // the button that was pressed is gone
    what();
  };
  const locked = room.control.isLocked.value;
  return html`${roomTitle({ room, ui, api })}<ul>${repeat(
    room.members.value,
    ({ id }) => id,
    (member) => row(member, world),
  )}</ul>
    ${locked ? html`<p class="dim roster-locked">${say.lockedNote}</p>` : nothing}
    <div class="room-actions">${actions(room, watching).map((action) => html`<button title=${action.about} @click=${(event) => act(event, action.do)}>${action.word}</button>`)}</div>
    ${walls(room)}${recordings(world, avatar)}
    ${ownName.isFixed.value ? nothing : nameForm({ room, ui, ownName })}`;
}

/** For the presenter, above the toasts: the oldest requests for control, one line each. */
export function requestLines({ room: { control } }) {
  const asking = control.requests.value;
  return html`${repeat(
    asking.slice(0, 2),
    ({ id }) => id,
    (member) => html`<div class="request-line" role="status">${avatar(member)}<span class="clipped">${say.asks(member)}</span>
    <button @click=${() => control.give(member.id)} aria-label=${say.giveTo(member)}>${say.give}</button><button class="ghost" @click=${() => control.refuse(member.id)} aria-label=${say.refuseTo(member)}>${say.refuse}</button></div>`,
  )}
    ${asking.length > 2 ? html`<div class="request-line" role="status">${say.moreAsk({ n: asking.length - 2 })}</div>` : nothing}`;
}
