// The inspector's Selection of an oblique plane, or of a new one: its name, direction and place, and the ways to make one.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import {
  alongBeam,
  anglesOf,
  facing,
  normalOfAngles,
  normalOfKind,
  obliqueName,
  originAt,
  planeOfNormal,
  positionOf,
  roundedOrigin,
} from '../../room/obliques.js';
import { crosshair } from '../../room/plan.js';
import { checkbox, numberField } from '../../parts/fields.js';
import { position as positionText } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { change, deleteOblique, isFull, obliquesOf, openOblique, setOblique } from './oblique_rows.js';
import { say } from './later_words.js';
import { takePoint } from './pane_picking.js';

const tenths = (value) => Math.round(value * 10) / 10 || 0;
const slices = ['axial', 'coronal', 'sagittal'];

export function obliqueBlock(world, isDisabled) {
  const { id } = world.ui.selection.value;
  const oblique = obliquesOf(world)[id];
  return html`${oblique ? planeBlock(world, id, oblique, isDisabled) : nothing}${placeBlock(world, oblique ? id : '', isDisabled)}`;
}

function planeBlock(world, id, oblique, isDisabled) {
  const plane = planeOfNormal(oblique.origin_mm, oblique.normal);
  const { turn, tilt } = anglesOf(oblique.normal);
  const words = obliqueName(id, oblique);
  const set = (fields, event) => change(world, id, fields, event);
  const rename = (event) => set({ name: event.target.value.trim().slice(0, 40) }, event);
  return html`<section class="block"><h3>${icon('plane')} ${words}</h3>
    <dl class="clip-list"><dt>${say.name}</dt><dd><input class="clip-name" maxlength="40" aria-label=${say.nameOf} placeholder=${obliqueName(id)} .value=${live(oblique.name)} ?disabled=${isDisabled} @change=${rename}></dd>
      <dt title=${say.turnIs}>${say.turn}</dt><dd>${numberField(say.turnDegrees, tenths(turn), '°', isDisabled, (value, event) => set({ normal: normalOfAngles(value, tilt) }, event))}</dd>
      <dt title=${say.tiltIs}>${say.tilt}</dt><dd>${numberField(say.tiltDegrees, tenths(tilt), '°', isDisabled, (value, event) => set({ normal: normalOfAngles(turn, Math.min(Math.max(value, -90), 90)) }, event))}</dd>
      <dt title=${say.positionIs}>${say.position}</dt><dd>${numberField(say.positionMm, tenths(positionOf(plane)), 'mm', isDisabled, (value, event) => set({ origin_mm: originAt(plane, Math.min(Math.max(value, -1e4), 1e4)) }, event))}</dd></dl>
    <p class="note">${say.facing({ direction: facing(oblique.normal) })}</p>
    <div class="checks">${checkbox(say.show, oblique.visible, isDisabled, (visible, event) => set({ visible }, event))}</div>
    <div class="buttons"><button @click=${() => openOblique(world, id)}>${icon('single')}${say.pane}</button>
      <button ?disabled=${isDisabled} @click=${(event) => set({ origin_mm: roundedOrigin(crosshair(world.room.scene.value)) }, event)}>${icon('crosshair')}${say.toCrosshair}</button>
      <button ?disabled=${isDisabled} @click=${(event) => deleteOblique(world, id, event)}>${icon('trash')}${say.delete}</button></div></section>`;
}

/** The ways to make a plane, or to give the chosen one another place. */
function placeBlock(world, id, isDisabled) {
  const { room, ui } = world;
  const plan = room.plan.value;
  const isOff = isDisabled || (!id && isFull(world));
  const through = () => roundedOrigin(crosshair(room.scene.value));
  const set = (plane, event) => setOblique(world, id, plane, event);
  const beams = plan.beams.filter(alongBeam);
  const start = (kind) => {
    ui.picking.value = { kind, id, points: [], from: null, to: null, view: 0 };
  };
  return html`<section class="block"><h3>${icon('plane')} ${id ? say.anotherPlace : say.newPlane} <span class="dim">${!id && isFull(world) ? say.most : ''}</span></h3>
    <div class="clip-make"><span class="dim">${say.throughAs}</span><div class="buttons">${slices.map((kind) => html`<button ?disabled=${isOff} @click=${(event) => set({ origin_mm: through(), normal: normalOfKind[kind] }, event)}>${say[kind]}</button>`)}</div>
      <span class="dim">${say.throughFacing}</span><form class="clip-angles" @submit=${(event) => byAngles(event, through, set)}>
        <span class="field"><input type="number" step="any" name="turn" value="30" aria-label=${say.turnOf} ?disabled=${isOff}><span>${say.degreesTurn}</span></span>
        <span class="field"><input type="number" step="any" name="tilt" value="0" aria-label=${say.tiltOf} ?disabled=${isOff}><span>${say.degreesTilt}</span></span><button ?disabled=${isOff}>${id ? say.set : say.add}</button></form>
      <span class="dim">${say.inPanes}</span><div class="buttons"><button aria-pressed=${ui.picking.value?.kind === 'points'} ?disabled=${isOff} title=${say.clickThree} @click=${() => start('points')}>${say.threePoints}</button>
        <button aria-pressed=${ui.picking.value?.kind === 'line'} ?disabled=${isOff} title=${say.dragLine} @click=${() => start('line')}>${say.line}</button>
        ${beams.map((beam) => html`<button class="clip-beam" ?disabled=${isOff} title=${say.throughBeam({ beam: beam.name || beam.id })} @click=${(event) => set(alongBeam(beam), event)}>${beams.length > 1 ? say.alongBeam({ beam: beam.name || beam.id }) : say.alongTheBeam}</button>`)}</div></div>
    ${picking(world)}</section>`;
}

function byAngles(event, through, set) {
  event.preventDefault();
  const { turn, tilt } = event.target.elements;
  if ([turn, tilt].some(({ valueAsNumber }) => !Number.isFinite(valueAsNumber))) return;
  set({ origin_mm: through(), normal: normalOfAngles(turn.valueAsNumber, Math.min(Math.max(tilt.valueAsNumber, -90), 90)) }, event);
}

/** While points are taken: those that are there; the crosshair is one for who uses no pointer. */
function picking(world) {
  const { ui } = world;
  const { kind, points } = ui.picking.value ?? {};
  if (!kind) return nothing;
  const cancel = html`<button @click=${() => {
    ui.picking.value = null;
  }}>${say.cancel}</button>`;
  if (kind === 'line') return html`<p class="note" role="status">${say.dragNow}</p><div class="buttons">${cancel}</div>`;
  return html`<p class="note" role="status">${say.pointNow({ n: points.length + 1 })}</p>${points.length ? html`<ol class="clip-points">${points.map((point) => html`<li>${positionText(point)}</li>`)}</ol>` : nothing}
    <div class="buttons"><button @click=${(event) => takePoint(world, crosshair(world.room.scene.value), event)}>${icon('crosshair')}${say.takeCrosshair}</button>${cancel}</div>`;
}
