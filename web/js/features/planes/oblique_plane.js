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
import { takePoint } from './pane_picking.js';

const tenths = (value) => Math.round(value * 10) / 10 || 0;
const slices = [
  ['axial', 'Axial'],
  ['coronal', 'Coronal'],
  ['sagittal', 'Sagittal'],
];

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
    <dl class="clip-list"><dt>Name</dt><dd><input class="clip-name" maxlength="40" aria-label="Name of the plane" placeholder=${obliqueName(id)} .value=${live(oblique.name)} ?disabled=${isDisabled} @change=${rename}></dd>
      <dt title="About the patient's long axis: 0 anterior, 90 left, 180 posterior, −90 right">Turn</dt><dd>${numberField('Turn in degrees', tenths(turn), '°', isDisabled, (value, event) => set({ normal: normalOfAngles(value, tilt) }, event))}</dd>
      <dt title="Upwards: 90 superior, −90 inferior">Tilt</dt><dd>${numberField('Tilt in degrees', tenths(tilt), '°', isDisabled, (value, event) => set({ normal: normalOfAngles(turn, Math.min(Math.max(value, -90), 90)) }, event))}</dd>
      <dt title="Along its normal, from the patient's origin">Position</dt><dd>${numberField('Position along the normal in mm', tenths(positionOf(plane)), 'mm', isDisabled, (value, event) => set({ origin_mm: originAt(plane, Math.min(Math.max(value, -1e4), 1e4)) }, event))}</dd></dl>
    <p class="note">Faces ${facing(oblique.normal)}. Turn: 0° anterior, 90° left; tilt: 90° superior. In its pane the wheel moves it.</p>
    <div class="checks">${checkbox('Show in 3-D', oblique.visible, isDisabled, (visible, event) => set({ visible }, event))}</div>
    <div class="buttons"><button @click=${() => openOblique(world, id)}>${icon('single')}Show in a pane</button>
      <button ?disabled=${isDisabled} @click=${(event) => set({ origin_mm: roundedOrigin(crosshair(world.room.scene.value)) }, event)}>${icon('crosshair')}To crosshair</button>
      <button ?disabled=${isDisabled} @click=${(event) => deleteOblique(world, id, event)}>${icon('trash')}Delete</button></div></section>`;
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
  return html`<section class="block"><h3>${icon('plane')} ${id ? 'Another place' : 'New plane'} <span class="dim">${!id && isFull(world) ? 'eight are the most' : ''}</span></h3>
    <div class="clip-make"><span class="dim">Through the crosshair, as</span><div class="buttons">${slices.map(([kind, word]) => html`<button ?disabled=${isOff} @click=${(event) => set({ origin_mm: through(), normal: normalOfKind[kind] }, event)}>${word}</button>`)}</div>
      <span class="dim">Through the crosshair, facing</span><form class="clip-angles" @submit=${(event) => byAngles(event, through, set)}>
        <span class="field"><input type="number" step="any" name="turn" value="30" aria-label="Turn of the plane in degrees" ?disabled=${isOff}><span>° turn</span></span>
        <span class="field"><input type="number" step="any" name="tilt" value="0" aria-label="Tilt of the plane in degrees" ?disabled=${isOff}><span>° tilt</span></span><button ?disabled=${isOff}>${id ? 'Set' : 'Add'}</button></form>
      <span class="dim">In the panes</span><div class="buttons"><button aria-pressed=${ui.picking.value?.kind === 'points'} ?disabled=${isOff} title="Click three points in slice panes" @click=${() => start('points')}>Three points</button>
        <button aria-pressed=${ui.picking.value?.kind === 'line'} ?disabled=${isOff} title="Drag a line in a slice pane: the plane stands on that slice" @click=${() => start('line')}>Line</button>
        ${beams.map((beam) => html`<button class="clip-beam" ?disabled=${isOff} title=${`Through the axis of the beam ${beam.name || beam.id}, upright`} @click=${(event) => set(alongBeam(beam), event)}>${beams.length > 1 ? `Along ${beam.name || beam.id}` : 'Along the beam'}</button>`)}</div></div>
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
  }}>Cancel</button>`;
  if (kind === 'line') return html`<p class="note" role="status">Drag a line in a slice pane.</p><div class="buttons">${cancel}</div>`;
  return html`<p class="note" role="status">Point ${points.length + 1} of 3: click it in a slice pane.</p>${points.length ? html`<ol class="clip-points">${points.map((point) => html`<li>${positionText(point)}</li>`)}</ol>` : nothing}
    <div class="buttons"><button @click=${(event) => takePoint(world, crosshair(world.room.scene.value), event)}>${icon('crosshair')}Take the crosshair</button>${cancel}</div>`;
}
