// The one dose legend of a room's panes: a strip above them or a column at their right, never on a picture.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { ofFits } from '../fits/feature.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { LegendGrip } from './legend_grip.js';
import { legendPlace } from './legend_place.js';
import { legendRows } from './legend_rows.js';
import { say } from './drawn_words.js';

const grips = new WeakMap(); // of each page
const gripOf = (world) => {
  if (!grips.has(world.ui)) grips.set(world.ui, new LegendGrip(world));
  return grips.get(world.ui);
};

/** The rows of what the room's panes show. */
export const rowsOf = ({ room, doses }) => {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan || !scene?.dose) return [];
  const scale = doses.scale.value;
  return legendRows(plan, scene, {
    scale,
    gamma: doses.gamma.value,
    reference: doses.reference.value,
    isKnown: doses.isOfScene(scale.result),
  });
};

/** Between the bars and the panes, or beside these. @param {object} world that of the room page */
export function doseLegend(world) {
  const rows = rowsOf(world);
  if (!rows.length) return nothing;
  const { ui, room } = world;
  const place = legendPlace(world);
  const { size } = ui.arrangement.value;
  if (size === 'phone') return swatches(world, rows);
  const mark = ofFits(room)?.wordMark({ room }, ['dose']) ?? nothing;
  const grip = gripOf(world);
  const about = place.isOffered ? say.gripIs : say.gripClicks;
  return html`<section class=${classMap({ 'dose-legend': true, 'in-column': place.isColumn, 'in-strip': !place.isColumn, [grip.towards.value]: Boolean(grip.towards.value) })} aria-label=${say.dose}>
    <button class="legend-grip" title=${about} aria-label=${say.grip} @pointerdown=${grip.down} @pointermove=${grip.move} @pointerup=${grip.up} @pointercancel=${grip.cancel}
      @click=${grip.click} @keydown=${grip.key}>${dots}</button>
    <div class="legend-rows">${legendBody(rows, mark)}</div></section>`;
}

const dots = html`<svg viewBox="0 0 8 14" width="8" height="14" aria-hidden="true">${[0, 1].map((x) => [0, 1, 2].map((y) => svg`<circle cx=${2 + 4 * x} cy=${3 + 4 * y} r="1" />`))}</svg>`;

/** On a telephone: colours alone; a tap has the list. */
function swatches({ ui }, rows) {
  const open = () => ui.choose('legend');
  return html`<section class="dose-legend phone" aria-label=${say.dose}><button title=${say.list} aria-label=${say.list} @click=${open}>${rows.map(
    (row) => (row.scale ? bar(row.scale) : row.levels.map(swatch)),
  )}${icon('chevronRight')}</button></section>`;
}

/** The rows as they stand in a strip, a column or a list; data alone, so that a display can have them too. @param {import('./legend_rows.js').LegendRow[]} rows */
export const legendBody = (rows, mark = nothing) =>
  rows.map(
    (
      row,
    ) => html`<div class=${classMap({ 'legend-row': true, old: row.isOld })} data-kind=${row.kind} role="group" aria-label=${row.quantity}>
    ${mark === nothing ? nothing : html`<span class="legend-mark">${mark}</span>`}${row.warn ? html`<span class="legend-mark warn">${icon('warning', 12)} ${row.warn}</span>` : nothing}
    <p class="legend-words" title=${row.whole}><b>${row.quantity}</b>${[row.weights, row.reference, row.more].filter(Boolean).map((words) => html`<span>${words}</span>`)}</p>
    ${row.scale ? scaleOf(row) : nothing}${row.levels.length ? levelsOf(row) : nothing}</div>`,
  );

const swatch = ({ color, isArea }) => html`<i class=${isArea ? 'area' : 'line'} ${variables({ '--color': color })}></i>`;

const levelsOf = ({ levels, unit }) =>
  html`<ul class="legend-levels"><li class="legend-unit">${say.unitOfLevels({ unit })}</li>${levels.map((level) => html`<li>${swatch(level)}<span>${level.percent}</span><span>${level.value}</span></li>`)}</ul>`;

const bar = ({ gradient }) => html`<i class="legend-bar" ${variables({ '--scale': gradient })}></i>`;

const scaleOf = ({ scale, domain, figures, whole }) =>
  html`<div class="legend-scale">${bar(scale)}<p class="legend-ends">${scale.ends.map((end) => html`<span>${end}</span>`)}</p></div>
    <p class="legend-domain" title=${whole}>${domain ? html`<span>${domain}</span>` : nothing}${figures ? html`<span>${figures}</span>` : nothing}</p>`;
