// The image as a volume in the 3-D picture: its Selection in the inspector.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { cullsNothing, usualCull } from '../../room/image_look.js';
import { significant, unitText } from '../../parts/format.js';
import { otsu } from './histograms.js';
import { shownImage } from '../../room/plan.js';
import { isSamePoints, visiblePatch } from './transfer.js';
import { presetPoints, presetsOfImage } from './volume_presets.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { transferEditor } from './transfer_editor.js';
import { say } from './later_words.js';

const [fewest, most] = [2, 1024]; // slices: proto/scene.json
const methods = [
  ['ray', say.ray, say.rayIs],
  ['slices', say.slices, say.slicesAre],
  ['mip', say.maximum, say.maximumIs],
  ['average', say.average, say.averageIs],
];

export function volumeBlock(world, isDisabled, changeScene) {
  const { room } = world;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const image = shownImage(plan, scene);
  const volume = scene.image.volume;
  if (!image) return nothing;
  const change = (patch, event) => changeScene({ image: { volume: patch } }, event);
  const choose = async (method, event) => {
    const { timeStamp } = event; // which is not the event's any more once it has been waited for
    const cull = method === 'slices' && volume.cull_below <= cullsNothing ? await thresholdOf(world, image) : null;
    if (room.canChange.value) change({ method, ...(cull !== null && { cull_below: cull }) }, { timeStamp });
  };
  return html`<section class="block"><h3>${icon('cube')} ${say.volume} <span class="dim">${say.volumeOf({ image: image.name || image.modality })}</span></h3>
      <div class="checks">${checkbox(say.visible, volume.visible, isDisabled, (isOn, event) => changeScene(visiblePatch(plan, room.scene.value, isOn), event))}
        ${checkbox(say.cutByPlanes, volume.clipped, isDisabled, (clipped, event) => change({ clipped }, event))}</div>
      <div class="shown-as"><span class="dim">${say.drawnBy}</span>${segment(say.method, methods, volume.method, isDisabled, choose)}</div>
      <dl class="image-rows">${volume.method === 'slices' ? html`<dt>${say.slices}</dt><dd>${numberField(say.nSlices, volume.steps, '', isDisabled, (value, event) => change({ steps: Math.min(Math.max(Math.round(value), fewest), most) }, event))}</dd>` : nothing}
        <dt>${say.betweenVoxels}</dt><dd>${segment(
          say.volumeBetween,
          [
            ['linear', say.linear],
            ['nearest', say.nearest],
          ],
          volume.interpolation,
          isDisabled,
          (interpolation, event) => change({ interpolation }, event),
        )}</dd></dl>
      ${cullRow(world, image, volume, isDisabled, change)}</section>
    ${volume.method === 'ray' ? rayBlock(world, image, isDisabled, change) : nothing}`;
}

/** Opaque slices leave out what is below Otsu's threshold at first, so that air hides nothing. null: low values are white, or there is no histogram. */
async function thresholdOf({ room, histograms }, image) {
  const histogram = image.isInverted ? null : await histograms.load(room.planId.peek(), image.id);
  return histogram && otsu(histogram);
}

function cullRow({ room, histograms }, image, volume, isDisabled, change) {
  const isOn = volume.cull_below > cullsNothing;
  const histogram = isOn ? histograms.of(room.planId.value, image.id) : null;
  const set = async (on, event) => {
    const { timeStamp } = event;
    const own = on && volume.method === 'slices' ? await thresholdOf({ room, histograms }, image) : null;
    const cull_below = on ? (own ?? usualCull(image, room.scene.value.image.window)) : cullsNothing;
    if (room.canChange.value) change({ cull_below }, { timeStamp });
  };
  const value = Number(volume.cull_below.toPrecision(6));
  return html`<div class="checks cull">${checkbox(say.leaveOut, isOn, isDisabled, set, say.leaveOutVolumeIs)}
    ${isOn ? numberField(say.leaveOutVolume, value, unitText(image.unit), isDisabled, (cull_below, event) => change({ cull_below }, event)) : nothing}</div>
    ${
      histogram
        ? html`<input class="cull-slider" type="range" min=${histogram.low} max=${histogram.high} step=${stepOf(histogram)} .value=${live(String(value))} aria-label=${say.leaveOutSlider} aria-valuetext=${`${significant(value)} ${unitText(image.unit)}`} ?disabled=${isDisabled}
      @input=${(event) => change({ cull_below: event.target.valueAsNumber }, event)}>`
        : nothing
    }`;
}

/** Whole values of an image with many of them, else a part of the range. */
const stepOf = ({ low, high }) => (Number.isInteger(low) && Number.isInteger(high) && high - low >= 64 ? 1 : (high - low) / 256);

/** The presets of proto/volume_presets.json. */
const presetNames = { Bone: say.bone, Skin: say.skin, 'Soft tissue': say.softTissue, Head: say.head, Brain: say.brain };

/** Fields that only the method ray has: light, and the transfer function. */
function rayBlock(world, image, isDisabled, change) {
  const { window, volume } = world.room.scene.value.image;
  return html`<section class="block"><h3>${say.transfer} <span class="dim">${say.transferOf({ image: image.modality })}</span></h3>
    <div class="buttons looks image-presets" role="group" aria-label=${say.transferPresets}>${presetsOfImage(image).map((preset) => {
      const points = presetPoints(preset, window);
      const isOn = isSamePoints(volume.points, points);
      return html`<button class=${classMap({ on: isOn })} aria-pressed=${isOn} ?disabled=${isDisabled} @click=${(event) => change({ points }, event)}>${presetNames[preset.name] ?? preset.name}</button>`;
    })}</div>
    ${transferEditor(world, image, isDisabled, change)}
    <div class="checks">${checkbox(say.shaded, volume.shaded, isDisabled, (shaded, event) => change({ shaded }, event), say.shadedIs)}</div></section>`;
}
