// The inspector at the right: values at the crosshair, how pictures are drawn, the report of loading.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { live } from '../../lib/directives/live.js';
import { crosshair, frameWords, imagePatch, isLowWhite, reportSummary, shownImage, windowPresets } from '../state/plan.js';
import { algorithms } from '../state/shapes.js';
import { drawingBlocks } from './drawing.js';
import { numberField, segment } from './fields.js';
import { number, seconds, significant, unitText } from './format.js';
import { icon } from './icons.js';
import { regionBlock } from './region.js';
import { reportLines } from './report.js';
import { roving } from './tools.js';

const tabs = [['probe', 'Probe'], ['view', 'View'], ['report', 'Report']];
const sides = [['sagittal', 'Sagittal'], ['coronal', 'Coronal'], ['axial', 'Axial']];

export function inspector(world) {
  const { room, ui } = world;
  if (!ui.isInspectorOpen.value)
    return html`<button class="icon-button rail" title="Show the inspector" aria-label="Show the inspector" @click=${() => { ui.isInspectorOpen.value = true; }}>${icon('panel')}</button>`;
  const tab = ui.tab.value;
  const content = { probe, view: viewTab, report: reportTab }[tab];
  return html`<div class="tabs"><div role="tablist" aria-label="Inspector" @keydown=${roving}>
      ${tabs.map(([id, name]) => html`<button role="tab" id=${`tab-${id}`} aria-selected=${tab === id} aria-controls="tab-panel" tabindex=${tab === id ? 0 : -1}
        @click=${() => { ui.tab.value = id; }}>${name}</button>`)}</div><span class="grow"></span>
      <button class="icon-button" title="Fold" aria-label="Fold the inspector" @click=${() => { ui.isInspectorOpen.value = false; }}>${icon('chevronRight')}</button></div>
    <div class="scroll" role="tabpanel" id="tab-panel" aria-labelledby=${`tab-${tab}`}>${room.plan.value && room.scene.value ? content(world) : html`<p class="empty">The plan is being loaded.</p>`}</div>`;
}

// ---- probe ------------------------------------------------------------------------------------------------------------

function probe(world) {
  const { room, ui, probed } = world;
  const plan = room.plan.value;
  const scene = room.scene.value;
  const image = shownImage(plan, scene);
  const { result, error, isOld } = probed.value;
  const value = result?.images?.find((other) => other.id === image?.id);
  const point = crosshair(scene);
  return html`<section class="block"><h3>Probe at crosshair</h3>
      <div class="numbers">${['L', 'P', 'S'].map((letter, axis) => html`<div><span class="dim">${letter}</span><b>${number(point[axis], 1)}${axis === 2 ? ' mm' : ''}</b></div>`)}
        ${image ? html`<div class=${classMap({ end: true, old: isOld })}><span class="dim">${image.modality}</span><b>${value && value.value !== null ? `${significant(value.value)} ${value.unit}` : '–'}</b></div>` : nothing}</div>
      <div class=${classMap({ inside: true, old: isOld })}>${error ? html`<span class="err">${icon('error')} ${error}</span>` : inside(plan, scene, result)}</div></section>
    ${doseTable(result, isOld)}${regionBlock(world, plan.regions.find((region) => region.id === ui.region.value))}`;
}

function inside(plan, scene, result) {
  if (!result) return html`<span class="dim">…</span>`;
  const regions = result.regions.map((id) => plan.regions.find((region) => region.id === id)).filter(Boolean);
  if (!regions.length) return html`<span class="dim">outside every region</span>`;
  const [first, ...outer] = regions;
  return html`<svg class="swatch" viewBox="0 0 12 12" width="12" height="12" aria-hidden="true"><rect width="12" height="12" rx="2.5" fill=${scene.regions[first.id]?.color ?? first.color}/></svg>
    <b>${first.name}</b><span class="dim">${outer.map((region) => `in ${region.name}`).join(', ')}</span>`;
}

