// The regions in the tree: colour, name, volume and opacity of each; above them the filter and what acts on all.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { ownRegions } from '../../room/identity.js';
import { isTarget, showPatch, soloPatch } from '../../room/plan.js';
import { number, volume } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { roving } from '../../parts/roving.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';
import { say } from './words.js';

/** The regions whose names contain what was typed. */
const listed = ({ room, ui }) => {
  const wanted = ui.filter.value.trim().toLowerCase();
  return ownRegions(room.plan.value, room.scene.value).filter((region) => region.name.toLowerCase().includes(wanted));
};

export function regionRows(world) {
  const regions = listed(world);
  if (!regions.length) return html`<li class="empty" role="treeitem" aria-level="2" aria-selected="false">${say.noneNamed}</li>`;
  return repeat(
    regions,
    (region) => region.id,
    (region) => row(world, region),
  );
}

/** Filter, hide all, only targets. */
export function regionTools(world) {
  const { room, ui } = world;
  const scene = room.scene.value;
  const regions = scene ? ownRegions(room.plan.value, scene) : [];
  if (regions.length < 2) return nothing;
  const isDisabled = !room.canChange.value;
  const nShown = regions.filter(({ id }) => scene.regions[id]?.visible).length;
  const targets = regions.filter(isTarget);
  const isTargets = targets.length > 0 && regions.every((region) => Boolean(scene.regions[region.id]?.visible) === isTarget(region));
  const names = targets.map((region) => region.name).join(', ');
  const n = targets.length;
  const only = n > 3 ? say.onlyN({ n, count: number(n) }) : say.only({ regions: names });
  const show = (test) => (event) => room.patchScene(showPatch(regions, test), { view: ui.active.value, at: event.timeStamp });
  return html`<div class="tree-tools"><span class="filter">${icon('search', 12)}<input type="search" placeholder=${say.find} aria-label=${say.find} .value=${live(ui.filter.value)}
      @input=${(event) => {
        ui.filter.value = event.target.value;
      }}></span>
    <div class="pair" role="toolbar" aria-label=${say.all} @keydown=${roving}>
      <button tabindex="0" title=${nShown ? say.hideAllIs : say.showAllIs} ?disabled=${isDisabled} @click=${show(() => nShown === 0)}>${nShown ? say.hideAll : say.showAll}</button>
      <button tabindex="-1" class=${classMap({ on: isTargets })} aria-pressed=${isTargets} aria-label=${say.onlyTargets} ?disabled=${isDisabled || !targets.length}
        title=${n ? only : say.noTarget}
        @click=${show(isTarget)}>${say.targets}</button></div></div>`;
}

function row(world, region) {
  const { room, ui, refused } = world;
  const scene = room.scene.value;
  const style = scene?.regions[region.id];
  if (!style) return nothing;
  const refusal = refused.value[region.id];
  const isDisabled = !room.canChange.value;
  const how = (event) => ({ view: ui.active.value, at: event.timeStamp });
  const change = (patch, event) => room.patchScene({ regions: { [region.id]: patch } }, how(event));
  const setOpacity = (value, event) => Number.isFinite(value) && change({ opacity: Math.min(Math.max(value, 0), 100) / 100 }, event);
  const percent = Math.round(style.opacity * 100);
  const toggle = (event) =>
    event.altKey
      ? room.patchScene(soloPatch(ownRegions(room.plan.value, scene), scene, region.id), how(event))
      : change({ visible: !style.visible }, event);
  const still = (event) => event.stopPropagation();
  const size = region.voxels ? volume(region.volume_cm3) : say.empty;
  return treeRow(
    world,
    {
      kind: 'region',
      id: region.id,
      words: [region.name, size],
      more: [say.opacityIs({ percent })],
      title: `${region.name}, ${number(region.volume_cm3, 2)} cm³`,
      depth: region.depth,
      isOn: style.visible,
      toggle,
      step: (by, event) => setOpacity(percent + 5 * by, event),
    },
    html`
    ${eye(style.visible, say.show({ region: region.name }), say.showOrHide, isDisabled, toggle)}
    <input type="color" tabindex="-1" .value=${live(style.color)} aria-label=${say.colourOf({ region: region.name })} title=${say.colour} ?disabled=${isDisabled} @click=${still}
      @input=${(event) => change({ color: event.target.value }, event)}>
    ${name(region.name)}
    ${refusal ? html`<span class="refused warn" role="img" aria-label=${say.refused({ reason: refusal })} title=${say.refused({ reason: refusal })}>${icon('warning')}</span>` : nothing}
    <span class="tail volume" aria-hidden="true">${size}</span>
    <input type="range" class="mini" tabindex="-1" min="0" max="100" step="1" .value=${live(String(percent))} ${variables({ '--fill': `${percent}%` })}
      aria-label=${say.opacityOf({ region: region.name })} title=${say.opacity} ?disabled=${isDisabled} @click=${still} @input=${(event) => setOpacity(event.target.valueAsNumber, event)}>
    <span class="percent"><input type="number" tabindex="-1" min="0" max="100" step="1" .value=${live(String(percent))} aria-label=${say.opacityPercent({ region: region.name })} ?disabled=${isDisabled}
      @click=${still} @change=${(event) => setOpacity(event.target.valueAsNumber, event)}></span>`,
  );
}
