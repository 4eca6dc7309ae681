// The selected region: its figures, how it is shown, saving its shape as a file.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { enabledClips } from '../clip/clip.js';
import { ownRegions } from '../../room/identity.js';
import { crosshairPatch, shownImage, soloPatch } from '../../room/plan.js';
import { isExportable, representations, shapeQuery, volumeDifference } from './shapes.js';
import { textureNote, textureOf, texturePatch, textures, withInner } from './textures.js';
import { waitReason } from '../../room/waits.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { number, seconds, signed, significant, volume } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';

const files = [
  ['stl', 'binary STL'],
  ['ply', 'binary PLY'],
  ['glb', 'GLB (glTF 2.0), in metres with the top up'],
];

export function regionBlock(world, region) {
  const { room, ui } = world;
  if (!region) return nothing;
  const plan = room.plan.value;
  const scene = room.scene.value;
  const style = scene.regions[region.id];
  const isDisabled = !room.canChange.value;
  const how = (event) => ({ view: ui.active.value, at: event.timeStamp });
  const change = (patch, event) => room.patchScene({ regions: { [region.id]: patch } }, how(event));
  const parent = plan.regions.find((other) => other.id === region.parent);
  const show = (event) => room.patchScene(crosshairPatch(plan, shownImage(plan, scene), region.center_mm), how(event));
  const own = ownRegions(plan, scene);
  const isAlone = own.every((other) => Boolean(scene.regions[other.id]?.visible) === (other.id === region.id));
  const isShared = own.every((other) => scene.regions[other.id]?.representation === style.representation);
  const share = (event) =>
    room.patchScene({ regions: Object.fromEntries(own.map(({ id }) => [id, { representation: style.representation }])) }, how(event));
  return html`<section class="block"><h3>Region ${region.name} <span class="dim">${parent ? `in ${parent.name}` : ''}</span></h3>
    <dl><dt>Volume</dt><dd>${volume(region.volume_cm3)}, ${number(region.voxels)} univels</dd>
      ${region.touches_edge ? html`<dt>Edge</dt><dd>cut by the edge of the scan</dd>` : nothing}
      <dt>Opacity</dt><dd class="pair"><input type="range" min="0" max="100" step="1" .value=${live(String(Math.round(style.opacity * 100)))} aria-label="Opacity" ?disabled=${isDisabled}
        @input=${(event) => change({ opacity: event.target.valueAsNumber / 100 }, event)}>${numberField('Opacity in per cent', Math.round(style.opacity * 100), '%', isDisabled, (value, event) => change({ opacity: Math.min(Math.max(value, 0), 100) / 100 }, event))}</dd>
      <dt>Colour</dt><dd><input type="color" .value=${live(style.color)} aria-label="Colour" ?disabled=${isDisabled} @input=${(event) => change({ color: event.target.value }, event)}></dd>
      <dt title="Higher lies on top where regions overlap">Order</dt><dd>${numberField('Order, higher lies on top', style.order, '', isDisabled, (value, event) => change({ order: Math.min(Math.max(Math.round(value), -1000), 1000) }, event))}</dd></dl>
    ${style.clipped && !enabledClips(plan, scene).length ? nothing : html`<div class="checks">${checkbox('Not cut by clip planes', style.clipped === false, isDisabled, (on, event) => change({ clipped: !on }, event), 'The region is whole before the cut')}</div>`}
    <div class="shown-as"><span class="dim">Shown as</span>${segment('Shown as', representations, style.representation, isDisabled || !region.voxels, (representation, event) => change({ representation }, event))}</div>
    ${coloured(world, region, isDisabled, how)}
    ${region.voxels ? figures(world, region, style.representation) : nothing}
    <div class="buttons"><button aria-pressed=${isAlone} class=${classMap({ on: isAlone })} ?disabled=${isDisabled} @click=${(event) => room.patchScene(soloPatch(own, scene, region.id), how(event))}>${icon('solo')}<span>Solo</span></button>
      ${region.center_mm ? html`<button ?disabled=${isDisabled} @click=${show}>${icon('target')}<span>Go to centre</span></button>` : nothing}
      ${own.length > 1 ? html`<button ?disabled=${isDisabled || isShared} @click=${share}><span>All regions like this</span></button>` : nothing}
      ${
        region.voxels
          ? html`<button aria-haspopup="dialog" @click=${() => {
              ui.popover.value = 'figures';
            }}><span>Compare methods</span></button>`
          : nothing
      }</div>
    ${region.voxels && isExportable(style.representation) && !isRefused(world, region, style.representation) ? downloads(world, region, style.representation) : nothing}</section>`;
}

