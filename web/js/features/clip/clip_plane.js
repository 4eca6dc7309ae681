// The inspector's Selection of a clip plane: where it is, which side it keeps, caps, and what it does not cut.
import { html, nothing } from '../../../lib/lit-html.js';
import {
  allThroughCrosshair,
  beamOf,
  clipName,
  clipRow,
  clipThrough,
  clipWords,
  clipsOf,
  enabledClips,
  flippedClip,
  freeByAngles,
  leavesNothing,
  movedClip,
  positionOfClip,
  rangeOfClip,
  switchedClip,
  toggledClips,
} from './clip.js';
import { ownRegions } from '../../room/identity.js';
import { replaced } from '../../parts/lists.js';
import { alongBeam, anglesOf, facing } from '../../room/obliques.js';
import { crosshair, shownImage } from '../../room/plan.js';
import { axes } from '../../room/camera.js';
import { clipRange } from './clip_range.js';
import { clipPosition } from './clip_rows.js';
import { checkbox, numberField } from '../../parts/fields.js';
import { number } from '../../parts/format.js';
import { icon, swatch } from '../../parts/icons.js';

const tenths = (value) => Math.round(value * 10) / 10 || 0;
const manyRegions = 8; // more are folded

/** @param {(patch: object, event: Event) => void} change */
export function clipBlock(world, isDisabled, change) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const row = clipsOf(plan).find(({ id }) => id === ui.selection.value.id);
  const part = { world, plan, scene, row, isDisabled, change };
  return html`${row ? planeBlock(part) : nothing}${capBlock(part)}${exemptBlock(part)}${cuttingBlock(part)}`;
}

function planeBlock(part) {
  const { row, plan, scene, isDisabled, change, world } = part;
  const { id } = row;
  const { enabled: isOn } = scene.clip[id];
  return html`<section class="block clip-plane"><h3>${icon('clip')} Clip plane, ${row.axis ?? id} <span class="clip-on">${checkbox('on', isOn, isDisabled, (on, event) => change(switchedClip(plan, scene, id, on), event), 'Whether this plane cuts')}</span></h3>
    ${row.axis ? axisFields(part) : id === 'beam' ? beamFields(part) : freeFields(part)}
    <div class="buttons"><button ?disabled=${isDisabled} title="Through the crosshair" @click=${(event) => change(clipThrough(plan, scene, id, crosshair(scene)), event)}>${icon('crosshair')}To crosshair</button>
      ${id === 'beam' ? nothing : html`<button ?disabled=${isDisabled} title="Keep the other side" @click=${(event) => flip(world, id, change, event)}>${icon('flip')}Flip</button>`}
      ${id === 'free' ? freeButtons(part) : nothing}</div></section>`;
}

function flip({ room, ui }, id, change, event) {
  const flipped = flippedClip(room.scene.value, id);
  change(flipped.patch, event);
  ui.select('clip', flipped.id);
}

/** Low and high of the axis: numbers, and one slider with both. */
function axisFields({ row, plan, scene, isDisabled, change }) {
  const ids = [`${row.axis}_low`, `${row.axis}_high`];
  const range = rangeOfClip(plan, scene, row.id);
  const [low, high] = ids.map((id) => scene.clip[id]);
  const isBoth = low.enabled && high.enabled;
  const move = (at) => (mm, event) => {
    const value = !isBoth ? mm : at ? Math.max(mm, low.position_mm) : Math.min(mm, high.position_mm);
    change(movedClip(plan, scene, ids[at], value), event);
  };
  const field = (at, word) => {
    const [id, style] = [ids[at], [low, high][at]];
    const { keeps } = clipRow(id);
    return html`<div class=${style.enabled ? '' : 'off'}>${checkbox(word, style.enabled, isDisabled, (on, event) => change(switchedClip(plan, scene, id, on), event), `Keep what is ${keeps} it`)}
      <span class="clip-number"><span aria-hidden="true">${row.letter}</span>${numberField(`${row.name}, keeps ${keeps}, ${row.letter} in mm`, tenths(style.position_mm), 'mm', isDisabled, (value, event) => change(movedClip(plan, scene, id, value), event))}</span></div>`;
  };
  const thumbs = ids.map((id, at) => ({
    label: `${row.name}, keeps ${clipRow(id).keeps}`,
    value: tenths([low, high][at].position_mm),
    text: clipPosition(row, [low, high][at].position_mm),
    isOn: [low, high][at].enabled,
    isChosen: id === row.id,
    move: move(at),
  }));
  return html`<div class="clip-ends">${field(0, 'Keeps from')}${field(1, 'to')}</div>
    ${clipRange(range, thumbs, [low.enabled ? low.position_mm : range.low, high.enabled ? high.position_mm : range.high], isDisabled)}
    ${ends(row, range)}
    ${leavesNothing(scene, row.axis) ? html`<p class="note why" role="status">${icon('warning', 12)} Nothing is left: each of the two planes cuts off what the other one keeps.</p>` : nothing}`;
}

