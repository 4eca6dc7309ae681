// The room chip: who presents, whether this member follows or is on their own, and what can be done about it.
import { html, nothing } from '../../lib/lit-html.js';
import { effect, untracked } from '../../lib/signals-core.js';
import { partsOf } from '../features/index.js';
import { keyMark } from '../parts/fields.js';
import { dayTime } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { known, later } from '../parts/lazy.js';
import { say } from './words.js';

const marks = { presenting: 'people', following: 'people', own: 'person', away: 'phase', none: 'warning' };

function words({ following, control, recording }) {
  const { started_ms, plan_changed } = recording.replay.value ?? {};
  const trouble = recording.at.value?.state === 'failed' ? say.unreadable : plan_changed && say.planChanged; // the popover says when the meeting was
  const replay = started_ms && (trouble || say.replay({ time: dayTime(started_ms) }));
  const name = following.presenter.value?.name ?? '';
  const n = following.nFollowers.value;
  switch (following.standing.value) {
    case 'presenting':
      return { text: control.isLocked.value ? say.locked : say.presenting, more: n ? say.followers({ n }) : '' };
    case 'own':
      return {
        text: replay ?? say.onMyOwn,
        act: {
          word: say.return,
          command: 'follow',
          about: name ? say.returnTo({ name }) : say.returnToShared,
          do: () => following.return(),
        },
      };
    case 'away':
      return { text: say.away({ name }) };
    case 'none':
      return {
        text: replay ?? say.noPresenter,
        act: !replay && control.may('scene') && { word: say.takeOver, about: say.takeOverIs, do: () => following.present() },
      };
    default:
      return { text: replay ?? (name ? say.following({ name }) : say.followingNobody) };
  }
}

/** The members, what can be done about control, and the own name: no part of what a first visit loads. */
const roster = later(() => import('./roster.js'), 'js/shell/roster.css');

/** Above the toasts: who requests control, for the presenter. */
export const requestLines = (world) => {
  const { following, control } = world.room;
  return following.isPresenting.value && control.requests.value.length ? known(roster)?.requestLines(world) : null;
};

const places = ['strip', 'banner'];
const topic = 'following'; // one message about who one is here and whom one follows: two would lie over the letters of a pane
const chipOf = (place) => `room-${place}`;

/** Opens the chip's popover with the focus in the field of the own name. */
async function askName(ui) {
  await roster.load();
  ui.popover.value = chipOf(places[Number(ui.isTouch.value)]);
  queueMicrotask(() => document.querySelector('#room-name')?.focus()); // after it is drawn
}

/** Tells a person without a name, who finds others in the room, under which name they are there: once, and without asking anything of them. */
export function offerName({ room, ui, ownName }) {
  let isDone = !ownName.isAsked.peek();
  return effect(() => {
    const members = room.members.value;
    if (isDone || !members.length || ownName.isFixed.value) return;
    isDone = true;
    if (members.some(({ id, connected }) => id !== room.member.value && connected !== false))
      untracked(() => ui.notify('ok', say.youAre(room.identity), topic, { word: say.giveName, act: () => askName(ui) }));
  });
}

/** @param {object} world {room, ui, ownName} @param {'strip'|'banner'} place each has its own chip, one of which the style sheet hides */
export function roomChip(world, place) {
  const { room, ui } = world;
  if (!room.members.value.length) return nothing;
  const name = chipOf(place);
  const isOpen = ui.popover.value === name;
  const { text, more, act } = words(room);
  const keep = (event) => event.stopPropagation(); // the arrow keys of the tool bar stay out of the chip
  return html`<span class="anchor room-chip in-${place}" role="group" aria-label=${say.room} data-standing=${room.following.standing.value} ?data-replay=${room.recording.replay.value} @keydown=${(event) => event.key.startsWith('Arrow') && keep(event)}>
    <button class="chip-main" aria-haspopup="dialog" aria-expanded=${isOpen} title=${room.name.value ? `${room.name.value}: ${say.whoIsHere}` : say.whoIsHere} @click=${() => ui.toggle(name)}>${icon(marks[room.following.standing.value], 12)}
      ${room.recording.running.value ? html`<b class="chip-recorded">${say.recorded}</b>` : nothing}
      ${partsOf('chip', world)}<span class="chip-words"><b>${text}</b>${more ? html` <span class="dim">${more}</span>` : nothing}</span></button>
    ${act ? html`<button class="chip-act" title=${act.about} @click=${act.do}>${act.word}${act.command ? keyMark(ui.keys.text(act.command)) : nothing}</button>` : nothing}
    ${isOpen ? html`<div class="popover room-members" role="dialog" aria-label=${say.membersOf}>${partsOf('chipCard', world)}${roster.draw((loaded) => loaded.roster(world))}</div>` : nothing}</span>`;
}
