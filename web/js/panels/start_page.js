// The start page: the plans of this server, their state, and the way into a room.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { repeat } from '../../lib/directives/repeat.js';
import { effect } from '../../lib/signals-core.js';
import { reportSummary } from '../state/plan.js';
import { PlansState } from '../state/plans.js';
import { UploadsState } from '../state/uploads.js';
import { isId } from '../wire/check.js';
import { brand } from './banner.js';
import { bytes, count, number, seconds } from './format.js';
import { icon } from './icons.js';
import { mount, variables } from './mount.js';
import { reportLines } from './report.js';
import { roving } from './tools.js';
import { dropZone, listenDrops, uploadRows } from './upload.js';

const filters = [['all', 'All'], ['ready', 'Ready'], ['warnings', 'With warnings']];

/** @param {HTMLElement} host @param {object} world {api, clock, enter} @returns {() => void} leaves the page */
export function startPage(host, world) {
  const state = new PlansState(world);
  const uploads = new UploadsState({ ...world, arrived: (plan) => state.arrived(plan).then(() => reveal(host, plan)), limit: () => state.version.value?.max_upload_bytes ?? Infinity });
  const unmount = mount(host, () => page(state, uploads, world.enter));
  const unlisten = listenDrops(uploads);
  let newest = 0;
  const unscroll = effect(() => { // scrolls to the top, where a newly chosen upload asks for its name
    const { key = 0 } = uploads.rows.value.at(-1) ?? {};
    if (key > newest) queueMicrotask(() => {
      host.querySelector('main').scrollTo(0, 0);
      host.querySelector(`[data-upload="${key}"] input[name="name"]`)?.focus({ preventScroll: true });
    });
    newest = Math.max(newest, key);
  });
  state.start();
  return () => {
    state.stop();
    uploads.stop();
    unlisten();
    unscroll();
    unmount();
  };
}

const reveal = (host, plan) => host.querySelector(`[data-plan="${CSS.escape(plan)}"]`)?.scrollIntoView({ block: 'nearest' });

const page = (state, uploads, enter) => html`<div class="start">
  <header class="banner">${brand()}<span class="grow"></span>
    <label class="search">${icon('search')}<input type="search" placeholder="Find a plan" aria-label="Find a plan" .value=${state.search.value} @input=${(event) => { state.search.value = event.target.value; }}></label>
    ${join(state, enter)}</header>
  <main>${list(state, uploads)}</main>
  <aside class="load-report" aria-label="Load report"><div class="found">${report(state)}</div>${dropZone(uploads, state.version.value?.max_upload_bytes)}</aside>
  <footer class="status">${serverStatus(state)}<span class="grow"></span><b class="research">Research use. Not for diagnosis or treatment decisions.</b></footer></div>`;

function join(state, enter) {
  const go = (event) => {
    event.preventDefault();
    const field = event.target.elements.room;
    // a whole link is accepted as well as the id in it
    const id = field.value.trim().split('/').at(-1);
    field.setCustomValidity(isId(id) ? '' : 'A room is named by letters a to z, digits and -.');
    if (field.reportValidity()) enter(id);
  };
  return html`<span class="anchor"><button aria-expanded=${state.isJoining.value} @click=${() => { state.isJoining.value = !state.isJoining.value; }}>${icon('people')}<span>Join a room</span></button>
    ${state.isJoining.value ? html`<form class="popover invite" @submit=${go} @keydown=${(event) => { if (event.key === 'Escape') state.isJoining.value = false; }}>
      <label for="join-id">Room id or link</label><div class="pair"><input id="join-id" name="room" autocomplete="off" @input=${(event) => event.target.setCustomValidity('')}><button class="primary">Join</button></div></form>` : nothing}</span>`;
}

function list(state, uploads) {
  const plans = state.plans.value;
  const shown = state.shown.value;
  return html`<div class="list-head"><h1>Plans</h1><span class="dim">${plans ? count(plans.length, 'plan') : ''}</span><span class="grow"></span>
      <div class="segment" role="radiogroup" aria-label="Which plans" @keydown=${roving}>${filters.map(([id, name]) => html`<button role="radio" aria-checked=${state.filter.value === id} tabindex=${state.filter.value === id ? 0 : -1}
        class=${classMap({ on: state.filter.value === id })} @click=${() => { state.filter.value = id; }}>${name}</button>`)}</div></div>
    ${state.error.value ? html`<div class="refusal">${icon('error')}<div><b>${state.error.value}</b><p>Trying again every few seconds.</p></div></div>` : nothing}
    <div class="columns" aria-hidden="true"><span>Plan</span><span>Parts</span><span class="end">Size</span><span>State</span></div>
    <ul class="plans">${uploadRows(uploads)}${repeat(shown, (plan) => plan.id, (plan) => row(state, plan))}</ul>
    ${plans && !shown.length ? html`<p class="empty">${plans.length ? 'No plan fits the search and the filter.' : 'No plans here. Drop one on this page; the server also looks in the folders given with --plans.'}</p>` : nothing}`;
}

