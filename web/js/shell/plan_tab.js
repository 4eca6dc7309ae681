// The inspector's Plan: its parts, and the report of loading.
import { html, nothing } from '../../lib/lit-html.js';
import { reportSummary } from '../room/plan.js';
import { partsOf } from '../features/index.js';
import { number, seconds } from '../parts/format.js';
import { reportLines } from '../parts/report.js';
import { say } from './words.js';

export function planTab(world) {
  const { room } = world;
  const plan = room.plan.value;
  const parts = [
    [say.images, plan.images.length],
    [say.regions, plan.regions.length],
    [say.doses, plan.doses.length],
    [say.beams, plan.beams.length],
    [say.curves, plan.curves.length],
    [say.segments, plan.nTracks],
  ];
  const summary = reportSummary(plan.report);
  return html`${partsOf('planTop', world)}<section class="block"><h3>${plan.name}</h3>${plan.note ? html`<p>${plan.note}</p>` : nothing}
      <dl class="parts">${parts.filter(([, n]) => n).map(([name, n]) => html`<dt>${name}</dt><dd>${number(n)}</dd>`)}</dl></section>
    ${partsOf('planParts', world)}
    <section class="block"><h3>${say.loadReport}</h3><p class="note">${plan.loadMs === null ? summary : say.loadedIn({ summary, time: seconds(plan.loadMs) })}</p></section>${reportLines(plan.report)}`;
}
