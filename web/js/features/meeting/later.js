// The meeting that the room is a case of: how it stands, going on to the next case, the card between two patients, waiting outside. Loaded when the server
// tells of a meeting.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, signal, untracked } from '../../../lib/signals-core.js';
import { ofMember } from '../../net/api.js';
import { agenda } from './agenda.js';
import { overlay, showCard } from './card.js';
import { say } from './later_words.js';

const askedS = 10;
const topic = 'meeting';
const isShown = (popover) => popover.startsWith('room-'); // the card of the room chip

/** A form for a decision in which something stands. */
export function isDecisionWritten(root = document) {
  const choice = root.querySelector('.record-form select[name="decision"]');
  return Boolean(choice && (choice.value || choice.form.elements.text?.value.trim()));
}

/** @param {object} world {room, ui, api, clock, connection, enter} */
export function join(world) {
  const { room, ui, api, clock, connection, enter } = world;
  const told = signal(null); // the message meeting
  const waits = signal(null); // {n, of}: a case that is not open to this person
  const asked = signal(null); // {n, until_ms}: the meeting went on, and this person looks on their own
  const asks = signal(null); // what is asked before the meeting goes on: {go}
  const isInviting = signal(false); // the card shows links
  const list = signal(null); // the agenda as GET gave it
  const opens = signal(false); // the room's first saved view is to be shown
  let hidden = null;

  const call = (method, path, body) =>
    api.call(method, `meetings/${told.peek().meeting}${path}`, { body, more: room.identity?.member ? ofMember(room.identity) : {} });
  const say_ = (error) => ui.notify('err', error.message, topic);

  function goIn(message) {
    hidden?.();
    showCard(message, clock);
    enter(message.room, '', '', false, { member: message.member, secret: message.secret, from: room.id });
  }

  function taken(message) {
    if (!message.open) {
      asked.value = null;
      waits.value = { n: message.n, of: message.of };
      return;
    }
    waits.value = null;
    if (!message.asks && !isDecisionWritten()) return goIn(message);
    const seat = message.asks ? null : message;
    asked.value = { n: message.n, to: message.to, seat, by: message.by, until: clock.now() + askedS * 1000 };
  }

  const take = (message) => {
    if (message.type === 'meeting') {
      told.value = message;
      waits.value = message.waits ? { n: message.n_now, of: message.of } : null;
      if (message.opens) opens.value = true;
      if (isShown(ui.popover.peek())) void look();
    } else if (message.type === 'meeting.case') taken(message);
  };

  const along = () => {
    const { seat, to } = asked.peek() ?? { to: told.peek()?.now };
    asked.value = null;
    if (seat) goIn(seat);
    else connection.send({ type: 'meeting.go', to: to ?? '' });
  };

  /** Somebody who came by a link without signing in: the agenda is not told to them. */
  const isGuest = () => {
    const signedIn = world.session?.peek();
    return Boolean(signedIn?.facts.peek().sign_in.length && !signedIn.person.peek());
  };

  async function look() {
    if (isGuest()) return;
    list.value = await call('GET', '').catch(() => list.peek());
  }

  /** Also of whom control was given to since the server told. */
  const mayAdvance = () => told.value?.may_advance || (room.following.isPresenting.value && !isGuest());

  const send = (to) => {
    asks.value = null;
    ui.popover.value = '';
    connection.send({ type: 'meeting.next', to, from: told.peek().now });
  };

  /** Has the meeting go on; asks first if a decision is being written. */
  const next = (to = '') => {
    const now = told.peek();
    if (!now || now.over) return;
    if (!mayAdvance()) return ui.notify('ok', say.notYou, topic);
    if (!to && now.n_now === now.of) return ui.notify('ok', say.isLast, topic);
    if (isDecisionWritten()) asks.value = { go: () => send(to) };
    else send(to);
  };

  const meeting = {
    told,
    waits,
    asked,
    asks,
    list,
    isInviting,
    isGuest,
    call,
    take,
    along,
    mayAdvance,
    next,
    look,
    stay: () => {
      asked.value = null;
    },
    end: () => {
      call('POST', '/end', {}).then(look, say_);
    },
    leave: () => hidden?.(),
  };

  // the covers lie over the page, outside of what the room draws
  const stopTick = effect(() => {
    const { until } = asked.value ?? {};
    if (until && ui.now.value >= until) asked.value = null;
  });
  const stopLook = effect(() => {
    if (isShown(ui.popover.value)) untracked(() => void look());
  });
  const stopOverlay = overlay(world, meeting);
  const stopOpening = effect(() => {
    const isReady = room.canChange.value && room.plan.value && ui.visible.value.every((number) => room.view(number).isOpen.value);
    if (!opens.value || !isReady) return;
    queueMicrotask(() => {
      if (!opens.peek()) return;
      opens.value = false;
      if (room.following.isPresenting.peek()) void world.beginPrepared();
    });
  });
  hidden = () => {
    hidden = null;
    stopTick();
    stopLook();
    stopOpening();
    stopOverlay();
  };
  return meeting;
}

/** In the room chip: which case this is. */
export function chip({ meeting }) {
  const told = meeting.value?.told.value;
  if (!told) return nothing;
  const isElsewhere = !told.over && told.n_now > 0 && told.now !== told.here;
  return html`<b class="chip-case" title=${say.caseOf(told)} ?data-elsewhere=${isElsewhere}>${say.caseShort(told)}</b> `;
}

/** At the top of the chip's card: the agenda and the way on. */
export const chipCard = (world) =>
  world.meeting.value?.told.value ? html`<section class="meeting-card" aria-label=${say.meetingIs}>${agenda(world)}</section>` : nothing;
