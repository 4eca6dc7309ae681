// Parts of the inspector's Selection: the 3-D picture, and the slices in it.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { cullsNothing, usualCull } from '../../room/image_look.js';
import { shownImage } from '../../room/plan.js';
import { unitText } from '../../parts/format.js';
import { numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { active3d } from '../../pane/pane_layouts.js';
import { lightsBlock } from './lights.js';
import { turningBlock } from './turning.js';
import { say } from './later_words.js';

const sides = [
  ['sagittal', say.sagittal],
  ['coronal', say.coronal],
  ['axial', say.axial],
];

const grounds = { dark: '#08090b', grey: '#808080', white: '#ffffff' };

/** Where the camera can look from: word, name, tooltip. */
const directions = [
  ['anterior', say.anterior, say.fromAnterior],
  ['posterior', say.posterior, say.fromPosterior],
  ['left', say.left, say.fromLeft],
  ['right', say.right, say.fromRight],
  ['superior', say.superior, say.fromSuperior],
  ['inferior', say.inferior, say.fromInferior],
];

/** The slices of the image in the 3-D picture. */
export function slicesBlock(scene, image, isDisabled, change) {
  return html`<section class="block"><h3>${say.slicesIn3d}</h3><div class="checks" role="group" aria-label=${say.slices3d}>${sides.map(
    ([id, name]) => html`<label><input type="checkbox" .checked=${live(scene.image.slices[id].visible)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { slices: { [id]: { visible: event.target.checked } } } }, event)}>${name}</label>`,
  )}</div>${cullRow(scene, image, isDisabled, change)}</section>`;
}

/** The threshold below which slices in the 3-D view are transparent, so that air hides nothing. */
function cullRow(scene, image, isDisabled, change) {
  const { cull_below: value } = scene.image;
  const isOn = value > cullsNothing;
  return html`<div class="checks cull"><label title=${say.leaveOutIs}><input type="checkbox" .checked=${live(isOn)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { cull_below: event.target.checked ? usualCull(image, scene.image.window) : cullsNothing } }, event)}>${say.leaveOut}</label>
    ${isOn ? numberField(say.leaveOutValues, Number(value.toPrecision(6)), unitText(image.unit), isDisabled, (cull_below, event) => change({ image: { cull_below } }, event)) : nothing}</div>`;
}

/** The ground of 3-D pictures: of everybody in the room, as the lights are. */
function groundRow(background, isDisabled, set) {
  const known = Object.keys(grounds).find((name) => grounds[name] === background) ?? '';
  return html`<dt>${say.ground}</dt><dd class="pair ground">${segment(
    say.ground,
    [
      ['dark', say.groundDark],
      ['grey', say.groundGrey],
      ['white', say.groundWhite],
    ],
    known,
    isDisabled,
    (name, event) => set(grounds[name], event),
  )}<input type="color" class="dose-swatch" .value=${live(background)} aria-label=${say.groundColour} title=${say.groundColour} ?disabled=${isDisabled} @input=${(event) => set(event.target.value, event)}></dd>`;
}

/** Camera and translucency of the 3-D picture. */
export function pictureBlock(world, isDisabled, change) {
  const { room } = world;
  const scene = room.scene.value;
  const image = shownImage(room.plan.value, scene);
  const { cameras } = active3d(world).actions;
  return html`<section class="block"><h3>${icon('cube')} ${say.picture}</h3>
      <dl>${
        room.view(1).document.value
          ? html`<dt>${say.projection}</dt><dd>${segment(
              say.projection,
              [
                ['perspective', say.perspective],
                ['parallel', say.parallel],
              ],
              cameras.value.projection,
              isDisabled,
              (id, event) => cameras.setProjection(id, event.timeStamp),
            )}</dd>`
          : nothing
      }
        <dt>${say.translucency}</dt><dd>${segment(
          say.translucency,
          [
            ['rim', say.rim],
            ['plain', say.plain],
          ],
          scene.surface.translucency,
          isDisabled,
          (translucency, event) => change({ surface: { translucency } }, event),
        )}</dd>
        <dt>${say.overlaps}</dt><dd>${segment(
          say.whatBefore,
          [
            ['exact', say.exact, say.exactIs],
            ['hierarchy', say.byHierarchy, say.byHierarchyIs],
          ],
          scene.surface.translucent_order,
          isDisabled,
          (translucent_order, event) => change({ surface: { translucent_order } }, event),
        )}</dd>
        ${scene.space ? groundRow(scene.space.background, isDisabled, (background, event) => change({ space: { background } }, event)) : nothing}</dl>
      <div class="buttons looks" role="group" aria-label=${say.lookFrom}>${directions.map(
        ([from, name, about]) => html`<button ?disabled=${isDisabled} title=${about}
        @click=${(event) => cameras.lookFrom(from, event.timeStamp)}>${name}</button>`,
      )}</div></section>
    ${turningBlock(world, isDisabled)}${lightsBlock(world, isDisabled, change)}
    ${image ? slicesBlock(scene, image, isDisabled, change) : nothing}`;
}
