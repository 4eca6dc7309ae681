// The start page: the plans of this server, their state, and the way into a room.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, signal } from '../../../lib/signals-core.js';
import { reportSummary } from '../../room/plan.js';
import { PlansState } from '../../room/plans.js';
import { UploadsState } from './uploads.js';
import { roomOf } from '../../net/address.js';
import { brand } from '../../shell/banner.js';
import { deleteDialog, watchDialog } from './delete_dialog.js';
import { seconds } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';
import { askName, nameButton, roomsList } from './lobby.js';
import { meetingsToday } from './meeting_list.js';
import { MeetingsState } from './meetings.js';
import { later } from '../../parts/lazy.js';
import { mount } from '../../parts/mount.js';
import { addressOfPlace, placeOfAddress, places } from './places.js';
import { planList } from './plan_list.js';
import { listenPopovers } from './popovers.js';
import { refusalOf } from './plan_row.js';
import { reportLines } from '../../parts/report.js';
import { listenDrops, uploadButton } from './upload.js';

// what main.js gives the page, and nothing else needs
export { sendPlan } from '../../net/upload.js';
export { Thumbnails } from './thumbnails.js';

/** @param {HTMLElement} host @param {object} world {api, clock, enter, send, ownName, session, thumbnails} @returns {() => void} leaves the page */
export function startPage(host, world) {
  const state = new PlansState({ ...world, place: placeOfAddress(location.search), seen: (plans) => void world.thumbnails.update(plans) });
  const popover = signal(''); // of the banner: '' | 'upload' | 'look' | 'join'
  const uploads = new UploadsState({
    ...world,
    popover,
    arrived: (plan) => state.arrived(plan).then(() => reveal(host, plan)),
    limit: () => state.version.value?.max_upload_bytes ?? Infinity,
  });
  const meetings = new MeetingsState(world);
  const unmount = mount(host, () => page(state, uploads, meetings, world));
  const unkey = listenForSearch(host);
  const unwatch = watchDialog(host, state);
  const unpopover = listenPopovers(popover, () => {
    uploads.error.value = '';
    state.isNaming.value = false;
  });
  const unlisten = listenDrops(uploads, (file) => openSnapshot(world, file));
  const unaddress = effect(() => keepInAddress(state));
  let newest = 0;
  const unscroll = effect(() => {
    // scrolls to a newly chosen upload, which asks for its name
    const { key = 0 } = uploads.rows.value.at(-1) ?? {};
    if (key > newest)
      queueMicrotask(() => {
        const row = host.querySelector(`[data-upload="${key}"]`);
        row?.scrollIntoView({ block: 'center' });
        row?.querySelector('input[name="name"]')?.focus({ preventScroll: true });
      });
    newest = Math.max(newest, key);
  });
  state.start();
  meetings.start();
  return () => {
    state.stop();
    meetings.stop();
    unkey();
    uploads.stop();
    unpopover();
    unlisten();
    unwatch();
    unscroll();
    unaddress();
    unmount();
  };
}

/** A snapshot that was dropped on the page. */
async function openSnapshot({ api, enter }, file) {
  const { openDroppedSnapshot } = await import('../report/later_snapshots.js');
  return openDroppedSnapshot(api, file, enter);
}

const look = later(() => import('../../shell/look_choice.js'), 'js/shell/look.css');

function lookButton(popover) {
  const isOpen = popover.value === 'look';
  return html`<span class="anchor"><button class="ghost" aria-expanded=${isOpen} aria-label=${say.look} title=${say.look} @click=${() => {
    popover.value = isOpen ? '' : 'look';
  }}>${icon('window')}</button>${isOpen ? html`<div class="popover look-card">${look.draw((loaded) => loaded.lookChoice())}</div>` : nothing}</span>`;
}

/** The place stands in the address, for a reload and for others; a folder that is not there, or no longer for this person, gives way to today. */
function keepInAddress(state) {
  const [{ kind, id }, { n_all }, folder] = [state.place.value, state.found.value, state.folder.value];
  if (kind === 'folder' && n_all > 0 && !folder) queueMicrotask(() => state.show({ place: { kind: 'today', id: '' } }));
  else if (location.pathname === '/' && location.search !== new URL(addressOfPlace({ kind, id }), location.href).search)
    history.replaceState(history.state, '', addressOfPlace({ kind, id }));
}

/** "/" anywhere but in a text goes to the search. */
function listenForSearch(host) {
  const press = (event) => {
    const isPlain = event.key === '/' && !event.ctrlKey && !event.metaKey && !event.altKey;
    if (!isPlain || event.target.matches?.('input, textarea, select') || document.querySelector('dialog[open]')) return;
    event.preventDefault();
    host.querySelector('.search input')?.focus();
  };
  addEventListener('keydown', press);
  return () => removeEventListener('keydown', press);
}

const reveal = (host, plan) => host.querySelector(`[data-plan="${CSS.escape(plan)}"]`)?.scrollIntoView({ block: 'nearest' });

