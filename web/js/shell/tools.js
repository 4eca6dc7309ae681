// The tool strip above the panes or, for fingers, the dock below them: tool of the left button, layout of the panes, what acts on the active pane.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { crosshair } from '../room/plan.js';
import { number } from '../parts/format.js';
import { ofBeams } from '../features/beams/feature.js';
import { hasCharts } from '../features/dose/plots/chart_loader.js';
import { ofDose } from '../features/dose/feature.js';
import { icon } from '../parts/icons.js';
import { layoutButtons, panesMenu } from '../pane/pane_layouts.js';
import { pointTools } from '../features/pointers/feature.js';
import { roving } from '../parts/roving.js';
import { roomChip } from './room_chip.js';
import { sectionsOf } from './sections.js';
import { snapshotMenu } from '../features/report/snapshots.js';
import { undoButtons } from './undo_buttons.js';

const tools = [
  ['crosshair', 'Crosshair', 'Crosshair in slices, turn in 3-D'],
  ['window', 'Window', 'Window and level by dragging in a slice (W)'],
  ['pan', 'Pan', 'Move the picture (middle button, Shift)'],
  ['zoom', 'Zoom', 'Zoom (right button, Z)'],
  ['measure', 'Measure', 'Distance, angle, polyline or ellipse in a slice (M)'],
];

/** With the tool comes the choice of what is measured. */
function choose(ui, id) {
  ui.tool.value = id;
  if (id === 'measure') ui.choose('measures');
}

const tool = (
  ui,
  [id, name, title],
) => html`<button class=${classMap({ tool: true, on: ui.tool.value === id })} title=${title} aria-pressed=${ui.tool.value === id}
  aria-label=${name} tabindex=${id === 'crosshair' ? 0 : -1} @click=${() => choose(ui, id)}>${icon(id)}<span class="word">${name}</span></button>`;

export function toolStrip(world) {
  return world.ui.isTouch.value ? dock(world) : strip(world);
}

function strip(world) {
  const { ui } = world;
  const isPicture = ui.tab.value === 'selection' && ui.selection.value.kind === 'view' && ui.isInspectorOpen.value;
  return html`<div class="tools" role="toolbar" aria-label="Tools" @keydown=${roving}>
    ${tools.map((row) => tool(ui, row))}${ofBeams(world.room)?.moveTool(world)}
    <i class="rule"></i>
    ${layoutButtons(world)}${panesMenu(world)}
    <i class="rule"></i>
    ${doseTools(world)}<button class=${classMap({ tool: true, plain: true, on: isPicture })} tabindex="-1" title="Projection, translucency and slices of the 3-D picture" aria-label="3-D picture" aria-pressed=${isPicture} @click=${() => ui.choose('view')}>${icon('cube')}</button>
    ${hasCharts(world.room.plan.value) ? html`<button class=${classMap({ tool: true, plain: true, on: ui.isDrawerOpen.value })} tabindex="-1" title="Plots of dose: histograms, depth profile (V)" aria-label="Plots of dose" aria-pressed=${ui.isDrawerOpen.value} @click=${() => ui.toggleDrawer()}>${icon('drawer')}</button>` : nothing}
    <span class="grow"></span>
    ${pointTools(world)}${roomChip(world, 'strip')}
    ${stripEnd(world)}
  </div>`;
}

/** The right end of the strip, of the banner on touch screens: what is the room's, and what acts on the active pane. */
export function stripEnd(world) {
  const { room, ui, panes } = world;
  const active = panes()[ui.active.value - 1];
  return html`
    ${undoButtons(world)}
    <button class="tool plain" tabindex="-1" title="Reset this view (R)" aria-label="Reset view" ?disabled=${!room.canChange.value} @click=${(event) => active.actions.reset(event.timeStamp)}>${icon('reset')}</button>
    ${snapshotMenu(world)}`;
}

/** Isodose lines and wash, where the plan has a dose. */
function doseTools({ room, ui }, size = '') {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan?.doses.length || !scene || size === 'phone') return nothing;
  const isDock = Boolean(size);
  return [
    ['lines', 'isodose', 'Isodose', 'Isodose lines (I)'],
    ['wash', 'wash', 'Wash', 'Wash of dose (D)'],
  ].map(([part, picture, word, title]) => {
    const { visible } = scene.dose[part];
    return html`<button class=${classMap({ tool: true, plain: !isDock, on: visible })} tabindex="-1" title=${title} aria-label=${word} aria-pressed=${visible} ?disabled=${!room.canChange.value}
      @click=${(event) => ofDose(room)?.toggleDose(room, ui, part, event.timeStamp)}>${icon(picture, isDock ? 20 : 16)}${isDock ? html`<span class="word">${word}</span>` : nothing}</button>`;
  });
}

/** Buttons 74 x 56; at the right the region and the position at the crosshair. */
function dock(world) {
  const { room, ui, probed } = world;
  const { size, sheet } = ui.arrangement.value;
  const scene = room.scene.value;
  const plan = room.plan.value;
  const region = plan?.regions.find(({ id }) => id === probed.value.result?.regions[0]);
  const point = scene && crosshair(scene);
  const isTab = (tab) => sheet === 'inspector' && ui.tab.value === tab;
  const open = (tab) => () => {
    if (isTab(tab)) ui.sheet.value = '';
    else ui.showTab(tab);
  };
  const button = (picture, name, isOn, act) =>
    html`<button class=${classMap({ tool: true, on: isOn })} tabindex="-1" aria-expanded=${isOn} @click=${act}>${icon(picture, 20)}<span class="word">${name}</span></button>`;
  return html`<div class="tools dock" role="toolbar" aria-label="Tools" @keydown=${roving}>
    ${tools.filter(([id]) => (size !== 'phone' && !plan?.doses.length) || ['crosshair', 'window', 'measure'].includes(id)).map((row) => tool(ui, row))}
    ${size === 'phone' ? nothing : html`<i class="rule"></i>`}
    ${sectionsOf(plan, scene).length ? button('tree', 'Parts', sheet === 'tree', () => ui.openSheet('tree')) : nothing}
    ${doseTools(world, size)}${button('target', 'Probe', isTab('probe'), open('probe'))}
    ${hasCharts(plan) && size !== 'phone' ? button('curve', 'DVH', isTab('dvh'), open('dvh')) : nothing}
    ${button('panel', 'Selection', isTab('selection'), open('selection'))}
    ${
      size === 'phone'
        ? nothing
        : html`${button('cube', '3-D', isTab('selection') && ui.selection.value.kind === 'view', () => ui.choose('view'))}${panesMenu(world, true)}${pointTools(world, true)}
      <span class="grow"></span><p class="at-crosshair"><b>${[region?.name, ofDose(room)?.doseHere(world)].filter(Boolean).join(' · ')}</b><span>${point ? `L ${number(point[0], 1)}  P ${number(point[1], 1)}  S ${number(point[2], 1)} mm` : ''}</span></p>`
    }
  </div>`;
}
