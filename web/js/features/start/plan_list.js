// The list of plans on the start page: thumbnail, parts, size, state, and the buttons of each; folders that are no plans.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { isOfServer } from '../../room/plans.js';
import { bytes, number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { roving } from '../../parts/roving.js';
import { say } from './later_words.js';
import { uploadRows } from './upload.js';

const filters = [
  ['all', say.all],
  ['ready', say.ready],
  ['warnings', say.withWarnings],
];

export function planList(state, uploads, thumbnails) {
  const isKnown = state.plans.value !== null;
  const shown = state.shown.value;
  const n = (state.plans.value?.length ?? 0) - state.folders.value.length;
  return html`<div class="list-head"><h1>${say.plans}</h1>
      <span class="dim">${isKnown ? say.nPlans({ count: number(n), n }) : say.looking}</span><span class="grow"></span>
      <div class="segment" role="radiogroup" aria-label=${say.which} @keydown=${roving}>${filters.map(
        ([id, name]) => html`<button role="radio" aria-checked=${state.filter.value === id} tabindex=${state.filter.value === id ? 0 : -1}
        class=${classMap({ on: state.filter.value === id })} @click=${() => {
          state.filter.value = id;
        }}>${name}</button>`,
      )}</div></div>
    <div class="columns" aria-hidden="true"><span></span><span>${say.plan}</span><span>${say.parts}</span><span class="end">${say.size}</span><span>${say.state}</span></div>
    <ul class="plans" aria-label=${say.plans}>${uploadRows(uploads)}${repeat(
      shown,
      (plan) => plan.id,
      (plan) => row(state, thumbnails, plan),
    )}</ul>
    ${isKnown && !shown.length ? html`<p class="empty">${n ? say.noneFits : say.none}</p>` : nothing}
    ${folders(state.folders.value)}`;
}

const folders = (list) =>
  list.length
    ? html`<details class="folders"><summary>${say.notPlans({ count: number(list.length), n: list.length })}</summary>
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
      <div class="title"><button class="as-text" aria-pressed=${isChosen} title=${say.showReport}
        @click=${() => state.choose(plan.id)}>${plan.name}</button>${plan.is_phantom ? html`<span class="tag phantom">${say.phantom}</span>` : nothing}<code>${plan.id}</code></div>
      <div class="parts">${(plan.parts ?? []).map((part) => html`<span class="tag">${part}</span>`)}</div>
      <div class="end size">${bytes(plan.n_bytes)}</div><div class="plan-state">${stateWords(plan, job, refusal)}</div>
      <div class="end buttons-of">${action(state, plan, job, isChosen)}</div></div>
    ${job ? progress(job) : nothing}
    ${refusal && !job ? html`<div class="refusal">${icon('error')}<div><p>${refusal}</p><p class="place">${say.nothingLoaded}</p></div></div>` : nothing}</li>`;
}

const thumbnail = (url, refusal) =>
  html`<span class="thumb">${url ? html`<img src=${url} alt="" width="96" height="58">` : icon(refusal ? 'error' : 'image')}</span>`;

function stateWords(plan, job, refusal) {
  if (job || ['loading', 'starting', 'restarting'].includes(plan.state)) return html`<b>${say.loading}</b>`;
  if (refusal) return html`<span class="err">${icon('error')} ${say.refused}</span>`;
  if (isWaiting(plan)) return html`<span class="warn" title=${plan.reason}>${icon('stale')} ${say.waitingForPlace}</span>`;
  if (plan.state !== 'ready') return html`<span class="dim">${say.notLoaded}</span>`;
  const n = plan.n_warnings;
  const warnings = () => html`<span class="warn">${icon('warning')} ${say.nWarnings({ count: number(n), n })}</span>`;
  return html`<span class="ok">${icon('check')} ${say.ready}</span>${n ? warnings() : nothing}`;
}

function action(state, plan, job, isChosen) {
  const act = (run) => (event) => {
    event.stopPropagation();
    run(plan.id);
  };
  if (job)
    return html`<button ?disabled=${!job.id} aria-label=${say.cancelLoading({ plan: plan.name })}
      @click=${act((id) => state.cancel(id))}>${icon('close')}<span>${say.cancel}</span></button>`;
  const remove = plan.uploaded
    ? html`<button class="icon-button" title=${say.deleteUploaded} aria-label=${say.deletePlan({ plan: plan.name })}
        @click=${act((id) => state.askToRemove(id))}>${icon('trash')}</button>`
    : nothing;
  if (plan.state === 'unreadable') return remove;
  const [word, ofPlan] = plan.state === 'failed' ? [say.again, say.againPlan] : [say.open, say.openPlan];
  return html`${remove}<button class=${classMap({ primary: isChosen })} aria-label=${ofPlan({ plan: plan.name })}
    @click=${act((id) => state.open(id))}>${word}</button>`;
}

const progress = (
  job,
) => html`<div class="progress"><i class="bar" role="progressbar" aria-label=${say.loading} aria-valuemin="0" aria-valuemax="100" aria-valuenow=${Math.round(job.percent ?? 0)}
  ${variables({ '--fill': `${job.percent ?? 0}%` })}></i><b>${number(job.percent ?? 0)} %</b><span class="phase">${icon('phase')} ${job.phase || say.waiting}</span></div>`;
