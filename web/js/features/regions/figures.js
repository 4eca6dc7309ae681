// The dialog that compares the representations of a region by their figures.
import { html, nothing } from '../../../lib/lit-html.js';
import { figureRows } from './representations.js';
import { volumeDifference } from './shapes.js';
import { exportRows } from '../../room/exports.js';
import { number, signed } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './method_words.js';

const columns = [
  [say.polygons, ({ triangles }) => (triangles ? number(triangles) : '–')],
  [say.vertices, ({ vertices, points }) => number(vertices || points)],
  [say.madeIn, ({ ms }) => `${number(ms, 1)} ms`],
  [say.drawn, ({ frames_per_second: fps }) => (Number.isFinite(fps) ? `${number(fps)} /s` : '–')],
  [say.area, ({ area_mm2: area }) => (area ? `${number(area / 100, 1)} cm²` : '–')],
  [say.encloses, ({ volume_mm3: volume }) => (volume ? `${number(volume / 1000, 2)} cm³` : '–')],
  [say.toUnivels, (row) => (row.volume_mm3 ? `${signed(volumeDifference(row), 2)} %` : '–')],
  [say.offAtMost, ({ distance_max_mm: distance }) => (Number.isFinite(distance) ? `${number(distance, 2)} mm` : '–')],
];

export function figuresDialog(world) {
  const { room, ui, comparison } = world;
  const region = room.plan.value?.regions.find((other) => other.id === ui.region.value);
  if (ui.popover.value !== 'figures' || !region || !comparison) return nothing;
  const rows = comparison.rows.value;
  const n = rows.filter((row) => row.result || row.error).length;
  return html`<section class="card compare" role="dialog" tabindex="-1" aria-label=${say.compared}>
    <div class="card-head"><h2>${say.comparedOf({ region: region.name })}</h2><span class="grow"></span>
      ${room.control.mayExport ? html`<button ?disabled=${!rows.length || n < rows.length} @click=${() => exportRows(world, 'methods', `${room.planId.value}-${region.id}-methods.csv`, figureRows(rows))}>CSV</button>` : nothing}
      <button class="icon-button" aria-label=${say.close} @click=${() => {
        ui.popover.value = '';
      }}>${icon('close')}</button></div>
    <p class="note">${n < rows.length ? html`<span role="status">${say.workingOut({ n: n + 1, all: rows.length })}</span>` : say.ownUnivels({ cm3: number(region.volume_cm3, 2), count: number(region.voxels), n: region.voxels })}
      ${say.howCompared}</p>
    <div class="table"><table><thead><tr><th scope="col">${say.method}</th>${columns.map(([name]) => html`<th scope="col">${name}</th>`)}</tr></thead>
      <tbody>${rows.map(
        ({ name, result, error }) =>
          html`<tr><th scope="row">${name}</th>${
            result
              ? columns.map(([, text]) => html`<td>${text(result)}</td>`)
              : html`<td colspan=${columns.length} class=${error ? 'why' : 'dim'}>${error ?? '…'}</td>`
          }</tr>`,
      )}</tbody></table></div></section>`;
}
