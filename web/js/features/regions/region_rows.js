// The regions in the tree: colour, name, volume and opacity of each; above them the filter and what acts on all.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { live } from '../../../lib/directives/live.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { ownRegions } from '../../room/identity.js';
import { isTarget, showPatch, soloPatch } from '../../room/plan.js';
import { count, number, volume } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { variables } from '../../parts/mount.js';
import { roving } from '../../parts/roving.js';
import { eye, name, treeRow } from '../../parts/tree_row.js';

/** The regions whose names contain what was typed. */
const listed = ({ room, ui }) => {
  const wanted = ui.filter.value.trim().toLowerCase();
  return ownRegions(room.plan.value, room.scene.value).filter((region) => region.name.toLowerCase().includes(wanted));
};

export function regionRows(world) {
  const regions = listed(world);
  if (!regions.length) return html`<li class="empty" role="treeitem" aria-level="2" aria-selected="false">No region has such a name.</li>`;
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
  const show = (test) => (event) => room.patchScene(showPatch(regions, test), { view: ui.active.value, at: event.timeStamp });
  return html`<div class="tree-tools"><span class="filter">${icon('search', 12)}<input type="search" placeholder="Find a region" aria-label="Find a region" .value=${live(ui.filter.value)}
      @input=${(event) => {
        ui.filter.value = event.target.value;
      }}></span>
    <div class="pair" role="toolbar" aria-label="All regions" @keydown=${roving}>
      <button tabindex="0" title=${nShown ? 'Hide all regions' : 'Show all regions'} ?disabled=${isDisabled} @click=${show(() => nShown === 0)}>${nShown ? 'Hide all' : 'Show all'}</button>
      <button tabindex="-1" class=${classMap({ on: isTargets })} aria-pressed=${isTargets} aria-label="Show only targets" ?disabled=${isDisabled || !targets.length}
        title=${targets.length ? `Show only ${targets.length > 3 ? count(targets.length, 'target') : targets.map((region) => region.name).join(', ')}` : 'No region is a target by its name'}
        @click=${show(isTarget)}>Targets</button></div></div>`;
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
  const size = region.voxels ? volume(region.volume_cm3) : 'empty';
  return treeRow(
    world,
    {
      kind: 'region',
      id: region.id,
      words: [region.name, size],
      more: [`opacity ${percent} %`],
      title: `${region.name}, ${number(region.volume_cm3, 2)} cm³`,
      depth: region.depth,
      isOn: style.visible,
      toggle,
      step: (by, event) => setOpacity(percent + 5 * by, event),
    },
    html`
    ${eye(style.visible, `Show ${region.name}`, 'Show or hide (Alt: only this one)', isDisabled, toggle)}
    <input type="color" tabindex="-1" .value=${live(style.color)} aria-label=${`Colour of ${region.name}`} title="Colour" ?disabled=${isDisabled} @click=${still}
      @input=${(event) => change({ color: event.target.value }, event)}>
    ${name(region.name)}
    ${refusal ? html`<span class="refused warn" role="img" aria-label=${`Not in the 3-D picture: ${refusal}`} title=${`Not in the 3-D picture: ${refusal}`}>${icon('warning')}</span>` : nothing}
    <span class="tail volume" aria-hidden="true">${size}</span>
    <input type="range" class="mini" tabindex="-1" min="0" max="100" step="1" .value=${live(String(percent))} ${variables({ '--fill': `${percent}%` })}
      aria-label=${`Opacity of ${region.name}`} title="Opacity" ?disabled=${isDisabled} @click=${still} @input=${(event) => setOpacity(event.target.valueAsNumber, event)}>
    <span class="percent"><input type="number" tabindex="-1" min="0" max="100" step="1" .value=${live(String(percent))} aria-label=${`Opacity of ${region.name} in per cent`} ?disabled=${isDisabled}
      @click=${still} @change=${(event) => setOpacity(event.target.valueAsNumber, event)}></span>`,
  );
}
