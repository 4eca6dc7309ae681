// The inspector's Selection of measures: how one is drawn, all of them with their values, and one with its points to edit.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { replaced, without } from '../../parts/lists.js';
import { freeId, kinds, listed, mostMeasures, mostPoints, pointsAround, pointsOf, removePatch } from './measures.js';
import { nearestIn, planeOfView } from '../../room/obliques.js';
import { crosshair, crosshairPatch, shownImage } from '../../room/plan.js';
import { isInSpace } from '../../room/kinds.js';
import { add, scale, subtract } from '../../parts/vec.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { imageName } from '../image/image_shown.js';
import { imageOf, kindIcons, measureName, valueTexts } from './measure_words.js';
import { newMeasure } from './pane_measures.js';
import { measuresOf, showMeasure } from './measure_rows.js';
import { say } from './later_words.js';

const letters = ['L', 'P', 'S'];
const howTo = { distance: say.drawDistance, angle: say.drawAngle, polyline: say.drawPolyline, ellipse: say.drawEllipse };
const kindWords = { distance: say.ofDistance, angle: say.ofAngle, polyline: say.ofPolyline, ellipse: say.ofEllipse };

const jump = ({ room, ui }, measure, event) => {
  const [plan, scene] = [room.plan.value, room.scene.value];
  room.patchScene(crosshairPatch(plan, shownImage(plan, scene), pointsOf(measure)[0], { isFree: true }), {
    view: ui.active.value,
    at: event.timeStamp,
  });
};
function remove({ room, ui }, id, event) {
  room.patchScene(removePatch(id, room.isForRoom({ measures: { [id]: null } })), { view: ui.active.value, at: event.timeStamp });
  ui.select('measures');
}

/** How the next measure is drawn, and all that there are. */
export function measuresBlock(world, isDisabled) {
  const { ui } = world;
  const kind = ui.measureKind.value;
  const isTool = ui.tool.value === 'measure';
  const choose = (id) => {
    ui.measureKind.value = id;
    ui.draft.value = null;
  };
  return html`<section class="block"><h3>${icon('measure')} ${say.measure}</h3>
      <div class="shown-as">${segment(
        say.what,
        kinds.map(([id, name]) => [id, name]),
        kind,
        isDisabled,
        choose,
      )}</div>
      <p class="note">${howTo[kind]} ${say.inSlice}</p>
      <div class="buttons"><button class=${classMap({ on: isTool })} aria-pressed=${isTool} title=${ui.keys.tip(say.draw, 'measure')} @click=${() => {
        ui.tool.value = isTool ? 'crosshair' : 'measure';
      }}>${say.draw}</button>
        <button ?disabled=${isDisabled} @click=${(event) => addAtCrosshair(world, kind, event)}>${say.add}</button></div></section>
    ${listBlock(world, isDisabled)}`;
}

/** Across the active pane, 40 mm wide; of the 3-D pane, the axial one. */
function addAtCrosshair({ room, ui }, kind, event) {
  const scene = room.scene.value;
  const active = room.view(ui.active.value);
  const plane = planeOfView(scene, isInSpace(active.kind) ? { kind: 'axial' } : active.document.value, room.plan.value);
  const id = freeId(scene.measures, room.sharesMarks, room.markSuffix);
  if (measuresOf(scene).length >= mostMeasures) return void ui.notify('warn', say.full({ n: mostMeasures }), 'measures');
  room.patchScene(newMeasure(id, kind, pointsAround(kind, nearestIn(plane, crosshair(scene)), plane), shownImage(room.plan.value, scene)), {
    view: ui.active.value,
    at: event.timeStamp,
  });
  ui.select('measure', id);
}

/** "by Ben", where that is not this person. */
const byOther = (room, { author }) =>
  author && author !== room.identity?.name ? html`<span class="dim">${say.by({ author })}</span> ` : nothing;

function listBlock(world, isDisabled) {
  const { room, ui } = world;
  const entries = measuresOf(room.scene.value);
  if (!entries.length) return nothing;
  return html`<section class="block"><h3>${say.measures} <span class="dim">${entries.length}</span></h3><ul class="image-list" aria-label=${say.measures}>${repeat(
    entries,
    ([id]) => id,
    ([id, measure]) => {
      const words = measureName(id, measure);
      return html`<li><button class="image-measure-name" title=${words} @click=${() => ui.choose('measure', id)}>${icon(kindIcons[measure.kind])}<b>${words}</b><span>${byOther(room, measure)}${valueTexts(world, id, measure).map((text) => html`<span>${text}</span> `)}</span></button>
      <button class="icon-button small" aria-pressed=${measure.visible} aria-label=${say.show({ measure: words })} title=${say.showOrHide} ?disabled=${isDisabled} @click=${(event) => showMeasure(world, id, !measure.visible, event)}>${icon(measure.visible ? 'eye' : 'eyeOff')}</button>
      <button class="icon-button small" aria-label=${say.crosshairTo({ measure: words })} title=${say.crosshairThere} ?disabled=${isDisabled} @click=${(event) => jump(world, measure, event)}>${icon('target')}</button>
      <button class="icon-button small" aria-label=${say.deleteOne({ measure: words })} title=${say.delete} ?disabled=${isDisabled} @click=${(event) => remove(world, id, event)}>${icon('trash')}</button></li>`;
    },
  )}</ul></section>`;
}

