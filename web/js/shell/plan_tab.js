// The inspector's Plan: its parts, and the report of loading.
import { html, nothing } from '../../lib/lit-html.js';
import { reportSummary } from '../room/plan.js';
import { partsOf } from '../features/index.js';
import { number, seconds } from '../parts/format.js';
import { reportLines } from '../parts/report.js';

export function planTab(world) {
  const { room } = world;
  const plan = room.plan.value;
  const parts = [
    ['Images', plan.images.length],
    ['Regions', plan.regions.length],
    ['Doses', plan.doses.length],
    ['Beams', plan.beams.length],
    ['Reference curves', plan.curves.length],
    ['Segments of tracks', plan.nTracks],
  ];
  return html`${partsOf('planTop', world)}<section class="block"><h3>${plan.name}</h3>${plan.note ? html`<p>${plan.note}</p>` : nothing}
      <dl class="parts">${parts.filter(([, n]) => n).map(([name, n]) => html`<dt>${name}</dt><dd>${number(n)}</dd>`)}</dl></section>
    ${partsOf('planParts', world)}
    <section class="block"><h3>Load report</h3><p class="note">${reportSummary(plan.report)}${plan.loadMs === null ? '' : `, loaded in ${seconds(plan.loadMs)}`}</p></section>${reportLines(plan.report)}`;
}
