// The list of plans on the start page: its head with what was found, its order, the pages of 50, and folders that are no plans.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { pagePlans } from '../../room/plans.js';
import { number } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { roving } from '../../parts/roving.js';
import { say } from './later_words.js';
import { planRow } from './plan_row.js';
import { uploadRows } from './upload.js';

const orders = [
  ['used', say.lastUsed],
  ['name', say.byName],
  ['approved', say.byApproval],
];

/** "4 of 412"; with the text and the place where there is one. */
function foundWords(state) {
  if (state.plans.value === null) return say.looking;
  const { total, of } = state.found.value;
  const [text, { kind }] = [state.search.value.trim(), state.place.value];
  const place = { folder: state.folder.value?.name, uploads: say.uploads }[kind] ?? '';
  const where = text ? (place ? say.textIn({ text, place }) : say.text({ text })) : place ? say.place({ place }) : '';
  return `${where}${say.nOf({ total: number(total), of: number(of) })}`;
}

const order = (state) =>
  html`<div class="segment" role="radiogroup" aria-label=${say.order} @keydown=${roving}>${orders.map(
    ([id, name]) => html`<button role="radio" aria-checked=${state.sort.value === id} tabindex=${state.sort.value === id ? 0 : -1}
    class=${classMap({ on: state.sort.value === id })} @click=${() => state.show({ sort: id })}>${name}</button>`,
  )}</div>`;

/** Which of the plans that were found are shown, and the way to others. */
function pages(state) {
  const [{ total, next }, before, shown] = [state.found.value, state.cursors.value.length - 1, state.plans.value?.length ?? 0];
  if (!next && !before) return nothing;
  const first = before * pagePlans + 1;
  return html`<nav class="pages" aria-label=${say.pages}><button ?disabled=${!before} @click=${() => state.turn(false)}>${icon('undo')}<span>${say.pageBefore}</span></button>
    <span class="dim">${say.shownOf({ first: number(first), last: number(first + shown - 1), total: number(total) })}</span>
    <button ?disabled=${!next} @click=${() => state.turn(true)}>${say.pageNext}</button></nav>`;
}

const noPlans = (list) =>
  html`<ul class="no-plans">${list.map(({ id, reason }) => html`<li><code>${id}</code><span>${reason}</span></li>`)}</ul>`;

export function planList(state, uploads, world) {
  const list = state.plans.value ?? [];
  const isOfPlans = state.place.value.kind !== 'no-plans';
  const empty = state.found.value.of || state.search.value ? say.noneFits : say.none;
  return html`<section class="plan-list" aria-busy=${state.isOld.value}><div class="list-head"><h1>${isOfPlans ? say.plans : say.noPlans}</h1>
      <span class="dim" role="status">${foundWords(state)}</span><span class="grow"></span>${isOfPlans ? order(state) : nothing}</div>
    ${
      isOfPlans
        ? html`<ul class="plans" aria-label=${say.plans}>${uploadRows(uploads)}${repeat(
            list,
            (plan) => plan.id,
            (plan) => planRow(state, plan, world),
          )}</ul>`
        : noPlans(list)
    }
    ${state.plans.value !== null && !list.length ? html`<p class="empty">${empty}</p>` : nothing}${pages(state)}</section>`;
}
