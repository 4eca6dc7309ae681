// The editor of a transfer function: its points over the image's histogram, moved by mouse, fingers and keys, and the same points as a table.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { axisOf, bars, fromPlot, gapBeside, inserted, mostPoints, moved, nearest, recolored, removed, toPlot } from './transfer.js';
import { numberField } from '../../parts/fields.js';
import { significant, unitText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const [mousePx, fingerPx] = [12, 26]; // how far from a point a press still takes it
const keyStep = 0.01; // of the plot; with Shift a tenth of it
const opacityTicks = [0.01, 0.1, 0.5, 1];

let dragged = null; // {index, axis}: the point that a pointer holds; its axis stays, so that the plot does not move below it

export function transferEditor(world, image, isDisabled, change) {
  const { room, ui, histograms } = world;
  const { points } = room.scene.value.image.volume;
  const histogram = histograms.of(room.planId.value, image.id);
  const axis = dragged?.axis ?? axisOf(image, histogram, points);
  const at = Math.min(ui.transferPoint.value, points.length - 1);
  const set = (list, event) => !isDisabled && change({ points: list }, event);
  const choose = (index) => {
    ui.transferPoint.value = index;
  };
  const insert = (value, opacity, event) => {
    const next = inserted(pointsNow(room), axis, value, opacity);
    if (next.index < 0) return;
    choose(next.index);
    set(next.points, event);
  };
  const insertBeside = (event) => insert(gapBeside(points, axis, at), null, event);
  const remove = (index, event) => {
    choose(Math.max(0, Math.min(index, points.length - 2)));
    set(removed(points, index), event);
  };
  const tools = { room, axis, at, isDisabled, set, choose, insert, insertBeside, remove };
  return html`<div class="image-transfer">${plot(tools, points, histogram, image)}
      <p class="image-axis"><span>${significant(axis.low)}</span><span>${unitText(image.unit)}</span><span>${significant(axis.high)}</span></p></div>
    ${chosenPoint(tools, points, image)}
    <details class="more image-points"><summary>${icon('chevronDown', 12)}<span>${say.pointsTable({ n: points.length })}</span></summary>${table(tools, points, image)}</details>`;
}

const pointsNow = (room) => room.scene.peek().image.volume.points;
const percentOf = (opacity) => Number((opacity * 100).toPrecision(3));
const words = ({ value, opacity }, index, unit) =>
  say.pointIs({ n: index + 1, value: [significant(value), unitText(unit)].filter(Boolean).join(' '), percent: percentOf(opacity) });

/** One tab stop: arrows move the chosen point, Page up and Page down choose another. */
function plot(tools, points, histogram, image) {
  const { axis, at, isDisabled } = tools;
  const percent = (part) => `${100 * part}%`;
  return html`<svg class="image-plot" role="listbox" tabindex="0" aria-label=${say.points} aria-activedescendant=${points.length ? `transfer-${at}` : nothing} aria-disabled=${isDisabled}
      @pointerdown=${(event) => press(event, tools)} @pointermove=${(event) => drag(event, tools)} @pointerup=${release} @pointercancel=${release}
      @dblclick=${(event) => insertAt(event, tools)} @keydown=${(event) => keys(event, tools)}>
    <g aria-hidden="true">
      <svg viewBox="0 0 1 1" preserveAspectRatio="none" width="100%" height="100%">
        <linearGradient id="transfer-colors" gradientUnits="userSpaceOnUse" x1="0" x2="1" y1="0" y2="0">${points.map((point) => svg`<stop offset=${Math.min(Math.max(toPlot(point, axis)[0], 0), 1)} stop-color=${point.color} />`)}</linearGradient>
        ${
          histogram
            ? svg`<path class="counts" d=${`M0 1${bars(histogram, axis)
                .map(([x, y]) => `L${x.toFixed(4)} ${(1 - y).toFixed(4)}`)
                .join('')}L1 1Z`} />`
            : nothing
        }
        ${points.length ? svg`<path class="fill" fill="url(#transfer-colors)" d=${`${curve(points, axis)}V1H0Z`} /><path class="curve under" d=${curve(points, axis)} /><path class="curve ink" d=${curve(points, axis)} />` : nothing}</svg>
      ${opacityTicks.map((tick) => svg`<line class="tick" x1="0" x2="100%" y1=${percent(1 - Math.sqrt(tick))} y2=${percent(1 - Math.sqrt(tick))} /><text x="3" y=${percent(1 - Math.sqrt(tick))} dy=${tick === 1 ? 11 : -3}>${tick === 1 ? say.stopped({ percent: percentOf(tick) }) : `${percentOf(tick)} %`}</text>`)}</g>
    ${points.map((point, index) => {
      const [x, y] = toPlot(point, axis);
      return svg`<g role="option" id=${`transfer-${index}`} aria-selected=${index === at} aria-label=${words(point, index, image.unit)} class=${classMap({ chosen: index === at })}>
        <circle class="ring" cx=${percent(x)} cy=${percent(1 - y)} r="9" /><circle class="dot" cx=${percent(x)} cy=${percent(1 - y)} r="6" fill=${point.color} /></g>`;
    })}</svg>`;
}

/** Opacities between two points are linear, so their square roots are not: drawn in short steps. */
function curve(points, axis) {
  const places = points.flatMap((point, index) => {
    const next = points[index + 1];
    if (!next) return [toPlot(point, axis)];
    return Array.from({ length: 12 }, (_, step) =>
      toPlot(
        {
          value: point.value + ((next.value - point.value) * step) / 12,
          opacity: point.opacity + ((next.opacity - point.opacity) * step) / 12,
        },
        axis,
      ),
    );
  });
  const [first, last] = [places[0], places.at(-1)];
  return `M0 ${1 - first[1]}${places.map(([x, y]) => `L${x.toFixed(5)} ${(1 - y).toFixed(5)}`).join('')}L1 ${1 - last[1]}`;
}

const placeOf = (event) => {
  const box = event.currentTarget.getBoundingClientRect();
  return { place: [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height], size: [box.width, box.height] };
};

function press(event, { room, axis, isDisabled, choose }) {
  if (event.button > 0) return;
  const { place, size } = placeOf(event);
  const index = nearest(pointsNow(room), axis, place, size, event.pointerType === 'touch' ? fingerPx : mousePx);
  if (index < 0) return;
  choose(index);
  if (isDisabled) return;
  dragged = { index, axis };
  event.currentTarget.setPointerCapture(event.pointerId);
}

function drag(event, { room, set }) {
  if (!dragged) return;
  const { place } = placeOf(event);
  const at = fromPlot(place, dragged.axis);
  set(moved(pointsNow(room), dragged.axis, dragged.index, at), event);
}

function release() {
  dragged = null;
}

function insertAt(event, { room, axis, insert }) {
  const { place, size } = placeOf(event);
  if (nearest(pointsNow(room), axis, place, size, mousePx) >= 0) return;
  const { value, opacity } = fromPlot(place, axis);
  insert(value, opacity, event);
}

function keys(event, { room, axis, at, set, choose, insertBeside, remove }) {
  if (event.altKey || event.ctrlKey || event.metaKey) return;
  const points = pointsNow(room);
  const step = event.shiftKey ? keyStep / 10 : keyStep;
  const by = (dx, dy) => () => {
    if (!points[at]) return;
    const [x, y] = toPlot(points[at], axis);
    set(
      moved(points, axis, at, {
        ...(dx ? { value: fromPlot([x + dx * step, y], axis).value } : {}),
        ...(dy ? { opacity: fromPlot([x, y + dy * step], axis).opacity } : {}),
      }),
      event,
    );
  };
  const to = (index) => () => choose(Math.min(Math.max(index, 0), points.length - 1));
  const act = {
    ArrowLeft: by(-1, 0),
    ArrowRight: by(1, 0),
    ArrowUp: by(0, 1),
    ArrowDown: by(0, -1),
    PageUp: to(at - 1),
    PageDown: to(at + 1),
    Home: to(0),
    End: to(points.length - 1),
    Insert: () => insertBeside(event),
    Delete: () => points[at] && remove(at, event),
  }[event.key];
  if (!act) return;
  event.preventDefault();
  act();
}

const valueField = ({ room, axis, isDisabled, set }, points, index, unit) =>
  numberField(say.valueOfPoint({ n: index + 1 }), Number(points[index].value.toPrecision(6)), unitText(unit), isDisabled, (value, event) =>
    set(moved(pointsNow(room), axis, index, { value }), event),
  );
const opacityField = ({ room, axis, isDisabled, set }, points, index) =>
  numberField(say.opacityOf({ n: index + 1 }), percentOf(points[index].opacity), '%', isDisabled, (percent, event) =>
    set(moved(pointsNow(room), axis, index, { opacity: percent / 100 }), event),
  );
const colorField = (
  { room, isDisabled, set },
  points,
  index,
) => html`<input type="color" .value=${live(points[index].color)} aria-label=${say.colourOf({ n: index + 1 })} ?disabled=${isDisabled}
  @input=${(event) => set(recolored(pointsNow(room), index, event.target.value), event)}>`;

/** Adding, removing, and the colour of the chosen point. */
function chosenPoint(tools, points, image) {
  const { at, isDisabled, insertBeside, remove } = tools;
  const point = points[at];
  return html`<p class="image-chosen" role="status">${point ? words(point, at, image.unit) : say.noPoint}</p>
    <div class="buttons image-edit">${
      point
        ? html`<label>${say.colour} <input type="color" .value=${live(point.color)} aria-label=${say.colourOfChosen} ?disabled=${isDisabled}
        @input=${(event) => tools.set(recolored(pointsNow(tools.room), at, event.target.value), event)}></label>`
        : nothing
    }
      <button title=${say.addIs} ?disabled=${isDisabled || points.length >= mostPoints} @click=${insertBeside}>${say.add}</button>
      <button title=${say.removeIs} ?disabled=${isDisabled || !point} @click=${(event) => remove(at, event)}>${say.remove}</button></div>`;
}

function table(tools, points, image) {
  return html`<table><thead><tr><th scope="col">${say.value}</th><th scope="col">${say.stoppedColumn}</th><th scope="col">${say.colour}</th></tr></thead>
    <tbody>${points.map((_, index) => html`<tr><td>${valueField(tools, points, index, image.unit)}</td><td>${opacityField(tools, points, index)}</td><td>${colorField(tools, points, index)}</td></tr>`)}</tbody></table>`;
}
