// Below a selected region: how the surfaces, outlines, points and splines of all regions are drawn, and the check of a segmentation.
import { html, nothing } from '../../../lib/lit-html.js';
import { ownRegions } from '../../room/identity.js';
import { algorithms } from './representations.js';
import { textureOf, texturePatch, textures } from './textures.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { say } from './later_words.js';

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

export function drawingBlocks({ room, ui }, isDisabled, change) {
  const scene = room.scene.value;
  const plan = room.plan.value;
  if (!plan.regions.length) return nothing;
  const isUsed = (...words) => plan.regions.some((region) => words.includes(scene.regions[region.id]?.representation));
  return html`${surfaces(scene.surface, plan, scene, isDisabled, change)}${outlines(scene.outline, isDisabled, change)}
    ${isUsed('points', 'solid') ? points(scene.points, isDisabled, change) : nothing}
    ${isUsed('nurbs') ? splines(scene.nurbs, isDisabled, change) : nothing}
    ${check(
      scene.check,
      plan.regions.find((region) => region.id === ui.region.value),
      plan,
      isDisabled,
      change,
    )}`;
}

function surfaces(surface, plan, scene, isDisabled, change) {
  const texture = textureOf(scene, ownRegions(plan, scene));
  return html`<section class="block"><h3>${say.surfaces} <span class="dim">${say.ofAll}</span></h3>
    <dl><dt>${say.madeBy}</dt><dd>${segment(say.surface, algorithms, surface.algorithm, isDisabled, (algorithm, event) => change({ surface: { algorithm } }, event))}</dd>
      <dt>${say.shading}</dt><dd>${segment(
        say.shading,
        [
          ['vertex', say.smooth],
          ['face', say.faceted],
        ],
        surface.normals,
        isDisabled,
        (normals, event) => change({ surface: { normals } }, event),
      )}</dd>
      <dt>${say.colouredBy}</dt><dd>${segment(say.allColouredBy, textures(plan, texture), texture, isDisabled, (wanted, event) => change(texturePatch(ownRegions(plan, scene), wanted), event))}</dd></dl></section>`;
}

function outlines(outline, isDisabled, change) {
  return html`<section class="block"><h3>${say.outlines} <span class="dim">${say.ofAll}</span></h3>
    <dl><dt>${say.run}</dt><dd>${segment(
      say.outlinesRun,
      [
        ['surface', say.alongSurface, say.alongSurfaceIs],
        ['marching-squares', say.between, say.betweenIs],
        ['traced', say.through, say.throughIs],
      ],
      outline.method,
      isDisabled,
      (method, event) => change({ outline: { method } }, event),
    )}</dd>
      <dt>${say.width}</dt><dd>${numberField(say.widthOf, outline.width_px, 'px', isDisabled, (value, event) => change({ outline: { width_px: clamp(value, 1, 8) } }, event))}</dd></dl>
    <div class="checks">${checkbox(say.onSlices, outline.on_slices, isDisabled, (on_slices, event) => change({ outline: { on_slices } }, event), say.onSlicesIs)}</div></section>`;
}

function points(style, isDisabled, change) {
  return html`<section class="block"><h3>${say.points} <span class="dim">${say.ofAll}</span></h3>
    <dl><dt>${say.size}</dt><dd>${numberField(say.sizeOf, style.size_px, 'px', isDisabled, (value, event) => change({ points: { size_px: clamp(value, 1, 16) } }, event))}</dd>
      <dt>${say.light}</dt><dd>${segment(
        say.lightOn,
        [
          ['baked', say.fixed, say.fixedIs],
          ['live', say.live, say.liveIs],
        ],
        style.solid,
        isDisabled,
        (solid, event) => change({ points: { solid } }, event),
      )}</dd></dl>
    <div class="checks">${checkbox(say.inner, style.inner_boundary, isDisabled, (inner_boundary, event) => change({ points: { inner_boundary } }, event), say.innerIs)}</div></section>`;
}

function splines(nurbs, isDisabled, change) {
  return html`<section class="block"><h3>NURBS <span class="dim">${say.ofAll}</span></h3>
    <dl><dt>${say.nurbsOrder}</dt><dd>${segment(
      say.nurbsOrder,
      [
        [2, '2', say.linear],
        [3, '3', say.quadratic],
        [4, '4', say.cubic],
      ],
      nurbs.order,
      isDisabled,
      (order, event) => change({ nurbs: { order } }, event),
    )}</dd>
      <dt>${say.controlPoints}</dt><dd>${segment(
        say.controlPoints,
        [
          ['traces', say.traces, say.tracesAre],
          ['degree-bins', say.degreeBins, say.degreeBinsAre],
        ],
        nurbs.sampling,
        isDisabled,
        (sampling, event) => change({ nurbs: { sampling } }, event),
      )}</dd>
      <dt>${say.aroundSlice}</dt><dd>${numberField(say.aroundSliceIs, nurbs.bins, '', isDisabled, (value, event) => change({ nurbs: { bins: clamp(Math.round(value), 8, 360) } }, event))}</dd></dl></section>`;
}

/** The check of a segmentation, for one region or for all visible ones. */
function check(style, chosen, plan, isDisabled, change) {
  const checked = plan.regions.find((region) => region.id === style.region);
  const options = [['', say.allVisible], ...[...new Set([checked, chosen])].filter(Boolean).map((region) => [region.id, region.name])];
  return html`<section class="block"><h3>${say.check}</h3>
    <div class="checks">${checkbox(say.mark, style.visible, isDisabled, (visible, event) => change({ check: { visible } }, event), say.onPanes)}</div>
    ${style.visible ? html`<dl class="check-of"><dt>${say.of}</dt><dd>${segment(say.toCheck, options, style.region, isDisabled, (region, event) => change({ check: { region } }, event))}</dd></dl>` : nothing}</section>`;
}
