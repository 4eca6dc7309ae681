// Shown over the page: toasts, the list of keys.
import { html, nothing } from '../../lib/lit-html.js';
import { repeat } from '../../lib/directives/repeat.js';
import { effect } from '../../lib/signals-core.js';
import { icon } from '../parts/icons.js';

const signs = { ok: 'check', warn: 'warning', err: 'error' };

export const toasts = ({ ui }) =>
  html`${repeat(
    ui.toasts.value,
    (toast) => toast.id,
    ({ id, kind, text, action }) => html`
  <div class="toast" role=${kind === 'err' ? 'alert' : 'status'}><span class=${kind}>${icon(signs[kind])}</span><span>${text}</span>
    ${
      action
        ? html`<button class="toast-act" @click=${() => {
            ui.dismiss(id);
            action.act();
          }}>${action.word}${action.keys ? html` <kbd>${action.keys}</kbd>` : nothing}</button>`
        : nothing
    }
    <button class="icon-button small" aria-label="Dismiss" @click=${() => ui.dismiss(id)}>${icon('close', 12)}</button><i></i></div>`,
  )}`;

const keys = [
  ['Left drag', 'Turn in 3-D, crosshair in slices (Alt: free, not on voxels only)'],
  ['Click', 'Select the region there; in slices the crosshair too'],
  ['Pointer at rest', 'Region, value and position there'],
  ['Middle drag, Shift + left drag', 'Move the picture'],
  ['Right drag, Ctrl + wheel', 'Zoom'],
  ['Ctrl + Shift + drag, Alt + drag in 3-D', 'Roll'],
  ['Wheel', 'Zoom in 3-D, next slice in slices'],
  ['Shift + move', 'Crosshair in all panes, in 3-D to what is seen there'],
  ['Shift + click in 3-D', 'Crosshair to what is seen there'],
  ['Double click, Enter', 'Maximise and back'],
  ['One finger, two fingers, pinch', 'As left drag, move, zoom'],
  ['Long press', 'Crosshair and values there'],
  ['Double tap', 'Reset the view'],
  ['Arrow keys', 'Turn by 5° in 3-D, next slice in slices'],
  ['Page up, Page down', 'Ten slices on'],
  ['Ctrl + arrow keys', 'Move the picture'],
  ['+ −', 'Zoom'],
  [', .', 'Roll by 5° in 3-D'],
  ['Numpad 1 3 7 (Shift: opposite)', 'From anterior, left, superior'],
  ['G', 'Fit to the selected region or measure'],
  ['R, Space', 'Reset the view'],
  ['1 to 5', 'Window presets; of an image that is no CT percentiles'],
  ['Shift + 1 to 7', 'Layouts of the panes, the last in plans with a beam'],
  ['B', 'Beam’s eye instead of 3-D, and back'],
  ['[ ]', 'Beam slice 1 mm back and on along its beam (Shift: 10 mm)'],
  ['W', 'Window and level by left drag'],
  ['Z', 'Zoom by left drag'],
  ['M', 'Measure in a slice: drag or click; Enter sets a point at the crosshair, Backspace takes it back'],
  ['With Move beam: arrow keys', 'Entry or target by 1 mm in the pane (Shift: 10 mm)'],
  ['C', 'All clip planes off, and on again'],
  ['K', 'Caps of the clip planes on or off'],
  ['V', 'Plots of dose: histograms, depth profile'],
  ['D', 'Wash of the dose on or off'],
  ['I', 'Isodose lines on or off'],
  ['T', 'Particle tracks on or off'],
  ['Q', 'Pin the values at the crosshair'],
  ['P', 'Point: the others see where; with Shift ask them to look here'],
  ['N', 'Write a note at the crosshair'],
  ['F', 'Return to the presenter, or look for yourself'],
  ['Ctrl + Z', 'Undo your last change of scene or camera'],
  ['Ctrl + Shift + Z, Ctrl + Y', 'Redo it'],
  ['In the tree: Space, Enter', 'Show or hide, select'],
  ['In the tree: Shift + ← →', 'Opacity of a region by 5 %'],
  ['In a transfer function: arrow keys', 'Move the chosen point (Shift: a tenth of the way)'],
  ['There: Page up, Page down', 'Choose the point before, after'],
  ['There: Insert, Delete, double click', 'Add a point, remove it, add one there'],
  ['While saved views are presented: Page up, Page down', 'The view before, the next one'],
  ['?', 'This list'],
  ['Esc', 'Leave tool, popover, pointing, own view, message, full pane'],
];

export const help = ({ ui }) =>
  ui.popover.value !== 'help'
    ? nothing
    : html`<section class="card help" role="dialog" tabindex="-1" aria-label="Keys and mouse">
  <div class="card-head"><h2>Keys and mouse</h2><span class="grow"></span><button class="icon-button" aria-label="Close" @click=${() => ui.toggle('help')}>${icon('close')}</button></div>
  <p class="note">Keys act in the pane that has the focus.</p>
  <dl>${keys.map(([key, what]) => html`<dt>${key}</dt><dd>${what}</dd>`)}</dl>
  <p class="note"><a href="gen/reference.html" target="_blank">Reference: scene, messages, HTTP API, problems, codes of load reports</a></p></section>`;

/** While the report to print is open, what it covers takes no focus. @returns {() => void} stops */
export const coverPage = (host, ui) =>
  effect(() => {
    const isOpen = ui.popover.value === 'printout';
    for (const part of host.querySelectorAll('.room > :not(.floating)')) part.inert = isOpen;
  });
