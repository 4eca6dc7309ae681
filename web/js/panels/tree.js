// The tree at the left: parts of the plan, each with visibility, colour and opacity.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { live } from '../../lib/directives/live.js';
import { repeat } from '../../lib/directives/repeat.js';
import { beamWords, doseWords, frameWords, imagePatch, shownImage, soloPatch } from '../state/plan.js';
import { count, number, volume, windowText } from './format.js';
import { icon } from './icons.js';
import { variables } from './mount.js';

const hierarchyWords = { file: 'hierarchy from file', derived: 'hierarchy derived', none: '' };

export function tree({ room, ui, refused }) {
  const plan = room.plan.value;
  if (!ui.isTreeOpen.value)
    return html`<button class="icon-button rail" title="Show the plan's parts" aria-label="Show the plan's parts" @click=${() => { ui.isTreeOpen.value = true; }}>${icon('tree')}</button>`;
  return html`
    <header class="panel-head"><h2>Plan</h2><span class="grow"></span>
      <button class="icon-button" title="Fold" aria-label="Fold the plan's parts" @click=${() => { ui.isTreeOpen.value = false; }}>${icon('chevronLeft')}</button></header>
    <div class="scroll">${plan ? html`${images(room, plan)}${regions(room, ui, plan, refused)}${doses(room, ui, plan)}${beams(plan)}` : html`<p class="empty">The plan is being loaded.</p>`}</div>`;
}

function section(title, note, rows) {
  return html`<details class="section" open><summary>${icon('chevronDown', 12)}<h3>${title}</h3><span class="grow"></span><span class="note">${note}</span></summary>${rows}</details>`;
}

function images(room, plan) {
  const scene = room.scene.value;
  if (!plan.images.length) return section('Images', '', html`<p class="empty">No image in this plan.</p>`);
  const shown = shownImage(plan, scene);
  return section('Images', '', plan.images.map((image) => html`
    <button class=${classMap({ row: true, selected: plan.images.length > 1 && image === shown })} ?disabled=${!room.canChange.value}
      title=${`${image.size.join(' × ')} voxels`} aria-pressed=${image === shown}
      @click=${() => image !== shown && room.patchScene(imagePatch(image))}>
      ${icon('image')}<span class="name">${image.modality}</span><span class="dim">${plan.images.length > 1 ? image.id : ''}</span><span class="grow"></span>
      <span class="tail">${image === shown && scene ? windowText(scene.image.window, '') : ''}</span></button>`));
}

function regions(room, ui, plan, refused) {
  if (!plan.regions.length) return section('Regions', '', html`<p class="empty">No regions in this plan.</p>`);
  const note = hierarchyWords[plan.hierarchy] ?? '';
  return section('Regions', note, html`<ul class="rows" @keydown=${walk}>${repeat(plan.regions, (region) => region.id, (region) => row(room, ui, plan, region, refused.value[region.id]))}</ul>`);
}

/** Moves between rows by the up and down keys. */
function walk(event) {
  const by = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!by || event.target.type === 'range' || event.target.type === 'number') return;
  const names = [...event.currentTarget.querySelectorAll('button.name')];
  const at = names.findIndex((name) => name.closest('li').contains(event.target));
  names[at + by]?.focus();
  event.preventDefault();
}

