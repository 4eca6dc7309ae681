// The tool strip above the panes or, for fingers, the dock below them: tool of the left button, layout of the panes, what acts on the active pane.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { crosshair } from '../room/plan.js';
import { features, partsOf } from '../features/index.js';
import { number } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { layoutButtons, panesMenu } from '../pane/pane_layouts.js';
import { roving } from '../parts/roving.js';
import { roomChip } from './room_chip.js';
import { sectionsOf } from './sections.js';
import { undoButtons } from './undo_buttons.js';
import { say } from './words.js';

const tools = [
  ['crosshair', say.crosshair, say.crosshairIs],
  ['window', say.window, say.windowIs, 'window'],
  ['pan', say.pan, say.panIs],
  ['zoom', say.zoom, say.zoomIs, 'zoom'],
  ['measure', say.measure, say.measureIs, 'measure'],
];

/** With the tool comes the choice of what is measured. */
function choose(ui, id) {
  ui.tool.value = id;
  if (id === 'measure') ui.choose('measures');
}

const tool = (
  ui,
  [id, name, title, command],
) => html`<button class=${classMap({ tool: true, on: ui.tool.value === id })} title=${command ? ui.keys.tip(title, command) : title} aria-pressed=${ui.tool.value === id}
  aria-label=${name} tabindex=${id === 'crosshair' ? 0 : -1} @click=${() => choose(ui, id)}>${icon(id)}<span class="word">${name}</span></button>`;

const stripOf = (place, ...args) => features.map(({ strip }) => strip?.[place]?.(...args));
const hasDrawer = (plan) => features.some(({ drawer }) => drawer?.has(plan));

export function toolStrip(world) {
  return world.ui.isTouch.value ? dock(world) : strip(world);
}

function strip(world) {
  const { ui } = world;
  const isPicture = ui.tab.value === 'selection' && ui.selection.value.kind === 'view' && ui.isInspectorOpen.value;
  return html`<div class="tools" role="toolbar" aria-label=${say.tools} @keydown=${roving}>
    ${tools.map((row) => tool(ui, row))}${stripOf('mode', world)}
    <i class="rule"></i>
    ${layoutButtons(world)}${panesMenu(world)}
    <i class="rule"></i>
    ${stripOf('show', world)}<button class=${classMap({ tool: true, plain: true, on: isPicture })} tabindex="-1" title=${say.pictureIs} aria-label=${say.picture} aria-pressed=${isPicture} @click=${() => ui.choose('view')}>${icon('cube')}</button>
    ${hasDrawer(world.room.plan.value) ? html`<button class=${classMap({ tool: true, plain: true, on: ui.isDrawerOpen.value })} tabindex="-1" title=${ui.keys.tip(say.plotsIs, 'drawer')} aria-label=${say.plots} aria-pressed=${ui.isDrawerOpen.value} @click=${() => ui.toggleDrawer()}>${icon('drawer')}</button>` : nothing}
    <span class="grow"></span>
    ${stripOf('meet', world)}${roomChip(world, 'strip')}
    ${stripEnd(world)}
  </div>`;
}

/** The right end of the strip, of the banner on touch screens: what is the room's, and what acts on the active pane. */
export function stripEnd(world) {
  const { room, ui, panes } = world;
  const active = panes()[ui.active.value - 1];
  return html`
    ${undoButtons(world)}
    <button class="tool plain" tabindex="-1" title=${ui.keys.tip(say.resetIs, 'reset')} aria-label=${say.reset} ?disabled=${!room.canChange.value} @click=${(event) => active.actions.reset(event.timeStamp)}>${icon('reset')}</button>
    ${stripOf('end', world)}`;
}

/** Buttons 74 x 56; at the right the region and the position at the crosshair. */
function dock(world) {
  const { room, ui, probed } = world;
  const { size, sheet } = ui.arrangement.value;
  const scene = room.scene.value;
  const plan = room.plan.value;
  const region = plan?.regions.find(({ id }) => id === probed.value.result?.regions[0]);
  const point = scene && crosshair(scene);
  const sheetTabs = features.flatMap(({ tabs = [] }) => tabs).filter(({ inSheet }) => inSheet);
  const isTab = (tab) => sheet === 'inspector' && ui.tab.value === tab;
  const open = (tab) => () => {
    if (isTab(tab)) ui.sheet.value = '';
    else ui.showTab(tab);
  };
  const button = (picture, name, isOn, act) =>
    html`<button class=${classMap({ tool: true, on: isOn })} tabindex="-1" aria-expanded=${isOn} @click=${act}>${icon(picture, 20)}<span class="word">${name}</span></button>`;
  return html`<div class="tools dock" role="toolbar" aria-label=${say.tools} @keydown=${roving}>
    ${tools.filter(([id]) => (size !== 'phone' && !plan?.doses.length) || ['crosshair', 'window', 'measure'].includes(id)).map((row) => tool(ui, row))}
    ${size === 'phone' ? nothing : html`<i class="rule"></i>`}
    ${sectionsOf(plan, scene).length ? button('tree', say.parts, sheet === 'tree', () => ui.openSheet('tree')) : nothing}
    ${stripOf('show', world, size)}${button('target', say.probe, isTab('probe'), open('probe'))}
    ${size === 'phone' ? nothing : sheetTabs.filter(({ inSheet }) => inSheet(plan)).map(({ id, name }) => button('curve', name, isTab(id), open(id)))}
    ${button('panel', say.selection, isTab('selection'), open('selection'))}
    ${
      size === 'phone'
        ? nothing
        : html`${button('cube', '3-D', isTab('selection') && ui.selection.value.kind === 'view', () => ui.choose('view'))}${panesMenu(world, true)}${stripOf('meet', world, true)}
      <span class="grow"></span><p class="at-crosshair"><b>${[region?.name, ...partsOf('here', world)].filter(Boolean).join(' · ')}</b><span>${point ? `L ${number(point[0], 1)}  P ${number(point[1], 1)}  S ${number(point[2], 1)} mm` : ''}</span></p>`
    }
  </div>`;
}
