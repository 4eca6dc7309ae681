// Window and colour map of one image as fields and buttons, for the image shown and for one blended over it.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { endsOf, gammaOf, isCt, isSameWindow, lookOf, lookPatch, roundedWindow, windowFrom, windowPresets } from '../../room/image_look.js';
import { live } from '../../../lib/directives/live.js';
import { numberField } from '../../parts/fields.js';
import { significant, unitText } from '../../parts/format.js';
import { colorMaps } from './color_maps.js';
import { say } from './later_words.js';

const narrowest = 1e-15; // proto/scene.json, also of gamma
const [leastGamma, mostGamma] = [0.25, 5];

/** Formats a value with as many figures as tell the greys of a window of this width apart. */
const shown = (value, width) => Number(value.toFixed(Math.min(Math.max(1, 3 - Math.floor(Math.log10(width))), 20)));

/** The window as the scene has it now, percentiles included where the server knows them. */
export const histogramOf = ({ room, histograms }, image) => (isCt(image) ? null : histograms.of(room.planId.value, image.id));

const names = {
  window: say.window,
  centre: say.windowCentre,
  low: say.windowLow,
  width: say.windowWidth,
  gamma: say.windowGamma,
  high: say.windowHigh,
  presets: say.windowPresets,
};
const secondNames = {
  window: say.secondWindow,
  centre: say.secondCentre,
  low: say.secondLow,
  width: say.secondWidth,
  gamma: say.secondGamma,
  high: say.secondHigh,
  presets: say.secondPresets,
};

/**
 * @param {boolean} isSecond is blended over the image shown
 * @param {(window, event) => void} set
 */
export function windowFields(world, image, isSecond, isDisabled, set) {
  const { room } = world;
  const { window } = lookOf(room.plan.value, room.scene.value, image);
  const { low, high } = endsOf(window);
  const name = isSecond ? secondNames : names;
  const field = (words, label, value, change) =>
    html`<label class="image-field"><span>${words}</span>${numberField(label, shown(value, window.width), unitText(image.unit), isDisabled, (entered, event) => set(roundedWindow(change(entered)), event))}</label>`;
  return html`<div class="image-window" role="group" aria-label=${name.window}>
      ${field(say.centre, name.centre, window.center, (center) => ({ ...window, center }))}${field(say.low, name.low, low, (value) => windowFrom(value, high))}
      ${field(say.width, name.width, window.width, (width) => ({ ...window, width: Math.max(width, narrowest) }))}${field(say.high, name.high, high, (value) => windowFrom(low, value))}
      <label class="image-field" title=${say.gammaIs}><span>${say.gamma}</span>${numberField(name.gamma, Number(gammaOf(window).toPrecision(3)), '', isDisabled, (gamma, event) => set({ gamma: Math.min(Math.max(gamma, leastGamma), mostGamma) }, event))}</label></div>
    <div class="buttons looks" role="group" aria-label=${name.presets}>${windowPresets(image, histogramOf(world, image)).map((preset) => presetButton(preset, window, !isSecond, isDisabled, set))}</div>`;
}

function presetButton(preset, window, hasKey, isDisabled, set) {
  const isOn = isSameWindow(roundedWindow(preset), window);
  const { low, high } = endsOf(preset);
  const key = hasKey && preset.key;
  const range = { low: significant(low), high: significant(high) };
  return html`<button class=${classMap({ on: isOn })} aria-pressed=${isOn} ?disabled=${isDisabled} title=${key ? say.rangeKey({ ...range, key }) : say.range(range)}
    @click=${(event) => set(roundedWindow(preset), event)}>${preset.name}${key ? html` <kbd>${key}</kbd>` : nothing}</button>`;
}

/** The choice of a colour map. */
export function colorMapRow(world, image, isSecond, isDisabled, change) {
  const { room } = world;
  const { color_map: chosen } = lookOf(room.plan.value, room.scene.value, image);
  const choose = (event) => change(lookPatch(room.plan.value, room.scene.value, image, { color_map: event.target.value }), event);
  const [, , about] = colorMaps.find(([id]) => id === chosen) ?? [];
  return html`<dt>${say.colours}</dt><dd><select aria-label=${isSecond ? say.secondColours : say.colours} title=${about ?? nothing} ?disabled=${isDisabled} @change=${choose}>${colorMaps.map(
    ([id, name, is]) => html`<option value=${id} title=${is} .selected=${live(id === chosen)}>${name}</option>`,
  )}</select></dd>`;
}
