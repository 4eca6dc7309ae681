// The tool bar: tool of the left button, layout of the panes, reset, snapshot.
import { html } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { icon } from './icons.js';
import { undoButtons } from './undo_buttons.js';
import { roomChip } from './room_chip.js';
import { snapshotMenu } from './snapshots.js';

const tools = [
  ['crosshair', 'Crosshair', 'Crosshair in slices, turn in 3-D'],
  ['window', 'Window', 'Window and level by dragging in a slice (W)'],
  ['pan', 'Pan', 'Move the picture (middle button, Shift)'],
  ['zoom', 'Zoom', 'Zoom (right button, Z)'],
];
const layouts = [
  ['2x2', 'grid', 'Four panes'],
  ['1+3', 'oneThree', 'One large, three small'],
  ['single', 'single', 'One pane'],
];

/** Makes a row of buttons one tab stop, inside which the arrow keys move. */
export function roving(event) {
  const by = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!by) return;
  const buttons = [...event.currentTarget.querySelectorAll('button:not([disabled])')];
  const next = buttons[(buttons.indexOf(event.target) + by + buttons.length) % buttons.length];
  next?.focus();
  if (event.currentTarget.getAttribute('role') !== 'toolbar') next?.click();
  event.preventDefault();
}

export function toolStrip(world) {
  const { room, ui, panes } = world;
  const active = panes()[ui.active.value - 1];
  const setLayout = (layout) => {
    ui.maximised.value = 0;
    ui.layout.value = layout;
  };
  return html`<div class="tools" role="toolbar" aria-label="Tools" @keydown=${roving}>
    ${tools.map(([id, name, title]) => html`<button class=${classMap({ tool: true, on: ui.tool.value === id })} title=${title} aria-pressed=${ui.tool.value === id}
      aria-label=${name} tabindex=${ui.tool.value === id ? 0 : -1} @click=${() => { ui.tool.value = id; }}>${icon(id)}<span class="word">${name}</span></button>`)}
    <i class="rule"></i>
    ${layouts.map(([id, picture, name]) => html`<button class=${classMap({ tool: true, plain: true, on: !ui.maximised.value && ui.layout.value === id })} title=${name} aria-label=${name}
      aria-pressed=${ui.layout.value === id} tabindex="-1" @click=${() => setLayout(id)}>${icon(picture)}</button>`)}
    <span class="grow"></span>
    ${roomChip({ room, ui }, 'strip')}
    ${undoButtons(world)}
    <button class="tool plain" tabindex="-1" title="Reset this view (R)" aria-label="Reset view" ?disabled=${!room.canChange.value} @click=${(event) => active.actions.reset(event.timeStamp)}>${icon('reset')}</button>
    ${snapshotMenu(world)}
  </div>`;
}
