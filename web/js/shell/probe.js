// The inspector's Probe: values of image, regions and doses at the crosshair.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { crosshair, shownImage } from '../room/plan.js';
import { partsOf } from '../features/index.js';
import { number, significant, unitText } from '../parts/format.js';
import { icon, swatch } from '../parts/icons.js';
import { say } from './words.js';

export function probe(world) {
  const { room, ui, probed } = world;
  const plan = room.plan.value;
  const scene = room.scene.value;
  const image = shownImage(plan, scene);
  const { result, error, isOld } = probed.value;
  const value = result?.images?.find((other) => other.id === image?.id);
  const point = crosshair(scene);
  return html`<section class="block"><h3 class="dose-head">${say.probeAt} <span class="grow"></span>${partsOf('probeTool', world)}</h3>
      <div class="numbers">${['L', 'P', 'S'].map((letter, axis) => html`<div><span class="dim">${letter}</span><b>${number(point[axis], 1)}${axis === 2 ? ' mm' : ''}</b></div>`)}
        ${image ? html`<div class=${classMap({ end: true, old: isOld })}><span class="dim">${image.modality}</span><b>${value && value.value !== null ? [significant(value.value), unitText(value.unit)].filter(Boolean).join(' ') : '–'}</b></div>` : nothing}</div>
      <div class=${classMap({ inside: true, old: isOld })}>${error ? html`<span class="err">${icon('error')} ${error}</span>` : inside(plan, scene, result, ui)}</div></section>
    ${partsOf('probe', world)}`;
}

function inside(plan, scene, result, ui) {
  if (!result) return html`<span class="dim">…</span>`;
  const regions = result.regions.map((id) => plan.regions.find((region) => region.id === id)).filter(Boolean);
  if (!regions.length) return plan.regions.length ? html`<span class="dim">${say.outside}</span>` : nothing;
  const [first, ...outer] = regions;
  return html`${swatch(scene.regions[first.id]?.color ?? first.color)}
    <button class="link" title=${say.selectRegion} @click=${() => ui.choose('region', first.id)}>${first.name}</button><span class="dim">${outer.map((region) => say.within({ region: region.name })).join(', ')}</span>`;
}
