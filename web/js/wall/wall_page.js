// The page of a wall: the room's state, drawn without anything that could be pressed.
import { html, nothing } from '../../lib/lit-html.js';
import { computed, effect, signal, untracked } from '../../lib/signals-core.js';
import { dose } from '../features/dose/feature.js';
import { features } from '../features/index.js';
import { pointers } from '../features/pointers/feature.js';
import { WorkedIn } from '../features/watch/watching.js';
import { ofMember } from '../net/api.js';
import { soon } from '../net/soon.js';
import { approvalOf, shownPatient } from '../room/identity.js';
import { views } from '../room/layout.js';
import { crosshair } from '../room/plan.js';
import { RoomState } from '../room/room.js';
import { UiState } from '../room/ui.js';
import { Answer } from '../parts/answer.js';
import { icon } from '../parts/icons.js';
import { mount } from '../parts/mount.js';
import { wallColumn } from './wall_column.js';
import { wallBars, wallFoot, wallHeader } from './wall_frame.js';
import { arranged, viewOf } from './wall_layout.js';
import { WallPane } from './wall_pane.js';
import { say } from './words.js';

const tickMs = 250;
const probeMs = 60;
const linesScale = 1.4; // lines and letters over a picture, of those of a page, on a screen of this many px:
const standardPx = 1080;
const leastScale = 0.7;
const mostRatio = 4; // scene.json
const sleepKey = 'asleep-since';
const cardMs = 1500;

const frame = () => html`<div class="wall"><header class="wall-top"></header><div class="wall-bars"></div>
  <main class="wall-panes">${views.map((_, index) => html`<section class="pane wall-pane" data-view=${index + 1} hidden></section>`)}</main>
  <aside class="wall-column"></aside><footer class="wall-foot"></footer><div class="wall-notice" role="alert"></div></div>`;

/**
 * @param {HTMLElement} host @param {string} id of the room
 * @param {object} world {api, connection, clock, redraw, decode, storage: of this tab, card: message meeting.case by which it comes, goTo(message): goes to another case}
 * @param {string} only a kind of view that is shown alone; '': as the room has it
 * @returns {object} {room, panes} for tests
 */
export function wallPage(host, id, { api, connection, clock, redraw, decode, storage, card = null, goTo = () => {} }, only = '') {
  mount(host, frame);
  const part = (name) => host.querySelector(name);
  const ui = new UiState(clock);
  const room = new RoomState(id, { connection, clock, schedule: redraw.schedule, sendSoon: soon(clock), notify: () => {} });
  const scale = signal(scaleOf());
  const probing = probe(room, api, clock);
  let panes = [];
  const world = {
    room,
    ui,
    api,
    clock,
    connection,
    decode,
    redraw,
    storage: null,
    isWall: true,
    labelPx: 11.5, // as css/display.css has it
    scale,
    probed: probing.state,
    named: signal(null), // the patients in full, while somebody has them named on this wall
    meetingTold: signal(null), // the message meeting
    card: signal(card), // the message meeting.case with which the wall came here, while its card is shown
    closedCase: signal(0), // number of a case that is not open to this wall; 0: none
    asleepSince: signal(0), // ms since 1970; 0: the room is awake
    isOpenToEverybody: signal(false),
    onPainted: (header, isDrawn) => room.frameShown(header, isDrawn),
    panes: () => panes,
    get ratio() {
      return Math.min(globalThis.devicePixelRatio || 1, 2);
    },
  };
  const open = room.following.documentToOpen.bind(room.following);
  room.following.documentToOpen = (view) => ({ ...open(view), pixel_ratio: Math.min(Math.max(scale.peek() * world.ratio, 1), mostRatio) });
  for (const feature of features) feature.make?.(world);
  panes = room.views.map((view) => new WallPane(part(`[data-view="${view.number}"]`), world, view));
  connection.addEventListener('frame', ({ detail }) => {
    room.frameCame(detail.header);
    panes[detail.header.view - 1]?.painter.offer(detail);
  });
  const working = workedIn(room, clock);
  const shown = computed(() => {
    if (only) return { grid: 'one', cells: [viewOf({ kind: only }) || 1] };
    return arranged(room.wall.value ?? { layout: 'four', views: [] }, working.active.value, working.alone.value);
  });
  effect(() => layOut(part('.wall-panes'), shown.value, working.active.value, panes));
  takePlanes(room);
  watchSleep(world, storage);
  watchNamed(world);
  followMeeting(world, goTo);
  const draw = (name, template) => mount(part(name), () => template(world));
  shutWhenOut(room, panes, host);
  draw('.wall-top', wallHeader);
  draw('.wall-bars', wallBars);
  draw('.wall-column', wallColumn);
  draw('.wall-foot', wallFoot);
  draw('.wall-notice', notice);
  probing.start();
  dose.start(world);
  pointers.start(world);
  effect(() => describeTitle(room));
  addEventListener('resize', () => {
    scale.value = scaleOf();
    for (const view of room.views) room.hideView(view.number); // their lines have another width now
    fitColumns(part('.wall-panes'));
    for (const pane of panes) pane.measure();
  });
  setInterval(() => {
    ui.now.value = clock.now();
  }, tickMs);
  void tellOpen(world);
  keepAwake();
  return { room, panes, world };
}