const ends = (row, { low, high }) =>
  html`<div class="clip-scale"><span>${clipPosition(row, low)}</span><span>${clipPosition(row, high)}</span></div>`;

/** One number and a slider with one thumb: along a beam, or along the free plane's normal. */
function alongFields({ row, plan, scene, isDisabled, change }, label, keptFrom) {
  const range = rangeOfClip(plan, scene, row.id);
  const position = positionOfClip(plan, scene, row.id);
  const move = (mm, event) => change(movedClip(plan, scene, row.id, mm), event);
  const { enabled: isOn } = scene.clip[row.id];
  const kept = !isOn ? [range.low, range.high] : keptFrom ? [position, range.high] : [range.low, position];
  return html`<dl class="clip-list"><dt>${label}</dt><dd>${numberField(`${label} in mm`, tenths(position), 'mm', isDisabled, move)}</dd></dl>
    ${clipRange(range, [{ label, value: tenths(position), text: clipPosition(row, position), isOn, isChosen: true, move }], kept, isDisabled)}${ends(row, range)}`;
}

function beamFields(part) {
  const { plan, scene, isDisabled, change } = part;
  const shown = beamOf(plan, scene);
  return html`${plan.beams.length > 1 ? html`<div class="clip-beams" role="group" aria-label="Beam of the plane">${plan.beams.map(({ id, name }) => html`<button class=${id === shown.id ? 'on' : ''} aria-pressed=${id === shown.id} ?disabled=${isDisabled} @click=${(event) => change({ clip: { beam: { id } } }, event)}>${name || id}</button>`)}</div>` : nothing}
    ${alongFields(part, 'From the entry', true)}<p class="note">Across the beam ${shown.name || shown.id}, towards its target. What lies before the plane, as the beam runs, is cut off.</p>`;
}

function freeFields(part) {
  const { scene, isDisabled, change } = part;
  const { origin_mm: origin, normal } = scene.clip.free;
  const { turn, tilt } = anglesOf(normal);
  const place = (axis) => (value, event) =>
    change({ clip: { free: { origin_mm: replaced(origin, axis, Math.min(Math.max(value, -1e5), 1e5)) } } }, event);
  return html`${alongFields(part, 'Along its direction', false)}
    <dl class="clip-list"><dt title="About the patient's long axis: 0 anterior, 90 left, 180 posterior, −90 right">Turn</dt><dd>${numberField('Turn in degrees', tenths(turn), '°', isDisabled, (value, event) => change(freeByAngles(value, tilt), event))}</dd>
      <dt title="Upwards: 90 superior, −90 inferior">Tilt</dt><dd>${numberField('Tilt in degrees', tenths(tilt), '°', isDisabled, (value, event) => change(freeByAngles(turn, Math.min(Math.max(value, -90), 90)), event))}</dd>
      <dt>Through</dt><dd class="clip-origin">${['L', 'P', 'S'].map((letter, axis) => numberField(`Origin, ${letter} in mm`, tenths(origin[axis]), letter, isDisabled, place(axis)))}</dd></dl>
    <p class="note">Cuts off what faces ${facing(normal)}. Turn: 0° anterior, 90° left; tilt: 90° superior.</p>`;
}

function freeButtons({ world, plan, scene, isDisabled, change }) {
  const { panes, ui } = world;
  const camera = () => (panes()[ui.active.value - 1]?.actions.is3d ? panes()[ui.active.value - 1] : panes()[0]).actions.camera;
  const square = (event) =>
    change({ clip: { free: { normal: axes(camera()).forward.map((value) => Math.round(-value * 1e6) / 1e6 || 0) } } }, event);
  const shown = beamOf(plan, scene);
  const beam = shown && alongBeam({ entry_mm: shown.entry, target_mm: shown.target });
  return html`<button ?disabled=${isDisabled} title="Square to the line of sight of the 3-D picture; what is nearer is cut off" @click=${square}>Square to the view</button>
    ${beam ? html`<button ?disabled=${isDisabled} title=${`Through the axis of the beam ${shown.name || shown.id}, upright`} @click=${(event) => change({ clip: { free: beam } }, event)}>Along the beam</button>` : nothing}`;
}

