// The colours of an image: the bar of its window, and the legend of slice panes.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { blendedImage, endsOf, gammaOf, lookOf } from '../../room/image_look.js';
import { isInSpace } from '../../room/kinds.js';
import { isLowWhite, shownImage } from '../../room/plan.js';
import { significant, unitText } from '../../parts/format.js';
import { colorAt, colorMaps } from './color_maps.js';
import { say } from './words.js';

/** Places a window's gamma moves colours to: a grey g is drawn in the colour at g to the power 1 / gamma. */
const gammaPlaces = Array.from({ length: 17 }, (_, i) => i / 16);
function stopsOf(chosen, gamma) {
  const [id, , , stops] = colorMaps.find(([other]) => other === chosen) ?? colorMaps[0];
  return gamma === 1 ? stops : gammaPlaces.map((at) => [at, colorAt(id, at ** (1 / gamma))]);
}

/** The colours of a window from its lower to its upper end. place: names the bar on the page. */
export function colorBar({ room }, image, place = 'panel') {
  const { window, color_map: chosen } = lookOf(room.plan.value, room.scene.value, image);
  const stops = stopsOf(chosen, gammaOf(window));
  const isTurned = image === shownImage(room.plan.value, room.scene.value) ? isLowWhite(image, room.scene.value) : image.isInverted;
  const { low, high } = endsOf(window);
  const id = `image-bar-${place}-${image.id}`;
  return html`<div class="image-bar"><svg viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true"><linearGradient id=${id} x1=${isTurned ? 1 : 0} x2=${isTurned ? 0 : 1}>${stops.map(([at, color]) => svg`<stop offset=${at} stop-color=${color} />`)}</linearGradient>
    <rect width="100" height="10" fill=${`url(#${id})`} /></svg><p><span>${significant(low)}</span><span>${significant(high)} ${unitText(image.unit)}</span></p></div>`;
}

/** Between the bars and the panes, while a slice is on the screen: the colours of the image shown where they are no greys, and of one that is blended over it. */
export function imageLegend({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const blended = blendedImage(plan, scene);
  const shown = shownImage(plan, scene);
  const images = [shown, blended].filter((image) => image && (image === blended || lookOf(plan, scene, image).color_map !== 'grey'));
  const isSlice = room.views.some((view) => view.isOpen.value && !isInSpace(view.kind));
  return isSlice && images.length
    ? html`<ul class="picture-strip image-legend" aria-label=${say.colours}>${images.map((image) => html`<li><b>${image.modality}${image === blended ? ` ${Math.round(scene.image.blend.opacity * 100)} %` : ''}</b>${colorBar({ room }, image, 'strip')}</li>`)}</ul>`
    : nothing;
}