function doseTable(result, isOld) {
  if (!result?.doses?.length) return nothing;
  const ids = [...new Set(result.doses.map((dose) => dose.id))];
  return ids.map((id) => {
    const rows = result.doses.filter((dose) => dose.id === id);
    return html`<section class="block"><h3>Dose <span class="dim">${id}</span></h3><table class=${classMap({ old: isOld })}><thead><tr><th>Component</th><th>${unitText(rows[0].unit)}</th></tr></thead>
      <tbody>${rows.map((dose) => html`<tr><td>${componentName(dose)}</td><td>${dose.value === null ? 'not known here' : significant(dose.value)}${dose.unit === rows[0].unit ? '' : ` ${unitText(dose.unit)}`}</td></tr>`)}</tbody></table>
      <p class="note">${rows[0].per ? `Per ${unitText(rows[0].per.replace(/^per /, ''))}. ` : ''}Physical, no weights${rows.some(({ quantity }) => hasWeights.has(quantity)) ? ', but for weighted total and blood boron: there the file has put them in' : ''}.${boronNote(rows)}</p>
      ${frameWords(rows[0]) ? html`<p class="note why">${icon('warning', 12)} ${frameWords(rows[0])}</p>` : nothing}</section>`;
  });
}

const componentName = ({ quantity, per_ppm, boron_ppm: ppm }) => `${quantity[0].toUpperCase()}${quantity.slice(1).replaceAll('-', ' ')}${per_ppm ? ', per ppm' : ''}${Number.isFinite(ppm) ? `, boron at ${ppm} ppm` : ''}`;

/** The boron that a total includes; it cannot be taken out, so it is shown beside the value. */
function boronNote(rows) {
  const total = rows.find(({ boron_ppm: ppm }) => Number.isFinite(ppm));
  return total ? ` The ${total.quantity.replaceAll('-', ' ')} is with boron at ${total.boron_ppm} ppm in blood.` : '';
}
const hasWeights = new Set(['weighted-total', 'blood-boron']);

// ---- view -------------------------------------------------------------------------------------------------------------

function viewTab(world) {
  const { room, ui, panes } = world;
  const scene = room.scene.value;
  const plan = room.plan.value;
  const image = shownImage(plan, scene);
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene(patch, { view: ui.active.value, at: event.timeStamp });
  const camera = panes()[0].actions.camera;
  return html`${image ? imageBlock(world, plan, scene, image, isDisabled, change) : nothing}
    <section class="block"><h3>3-D picture</h3>
      <dl>${room.view(1).document.value ? html`<dt>Projection</dt><dd>${segment('Projection', [['perspective', 'Perspective'], ['parallel', 'Parallel']], camera.projection, isDisabled, (id) => panes()[0].actions.setProjection(id))}</dd>` : nothing}
        <dt>Surfaces</dt><dd>${segment('Surface', algorithms, scene.surface.algorithm, isDisabled, (algorithm, event) => change({ surface: { algorithm } }, event))}</dd>
        <dt>Shading</dt><dd>${segment('Shading', [['vertex', 'Smooth'], ['face', 'Faceted']], scene.surface.normals, isDisabled, (normals, event) => change({ surface: { normals } }, event))}</dd>
        <dt>Translucency</dt><dd>${segment('Translucency', [['rim', 'Rim'], ['plain', 'Plain']], scene.surface.translucency, isDisabled, (translucency, event) => change({ surface: { translucency } }, event))}</dd>
        <dt>Overlaps</dt><dd>${segment('What lies before what', [['exact', 'Exact', 'Each pixel in its own order, also where regions cross'], ['hierarchy', 'By hierarchy', 'Whole regions, inner before outer, as Sera3d does']], scene.surface.translucent_order, isDisabled, (translucent_order, event) => change({ surface: { translucent_order } }, event))}</dd></dl>
      ${image ? html`<div class="checks" role="group" aria-label="Slices in 3-D"><span class="dim">Slices in 3-D</span>${sides.map(([id, name]) => html`<label><input type="checkbox" .checked=${live(scene.image.slices[id].visible)} ?disabled=${isDisabled}
        @change=${(event) => change({ image: { slices: { [id]: { visible: event.target.checked } } } }, event)}>${name}</label>`)}</div>${cullRow(scene, image, isDisabled, change)}` : nothing}
      <div class="buttons looks" role="group" aria-label="Look from">${['anterior', 'posterior', 'left', 'right', 'superior', 'inferior'].map((name) => html`<button ?disabled=${isDisabled} title=${`Look from ${name}`}
        @click=${(event) => panes()[0].actions.lookFrom(name, event.timeStamp)}>${name[0].toUpperCase()}${name.slice(1)}</button>`)}</div></section>
    ${drawingBlocks(world, isDisabled, change)}`;
}