/** One measure. */
export function measureBlock(world, isDisabled, changeScene) {
  const { room, ui } = world;
  const { id } = ui.selection.value;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const measure = scene.measures?.[id];
  if (!measure) return measuresBlock(world, isDisabled);
  const change = (patch, event) => changeScene({ measures: { [id]: patch } }, event);
  const words = measureName(id, measure);
  const isEllipse = measure.kind === 'ellipse';
  return html`<section class="block"><h3>${icon(kindIcons[measure.kind])} ${words} <span class="dim">${measure.name ? kindWords[measure.kind] : ''}</span></h3>
      <p class="image-measured" role="status">${valueTexts(world, id, measure).map((text) => html`<b>${text}</b> `)}</p>
      <dl class="image-rows"><dt>${say.name}</dt><dd><input maxlength="40" aria-label=${say.nameOf} placeholder=${words} .value=${live(measure.name)} ?disabled=${isDisabled} @change=${(event) => change({ name: event.target.value.trim() }, event)}></dd>
        ${measure.author ? html`<dt>${say.byAuthor}</dt><dd>${measure.author}</dd>` : nothing}
        ${
          isEllipse && plan.images.length > 1
            ? html`<dt>${say.image}</dt><dd><select aria-label=${say.imageMeasured} ?disabled=${isDisabled} @change=${(event) => change({ image: event.target.value }, event)}>${plan.images.map(
                (image) =>
                  html`<option value=${image.id} .selected=${live(image === imageOf(plan, scene, measure))}>${imageName(plan, image)}</option>`,
              )}</select></dd>`
            : nothing
        }</dl>
      ${pointTable(measure, isDisabled, change)}
      <div class="checks">${checkbox(say.inPictures, measure.visible, isDisabled, (isOn, event) => showMeasure(world, id, isOn, event))}</div>
      <div class="buttons">${measure.kind === 'polyline' ? html`<button ?disabled=${isDisabled || measure.points.length >= mostPoints} @click=${(event) => change({ points: listed(continued(pointsOf(measure))) }, event)}>${say.addPoint}</button>` : nothing}
        <button ?disabled=${isDisabled} @click=${(event) => jump(world, measure, event)}>${icon('target')}<span>${say.crosshairThere}</span></button>
        <button ?disabled=${isDisabled} @click=${(event) => remove(world, id, event)}>${icon('trash')}<span>${say.delete}</span></button></div></section>
    ${measuresBlock(world, isDisabled)}`;
}

/** The line goes on as far again as its last part. */
const continued = (points) => [
  ...points,
  points.length > 1 ? add(points.at(-1), subtract(points.at(-1), points.at(-2))) : add(points[0], scale([1, 0, 0], 10)),
];

const pointNames = { ellipse: [say.centre, say.edge, say.edge2] };

function pointTable({ kind, points }, isDisabled, change) {
  const places = points.map(({ at_mm: at }) => at);
  const set = (index, axis, value, event) =>
    change({ points: listed(replaced(places, index, replaced(places[index], axis, Math.min(Math.max(value, -100000), 100000)))) }, event);
  const nameOf = (index) => pointNames[kind]?.[index] ?? say.point({ n: index + 1 });
  const isLine = kind === 'polyline' && places.length > 2;
  return html`<table class="image-places"><thead><tr><th scope="col">mm</th>${letters.map((letter) => html`<th scope="col">${letter}</th>`)}${isLine ? html`<th scope="col"><span class="hidden">${say.remove}</span></th>` : nothing}</tr></thead>
    <tbody>${places.map(
      (
        place,
        index,
      ) => html`<tr><th scope="row">${nameOf(index)}</th>${place.map((value, axis) => html`<td>${numberField(say.pointMm({ point: nameOf(index), letter: letters[axis] }), Number(value.toFixed(2)), '', isDisabled, (entered, event) => set(index, axis, entered, event))}</td>`)}
      ${isLine ? html`<td><button class="icon-button small" aria-label=${say.removePoint({ point: nameOf(index) })} ?disabled=${isDisabled} @click=${(event) => change({ points: listed(without(places, index)) }, event)}>${icon('close', 12)}</button></td>` : nothing}</tr>`,
    )}</tbody></table>`;
}