const scaleOf = () => Math.max((linesScale * globalThis.innerHeight) / standardPx, leastScale);

/** Columns and rows of whole pixels, so that no picture is drawn between two. */
function fitColumns(host) {
  const half = (side) => `${Math.floor((side - 1) / 2)}px`;
  host.style.setProperty('--half-width', half(host.clientWidth));
  host.style.setProperty('--half-height', half(host.clientHeight));
}

function layOut(host, { grid, cells }, active, panes) {
  const isOne = grid === 'one';
  host.dataset.grid = grid;
  fitColumns(host);
  untracked(() => {
    for (const [index, pane] of panes.entries()) {
      const number = index + 1;
      const at = cells.indexOf(number);
      pane.host.hidden = at < 0;
      pane.host.style.order = String(at);
      pane.host.classList.toggle('is-first', at === 0);
      pane.host.classList.toggle('worked-in', !isOne && number === active);
    }
    for (const pane of panes) pane.measure();
  });
}

/** active: the view that the presenter works in; alone: the same once that lasts, not back and forth faster than people can follow. */
function workedIn(room, clock) {
  const active = computed(() => viewOf(room.wall.value?.active));
  const alone = signal(0);
  const worked = new WorkedIn((view) => {
    alone.value = view;
  }, clock);
  effect(() => {
    if (active.value) untracked(() => worked.acted(active.value));
  });
  return { active, alone };
}

/** The oblique view shows the plane that the presenter's has. */
function takePlanes(room) {
  effect(() => {
    const told = room.wall.value;
    const name = [told?.active, ...(told?.views ?? [])].find((view) => view?.kind === 'oblique');
    const view = room.view(viewOf(name));
    if (!view || view.document.peek().plane === name.plane) return;
    untracked(() => {
      const size = view.ownSize;
      const wasOpen = view.isOpen.peek();
      if (wasOpen) room.hideView(view.number);
      view.restart({ kind: 'oblique', plane: name.plane });
      if (wasOpen) room.showView(view.number, size);
    });
  });
}

/** The values at the crosshair, asked for when it has moved or the renderer is there again. */
function probe(room, api, clock) {
  const key = () => {
    const scene = room.scene.value;
    return scene && room.plan.value && room.renderer.value.state === 'ready' ? crosshair(scene).join(' ') : '';
  };
  const ask = (place, aborted) => {
    const [x, y, z] = place.split(' ');
    return api.ofScene(room.planId.peek(), 'probe', room.id, {}, { x, y, z }, aborted);
  };
  return new Answer({ key, ask, clock, restMs: probeMs, renews: true });
}

/** Since when the room sleeps: this tab keeps it for a reload. */
function watchSleep({ connection, asleepSince }, storage) {
  connection.addEventListener('message', ({ detail }) => {
    if (detail.type === 'welcome') {
      asleepSince.value = 0;
      storage?.removeItem(sleepKey);
    } else if (detail.type === 'bye' && detail.code === 'asleep' && !asleepSince.value) {
      asleepSince.value = Number(storage?.getItem(sleepKey)) || Date.now();
      storage?.setItem(sleepKey, String(asleepSince.value));
    }
  });
}

