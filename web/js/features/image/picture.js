// Parts of the inspector's Selection: the 3-D picture, and the slices in it.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { cullsNothing, usualCull } from '../../room/image_look.js';
import { shownImage } from '../../room/plan.js';
import { numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { active3d } from '../../pane/pane_layouts.js';

const sides = [
  ['sagittal', 'Sagittal'],
  ['coronal', 'Coronal'],
  ['axial', 'Axial'],
];

/** The slices of the image in the 3-D picture. */
export function slicesBlock(scene, image, isDisabled, change) {
  return html`<section class="block"><h3>Slices in the 3-D picture</h3><div class="checks" role="group" aria-label="Slices in 3-D">${sides.map(
    ([id, name]) => html`<label><input type="checkbox" .checked=${live(scene.image.slices[id].visible)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { slices: { [id]: { visible: event.target.checked } } } }, event)}>${name}</label>`,
  )}</div>${cullRow(scene, image, isDisabled, change)}</section>`;
}

/** The threshold below which slices in the 3-D view are transparent, so that air hides nothing. */
function cullRow(scene, image, isDisabled, change) {
  const { cull_below: value } = scene.image;
  const isOn = value > cullsNothing;
  return html`<div class="checks cull"><label title="Slices in the 3-D view leave out lower values"><input type="checkbox" .checked=${live(isOn)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { cull_below: event.target.checked ? usualCull(image, scene.image.window) : cullsNothing } }, event)}>Leave out below</label>
    ${isOn ? numberField('Leave out values below', Number(value.toPrecision(6)), image.unit, isDisabled, (cull_below, event) => change({ image: { cull_below } }, event)) : nothing}</div>`;
}

/** Camera and translucency of the 3-D picture. */
export function pictureBlock(world, isDisabled, change) {
  const { room } = world;
  const scene = room.scene.value;
  const image = shownImage(room.plan.value, scene);
  const { cameras } = active3d(world).actions;
  return html`<section class="block"><h3>${icon('cube')} 3-D picture</h3>
      <dl>${
        room.view(1).document.value
          ? html`<dt>Projection</dt><dd>${segment(
              'Projection',
              [
                ['perspective', 'Perspective'],
                ['parallel', 'Parallel'],
              ],
              cameras.value.projection,
              isDisabled,
              (id, event) => cameras.setProjection(id, event.timeStamp),
            )}</dd>`
          : nothing
      }
        <dt>Translucency</dt><dd>${segment(
          'Translucency',
          [
            ['rim', 'Rim'],
            ['plain', 'Plain'],
          ],
          scene.surface.translucency,
          isDisabled,
          (translucency, event) => change({ surface: { translucency } }, event),
        )}</dd>
        <dt>Overlaps</dt><dd>${segment(
          'What lies before what',
          [
            ['exact', 'Exact', 'Each pixel in its own order, also where regions cross'],
            ['hierarchy', 'By hierarchy', 'Whole regions, inner before outer, as Sera3d does'],
          ],
          scene.surface.translucent_order,
          isDisabled,
          (translucent_order, event) => change({ surface: { translucent_order } }, event),
        )}</dd></dl>
      <div class="buttons looks" role="group" aria-label="Look from">${[
        'anterior',
        'posterior',
        'left',
        'right',
        'superior',
        'inferior',
      ].map(
        (name) => html`<button ?disabled=${isDisabled} title=${`Look from ${name}`}
        @click=${(event) => cameras.lookFrom(name, event.timeStamp)}>${name[0].toUpperCase()}${name.slice(1)}</button>`,
      )}</div></section>
    ${image ? slicesBlock(scene, image, isDisabled, change) : nothing}`;
}