function row(room, ui, plan, region, refusal) {
  const scene = room.scene.value;
  const style = scene?.regions[region.id];
  if (!style) return nothing;
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene({ regions: { [region.id]: patch } }, { view: ui.active.value, at: event.timeStamp });
  const percent = Math.round(style.opacity * 100);
  const toggle = (event) => (event.altKey
    ? room.patchScene(soloPatch(plan.regions, scene, region.id), { view: ui.active.value, at: event.timeStamp })
    : change({ visible: !style.visible }, event));
  return html`<li class=${classMap({ row: true, selected: ui.region.value === region.id, off: !style.visible })} data-region=${region.id}
      ${variables({ '--indent': String(region.depth) })}>
    <button class="eye" aria-pressed=${style.visible} aria-label=${`Show ${region.name}`} title="Show or hide (Alt: only this one)" ?disabled=${isDisabled}
      @click=${toggle}>${icon(style.visible ? 'eye' : 'eyeOff')}</button>
    <input type="color" .value=${live(style.color)} aria-label=${`Colour of ${region.name}`} title="Colour" ?disabled=${isDisabled}
      @input=${(event) => change({ color: event.target.value }, event)}>
    <button class="name" title=${`${region.name}, ${number(region.volume_cm3, 2)} cm³`} aria-pressed=${ui.region.value === region.id} aria-label=${`${region.name}, ${number(region.volume_cm3, 2)} cm³`}
      @click=${() => { ui.region.value = ui.region.value === region.id ? '' : region.id; }}>${region.name}</button>
    ${refusal ? html`<span class="refused warn" role="img" aria-label=${`Not in the 3-D picture: ${refusal}`} title=${`Not in the 3-D picture: ${refusal}`}>${icon('warning')}</span>` : nothing}
    <span class="tail volume" aria-hidden="true">${region.voxels ? volume(region.volume_cm3) : 'empty'}</span>
    <input type="range" class="mini" min="0" max="100" step="1" .value=${live(String(percent))} ${variables({ '--fill': `${percent}%` })}
      aria-label=${`Opacity of ${region.name}`} title="Opacity" ?disabled=${isDisabled}
      @input=${(event) => change({ opacity: event.target.valueAsNumber / 100 }, event)}>
    <span class="percent"><input type="number" min="0" max="100" step="1" .value=${live(String(percent))} aria-label=${`Opacity of ${region.name} in per cent`} ?disabled=${isDisabled}
      @change=${(event) => Number.isFinite(event.target.valueAsNumber) && change({ opacity: Math.min(Math.max(event.target.valueAsNumber, 0), 100) / 100 }, event)}> %</span>
  </li>`;
}

/** The doses, each with a button that shows its grid over the picture. */
function doses(room, ui, plan) {
  const scene = room.scene.value;
  if (!scene || !plan.doses.length) return nothing;
  const shown = scene.dose.grid ? plan.doses.find((dose) => dose.id === scene.dose.id) ?? plan.doses[0] : null;
  const row = (dose) => {
    const isShown = dose === shown;
    const toggle = (event) => room.patchScene({ dose: { id: dose.id, grid: !isShown } }, { view: ui.active.value, at: event.timeStamp });
    return html`<li class="row" data-dose=${dose.id} title=${doseWords(dose)}><button class="eye" aria-pressed=${isShown} aria-label=${`Show the grid of ${dose.name || dose.id}`} title="Show or hide the box of its grid"
      ?disabled=${!room.canChange.value} @click=${toggle}>${icon(isShown ? 'eye' : 'eyeOff')}</button><span class="clipped">${dose.name || dose.id}</span>${frameMark(dose)}<span class="tail">${dose.unit}</span></li>`;
  };
  const frameMark = (dose) => (dose.frame_of_reference === 'differs' ? html`<span class="refused warn" role="img" aria-label=${frameWords(dose)} title=${frameWords(dose)}>${icon('warning')}</span>` : nothing);
  return section('Doses', shown ? 'grid shown' : '', html`<ul class="rows">${plan.doses.map(row)}</ul>`);
}

function beams(plan) {
  const rows = [
    ...plan.beams.map((beam) => [beam.name || beam.id, beamWords(beam)]),
    ...(plan.nTracks ? [['Particle tracks', count(plan.nTracks, 'segment')]] : []),
    ...plan.curves.map((curve) => [curve.name || curve.id, 'reference curve']),
  ];
  if (!rows.length) return nothing;
  return section('Beams', '', html`<ul class="rows">${rows.map(([name, words]) => html`<li class="row plain" title=${`${name}: ${words}`}><span class="clipped">${name}</span><span class="tail clipped">${words}</span></li>`)}</ul>`);
}