/** Asks whom the plan is of while somebody who may has it named on this wall, and forgets it with that. */
function watchNamed({ room, api, named }) {
  const isNaming = computed(() => {
    const own = room.members.value.find(({ id }) => id === room.member.value);
    return own?.is_naming === true && room.link.value.state === 'open' ? shownPatient(room.plan.value, room.scene.value)?.masked : '';
  });
  effect(() => {
    const of = isNaming.value;
    named.value = null;
    if (!of) return;
    untracked(async () => {
      const answer = await api.call('GET', `rooms/${room.id}/identity`, { more: ofMember(room.identity) }).catch(() => null);
      if (answer && isNaming.peek() === of) named.value = answer.patients;
    });
  });
}

/** Nobody may look here any more: no picture of a patient stays on the screen. */
function shutWhenOut(room, panes, host) {
  effect(() => {
    const isOut = ['paused', 'ended'].includes(room.link.value.state);
    host.classList.toggle('is-out', isOut);
    if (!isOut) return;
    untracked(() => {
      room.plan.value = null;
      for (const pane of panes) pane.clear();
    });
  });
}

/** Goes along from case to case: a card with the next patient stands before its first picture. */
function followMeeting({ connection, clock, meetingTold, card, closedCase }, goTo) {
  if (card.peek())
    clock.setTimeout(() => {
      card.value = null;
    }, cardMs);
  connection.addEventListener('message', ({ detail }) => {
    if (detail.type === 'meeting') meetingTold.value = detail;
    if (detail.type === 'meeting' && !detail.waits) closedCase.value = 0;
    if (detail.type !== 'meeting.case') return;
    if (!detail.open) closedCase.value = detail.n;
    else if (detail.room) goTo(detail);
  });
}

function caseCard(to) {
  const [word, kind, picture] = approvalOf(to);
  return html`<section class="wall-card" role="status"><p>${say.caseOf(to)}</p><h2>${to.patient || say.unknown}</h2><p class="wall-card-plan">${to.plan}</p>
    <p class=${`wall-approval ${kind}`}>${picture ? icon(picture, 20) : nothing}${word}</p></section>`;
}

/** Words in place of the panes: who sleeps, or may not look any more. */
function notice({ room, asleepSince, card, closedCase }) {
  if (card.value) return caseCard(card.value);
  if (closedCase.value) return html`<div class="wall-said"><h2>${say.notOpen({ n: closedCase.value })}</h2></div>`;
  const { state, reason } = room.link.value;
  if (asleepSince.value) {
    const time = new Date(asleepSince.value).toLocaleTimeString('en-GB', { hour: '2-digit', minute: '2-digit' });
    return html`<div class="wall-said"><h2>${say.asleepSince({ time })}</h2><p>${say.wakes}</p></div>`;
  }
  if (state === 'paused') return html`<div class="wall-said"><h2>${room.member.value ? say.signInAgain : say.needsLink}</h2></div>`;
  if (state === 'ended') return html`<div class="wall-said"><h2>${say.ended({ reason })}</h2></div>`;
  return nothing;
}

function describeTitle(room) {
  document.title = room.plan.value ? say.title({ plan: room.plan.value.name }) : say.wall;
}

/** Says in red, where it is so, that this server is open to everybody. Asked until there is an answer. */
async function tellOpen(world) {
  const facts = await world.api.version().catch(() => null);
  if (!facts) world.clock.setTimeout(() => tellOpen(world), 2000);
  else world.isOpenToEverybody.value = facts.open_to_everybody === true;
}

/** The screen stays on; a browser gives the lock back when the page is hidden. */
function keepAwake() {
  const lock = () =>
    void Reflect.get(navigator, 'wakeLock')
      ?.request('screen')
      .catch(() => {}); // not in Firefox 121
  document.addEventListener('visibilitychange', () => document.visibilityState === 'visible' && lock());
  lock();
}
