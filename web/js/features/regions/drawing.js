// Below a selected region: how the surfaces, outlines, points and splines of all regions are drawn, and the check of a segmentation.
import { html, nothing } from '../../../lib/lit-html.js';
import { ownRegions } from '../../room/identity.js';
import { algorithms } from './shapes.js';
import { textureOf, texturePatch, textures } from './textures.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';

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
  return html`<section class="block"><h3>Surfaces <span class="dim">of all regions</span></h3>
    <dl><dt>Made by</dt><dd>${segment('Surface', algorithms, surface.algorithm, isDisabled, (algorithm, event) => change({ surface: { algorithm } }, event))}</dd>
      <dt>Shading</dt><dd>${segment(
        'Shading',
        [
          ['vertex', 'Smooth'],
          ['face', 'Faceted'],
        ],
        surface.normals,
        isDisabled,
        (normals, event) => change({ surface: { normals } }, event),
      )}</dd>
      <dt>Coloured by</dt><dd>${segment('All regions coloured by', textures(plan, texture), texture, isDisabled, (wanted, event) => change(texturePatch(ownRegions(plan, scene), wanted), event))}</dd></dl></section>`;
}

function outlines(outline, isDisabled, change) {
  return html`<section class="block"><h3>Outlines <span class="dim">of all regions</span></h3>
    <dl><dt>Run</dt><dd>${segment(
      'Outlines run',
      [
        ['surface', 'Surface', 'Where the slice cuts what 3-D shows'],
        ['marching-squares', 'Between', 'Marching squares, midway between inside and outside'],
        ['traced', 'Through', 'Traced along the centres of the border univels'],
      ],
      outline.method,
      isDisabled,
      (method, event) => change({ outline: { method } }, event),
    )}</dd>
      <dt>Width</dt><dd>${numberField('Width of outlines', outline.width_px, 'px', isDisabled, (value, event) => change({ outline: { width_px: clamp(value, 1, 8) } }, event))}</dd></dl>
    <div class="checks">${checkbox('On slices', outline.on_slices, isDisabled, (on_slices, event) => change({ outline: { on_slices } }, event), 'Outlines of the visible regions over the image')}</div></section>`;
}

function points(style, isDisabled, change) {
  return html`<section class="block"><h3>Points <span class="dim">of all regions</span></h3>
    <dl><dt>Size</dt><dd>${numberField('Size of points', style.size_px, 'px', isDisabled, (value, event) => change({ points: { size_px: clamp(value, 1, 16) } }, event))}</dd>
      <dt>Light on solid</dt><dd>${segment(
        'Light on solid points',
        [
          ['baked', 'Fixed', 'Worked out once, from one direction'],
          ['live', 'Live', 'From the eye'],
        ],
        style.solid,
        isDisabled,
        (solid, event) => change({ points: { solid } }, event),
      )}</dd></dl>
    <div class="checks">${checkbox('Inner boundary too', style.inner_boundary, isDisabled, (inner_boundary, event) => change({ points: { inner_boundary } }, event), 'Also where a region touches only regions inside it')}</div></section>`;
}

function splines(nurbs, isDisabled, change) {
  return html`<section class="block"><h3>NURBS <span class="dim">of all regions</span></h3>
    <dl><dt>Order</dt><dd>${segment(
      'Order',
      [
        [2, '2', 'Linear'],
        [3, '3', 'Quadratic'],
        [4, '4', 'Cubic'],
      ],
      nurbs.order,
      isDisabled,
      (order, event) => change({ nurbs: { order } }, event),
    )}</dd>
      <dt>Control points</dt><dd>${segment(
        'Control points',
        [
          ['traces', 'Traces', 'Evenly along each outline'],
          ['degree-bins', 'Degree bins', 'The outermost point of each sector'],
        ],
        nurbs.sampling,
        isDisabled,
        (sampling, event) => change({ nurbs: { sampling } }, event),
      )}</dd>
      <dt>Around a slice</dt><dd>${numberField('Control points around a slice', nurbs.bins, '', isDisabled, (value, event) => change({ nurbs: { bins: clamp(Math.round(value), 8, 360) } }, event))}</dd></dl></section>`;
}

/** The check of a segmentation, for one region or for all visible ones. */
function check(style, chosen, plan, isDisabled, change) {
  const checked = plan.regions.find((region) => region.id === style.region);
  const options = [['', 'All visible'], ...[...new Set([checked, chosen])].filter(Boolean).map((region) => [region.id, region.name])];
  return html`<section class="block"><h3>Check of the segmentation</h3>
    <div class="checks">${checkbox('Mark where surface and univels differ', style.visible, isDisabled, (visible, event) => change({ check: { visible } }, event), 'On the slice panes')}</div>
    ${style.visible ? html`<dl class="check-of"><dt>Of</dt><dd>${segment('Regions to check', options, style.region, isDisabled, (region, event) => change({ check: { region } }, event))}</dd></dl>` : nothing}</section>`;
}
