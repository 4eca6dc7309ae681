// The inspector: values at the crosshair, what was selected last, the plan. At the right, or in a sheet.
import { html, nothing } from '../../lib/lit-html.js';
import { repeat } from '../../lib/directives/repeat.js';
import { hasCharts } from '../features/dose/plots/chart_loader.js';
import { icon } from '../parts/icons.js';
import { Lazy } from '../parts/lazy.js';
import { drawNotes } from '../features/notes/feature.js';
import { planTab } from './plan_tab.js';
import { probe } from './probe.js';
import { drawRecord } from '../features/record/feature.js';
import { roving } from '../parts/roving.js';

export const selected = new Lazy(() => import('./selection.js'));
const selection = (world) => selected.draw((module) => module.selection(world));
const tabs = [
  ['probe', 'Probe', probe],
  ['selection', 'Selection', selection],
  ['plan', 'Plan', planTab],
  ['notes', 'Notes', drawNotes],
  ['record', 'Record', drawRecord],
];

/** In a sheet, which has the place of the drawer. */
const dvhTab = ['dvh', 'DVH', (world) => world.charts.draw('sheet')];

export function inspector(world) {
  const { room, ui } = world;
  const { inspector: place, sheet } = ui.arrangement.value;
  const isSheet = sheet === 'inspector';
  if (!place && !isSheet) return nothing;
  if (place === 'folded')
    return html`<button class="icon-button unfold" title="Show the inspector" aria-label="Show the inspector" @click=${() => {
      ui.isInspectorOpen.value = true;
    }}>${icon('panel')}</button>`;
  const shown = isSheet && hasCharts(room.plan.value) ? [tabs[0], dvhTab, ...tabs.slice(1)] : tabs;
  const [tab, , content] = shown.find(([id]) => id === ui.tab.value) ?? tabs[0];
  const fold = () => {
    if (isSheet) ui.sheet.value = '';
    else ui.isInspectorOpen.value = false;
  };
  const { kind, id: of } = ui.selection.value;
  return html`${isSheet ? html`<i class="grip"></i>` : nothing}<div class="tabs"><div role="tablist" aria-label="Inspector" @keydown=${roving}>
      ${shown.map(
        ([
          id,
          name,
        ]) => html`<button role="tab" id=${`tab-${id}`} aria-selected=${tab === id} aria-controls="tab-panel" tabindex=${tab === id ? 0 : -1}
        @click=${() => {
          ui.tab.value = id;
        }}>${name}${id === 'notes' && room.items.nOpen.value ? html` <span class="dim">${room.items.nOpen.value}</span>` : nothing}</button>`,
      )}</div><span class="grow"></span>
      <button class="icon-button" title=${isSheet ? 'Close' : 'Fold'} aria-label=${isSheet ? 'Close the sheet' : 'Fold the inspector'} @click=${fold}>${icon(isSheet ? 'chevronDown' : 'chevronRight')}</button></div>
    ${repeat(
      [tab === 'selection' ? `${kind} ${of}` : tab],
      (key) => key,
      () => html`<div class="scroll" role="tabpanel" id="tab-panel" tabindex="0" aria-labelledby=${`tab-${tab}`}>
      ${room.plan.value && room.scene.value ? content(world) : html`<p class="empty">The plan is being loaded.</p>`}</div>`,
    )}`;
}
