// The selected region: its figures, how it is shown, saving its shape as a file.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { enabledClips } from '../clip/clip.js';
import { ownRegions } from '../../room/identity.js';
import { crosshairPatch, shownImage, soloPatch } from '../../room/plan.js';
import { representations } from './representations.js';
import { tissueColours } from './tissue_colours.js';
import { isExportable, shapeQuery, volumeDifference } from './shapes.js';
import { isWashOff, textureNote, textureOf, texturePatch, textures, withInner } from './textures.js';
import { waitReason } from '../../room/waits.js';
import { checkbox, numberField, segment } from '../../parts/fields.js';
import { number, seconds, signed, significant, volume } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const files = [
  ['stl', say.saveStl],
  ['ply', say.savePly],
  ['glb', say.saveGlb],
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
  return html`<section class="block"><h3>${say.region({ region: region.name })} <span class="dim">${parent ? say.inside({ region: parent.name }) : ''}</span></h3>
    <dl><dt>${say.volume}</dt><dd>${say.volumeIs({ volume: volume(region.volume_cm3), count: number(region.voxels), n: region.voxels })}</dd>
      ${region.touches_edge ? html`<dt>${say.edge}</dt><dd>${say.cutByEdge}</dd>` : nothing}
      <dt>${say.opacity}</dt><dd class="pair"><input type="range" min="0" max="100" step="1" .value=${live(String(Math.round(style.opacity * 100)))} aria-label=${say.opacity} ?disabled=${isDisabled}
        @input=${(event) => change({ opacity: event.target.valueAsNumber / 100 }, event)}>${numberField(say.opacityPercent, Math.round(style.opacity * 100), '%', isDisabled, (value, event) => change({ opacity: Math.min(Math.max(value, 0), 100) / 100 }, event))}</dd>
      <dt>${say.colour}</dt><dd class="pair"><input type="color" .value=${live(style.color)} aria-label=${say.colour} ?disabled=${isDisabled} @input=${(event) => change({ color: event.target.value }, event)}>${tissueColour(style, isDisabled, change)}</dd>
      <dt title=${say.orderIs}>${say.order}</dt><dd>${numberField(say.orderHigher, style.order, '', isDisabled, (value, event) => change({ order: Math.min(Math.max(Math.round(value), -1000), 1000) }, event))}</dd></dl>
    ${style.clipped && !enabledClips(plan, scene).length ? nothing : html`<div class="checks">${checkbox(say.notCut, style.clipped === false, isDisabled, (on, event) => change({ clipped: !on }, event), say.notCutIs)}</div>`}
    <div class="shown-as"><span class="dim">${say.shownAs}</span>${segment(say.shownAs, representations, style.representation, isDisabled || !region.voxels, (representation, event) => change({ representation }, event))}</div>
    ${coloured(world, region, isDisabled, how)}
    ${region.voxels ? figures(world, region, style.representation) : nothing}
    <div class="buttons"><button aria-pressed=${isAlone} class=${classMap({ on: isAlone })} ?disabled=${isDisabled} @click=${(event) => room.patchScene(soloPatch(own, scene, region.id), how(event))}>${icon('solo')}<span>${say.solo}</span></button>
      ${region.center_mm ? html`<button ?disabled=${isDisabled} @click=${show}>${icon('target')}<span>${say.goToCentre}</span></button>` : nothing}
      ${own.length > 1 ? html`<button ?disabled=${isDisabled || isShared} @click=${share}><span>${say.allLikeThis}</span></button>` : nothing}
      ${
        region.voxels
          ? html`<button aria-haspopup="dialog" @click=${() => {
              ui.popover.value = 'figures';
            }}><span>${say.compare}</span></button>`
          : nothing
      }</div>
    ${region.voxels && isExportable(style.representation) && world.room.control.mayExport && !isRefused(world, region, style.representation) ? downloads(world, region, style.representation) : nothing}</section>`;
}

/** Choice among usual colours of tissues. */
function tissueColour({ color }, isDisabled, change) {
  const now = tissueColours.find(([, of]) => of === color);
  return html`<select aria-label=${say.tissueColour} ?disabled=${isDisabled} @change=${(event) => change({ color: event.target.value }, event)}>
    <option value="" .selected=${live(!now)} disabled>${say.ownColour}</option>${tissueColours.map(
      ([name, of]) => html`<option value=${of} .selected=${live(of === color)}>${name}</option>`,
    )}</select>`;
}

/** Choice of what colours the region in 3-D, and those inside it. */
function coloured({ room }, region, isDisabled, how) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const { texture } = scene.regions[region.id];
  const inner = withInner(plan, region);
  const note = textureNote(scene, region);
  const isOff = isWashOff(scene, region);
  return html`<div class="shown-as"><span class="dim">${say.colouredBy}</span>${segment(say.colouredBy, textures(plan, texture), texture, isDisabled || !region.voxels, (wanted, event) => room.patchScene(texturePatch([region], wanted), how(event)))}</div>
    ${note ? html`<p class="note why">${icon('warning', 12)} ${note}</p>` : nothing}
    ${
      isOff || (inner.length > 1 && textureOf(scene, inner) !== texture)
        ? html`<div class="buttons">
      ${isOff ? html`<button ?disabled=${isDisabled} @click=${(event) => room.patchScene({ dose: { wash: { visible: true } } }, how(event))}><span>${say.showWash}</span></button>` : nothing}
      ${inner.length > 1 && textureOf(scene, inner) !== texture ? html`<button ?disabled=${isDisabled} @click=${(event) => room.patchScene(texturePatch(inner, texture), how(event))}><span>${say.insideToo}</span></button>` : nothing}</div>`
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
  return html`<div class="buttons downloads" role="group" aria-label=${say.download}><span class="dim">${say.surfaceLps}</span>${files.map(
    ([format, save]) => html`<a class="button"
    download href=${api.surfaceUrl(room.planId.value, region.id, { format, ...query })} title=${save({ region: region.name })}>${format.toUpperCase()}</a>`,
  )}</div>`;
}

/** The server's figures of the shape that is shown. */
function figures({ room, shaped }, region, representation) {
  const { region: of, representation: as, result, error } = shaped.value;
  if (of !== region.id || as !== representation || (!result && !error))
    return html`<p class="note figures">${waitReason(room) || say.workingOut}</p>`;
  if (error) return html`<p class="figures err" role="status">${icon('error')} ${error}</p>`;
  const counts = [
    ['triangles', say.nTriangles],
    ['lines', say.nOutlines],
    ['points', say.nPoints],
    ['vertices', say.nVertices],
  ]
    .filter(([name]) => result[name])
    .map(([name, words]) => words({ count: number(result[name]), n: result[name] }));
  const difference = volumeDifference(result);
  return html`<dl class="figures"><dt>${say.madeOf}</dt><dd>${counts.join(', ') || say.nothing}</dd>
    ${result.area_mm2 ? html`<dt>${say.area}</dt><dd>${significant(result.area_mm2 / 100)} cm²</dd>` : nothing}
    ${result.volume_mm3 ? html`<dt>${say.encloses}</dt><dd>${say.enclosesIs({ volume: volume(result.volume_mm3 / 1000), percent: signed(difference, 2) })}</dd>` : nothing}
    ${Number.isFinite(result.distance_max_mm) ? html`<dt title=${say.offIs}>${say.off}</dt><dd>${say.offBy({ mean: number(result.distance_mean_mm, 2), most: number(result.distance_max_mm, 2) })}</dd>` : nothing}
    <dt>${say.madeIn}</dt><dd>${seconds(result.ms)}</dd></dl>`;
}