const page = (state, uploads, meetings, world) => {
  const { enter, ownName, session } = world;
  const isToday = state.place.value.kind === 'today';
  return html`<div class="start">
  <header class="banner">${brand()}
    <label class="search" data-keys="/">${icon('search')}<input type="search" placeholder=${say.find} aria-label=${say.find} .value=${state.search.value} @input=${(event) => state.show({ search: event.target.value })}><kbd aria-hidden="true">/</kbd></label><span class="grow"></span>
    ${uploadButton(uploads, state.version.value?.max_upload_bytes)}${join(uploads.popover, enter)}${lookButton(uploads.popover)}${session.value?.who() ?? nameButton(state, ownName)}</header>
  ${places(state, meetings)}
  <main>${notices(state)}${ownName.isFixed.value ? nothing : askName(ownName)}${isToday ? meetingsToday(meetings, { hasGuests: Boolean(session.value?.facts.value.guest_links) }) : nothing}${planList(state, uploads, world)}${isToday ? roomsList(state, ownName) : nothing}</main>
  <aside class="load-report" aria-label=${say.aside}><div class="found">${report(state)}</div></aside>
  <footer class="status">${serverStatus(state)}<span class="grow"></span><b class="research">${say.research}</b></footer>
  ${deleteDialog(state, ownName)}</div>`;
};

/** Notices about the server, not about one plan. */
const notices = (state) => html`${
  state.version.value?.open_to_everybody
    ? html`<div class="notice bad open-door" role="note">${icon('error')}<div><b>${say.openDoor}</b><p>${say.openDoorIs}</p></div></div>`
    : nothing
}${
  state.error.value
    ? html`<div class="notice bad" role="alert">${icon('error')}<div>
    <b>${state.error.value}</b><p>${say.tryingAgain}</p></div></div>`
    : nothing
}
  ${
    state.notice.value
      ? html`<div class="notice" role="alert">${icon('warning')}<div><b>${say.full}</b>
    <p>${say.fullIs({ why: `${state.notice.value[0].toUpperCase()}${state.notice.value.slice(1)}` })}</p></div>
    <button class="icon-button small" aria-label=${say.dismiss} @click=${() => {
      state.notice.value = '';
    }}>${icon('close', 12)}</button></div>`
      : nothing
  }`;

function join(popover, enter) {
  const isOpen = popover.value === 'join';
  const go = (event) => {
    event.preventDefault();
    const field = event.target.elements.room;
    // a whole link is accepted as well as the id in it
    const { place, id, plan, link } = roomOf(field.value);
    field.setCustomValidity(place === 'rooms' ? '' : say.noRoomId);
    if (field.reportValidity()) enter(id, plan, link);
  };
  return html`<span class="anchor"><button aria-expanded=${isOpen} @click=${() => {
    popover.value = isOpen ? '' : 'join';
  }}>${icon('people')}<span>${say.joinRoom}</span></button>
    ${
      isOpen
        ? html`<form class="popover invite" @submit=${go}>
      <label for="join-id">${say.roomIdOrLink}</label><div class="pair">
        <input id="join-id" name="room" autocomplete="off" @input=${(event) => event.target.setCustomValidity('')}>
        <button class="primary">${say.join}</button></div></form>`
        : nothing
    }</span>`;
}

function summaryOf(found) {
  const summary = reportSummary(found);
  return found.loadMs === null ? summary : say.loadedIn({ summary, time: seconds(found.loadMs) });
}

function report(state) {
  const plan = state.plans.value?.find((other) => other.id === state.chosen.value);
  if (!plan) return html`<header><h2>${say.loadReport}</h2></header><p class="empty">${say.choosePlan}</p>`;
  const found = state.report.value?.plan === plan.id ? state.report.value : null;
  const refusal = refusalOf(state, plan);
  return html`<header><h2>${say.loadReport}</h2><code>${plan.id}</code></header>
    ${found ? html`<p class="note">${summaryOf(found)}</p>` : nothing}
    ${plan.note ? html`<p class="plan-note">${plan.note}</p>` : nothing}
    ${
      found
        ? reportLines(found)
        : refusal
          ? html`<ul class="report"><li><span class="err">${icon('error')}</span><div><p><b class="err">${say.refused}</b></p>
            <p>${refusal}</p><p class="place">${say.nothingLoaded}</p></div></li></ul>`
          : html`<p class="empty">${say.notOpened}</p>`
    }`;
}

function serverStatus(state) {
  if (state.error.value) return html`<span class="badge disconnected">${icon('disconnected', 12)}<span>${say.noAnswer}</span></span>`;
  const version = state.version.value;
  if (!version) return nothing;
  const gl = version.gl;
  return html`<span class="badge live">${icon('ready', 12)}<span>${say.serverReady}</span></span><span class="dim wide">${[gl?.back_end, gl?.renderer].filter(Boolean).join(', ')}</span><span class="dim wide">Beamroom ${version.version}</span>`;
}
