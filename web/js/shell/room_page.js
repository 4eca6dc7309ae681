// The room page: panes with the panels around them, connected to the room's state.
import { html, nothing } from '../../lib/lit-html.js';
import { computed, effect, signal, untracked } from '../../lib/signals-core.js';
import { features, partsOf } from '../features/index.js';
import { AfterRoom } from '../room/after_room.js';
import { crosshair } from '../room/plan.js';
import { views } from '../room/layout.js';
import { splitVariables } from '../room/splits.js';
import { RoomState } from '../room/room.js';
import { UiState } from '../room/ui.js';
import { Undo, listenUndo } from '../room/undo.js';
import { banner } from './banner.js';
import { card, ended, watchEnd } from './ended.js';
import { coverPage, help, toasts } from './float.js';
import { inspector } from './inspector.js';
import { soon } from '../net/soon.js';
import { Answer } from '../parts/answer.js';
import { later } from '../parts/lazy.js';
import { mount } from '../parts/mount.js';
import { pageFactor } from '../parts/page_look.js';
import { Pane, card as pointedCard } from '../pane/pane.js';
import { giveOblique } from '../pane/pane_kind.js';
import { listenKeys } from './page_keys.js';
import { paneSwitch } from './pane_switch.js';
import { offerName, requestLines } from './room_chip.js';
import { savedLine } from './saved.js';
import { sectionOf } from './sections.js';
import { loadBlocks } from './selection.js';
import { status } from './status.js';
import { toolStrip } from './tools.js';
import { tree } from './tree.js';
import { undoNames } from './undo_buttons.js';
import { say } from './words.js';

const twiceMs = 20000;
const probeMs = 60;
const tickMs = 250;
const lateMs = 150; // without the room's plan, after which the panels are drawn without it
const inspectorFrom = 1209; // px: rail, inspector and two panes of 420

const filesBar = later(() => import('./files_bar.js'), 'js/features/fits/fit.css');
const undoKept = later(() => import('../room/undo_kept.js'));
const popovers = later(() => import('./popovers.js'));
const splitters = later(() => import('./splitters.js'), 'js/shell/splitters.css');
const drawer = (world) => (world.ui.arrangement.value.drawer ? features.map(({ drawer: own }) => own?.draw(world)) : nothing);
const dialogs = ['help', ...features.flatMap((feature) => feature.dialogs ?? [])];
const floating = (world) => html`${help(world)}${ended(world)}${partsOf('dialog', world)}`;

const frame = () => html`<div class="room">
  <a class="skip" href="#picture-1">${say.toPanes}</a>
  <header class="banner"></header><aside class="tree" aria-label=${say.plan}></aside>
  <section class="strip" aria-label=${say.tools}></section>
  <main><div class="switch"></div><div class="dose-bars"></div><div class="legends"></div><div class="panes">${views.map(({ kind }, index) => html`<section class="pane" data-view=${index + 1} data-kind=${kind}></section>`)}</div><section class="chart-drawer" aria-label=${say.plots}></section><div class="toasts"></div></main>
  <aside class="inspector" aria-label=${say.inspector}></aside><footer class="status"></footer><div class="floating"></div></div>`;

/**
 * @param {HTMLElement} host @param {string} id of the room
 * @param {object} world {api, connect, clock, redraw, decode, hooks, enter, ownName, session, storage: of the browser, isBack: this tab was in the room before,
 *   goOnHere: takes the seat of the tab that this one was duplicated from; null: it was not,
 *   plan: the room's, as far as the address knows it}
 * @returns {() => void} leaves the room
 */
