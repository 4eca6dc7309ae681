// The inspector: values at the crosshair, what was selected last, the plan. At the right, or in a sheet.
import { html, nothing } from '../../lib/lit-html.js';
import { repeat } from '../../lib/directives/repeat.js';
import { features } from '../features/index.js';
import { icon } from '../parts/icons.js';
import { planTab } from './plan_tab.js';
import { probe } from './probe.js';
import { roving } from '../parts/roving.js';
import { selection } from './selection.js';
import { say } from './words.js';

/** @type {import('../features/index.js').Tab[]} */
const own = [
  { id: 'probe', name: say.probe, draw: probe },
  { id: 'selection', name: say.selection, draw: selection },
  { id: 'plan', name: say.plan, draw: planTab },
];

/** In a sheet, which has the place of the drawer, with the tabs that stand only there. */
function tabsOf(plan, isSheet) {
  const more = features.flatMap(({ tabs = [] }) => tabs);
  const [first, ...rest] = [...own, ...more.filter(({ inSheet }) => !inSheet)];
  return [first, ...more.filter(({ inSheet }) => isSheet && inSheet?.(plan)), ...rest];
}

export function inspector(world) {
  const { room, ui } = world;
  const { inspector: place, sheet } = ui.arrangement.value;
  const isSheet = sheet === 'inspector';
  if (!place && !isSheet) return nothing;
  if (place === 'folded')
    return html`<button class="icon-button unfold" title=${say.showInspector} aria-label=${say.showInspector} @click=${() => {
      ui.isInspectorOpen.value = true;
    }}>${icon('panel')}</button>`;
  const shown = tabsOf(room.plan.value, isSheet);
  const { id: tab, draw } = shown.find(({ id }) => id === ui.tab.value) ?? shown[0];
  const fold = () => {
    if (isSheet) ui.sheet.value = '';
    else ui.isInspectorOpen.value = false;
  };
  const { kind, id: of } = ui.selection.value;
  return html`${isSheet ? html`<i class="grip"></i>` : nothing}<div class="tabs"><div role="tablist" aria-label=${say.inspector} @keydown=${roving}>
      ${shown.map(
        ({
          id,
          name,
          count,
        }) => html`<button role="tab" id=${`tab-${id}`} aria-selected=${tab === id} aria-controls="tab-panel" tabindex=${tab === id ? 0 : -1}
        @click=${() => {
          ui.tab.value = id;
        }}>${name}${count?.(world) ? html` <span class="dim">${count(world)}</span>` : nothing}</button>`,
      )}</div><span class="grow"></span>
      <button class="icon-button" title=${isSheet ? say.close : say.fold} aria-label=${isSheet ? say.closeSheet : say.foldInspector} @click=${fold}>${icon(isSheet ? 'chevronDown' : 'chevronRight')}</button></div>
    ${repeat(
      [tab === 'selection' ? `${kind} ${of}` : tab],
      (key) => key,
      () => html`<div class="scroll" role="tabpanel" id="tab-panel" tabindex="0" aria-labelledby=${`tab-${tab}`}>
      ${room.plan.value && room.scene.value ? draw(world) : html`<p class="empty">${say.loading}</p>`}</div>`,
    )}`;
}
