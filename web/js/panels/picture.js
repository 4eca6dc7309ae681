// Parts of the inspector's Selection: the shown image, and the 3-D picture.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { live } from '../../lib/directives/live.js';
import { isLowWhite, shownImage, windowPresets } from '../state/plan.js';
import { numberField, segment } from './fields.js';
import { icon } from './icons.js';

const sides = [['sagittal', 'Sagittal'], ['coronal', 'Coronal'], ['axial', 'Axial']];
const cullsNothing = -1e12; // proto/scene.json

export function imageBlock(world, isDisabled, change) {
  const { room, ui, panes } = world;
  const scene = room.scene.value;
  const image = shownImage(room.plan.value, scene);
  if (!image) return nothing;
  const { window } = scene.image;
  const setWindow = (value, event) => panes()[ui.active.value - 1].actions.setWindow({ ...window, ...value }, event.timeStamp);
  const isNow = (preset) => Math.abs(preset.center - window.center) < 0.06 && Math.abs(preset.width - window.width) < 0.06;
  return html`<section class="block"><h3>${icon('image')} Image ${image.name || image.modality} <span class="dim">${image.id}</span></h3>
    <dl><dt>Voxels</dt><dd>${image.size.join(' × ')}</dd>
      <dt>Centre</dt><dd>${numberField('Window centre', Math.round(window.center * 10) / 10, image.unit, isDisabled, (center, event) => setWindow({ center }, event))}</dd>
      <dt>Width</dt><dd>${numberField('Window width', Math.round(window.width * 10) / 10, image.unit, isDisabled, (width, event) => setWindow({ width: Math.max(width, 0.1) }, event))}</dd>
      <dt>Low values</dt><dd>${segment('Low values', [['black', 'Black'], ['white', 'White', 'The values stay; only their greys go the other way']], isLowWhite(image, scene) ? 'white' : 'black', isDisabled, (low_values, event) => change({ image: { low_values } }, event))}</dd>
      <dt>Between voxels</dt><dd>${segment('Interpolation', [['linear', 'Linear'], ['nearest', 'Nearest']], scene.image.interpolation, isDisabled, (interpolation, event) => change({ image: { interpolation } }, event))}</dd></dl>
    <div class="buttons looks" role="group" aria-label="Window presets">${windowPresets(image).map((preset) => html`<button class=${classMap({ on: isNow(preset) })} aria-pressed=${isNow(preset)} ?disabled=${isDisabled} title=${`Key ${preset.key}`}
      @click=${(event) => setWindow({ center: preset.center, width: preset.width }, event)}>${preset.name} <kbd>${preset.key}</kbd></button>`)}</div></section>
    ${slicesBlock(scene, image, isDisabled, change)}`;
}

/** The slices of the image in the 3-D picture. */
function slicesBlock(scene, image, isDisabled, change) {
  return html`<section class="block"><h3>Slices in the 3-D picture</h3><div class="checks" role="group" aria-label="Slices in 3-D">${sides.map(([id, name]) => html`<label><input type="checkbox" .checked=${live(scene.image.slices[id].visible)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { slices: { [id]: { visible: event.target.checked } } } }, event)}>${name}</label>`)}</div>${cullRow(scene, image, isDisabled, change)}</section>`;
}

/** The threshold below which slices in the 3-D view are transparent, so that air hides nothing. */
function cullRow(scene, image, isDisabled, change) {
  const { cull_below: value } = scene.image;
  const isOn = value > cullsNothing;
  return html`<div class="checks cull"><label title="Slices in the 3-D view leave out lower values"><input type="checkbox" .checked=${live(isOn)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { cull_below: event.target.checked ? null : cullsNothing } }, event)}>Leave out below</label>
    ${isOn ? numberField('Leave out values below', Number(value.toPrecision(6)), image.unit, isDisabled, (cull_below, event) => change({ image: { cull_below } }, event)) : nothing}</div>`;
}

/** Camera and translucency of the 3-D picture. */
export function pictureBlock({ room, panes }, isDisabled, change) {
  const scene = room.scene.value;
  const image = shownImage(room.plan.value, scene);
  const { camera } = panes()[0].actions;
  return html`<section class="block"><h3>${icon('cube')} 3-D picture</h3>
      <dl>${room.view(1).document.value ? html`<dt>Projection</dt><dd>${segment('Projection', [['perspective', 'Perspective'], ['parallel', 'Parallel']], camera.projection, isDisabled, (id) => panes()[0].actions.setProjection(id))}</dd>` : nothing}
        <dt>Translucency</dt><dd>${segment('Translucency', [['rim', 'Rim'], ['plain', 'Plain']], scene.surface.translucency, isDisabled, (translucency, event) => change({ surface: { translucency } }, event))}</dd>
        <dt>Overlaps</dt><dd>${segment('What lies before what', [['exact', 'Exact', 'Each pixel in its own order, also where regions cross'], ['hierarchy', 'By hierarchy', 'Whole regions, inner before outer, as Sera3d does']], scene.surface.translucent_order, isDisabled, (translucent_order, event) => change({ surface: { translucent_order } }, event))}</dd></dl>
      <div class="buttons looks" role="group" aria-label="Look from">${['anterior', 'posterior', 'left', 'right', 'superior', 'inferior'].map((name) => html`<button ?disabled=${isDisabled} title=${`Look from ${name}`}
        @click=${(event) => panes()[0].actions.lookFrom(name, event.timeStamp)}>${name[0].toUpperCase()}${name.slice(1)}</button>`)}</div></section>
    ${image ? slicesBlock(scene, image, isDisabled, change) : nothing}`;
}