/** Choice of what colours the region in 3-D, and those inside it. */
function coloured({ room }, region, isDisabled, how) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { texture } = scene.regions[region.id];
  const inner = withInner(plan, region);
  const note = textureNote(scene, region);
  const isOff = note.startsWith('The wash');
  return html`<div class="shown-as"><span class="dim">Coloured by</span>${segment('Coloured by', textures(plan, texture), texture, isDisabled || !region.voxels, (wanted, event) => room.patchScene(texturePatch([region], wanted), how(event)))}</div>
    ${note ? html`<p class="note why">${icon('warning', 12)} ${note}</p>` : nothing}
    ${
      isOff || (inner.length > 1 && textureOf(scene, inner) !== texture)
        ? html`<div class="buttons">
      ${isOff ? html`<button ?disabled=${isDisabled} @click=${(event) => room.patchScene({ dose: { wash: { visible: true } } }, how(event))}><span>Show the wash</span></button>` : nothing}
      ${inner.length > 1 && textureOf(scene, inner) !== texture ? html`<button ?disabled=${isDisabled} @click=${(event) => room.patchScene(texturePatch(inner, texture), how(event))}><span>Those inside it too</span></button>` : nothing}</div>`
        : nothing
    }`;
}

/** True when the server cannot build the shape, so there is no file to save either. */
function isRefused({ shaped, refused }, region, representation) {
  const { region: of, representation: as, error } = shaped.value;
  return Boolean(of === region.id && as === representation && error) || Boolean(refused.value[region.id]);
}

function downloads({ api, room }, region, representation) {
  const query = shapeQuery(room.scene.value, representation);
  return html`<div class="buttons downloads" role="group" aria-label="Download the surface"><span class="dim">Surface, mm LPS</span>${files.map(
    ([format, about]) => html`<a class="button"
    download href=${api.surfaceUrl(room.planId.value, region.id, { format, ...query })} title=${`Download the surface of ${region.name} as ${about}`}>${format.toUpperCase()}</a>`,
  )}</div>`;
}

/** The server's figures of the shape that is shown. */
function figures({ room, shaped }, region, representation) {
  const { region: of, representation: as, result, error } = shaped.value;
  if (of !== region.id || as !== representation || (!result && !error))
    return html`<p class="note figures">${waitReason(room) || 'Working out its figures …'}</p>`;
  if (error) return html`<p class="figures err" role="status">${icon('error')} ${error}</p>`;
  const counts = [
    ['triangles', 'triangles'],
    ['lines', 'outlines'],
    ['points', 'points'],
    ['vertices', 'vertices'],
  ]
    .filter(([name]) => result[name])
    .map(([name, word]) => `${number(result[name])} ${word}`);
  const difference = volumeDifference(result);
  return html`<dl class="figures"><dt>Made of</dt><dd>${counts.join(', ') || 'nothing'}</dd>
    ${result.area_mm2 ? html`<dt>Area</dt><dd>${significant(result.area_mm2 / 100)} cm²</dd>` : nothing}
    ${result.volume_mm3 ? html`<dt>Encloses</dt><dd>${volume(result.volume_mm3 / 1000)}, ${signed(difference, 2)} % to univels</dd>` : nothing}
    ${Number.isFinite(result.distance_max_mm) ? html`<dt title="Of its vertices, from the border of the univels">Off the univels</dt><dd>${number(result.distance_mean_mm, 2)} mm, at most ${number(result.distance_max_mm, 2)} mm</dd>` : nothing}
    <dt>Made in</dt><dd>${seconds(result.ms)}</dd></dl>`;
}
