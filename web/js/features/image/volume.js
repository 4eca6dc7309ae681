// The image as a volume in the 3-D picture: its Selection in the inspector.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { cullsNothing, usualCull } from '../../room/image_look.js';
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
  return html`<section class="block"><h3>${icon('cube')} ${say.volume} <span class="dim">${say.volumeOf({ image: image.name || image.modality })}</span></h3>
      <div class="checks">${checkbox(say.visible, volume.visible, isDisabled, (isOn, event) => changeScene(visiblePatch(plan, room.scene.value, isOn), event))}
        ${checkbox(say.cutByPlanes, volume.clipped, isDisabled, (clipped, event) => change({ clipped }, event))}</div>
      <div class="shown-as"><span class="dim">${say.drawnBy}</span>${segment(say.method, methods, volume.method, isDisabled, (method, event) => change({ method }, event))}</div>
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
      ${cullRow(image, scene, volume, isDisabled, change)}</section>
    ${volume.method === 'ray' ? rayBlock(world, image, isDisabled, change) : nothing}`;
}

function cullRow(image, scene, volume, isDisabled, change) {
  const isOn = volume.cull_below > cullsNothing;
  return html`<div class="checks cull">${checkbox(say.leaveOut, isOn, isDisabled, (on, event) => change({ cull_below: on ? usualCull(image, scene.image.window) : cullsNothing }, event), say.leaveOutVolumeIs)}
    ${isOn ? numberField(say.leaveOutVolume, Number(volume.cull_below.toPrecision(6)), image.unit, isDisabled, (cull_below, event) => change({ cull_below }, event)) : nothing}</div>`;
}

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
