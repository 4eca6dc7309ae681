// The inspector's Selection of an image: its window and colours, and a second image blended over the one shown.
import { html, nothing } from '../../../lib/lit-html.js';
import { live } from '../../../lib/directives/live.js';
import { blendedImage, lookPatch } from '../../room/image_look.js';
import { isLowWhite, shownImage } from '../../room/plan.js';
import { numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { imageName, showImage } from './image_shown.js';
import { slicesBlock } from './picture.js';
import { colorBar } from './image_legend.js';
import { colorMapRow, windowFields } from './window_fields.js';
import { say } from './later_words.js';

export function imageBlock(world, isDisabled, change) {
  const { room, ui } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const image = plan.images.find(({ id }) => id === ui.selection.value.id) ?? shownImage(plan, scene);
  if (!image) return nothing;
  const isShown = image === shownImage(plan, scene);
  const set = (window, event) => change(lookPatch(plan, scene, image, { window }), event);
  return html`<section class="block"><h3>${icon('image')} ${say.imageNamed({ image: image.name || image.modality })} <span class="dim">${image.id}</span></h3>
      ${isShown ? nothing : html`<p class="note">${blendedImage(plan, scene) === image ? say.blendedOver : say.notShown}</p><div class="buttons"><button ?disabled=${isDisabled} @click=${(event) => showImage(world, image, event)}>${say.showThis}</button></div>`}
      <dl><dt>${say.voxels}</dt><dd>${image.size.join(' × ')}</dd></dl>
      ${windowFields(world, image, false, isDisabled, set)}
      ${colorBar(world, image)}
      <dl class="image-rows">${colorMapRow(world, image, false, isDisabled, change)}
        ${
          isShown
            ? html`<dt>${say.lowValues}</dt><dd>${segment(
                say.lowValues,
                [
                  ['black', say.black],
                  ['white', say.white, say.whiteIs],
                ],
                isLowWhite(image, scene) ? 'white' : 'black',
                isDisabled,
                (low_values, event) => change({ image: { low_values } }, event),
              )}</dd>
        <dt>${say.betweenVoxels}</dt><dd>${segment(
          say.interpolation,
          [
            ['linear', say.linear],
            ['nearest', say.nearest],
          ],
          scene.image.interpolation,
          isDisabled,
          (interpolation, event) => change({ image: { interpolation } }, event),
        )}</dd>`
            : nothing
        }</dl></section>
    ${isShown ? html`${blendBlock(world, image, isDisabled, change)}${slicesBlock(scene, image, isDisabled, change)}` : nothing}`;
}

/** A second image over the one shown, each on its own grid. */
function blendBlock(world, image, isDisabled, change) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const others = plan.images.filter((other) => other !== image);
  if (!others.length) return nothing;
  const blended = blendedImage(plan, scene);
  const percent = Math.round((scene.image.blend?.opacity ?? 0.5) * 100);
  const setOpacity = (value, event) =>
    Number.isFinite(value) && change({ image: { blend: { opacity: Math.min(Math.max(value, 0), 100) / 100 } } }, event);
  const options = [['', say.none], ...others.map((other) => [other.id, imageName(plan, other)])];
  const choose = (id, event) => change({ image: { blend: { id } } }, event);
  return html`<section class="block"><h3>${say.secondOver}</h3>
    <select aria-label=${say.second} ?disabled=${isDisabled} @change=${(event) => choose(event.target.value, event)}>${options.map(([id, name]) => html`<option value=${id} .selected=${live(id === (blended?.id ?? ''))}>${name}</option>`)}</select>
    ${
      blended
        ? html`<dl class="image-rows"><dt>${say.opacity}</dt><dd class="pair"><input type="range" min="0" max="100" step="1" .value=${live(String(percent))} aria-label=${say.secondOpacity} ?disabled=${isDisabled}
        @input=${(event) => setOpacity(event.target.valueAsNumber, event)}>${numberField(say.secondOpacityPercent, percent, '%', isDisabled, setOpacity)}</dd></dl>
      ${windowFields(world, blended, true, isDisabled, (window, event) => change(lookPatch(plan, room.scene.value, blended, { window }), event))}
      ${colorBar(world, blended)}
      <dl class="image-rows">${colorMapRow(world, blended, true, isDisabled, change)}</dl>`
        : nothing
    }</section>`;
}