const cullsNothing = -1e12; // proto/scene.json

/** The threshold below which slices in the 3-D view are transparent, so that air hides nothing. */
function cullRow(scene, image, isDisabled, change) {
  const { cull_below: value } = scene.image;
  const isOn = value > cullsNothing;
  return html`<div class="checks cull"><label title="Slices in the 3-D view leave out lower values"><input type="checkbox" .checked=${live(isOn)} ?disabled=${isDisabled}
    @change=${(event) => change({ image: { cull_below: event.target.checked ? null : cullsNothing } }, event)}>Leave out below</label>
    ${isOn ? numberField('Leave out values below', Number(value.toPrecision(6)), image.unit, isDisabled, (cull_below, event) => change({ image: { cull_below } }, event)) : nothing}</div>`;
}

function imageBlock({ panes, ui }, plan, scene, image, isDisabled, change) {
  const { window } = scene.image;
  const setWindow = (value, event) => panes()[ui.active.value - 1].actions.setWindow({ ...window, ...value }, event.timeStamp);
  const isNow = (preset) => Math.abs(preset.center - window.center) < 0.06 && Math.abs(preset.width - window.width) < 0.06;
  return html`<section class="block"><h3>Image ${image.modality}</h3>
    ${plan.images.length > 1 ? html`<dl><dt>Image</dt><dd>${segment('Image', plan.images.map((other) => [other.id, `${other.modality} ${other.id}`]), image.id, isDisabled, (id, event) => change(imagePatch(plan.images.find((other) => other.id === id)), event))}</dd></dl>` : nothing}
    <dl><dt>Centre</dt><dd>${numberField('Window centre', Math.round(window.center * 10) / 10, image.unit, isDisabled, (center, event) => setWindow({ center }, event))}</dd>
      <dt>Width</dt><dd>${numberField('Window width', Math.round(window.width * 10) / 10, image.unit, isDisabled, (width, event) => setWindow({ width: Math.max(width, 0.1) }, event))}</dd>
      <dt>Low values</dt><dd>${segment('Low values', [['black', 'Black'], ['white', 'White', 'The values stay; only their greys go the other way']], isLowWhite(image, scene) ? 'white' : 'black', isDisabled, (low_values, event) => change({ image: { low_values } }, event))}</dd>
      <dt>Between voxels</dt><dd>${segment('Interpolation', [['linear', 'Linear'], ['nearest', 'Nearest']], scene.image.interpolation, isDisabled, (interpolation, event) => change({ image: { interpolation } }, event))}</dd></dl>
    <div class="buttons looks" role="group" aria-label="Window presets">${windowPresets(image).map((preset) => html`<button class=${classMap({ on: isNow(preset) })} aria-pressed=${isNow(preset)} ?disabled=${isDisabled} title=${`Key ${preset.key}`}
      @click=${(event) => setWindow({ center: preset.center, width: preset.width }, event)}>${preset.name} <kbd>${preset.key}</kbd></button>`)}</div></section>`;
}

// ---- report -----------------------------------------------------------------------------------------------------------

function reportTab({ room }) {
  const plan = room.plan.value;
  return html`<section class="block"><h3>Load report</h3><p class="note">${reportSummary(plan.report)}${plan.loadMs === null ? '' : `, loaded in ${seconds(plan.loadMs)}`}</p>
    ${plan.note ? html`<p>${plan.note}</p>` : nothing}</section>${reportLines(plan.report)}`;
}
