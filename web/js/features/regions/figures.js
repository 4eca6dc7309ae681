// The dialog that compares the representations of a region by their figures.
import { html, nothing } from '../../../lib/lit-html.js';
import { figureRows, volumeDifference } from './shapes.js';
import { exportRows } from '../../room/exports.js';
import { number, signed } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';

const columns = [
  ['Polygons', ({ triangles }) => (triangles ? number(triangles) : '–')],
  ['Vertices', ({ vertices, points }) => number(vertices || points)],
  ['Made in', ({ ms }) => `${number(ms, 1)} ms`],
  ['Drawn', ({ frames_per_second: fps }) => (Number.isFinite(fps) ? `${number(fps)} /s` : '–')],
  ['Area', ({ area_mm2: area }) => (area ? `${number(area / 100, 1)} cm²` : '–')],
  ['Encloses', ({ volume_mm3: volume }) => (volume ? `${number(volume / 1000, 2)} cm³` : '–')],
  ['to univels', (row) => (row.volume_mm3 ? `${signed(volumeDifference(row), 2)} %` : '–')],
  ['Off at most', ({ distance_max_mm: distance }) => (Number.isFinite(distance) ? `${number(distance, 2)} mm` : '–')],
];

export function figuresDialog(world) {
  const { room, ui, comparison } = world;
  const region = room.plan.value?.regions.find((other) => other.id === ui.region.value);
  if (ui.popover.value !== 'figures' || !region || !comparison) return nothing;
  const rows = comparison.rows.value;
  const n = rows.filter((row) => row.result || row.error).length;
  return html`<section class="card compare" role="dialog" tabindex="-1" aria-label="Methods compared">
    <div class="card-head"><h2>${region.name}: methods compared</h2><span class="grow"></span>
      <button ?disabled=${!rows.length || n < rows.length} @click=${() => exportRows(world, 'methods', `${room.planId.value}-${region.id}-methods.csv`, figureRows(rows))}>CSV</button>
      <button class="icon-button" aria-label="Close" @click=${() => {
        ui.popover.value = '';
      }}>${icon('close')}</button></div>
    <p class="note">${n < rows.length ? html`<span role="status">Working out ${n + 1} of ${rows.length} …</span>` : html`${number(region.volume_cm3, 2)} cm³ in ${number(region.voxels)} univels of its own.`}
      With all regions inside it. Drawn alone, 650 × 650 pixels, moving picture.</p>
    <div class="table"><table><thead><tr><th scope="col">Method</th>${columns.map(([name]) => html`<th scope="col">${name}</th>`)}</tr></thead>
      <tbody>${rows.map(
        ({ name, result, error }) =>
          html`<tr><th scope="row">${name}</th>${
            result
              ? columns.map(([, text]) => html`<td>${text(result)}</td>`)
              : html`<td colspan=${columns.length} class=${error ? 'why' : 'dim'}>${error ?? '…'}</td>`
          }</tr>`,
      )}</tbody></table></div></section>`;
}