function capBlock({ row, plan, scene, isDisabled, change }) {
  const { cap } = scene.clip;
  const image = shownImage(plan, scene);
  const set = (name) => (on, event) => change({ clip: { cap: { [name]: on } } }, event);
  return html`<section class="block"><h3>Cap ${row ? html`<span class="clip-on">${checkbox('closed', scene.clip[row.id].cap, isDisabled, (on, event) => change({ clip: { [row.id]: { cap: on } } }, event), 'Whether the cut through solid things is closed (K: of all planes)')}</span>` : html`<span class="dim">what caps show</span>`}</h3>
    <div class="clip-checks">${checkbox(image ? `Image, ${image.name || image.modality}` : 'Image', cap.image, isDisabled, set('image'), 'The image, as slices show it')}
      ${checkbox('Region colours', cap.regions, isDisabled, set('regions'), 'The colours of the visible regions, mixed with the image')}
      ${checkbox('Outlines', cap.outlines, isDisabled, set('outlines'), 'The outlines of the visible regions')}</div>
    <p class="note">Of all planes. Where there is nothing to show a cap is dark.</p></section>`;
}

function exemptBlock({ plan, scene, isDisabled, change }) {
  const regions = ownRegions(plan, scene);
  const names = regions.map(
    ({ id, name, color }) => html`<label><input type="checkbox" .checked=${!scene.regions[id]?.clipped} ?disabled=${isDisabled}
    @change=${(event) => change({ regions: { [id]: { clipped: !event.target.checked } } }, event)}>${swatch(scene.regions[id]?.color ?? color)}${name}</label>`,
  );
  const n = regions.filter(({ id }) => scene.regions[id]?.clipped === false).length;
  return html`<section class="block"><h3>Not cut <span class="dim">by any plane</span></h3>
    ${names.length > manyRegions ? html`<details class="more"><summary>${icon('chevronDown', 12)}Regions <span class="dim">${n ? `${number(n)} not cut` : 'all are cut'}</span></summary><div class="clip-checks">${names}</div></details>` : html`<div class="clip-checks">${names}</div>`}
    <div class="clip-checks">${
      plan.images.length
        ? html`${checkbox('Slices', !scene.image.clipped, isDisabled, (on, event) => change({ image: { clipped: !on } }, event), 'The slices in the 3-D picture')}
      ${checkbox('Volume', !scene.image.volume.clipped, isDisabled, (on, event) => change({ image: { volume: { clipped: !on } } }, event), 'The image as a volume')}`
        : nothing
    }</div></section>`;
}

function cuttingBlock({ world, plan, scene, isDisabled, change }) {
  const on = enabledClips(plan, scene);
  if (!on.length)
    return html`<section class="block"><p class="note">No plane cuts. C in a pane turns clipping on, K closes or opens the cuts.</p></section>`;
  const off = (event) => {
    const { patch, remembered } = toggledClips(plan, scene, world.ui.clips);
    world.ui.clips = remembered;
    change(patch, event);
  };
  return html`<section class="block"><h3>Planes that cut</h3><table><thead><tr><th scope="col">Plane</th><th scope="col">at</th><th scope="col">cap</th></tr></thead>
      <tbody>${on.map(({ id }) => html`<tr><td>${clipName(id)}</td><td>${clipPosition(clipRow(id), positionOfClip(plan, scene, id))}</td><td aria-label=${`${clipWords(id)} ${scene.clip[id].cap ? 'with cap' : 'without cap'}`}>${scene.clip[id].cap ? icon('check', 12) : '–'}</td></tr>`)}</tbody></table>
    <div class="buttons"><button ?disabled=${isDisabled} @click=${(event) => change(allThroughCrosshair(plan, scene), event)}>${icon('crosshair')}All to crosshair</button>
      <button ?disabled=${isDisabled} title="All planes off, and on again with C" @click=${off}>All off</button></div></section>`;
}
