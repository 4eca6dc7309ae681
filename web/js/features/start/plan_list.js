// The list of plans on the start page: thumbnail, parts, size, state, and the buttons of each; folders that are no plans.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { isOfServer } from '../../room/plans.js';
import { bytes, count, number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { roving } from '../../parts/roving.js';
import { uploadRows } from './upload.js';

const filters = [
  ['all', 'All'],
  ['ready', 'Ready'],
  ['warnings', 'With warnings'],
];

export function planList(state, uploads, thumbnails) {
  const isKnown = state.plans.value !== null;
  const shown = state.shown.value;
  const n = (state.plans.value?.length ?? 0) - state.folders.value.length;
  return html`<div class="list-head"><h1>Plans</h1><span class="dim">${isKnown ? count(n, 'plan') : 'Looking for plans'}</span><span class="grow"></span>
      <div class="segment" role="radiogroup" aria-label="Which plans" @keydown=${roving}>${filters.map(
        ([id, name]) => html`<button role="radio" aria-checked=${state.filter.value === id} tabindex=${state.filter.value === id ? 0 : -1}
        class=${classMap({ on: state.filter.value === id })} @click=${() => {
          state.filter.value = id;
        }}>${name}</button>`,
      )}</div></div>
    <div class="columns" aria-hidden="true"><span></span><span>Plan</span><span>Parts</span><span class="end">Size</span><span>State</span></div>
    <ul class="plans" aria-label="Plans">${uploadRows(uploads)}${repeat(
      shown,
      (plan) => plan.id,
      (plan) => row(state, thumbnails, plan),
    )}</ul>
    ${isKnown && !shown.length ? html`<p class="empty">${n ? 'No plan fits the search and the filter.' : 'No plans here. Drop one on this page; the server also looks in the folders given with --plans.'}</p>` : nothing}
    ${folders(state.folders.value)}`;
}

const folders = (list) =>
  list.length
    ? html`<details class="folders"><summary>${count(list.length, 'folder')} ${list.length === 1 ? 'is not a plan' : 'are not plans'}</summary>
  <ul>${list.map(({ id, reason }) => html`<li><code>${id}</code><span>${reason}</span></li>`)}</ul></details>`
    : nothing;

/** True for a plan that could not be loaded for want of a place on the server. */
const isWaiting = (plan) => plan.state === 'failed' && isOfServer(plan.problem);

/** Why the plan cannot be opened, if known. */
export const refusalOf = (state, plan) =>
  state.refusals.value[plan.id] || (['failed', 'unreadable'].includes(plan.state) && !isWaiting(plan) ? plan.reason : '');

function row(state, thumbnails, plan) {
  const job = state.jobs.value[plan.id];
  const refusal = refusalOf(state, plan);
  const isChosen = state.chosen.value === plan.id;
  return html`<li class=${classMap({ plan: true, chosen: isChosen })} data-plan=${plan.id} @click=${() => state.choose(plan.id)}>
    <div class="plan-row">${thumbnail(thumbnails.of(plan), refusal)}
      <div class="title"><button class="as-text" aria-pressed=${isChosen} title="Show its load report" @click=${() => state.choose(plan.id)}>${plan.name}</button>${plan.is_phantom ? html`<span class="tag phantom">PHANTOM</span>` : nothing}<code>${plan.id}</code></div>
      <div class="parts">${(plan.parts ?? []).map((part) => html`<span class="tag">${part}</span>`)}</div>
      <div class="end size">${bytes(plan.n_bytes)}</div><div class="plan-state">${stateWords(plan, job, refusal)}</div>
      <div class="end buttons-of">${action(state, plan, job, isChosen)}</div></div>
    ${job ? progress(job) : nothing}
    ${refusal && !job ? html`<div class="refusal">${icon('error')}<div><p>${refusal}</p><p class="place">Nothing was loaded.</p></div></div>` : nothing}</li>`;
}

const thumbnail = (url, refusal) =>
  html`<span class="thumb">${url ? html`<img src=${url} alt="" width="96" height="58">` : icon(refusal ? 'error' : 'image')}</span>`;

function stateWords(plan, job, refusal) {
  if (job || ['loading', 'starting', 'restarting'].includes(plan.state)) return html`<b>Loading</b>`;
  if (refusal) return html`<span class="err">${icon('error')} Refused</span>`;
  if (isWaiting(plan)) return html`<span class="warn" title=${plan.reason}>${icon('stale')} Waiting for a place</span>`;
  if (plan.state !== 'ready') return html`<span class="dim">Not loaded</span>`;
  return html`<span class="ok">${icon('check')} Ready</span>${plan.n_warnings ? html`<span class="warn">${icon('warning')} ${count(plan.n_warnings, 'warning')}</span>` : nothing}`;
}

function action(state, plan, job, isChosen) {
  const act = (run) => (event) => {
    event.stopPropagation();
    run(plan.id);
  };
  if (job)
    return html`<button ?disabled=${!job.id} aria-label=${`Cancel loading ${plan.name}`} @click=${act((id) => state.cancel(id))}>${icon('close')}<span>Cancel</span></button>`;
  const remove = plan.uploaded
    ? html`<button class="icon-button" title="Delete this uploaded plan" aria-label=${`Delete ${plan.name}`} @click=${act((id) => state.askToRemove(id))}>${icon('trash')}</button>`
    : nothing;
  if (plan.state === 'unreadable') return remove;
  const word = plan.state === 'failed' ? 'Try again' : 'Open';
  return html`${remove}<button class=${classMap({ primary: isChosen })} aria-label=${`${word} ${plan.name}`} @click=${act((id) => state.open(id))}>${word}</button>`;
}

const progress = (
  job,
) => html`<div class="progress"><i class="bar" role="progressbar" aria-label="Loading" aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(job.percent ?? 0)}
  ${variables({ '--fill': `${job.percent ?? 0}%` })}></i><b>${number(job.percent ?? 0)} %</b><span class="phase">${icon('phase')} ${job.phase || 'Waiting'}</span></div>`;