export function roomPage(
  host,
  id,
  { api, connect, clock, redraw, decode, hooks, enter, ownName, session, storage = null, isBack = false, goOnHere = null, plan = '' },
) {
  const stops = [mount(host, frame)];
  const part = (name) => host.querySelector(name);
  const ui = new UiState(clock, storage);
  const connection = connect(id);
  connection.open(); // its answer is on the way while the page is drawn; nothing is told before this returns
  const room = new RoomState(id, { connection, clock, schedule: redraw.schedule, sendSoon: soon(clock), notify: ui.notify });
  const undo = new Undo(room, { clock, notify: ui.notify });
  const probing = probe(room, api, clock);
  const onPainted = (header, isDrawn) => {
    const answered = room.frameShown(header, isDrawn);
    hooks.painted(header, answered, (timesMs) => room.measured(timesMs));
  };
  stops.push(
    redraw.watch(globalThis),
    loadBeforeClicks(),
    effect(() => splitters.loaded.value?.placeSplitters(host, ui)),
    effect(() => popovers.loaded.value?.keepInside(host, ui)),
    adapt(ui),
    effect(() => layOut(host.querySelector('.room'), ui)),
  ); // before the panes measure themselves: views open at their sizes
  const after = new AfterRoom({ api, clock, enter });
  const world = {
    after,
    room,
    ui,
    api,
    enter,
    clock,
    connection,
    decode,
    redraw,
    storage,
    ownName,
    session,
    undo,
    probed: probing.state,
    onPainted,
    panes: () => panes,
  };
  for (const feature of features) feature.make?.(world);
  const panes = room.views.map((view) => new Pane(part(`[data-view="${view.number}"]`), world, view));
  connection.addEventListener('frame', ({ detail }) => {
    room.frameCame(detail.header);
    panes[detail.header.view - 1]?.painter.offer(detail);
  });

  const panels = [
    ['.banner', banner],
    ['.tree', tree],
    ['.strip', toolStrip],
    ['.switch', paneSwitch],
    [
      '.dose-bars',
      () => html`${world.room.files.value ? filesBar.draw((loaded) => loaded.filesBar(world)) : nothing}${partsOf('bar', world)}`,
    ],
    ['.legends', () => html`${partsOf('legend', world)}`],
    ['.chart-drawer', drawer],
    ['.inspector', inspector],
    ['.status', status],
    ['.toasts', (shown) => html`${savedLine(shown)}${requestLines(shown)}${toasts(shown)}`],
    ['.floating', floating],
  ];
  stops.push(whenKnown(room, clock, () => stops.push(...panels.map(([name, draw]) => mount(part(name), () => draw(world), redraw)))));
  if (hasKept(`undo ${id}`)) undoKept.load();
  if (goOnHere) ui.notify('ok', say.isTwice, 'tabs', { word: say.goOnHere, act: goOnHere }, twiceMs);
  else if (!isBack) stops.push(offerName(world));
  stops.push(
    effect(() => describeTitle(room)),
    reveal(host, ui),
    probing.start(),
    ...features.flatMap((feature) => feature.start?.(world) ?? []),
  );
  stops.push(
    listenKeys(globalThis, world, () => Boolean(document.querySelector('[aria-modal="true"], dialog[open]'))),
    listenPresses(ui),
    effect(() => undoKept.loaded.value?.keepUndo(room, undo, sessionStorage, globalThis)),
    listenUndo(globalThis, undo),
    moveFocus(host, ui),
    watchEnd(host, room, after, plan),
    giveOblique(world),
    coverPage(host, ui),
    effect(() => {
      const signedIn = session.value;
      return untracked(() => signedIn?.inRoom(world));
    }),
  );

  const tick = setInterval(() => {
    ui.now.value = clock.now();
  }, tickMs);
  hooks.enter(room, panes);
  return () => {
    clearInterval(tick);
    connection.close();
    room.isLeft.value = true;
    for (const pane of panes) pane.stop();
    for (const stop of stops.reverse()) stop();
    document.title = 'Beamroom';
  };
}

/** Whether this tab keeps something under that name. */
function hasKept(name) {
  try {
    return sessionStorage.getItem(name) !== null;
  } catch {
    return false;
  }
}

/** Calls back when the room has told its plan, or is late with it: what is around the panes is then drawn once, and not before the views are open. */
function whenKnown(room, clock, act) {
  let isDone = false;
  const isLate = signal(false);
  const timer = clock.setTimeout(() => {
    isLate.value = true;
  }, lateMs);
  const stop = effect(() => {
    if (isDone || !(room.plan.value || isLate.value)) return;
    isDone = true;
    untracked(act);
  });
  return () => {
    clock.clearTimeout(timer);
    stop();
  };
}

