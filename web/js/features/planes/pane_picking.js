// In the slice panes while a plane is being made: the layer that takes three points, or a line that is dragged.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { planeOfView, throughLine, throughPoints } from '../../room/obliques.js';
import { fromPicture, toPicture } from '../../parts/vec.js';
import { setOblique } from './oblique_rows.js';
import { boxOf, placeOf } from '../../parts/page_look.js';

const shortestPx = 12; // a line that is shorter was a slip

/** Takes one of three points; the third makes the plane. */
export function takePoint(world, point, event) {
  const { ui } = world;
  const { points, ...rest } = ui.picking.value;
  const all = [...points, point];
  if (all.length < 3) return void (ui.picking.value = { ...rest, points: all });
  const plane = throughPoints(...all);
  ui.picking.value = plane ? null : { ...rest, points };
  setOblique(world, rest.id, plane, event);
}

/**
 * @param {{room, ui}} world @param {import('../../room/view.js').ViewState} view a slice pane with a picture
 * @param {{x: number, y: number, width: number, height: number}} box of the picture in the pane, CSS px
 */
export function pickingLayer(world, view, box) {
  const { room, ui } = world;
  const picking = ui.picking.value;
  if (!picking) return nothing;
  const matrix = view.painted.value.clip_from_lps_mm;
  const slice = () => planeOfView(room.scene.value, view.document.value, room.plan.value);
  const pointOf = (event) => {
    const { left, top } = boxOf(event.currentTarget);
    const { x, y } = placeOf(event);
    return fromPicture(matrix, [(x - left - box.x) / box.width, (y - top - box.y) / box.height], slice().origin);
  };
  const pixelOf = (point) => {
    const [x, y] = toPicture(matrix, point);
    return [box.x + x * box.width, box.y + y * box.height];
  };
  const down = (event) => {
    event.stopPropagation();
    if (event.button > 0) return;
    ui.active.value = view.number;
    if (picking.kind === 'points') return void takePoint(world, pointOf(event), event);
    event.currentTarget.setPointerCapture(event.pointerId);
    const from = pointOf(event);
    ui.picking.value = { ...picking, view: view.number, from, to: from };
  };
  const move = (event) => {
    event.stopPropagation();
    if (picking.from && event.currentTarget.hasPointerCapture(event.pointerId)) ui.picking.value = { ...picking, to: pointOf(event) };
  };
  const up = (event) => {
    if (!picking.from || picking.view !== view.number) return;
    const [a, b] = [picking.from, picking.to].map(pixelOf);
    const isLine = Math.hypot(a[0] - b[0], a[1] - b[1]) >= shortestPx;
    ui.picking.value = isLine ? null : { ...picking, from: null, to: null, view: 0 };
    if (isLine) setOblique(world, picking.id, throughLine(slice(), picking.from, picking.to), event);
  };
  const marks = picking.kind === 'points' ? picking.points.map(pixelOf) : [];
  const line = picking.from && picking.view === view.number ? [picking.from, picking.to].map(pixelOf) : null;
  return html`<div class="clip-picking" @pointerdown=${down} @pointermove=${move} @pointerup=${up} @pointercancel=${() => {
    ui.picking.value = { ...picking, from: null, to: null, view: 0 };
  }}>
    <svg class="overlay" aria-hidden="true">${marks.map(([x, y], n) => svg`<g class="marker">${['under', 'ink'].map((layer) => svg`<circle class=${layer} cx=${x} cy=${y} r="5" />`)}</g><text class="halo caption" x=${x + 9} y=${y - 7}>${n + 1}</text>`)}
      ${line ? ['under', 'ink'].map((layer) => svg`<g class="clip-line chosen"><line class=${layer} x1=${line[0][0]} y1=${line[0][1]} x2=${line[1][0]} y2=${line[1][1]} /></g>`) : nothing}</svg></div>`;
}
