// Window and colour map of one image as fields, buttons and a bar of its colours, for the image shown and for one blended over it.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import {
  blendedImage,
  colorMaps,
  endsOf,
  isCt,
  isPet,
  isSameWindow,
  lookOf,
  lookPatch,
  roundedWindow,
  windowFrom,
  windowPresets,
} from '../../room/image_look.js';
import { isLowWhite, shownImage } from '../../room/plan.js';
import { numberField, segment } from '../../parts/fields.js';
import { significant, unitText } from '../../parts/format.js';

const narrowest = 1e-15;

/** Formats a value with as many figures as tell the greys of a window of this width apart. */
const shown = (value, width) => Number(value.toFixed(Math.min(Math.max(1, 3 - Math.floor(Math.log10(width))), 20)));

/** The window as the scene has it now, percentiles included where the server knows them. */
export const histogramOf = ({ room, histograms }, image) => (isCt(image) ? null : histograms.of(room.planId.value, image.id));

/**
 * @param {string} of goes before the names of the fields: '' for the image shown
 * @param {(window, event) => void} set
 */
export function windowFields(world, image, of, isDisabled, set) {
  const { room } = world;
  const { window } = lookOf(room.plan.value, room.scene.value, image);
  const { low, high } = endsOf(window);
  const name = (words) => (of ? `${of} ${words}` : `${words[0].toUpperCase()}${words.slice(1)}`);
  const field = (words, value, change) =>
    html`<label class="image-field"><span>${words}</span>${numberField(name(`window ${words.toLowerCase()}`), shown(value, window.width), unitText(image.unit), isDisabled, (entered, event) => set(roundedWindow(change(entered)), event))}</label>`;
  return html`<div class="image-window" role="group" aria-label=${name('window')}>
      ${field('Centre', window.center, (center) => ({ ...window, center }))}${field('Low', low, (value) => windowFrom(value, high))}
      ${field('Width', window.width, (width) => ({ ...window, width: Math.max(width, narrowest) }))}${field('High', high, (value) => windowFrom(low, value))}</div>
    <div class="buttons looks" role="group" aria-label=${name('window presets')}>${windowPresets(image, histogramOf(world, image)).map((preset) => presetButton(preset, window, !of, isDisabled, set))}</div>`;
}

function presetButton(preset, window, hasKey, isDisabled, set) {
  const isOn = isSameWindow(roundedWindow(preset), window);
  const { low, high } = endsOf(preset);
  const key = hasKey && preset.key;
  return html`<button class=${classMap({ on: isOn })} aria-pressed=${isOn} ?disabled=${isDisabled} title=${`${significant(low)} to ${significant(high)}${key ? `, key ${key}` : ''}`}
    @click=${(event) => set(roundedWindow(preset), event)}>${preset.name}${key ? html` <kbd>${key}</kbd>` : nothing}</button>`;
}

/** The choice of a colour map: for PET, and wherever one is chosen already. */
export function colorMapRow(world, image, of, isDisabled, change) {
  const { room } = world;
  const { color_map: chosen } = lookOf(room.plan.value, room.scene.value, image);
  if (!of && !isPet(image) && chosen === 'grey') return nothing;
  return html`<dt>Colours</dt><dd>${segment(
    of ? `${of} colours` : 'Colours',
    colorMaps.map(([id, name, about]) => [id, name, about]),
    chosen,
    isDisabled,
    (color_map, event) => change(lookPatch(room.plan.value, room.scene.value, image, { color_map }), event),
  )}</dd>`;
}

/** The colours of a window from its lower to its upper end. place: names the bar on the page. */
export function colorBar({ room }, image, place = 'panel') {
  const { window, color_map: chosen } = lookOf(room.plan.value, room.scene.value, image);
  const [, , , stops] = colorMaps.find(([id]) => id === chosen) ?? colorMaps[0];
  const isTurned = image === shownImage(room.plan.value, room.scene.value) ? isLowWhite(image, room.scene.value) : image.isInverted;
  const { low, high } = endsOf(window);
  const id = `image-bar-${place}-${image.id}`;
  return html`<div class="image-bar"><svg viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true"><linearGradient id=${id} x1=${isTurned ? 1 : 0} x2=${isTurned ? 0 : 1}>${stops.map(([at, color]) => svg`<stop offset=${at} stop-color=${color} />`)}</linearGradient>
    <rect width="100" height="10" fill=${`url(#${id})`} /></svg><p><span>${significant(low)}</span><span>${significant(high)} ${unitText(image.unit)}</span></p></div>`;
}

/** In a slice pane: the colours of the image shown where they are no greys, and of one that is blended over it. */
export function imageLegend({ room }, place) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const blended = blendedImage(plan, scene);
  const shown = shownImage(plan, scene);
  const images = [shown, blended].filter((image) => image && (image === blended || lookOf(plan, scene, image).color_map !== 'grey'));
  return images.length
    ? html`<ul class="legend image-legend" aria-label="Colours of images">${images.map((image) => html`<li><span>${image.modality}${image === blended ? ` ${Math.round(scene.image.blend.opacity * 100)} %` : ''}</span>${colorBar({ room }, image, place)}</li>`)}</ul>`
    : nothing;
}