/** Why the plan cannot be opened, if known. */
const refusalOf = (state, plan) => state.refusals.value[plan.id] || (['failed', 'unreadable'].includes(plan.state) ? plan.reason : '');

function row(state, plan) {
  const job = state.jobs.value[plan.id];
  const refusal = refusalOf(state, plan);
  const isChosen = state.chosen.value === plan.id;
  return html`<li class=${classMap({ plan: true, chosen: isChosen })} data-plan=${plan.id} @click=${() => state.choose(plan.id)}>
    <div class="plan-row"><div class="title"><b>${plan.name}</b>${plan.is_phantom ? html`<span class="tag phantom">PHANTOM</span>` : nothing}<code>${plan.id}</code></div>
      <div class="parts">${(plan.parts ?? []).map((part) => html`<span class="tag">${part}</span>`)}</div>
      <div class="end">${bytes(plan.n_bytes)}</div><div class="plan-state">${stateWords(plan, job, refusal)}</div>
      <div class="end">${action(state, plan, job, isChosen)}</div></div>
    ${job ? progress(job) : nothing}
    ${refusal && !job ? html`<div class="refusal">${icon('error')}<div><p>${refusal}</p><p class="place">Nothing was loaded.</p></div></div>` : nothing}</li>`;
}

function stateWords(plan, job, refusal) {
  if (job || plan.state === 'loading') return html`<b>Loading</b>`;
  if (refusal) return html`<span class="err">${icon('error')} Refused</span>`;
  if (plan.state !== 'ready') return html`<span class="dim">Not loaded</span>`;
  return html`<span class="ok">${icon('check')} Ready</span>${plan.n_warnings ? html`<span class="warn">${icon('warning')} ${count(plan.n_warnings, 'warning')}</span>` : nothing}`;
}

function action(state, plan, job, isChosen) {
  const act = (run) => (event) => {
    event.stopPropagation();
    run(plan.id);
  };
  if (job) return html`<button ?disabled=${!job.id} @click=${act((id) => state.cancel(id))}>${icon('close')}<span>Cancel</span></button>`;
  if (state.deleting.value === plan.id)
    return html`<span class="really" role="group" aria-label=${`Delete ${plan.name} for good?`}><button class="danger" @click=${act((id) => state.remove(id))}>Delete for good</button><button @click=${act(() => { state.deleting.value = ''; })}>Keep</button></span>`;
  const remove = plan.uploaded ? html`<button class="icon-button" title="Delete this uploaded plan" aria-label=${`Delete ${plan.name}`} @click=${act((id) => { state.deleting.value = id; })}>${icon('trash')}</button>` : nothing;
  if (plan.state === 'unreadable') return remove;
  const word = plan.state === 'failed' ? 'Try again' : 'Open';
  return html`${remove}<button class=${classMap({ primary: isChosen })} aria-label=${`${word} ${plan.name}`} @click=${act((id) => state.open(id))}>${word}</button>`;
}

const progress = (job) => html`<div class="progress" role="progressbar" aria-label="Loading" aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(job.percent ?? 0)}>
  <i class="bar" ${variables({ '--fill': `${job.percent ?? 0}%` })}></i><b>${number(job.percent ?? 0)} %</b><span class="phase">${icon('phase')} ${job.phase || 'Waiting'}</span></div>`;

function report(state) {
  const plan = state.plans.value?.find((other) => other.id === state.chosen.value);
  if (!plan) return html`<header><h2>Load report</h2></header><p class="empty">Choose a plan to see what was noticed while loading it.</p>`;
  const found = state.report.value?.plan === plan.id ? state.report.value : null;
  const refusal = refusalOf(state, plan);
  return html`<header><h2>Load report</h2><code>${plan.id}</code></header>
    ${found ? html`<p class="note">${reportSummary(found)}${found.loadMs === null ? '' : `, loaded in ${seconds(found.loadMs)}`}</p>` : nothing}
    ${plan.note ? html`<p class="plan-note">${plan.note}</p>` : nothing}
    ${found ? reportLines(found) : refusal ? html`<ul class="report"><li><span class="err">${icon('error')}</span><div><p><b class="err">Refused</b></p><p>${refusal}</p><p class="place">Nothing was loaded.</p></div></li></ul>`
      : html`<p class="empty">The plan is not loaded. Open it to see what was noticed.</p>`}`;
}

function serverStatus(state) {
  if (state.error.value) return html`<span class="badge disconnected">${icon('disconnected', 12)}<span>Server does not answer</span></span>`;
  const version = state.version.value;
  if (!version) return nothing;
  const gl = version.gl;
  const n = (state.plans.value ?? []).filter((plan) => plan.state === 'ready').length;
  return html`<span class="badge live">${icon('ready', 12)}<span>Server ready</span></span><span>${count(n, 'renderer')} in use</span>
    <span class="dim wide">${[gl?.back_end, gl?.renderer].filter(Boolean).join(', ')}</span><span class="dim wide">Beamroom ${version.version}</span>`;
}
