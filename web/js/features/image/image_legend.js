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

/** The colours of a window from its lower to its upper end. isTurned: the last colour is the lower end's. */
function scaleOf({ room }, image) {
  const { window, color_map: chosen } = lookOf(room.plan.value, room.scene.value, image);
  const isTurned = image === shownImage(room.plan.value, room.scene.value) ? isLowWhite(image, room.scene.value) : image.isInverted;
  return { stops: stopsOf(chosen, gammaOf(window)), isTurned, ...endsOf(window) };
}

/** A bar of the colours of a window. place: names it on the page. */
export function colorBar(world, image, place = 'panel') {
  const { stops, isTurned, low, high } = scaleOf(world, image);
  const id = `image-bar-${place}-${image.id}`;
  return html`<div class="image-bar"><svg viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true"><linearGradient id=${id} x1=${isTurned ? 1 : 0} x2=${isTurned ? 0 : 1}>${stops.map(([at, color]) => svg`<stop offset=${at} stop-color=${color} />`)}</linearGradient>
    <rect width="100" height="10" fill=${`url(#${id})`} /></svg><p><span>${significant(low)}</span><span>${significant(high)} ${unitText(image.unit)}</span></p></div>`;
}

/** The image shown where its colours are no greys, and one that is blended over it. isCounted(image): in greys too. */
function colouredImages({ room }, isCounted = () => false) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const blended = blendedImage(plan, scene);
  const shown = shownImage(plan, scene);
  const isSlice = room.views.some((view) => view.isOpen.value && !isInSpace(view.kind));
  if (!isSlice) return [];
  return [shown, blended]
    .filter((image) => image && (image === blended || lookOf(plan, scene, image).color_map !== 'grey' || isCounted(image)))
    .map((image) => ({ image, name: `${image.modality}${image === blended ? ` ${Math.round(scene.image.blend.opacity * 100)} %` : ''}` }));
}

/** Between the bars and the panes, while a slice is on the screen. */
export function imageLegend(world) {
  const images = colouredImages(world);
  return images.length
    ? html`<ul class="picture-strip image-legend" aria-label=${say.colours}>${images.map(({ image, name }) => html`<li><b>${name}</b>${colorBar(world, image, 'strip')}</li>`)}</ul>`
    : nothing;
}

/** Scales of the colours of images for a wall, of PET and SPECT in greys too, which are quantities. @returns {{name: string, unit: string, gradient: string, ends: string[]}[]} gradient: of CSS, from the lower end to the upper one */
export function imageScales(world) {
  return colouredImages(world, ({ modality }) => /^(PE?T|NM)$/.test(modality)).map(({ image, name }) => {
    const { stops, isTurned, low, high } = scaleOf(world, image);
    const placed = stops.map(([at, color]) => `${color} ${100 * (isTurned ? 1 - at : at)}%`);
    return {
      name,
      unit: unitText(image.unit),
      gradient: `linear-gradient(90deg, ${(isTurned ? placed.reverse() : placed).join(', ')})`,
      ends: [significant(low), significant(high)],
    };
  });
}
