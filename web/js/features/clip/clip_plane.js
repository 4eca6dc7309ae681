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
import { say } from './later_words.js';

const tenths = (value) => Math.round(value * 10) / 10 || 0;
const manyRegions = 8; // more are folded
const headings = {
  axial: say.planeAxial,
  sagittal: say.planeSagittal,
  coronal: say.planeCoronal,
  beam: say.planeBeam,
  free: say.planeFree,
};
/** Each plane of an axis: its name with the side that it keeps, and what its switch does. */
const sides = {
  axial_high: { label: say.keepsBelow, about: say.keepBelow },
  axial_low: { label: say.keepsAbove, about: say.keepAbove },
  sagittal_high: { label: say.keepsRight, about: say.keepRight },
  sagittal_low: { label: say.keepsLeft, about: say.keepLeft },
  coronal_low: { label: say.keepsBehind, about: say.keepBehind },
  coronal_high: { label: say.keepsBefore, about: say.keepBefore },
};

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
  return html`<section class="block clip-plane"><h3>${icon('clip')} ${headings[row.axis ?? id]} <span class="clip-on">${checkbox(say.on, isOn, isDisabled, (on, event) => change(switchedClip(plan, scene, id, on), event), say.whetherCuts)}</span></h3>
    ${row.axis ? axisFields(part) : id === 'beam' ? beamFields(part) : freeFields(part)}
    <div class="buttons"><button ?disabled=${isDisabled} title=${say.throughCrosshair} @click=${(event) => change(clipThrough(plan, scene, id, crosshair(scene)), event)}>${icon('crosshair')}${say.toCrosshair}</button>
      ${id === 'beam' ? nothing : html`<button ?disabled=${isDisabled} title=${say.otherSide} @click=${(event) => flip(world, id, change, event)}>${icon('flip')}${say.flip}</button>`}
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
    const { label, about } = sides[id];
    return html`<div class=${style.enabled ? '' : 'off'}>${checkbox(word, style.enabled, isDisabled, (on, event) => change(switchedClip(plan, scene, id, on), event), about)}
      <span class="clip-number"><span aria-hidden="true">${row.letter}</span>${numberField(say.sideInMm({ side: label, letter: row.letter }), tenths(style.position_mm), 'mm', isDisabled, (value, event) => change(movedClip(plan, scene, id, value), event))}</span></div>`;
  };
  const thumbs = ids.map((id, at) => ({
    label: sides[id].label,
    value: tenths([low, high][at].position_mm),
    text: clipPosition(row, [low, high][at].position_mm),
    isOn: [low, high][at].enabled,
    isChosen: id === row.id,
    move: move(at),
  }));
  return html`<div class="clip-ends">${field(0, say.keepsFrom)}${field(1, say.to)}</div>
    ${clipRange(range, thumbs, [low.enabled ? low.position_mm : range.low, high.enabled ? high.position_mm : range.high], isDisabled)}
    ${ends(row, range)}
    ${leavesNothing(scene, row.axis) ? html`<p class="note why" role="status">${icon('warning', 12)} ${say.nothingLeft}</p>` : nothing}`;
}

const ends = (row, { low, high }) =>
  html`<div class="clip-scale"><span>${clipPosition(row, low)}</span><span>${clipPosition(row, high)}</span></div>`;

/** One number and a slider with one thumb: along a beam, or along the free plane's normal. */
function alongFields({ row, plan, scene, isDisabled, change }, label, inMm, keptFrom) {
  const range = rangeOfClip(plan, scene, row.id);
  const position = positionOfClip(plan, scene, row.id);
  const move = (mm, event) => change(movedClip(plan, scene, row.id, mm), event);
  const { enabled: isOn } = scene.clip[row.id];
  const kept = !isOn ? [range.low, range.high] : keptFrom ? [position, range.high] : [range.low, position];
  return html`<dl class="clip-list"><dt>${label}</dt><dd>${numberField(inMm, tenths(position), 'mm', isDisabled, move)}</dd></dl>
    ${clipRange(range, [{ label, value: tenths(position), text: clipPosition(row, position), isOn, isChosen: true, move }], kept, isDisabled)}${ends(row, range)}`;
}

function beamFields(part) {
  const { plan, scene, isDisabled, change } = part;
  const shown = beamOf(plan, scene);
  return html`${plan.beams.length > 1 ? html`<div class="clip-beams" role="group" aria-label=${say.beamOf}>${plan.beams.map(({ id, name }) => html`<button class=${id === shown.id ? 'on' : ''} aria-pressed=${id === shown.id} ?disabled=${isDisabled} @click=${(event) => change({ clip: { beam: { id } } }, event)}>${name || id}</button>`)}</div>` : nothing}
    ${alongFields(part, say.fromEntry, say.fromEntryMm, true)}<p class="note">${say.acrossBeam({ beam: shown.name || shown.id })}</p>`;
}

function freeFields(part) {
  const { scene, isDisabled, change } = part;
  const { origin_mm: origin, normal } = scene.clip.free;
  const { turn, tilt } = anglesOf(normal);
  const place = (axis) => (value, event) =>
    change({ clip: { free: { origin_mm: replaced(origin, axis, Math.min(Math.max(value, -1e5), 1e5)) } } }, event);
  return html`${alongFields(part, say.alongDirection, say.alongDirectionMm, false)}
    <dl class="clip-list"><dt title=${say.turnIs}>${say.turn}</dt><dd>${numberField(say.turnDegrees, tenths(turn), '°', isDisabled, (value, event) => change(freeByAngles(value, tilt), event))}</dd>
      <dt title=${say.tiltIs}>${say.tilt}</dt><dd>${numberField(say.tiltDegrees, tenths(tilt), '°', isDisabled, (value, event) => change(freeByAngles(turn, Math.min(Math.max(value, -90), 90)), event))}</dd>
      <dt>${say.through}</dt><dd class="clip-origin">${['L', 'P', 'S'].map((letter, axis) => numberField(say.originMm({ letter }), tenths(origin[axis]), letter, isDisabled, place(axis)))}</dd></dl>
    <p class="note">${say.cutsOff({ direction: facing(normal) })}</p>`;
}

function freeButtons({ world, plan, scene, isDisabled, change }) {
  const { panes, ui } = world;
  const camera = () => (panes()[ui.active.value - 1]?.actions.is3d ? panes()[ui.active.value - 1] : panes()[0]).actions.camera;
  const square = (event) =>
    change({ clip: { free: { normal: axes(camera()).forward.map((value) => Math.round(-value * 1e6) / 1e6 || 0) } } }, event);
  const shown = beamOf(plan, scene);
  const beam = shown && alongBeam({ entry_mm: shown.entry, target_mm: shown.target });
  return html`<button ?disabled=${isDisabled} title=${say.squareIs} @click=${square}>${say.square}</button>
    ${beam ? html`<button ?disabled=${isDisabled} title=${say.throughBeam({ beam: shown.name || shown.id })} @click=${(event) => change({ clip: { free: beam } }, event)}>${say.alongBeam}</button>` : nothing}`;
}

function capBlock({ row, plan, scene, isDisabled, change }) {
  const { cap } = scene.clip;
  const image = shownImage(plan, scene);
  const set = (name) => (on, event) => change({ clip: { cap: { [name]: on } } }, event);
  return html`<section class="block"><h3>${say.cap} ${row ? html`<span class="clip-on">${checkbox(say.closed, scene.clip[row.id].cap, isDisabled, (on, event) => change({ clip: { [row.id]: { cap: on } } }, event), say.closedIs)}</span>` : html`<span class="dim">${say.capsShow}</span>`}</h3>
    <div class="clip-checks">${checkbox(image ? say.imageNamed({ image: image.name || image.modality }) : say.image, cap.image, isDisabled, set('image'), say.imageIs)}
      ${checkbox(say.colours, cap.regions, isDisabled, set('regions'), say.coloursIs)}
      ${checkbox(say.outlines, cap.outlines, isDisabled, set('outlines'), say.outlinesIs)}</div>
    <p class="note">${say.capsNote}</p></section>`;
}

function exemptBlock({ plan, scene, isDisabled, change }) {
  const regions = ownRegions(plan, scene);
  const names = regions.map(
    ({ id, name, color }) => html`<label><input type="checkbox" .checked=${!scene.regions[id]?.clipped} ?disabled=${isDisabled}
    @change=${(event) => change({ regions: { [id]: { clipped: !event.target.checked } } }, event)}>${swatch(scene.regions[id]?.color ?? color)}${name}</label>`,
  );
  const n = regions.filter(({ id }) => scene.regions[id]?.clipped === false).length;
  return html`<section class="block"><h3>${say.notCut} <span class="dim">${say.byAny}</span></h3>
    ${names.length > manyRegions ? html`<details class="more"><summary>${icon('chevronDown', 12)}${say.regions} <span class="dim">${n ? say.nNotCut({ n: number(n) }) : say.allCut}</span></summary><div class="clip-checks">${names}</div></details>` : html`<div class="clip-checks">${names}</div>`}
    <div class="clip-checks">${
      plan.images.length
        ? html`${checkbox(say.slices, !scene.image.clipped, isDisabled, (on, event) => change({ image: { clipped: !on } }, event), say.slicesIs)}
      ${checkbox(say.volume, !scene.image.volume.clipped, isDisabled, (on, event) => change({ image: { volume: { clipped: !on } } }, event), say.volumeIs)}`
        : nothing
    }</div></section>`;
}

function cuttingBlock({ world, plan, scene, isDisabled, change }) {
  const on = enabledClips(plan, scene);
  if (!on.length) return html`<section class="block"><p class="note">${say.noPlane}</p></section>`;
  const off = (event) => {
    const { patch, remembered } = toggledClips(plan, scene, world.ui.clips);
    world.ui.clips = remembered;
    change(patch, event);
  };
  return html`<section class="block"><h3>${say.planesCut}</h3><table><thead><tr><th scope="col">${say.plane}</th><th scope="col">${say.at}</th><th scope="col">${say.capColumn}</th></tr></thead>
      <tbody>${on.map(({ id }) => html`<tr><td>${clipName(id)}</td><td>${clipPosition(clipRow(id), positionOfClip(plan, scene, id))}</td><td aria-label=${(scene.clip[id].cap ? say.withCap : say.withoutCap)({ plane: clipWords(id) })}>${scene.clip[id].cap ? icon('check', 12) : '–'}</td></tr>`)}</tbody></table>
    <div class="buttons"><button ?disabled=${isDisabled} @click=${(event) => change(allThroughCrosshair(plan, scene), event)}>${icon('crosshair')}${say.allToCrosshair}</button>
      <button ?disabled=${isDisabled} title=${say.allOffIs} @click=${off}>${say.allOff}</button></div></section>`;
}