/** Gives the style sheets the arrangement. */
function layOut(element, ui) {
  const { size, tree: place, overlay, inspector: at, sheet, drawer: charts, layout, visible } = ui.arrangement.value;
  Object.assign(element.dataset, { size, tree: place, overlay, inspector: at, sheet, drawer: charts, layout, tool: ui.tool.value });
  for (const [name, value] of Object.entries(splitVariables(ui.splitters.value))) element.style.setProperty(name, value);
  const panes = [...element.querySelectorAll('.pane')];
  const cells = [...ui.panes[layout === '2x1' || layout === '1x2' ? 'two' : 'four'].value];
  const order = [...cells, ...views.map((_, index) => index + 1).filter((n) => !cells.includes(n))].map((n) =>
    panes.find((pane) => Number(pane.dataset.view) === n),
  );
  const focused = document.activeElement;
  if (order.some((pane, index) => pane !== panes[index])) panes[0].parentElement.append(...order); // Tab goes through them as they stand
  for (const pane of panes) {
    const n = Number(pane.dataset.view);
    pane.hidden = !visible.includes(n);
    pane.classList.toggle('active', ui.active.value === n);
  }
  if (focused !== document.activeElement && !focused.closest('[hidden]')) focused.focus({ preventScroll: true }); // an element that is moved loses it
}

/** Scrolls the tree to what was selected, wherever it was clicked. */
function reveal(host, ui) {
  return effect(() => {
    const { kind } = ui.selection.value;
    if (sectionOf(kind)) queueMicrotask(() => host.querySelector('.tree .row.selected')?.scrollIntoView({ block: 'nearest' }));
  });
}

function describeTitle(room) {
  document.title = [room.name.value, room.plan.value?.name ?? room.planId.value, 'Beamroom'].filter(Boolean).join(' – ');
}

/** The values at the crosshair, asked for when it has moved or the renderer is there again. */
function probe(room, api, clock) {
  const key = () => {
    const scene = room.scene.value;
    return scene && room.plan.value && room.renderer.value.state === 'ready' ? crosshair(scene).join(' ') : '';
  };
  const ask = (place, aborted) => api.probe(room.planId.peek(), place.split(' ').map(Number), aborted);
  return new Answer({ key, ask, clock, restMs: probeMs, renews: true });
}

/** The inspector's Selection is loaded when somebody begins to use the page: it is there before the first click. So is what tells that the room has ended, when
 *  a server that restarts may not give it any more. */
function loadBeforeClicks() {
  const abort = new AbortController();
  const load = () => {
    abort.abort();
    loadBlocks();
    card.load();
    pointedCard.load();
    undoNames.load();
    splitters.load();
    popovers.load();
    undoKept.load();
  };
  for (const event of ['pointerover', 'keydown', 'touchstart']) addEventListener(event, load, { signal: abort.signal, passive: true });
  return () => abort.abort();
}

/** Tells the state the size of the window and whether fingers use it; folds an inspector for which there is no room. */
function adapt(ui) {
  const coarse = matchMedia('(pointer: coarse)');
  const set = () => {
    const before = ui.window.peek();
    const { clientWidth, clientHeight } = document.documentElement; // innerWidth is larger where a telephone shows more than the page
    const [width, height] = [clientWidth / pageFactor(), clientHeight / pageFactor()];
    ui.window.value = { width, height, isCoarse: coarse.matches };
    if (before.width >= inspectorFrom !== width >= inspectorFrom) ui.isInspectorOpen.value = width >= inspectorFrom;
  };
  set();
  addEventListener('resize', set);
  coarse.addEventListener('change', set);
  return () => {
    removeEventListener('resize', set);
    coarse.removeEventListener('change', set);
  };
}

/** Moves the focus into a dialog that opens, and back afterwards to the element that opened it. */
function moveFocus(host, ui) {
  let opener = null;
  const isDialog = computed(() => dialogs.includes(ui.popover.value));
  return effect(() => {
    const isOpen = isDialog.value;
    if (!isOpen && !opener) return;
    if (isOpen) opener = document.activeElement;
    queueMicrotask(() => {
      // after it is drawn
      const dialog = host.querySelector('[role="dialog"]');
      if (isOpen) return void dialog?.focus();
      if (document.activeElement === document.body) opener?.focus();
      opener = null;
    });
  });
}

/** A press beside an open popover closes it. */
function listenPresses(ui) {
  const onPress = (event) => {
    if (ui.popover.value && !dialogs.includes(ui.popover.value) && !event.target.closest('.anchor')) ui.popover.value = '';
  };
  addEventListener('pointerdown', onPress);
  return () => removeEventListener('pointerdown', onPress);
}
