// The inspector's Selection: what was clicked last, wherever it was. A row of the table for each kind.
import { html, nothing } from '../../lib/lit-html.js';
import { className, doseWords, frameWords } from '../state/plan.js';
import { clipBlock } from './clip_plane.js';
import { drawingBlocks } from './drawing.js';
import { count, number, significant, unitText } from './format.js';
import { icon } from './icons.js';
import { imageBlock } from './image.js';
import { measureBlock, measuresBlock } from './measure.js';
import { pictureBlock } from './picture.js';
import { componentName } from './probe.js';
import { obliqueBlock } from './oblique_plane.js';
import { regionBlock } from './region.js';
import { volumeBlock } from './volume.js';

const kinds = { view: pictureBlock, image: imageBlock, volume: volumeBlock, region: regionPart, dose, beam, curve, tracks, clip: clipBlock, oblique: obliqueBlock, measure: measureBlock, measures: measuresBlock };

export function selection(world) {
  const { room, ui } = world;
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene(patch, { view: ui.active.value, at: event.timeStamp });
  return kinds[ui.selection.value.kind](world, isDisabled, change);
}

const chosen = ({ room, ui }, list) => room.plan.value[list].find(({ id }) => id === ui.selection.value.id);
const triple = (mm) => `L ${number(mm[0], 1)}  P ${number(mm[1], 1)}  S ${number(mm[2], 1)} mm`;
const facts = (rows) => html`<dl>${rows.filter(Boolean).map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>`;

function regionPart(world, isDisabled, change) {
  return html`${regionBlock(world, chosen(world, 'regions'))}${drawingBlocks(world, isDisabled, change)}`;
}

function dose(world, isDisabled, change) {
  const shown = chosen(world, 'doses');
  if (!shown) return nothing;
  const { dose: style } = world.room.scene.value;
  const isShown = (style.id || world.room.plan.value.doses[0].id) === shown.id;
  const isOn = isShown && style.grid;
  const grids = new Set(shown.components.map(({ grid }) => JSON.stringify(grid.lps_mm_from_ijk)));
  const [{ grid }] = shown.components;
  return html`<section class="block"><h3>${icon('dose')} Dose ${shown.name || shown.id}</h3><p class="note">${doseWords(shown)}.</p>
      ${facts([['Grid', `${grid.size.join(' × ')} of ${grid.spacing_mm.map((mm) => number(mm, 1)).join(' × ')} mm`], grids.size > 1 && ['Other components', 'have grids of their own'],
        ['Axes of the grid', grid.orientation], shown.masked && ['Outside the body', 'not known'], ['In the probe', isShown ? 'in full' : 'folded']])}
      ${frameWords(shown) ? html`<p class="note why">${icon('warning', 12)} ${frameWords(shown)}</p>` : nothing}
      <div class="buttons"><button class=${isOn ? 'on' : ''} aria-pressed=${isOn} ?disabled=${isDisabled} @click=${(event) => change({ dose: { id: shown.id, grid: !isOn } }, event)}>Box of the grid</button>
        ${isShown ? nothing : html`<button ?disabled=${isDisabled} @click=${(event) => change({ dose: { id: shown.id } }, event)}>Probe this dose</button>`}</div></section>
    <section class="block"><table><thead><tr><th scope="col">Component</th><th scope="col">Highest</th><th scope="col">in body</th></tr></thead>
      <tbody>${shown.components.map((part) => html`<tr><td>${componentName(part)}</td><td>${significant(part.high)} ${unitText(part.unit)}</td><td>${Number.isFinite(part.body_high) ? significant(part.body_high) : '–'}</td></tr>`)}</tbody></table></section>`;
}

function beam(world) {
  const shown = chosen(world, 'beams');
  if (!shown) return nothing;
  const { delivery } = shown;
  const words = (name) => name.replace(/_(deg|mm)$/, '').replaceAll('_', ' ');
  const unit = (name) => ({ deg: '°', mm: ' mm' })[/_(deg|mm)$/.exec(name)?.[1]] ?? '';
  return html`<section class="block"><h3>${icon('target')} Beam ${shown.name || shown.id}</h3>
    ${facts([['Entry', triple(shown.entry_mm)], ['Target', triple(shown.target_mm)], ['Distance', `${number(Math.hypot(...shown.entry_mm.map((mm, axis) => mm - shown.target_mm[axis])), 1)} mm`],
      shown.aperture_mm && ['Aperture', `${number(shown.aperture_mm, 1)} mm`],
      ...Object.entries(delivery ?? {}).filter(([, value]) => ['number', 'string'].includes(typeof value) && value !== '')
        .map(([name, value]) => [`${words(name)[0].toUpperCase()}${words(name).slice(1)}`, `${value}${unit(name)}`])])}</section>`;
}

function curve(world) {
  const shown = chosen(world, 'curves');
  return shown ? html`<section class="block"><h3>${icon('curve')} Reference curve ${shown.name || shown.id}</h3>
    ${facts(Object.entries(shown).filter(([name, value]) => !['id', 'name'].includes(name) && ['number', 'string'].includes(typeof value) && value !== '').map(([name, value]) => [name.replaceAll('_', ' '), String(value)]))}</section>` : nothing;
}

function tracks({ room, ui }) {
  const { nTracks, trackClasses } = room.plan.value;
  return html`<section class="block"><h3>${icon('tracks')} Particle tracks <span class="dim">${count(nTracks, 'segment')}</span></h3>
    <table><thead><tr><th scope="col">Class</th><th scope="col">Segments</th><th scope="col">Share</th></tr></thead>
      <tbody>${trackClasses.map(({ id, n }) => html`<tr class=${id === ui.selection.value.id ? 'total' : ''}><td>${className(id)}</td><td>${number(n)}</td><td>${number((100 * n) / nTracks, 1)} %</td></tr>`)}</tbody></table></section>`;
}
