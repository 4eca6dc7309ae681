// Regions that a beam meets: those in its aperture and the lengths of those that its axis crosses.
import { swatch } from '../../parts/icons.js';
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { mm } from './beam_words.js';
import { number } from '../../parts/format.js';

/** @param {object|null} facts the answer to the question beam; null: not here yet */
export function regionBlocks(world, facts, isOld) {
  return facts ? html`${apertureBlock(world, facts, isOld)}${crossedBlock(world, facts, isOld)}` : nothing;
}

const unknown = "Not counted: the diameter of the aperture is not known. Enter one for the draft, or show the ring in the beam's-eye view.";

const share = (row) => (row && Number.isFinite(row.share) ? `${number(row.share * 100, 1)} %` : '–');

function named({ room, ui }, id) {
  const region = room.plan.value.regions.find((other) => other.id === id);
  const color = room.scene.value.regions[id]?.color ?? region?.color;
  return html`${color ? swatch(color) : nothing}<button class="link" @click=${() => ui.choose('region', id)}>${region?.name ?? id}</button>`;
}

function apertureBlock(world, { aperture, planned, is_draft: isDraft }, isOld) {
  if (!aperture) return html`<section class="block"><h3>Regions in the aperture</h3><p class="note">${unknown}</p></section>`;
  const before = isDraft && planned ? planned.aperture : undefined;
  const ids = [
    ...aperture.regions,
    ...(before?.regions ?? []).filter(({ region }) => !aperture.regions.some((other) => other.region === region)),
  ].map(({ region }) => region);
  const of = (list, id) => list?.regions.find(({ region }) => region === id);
  return html`<section class="block"><h3 class="beam-head">Regions in the ${aperture.is_ring ? 'ring' : 'aperture'} <span class="dim">${aperture.is_ring ? 'drawn, ' : ''}cylinder of ${number(aperture.diameter_mm, aperture.diameter_mm % 1 ? 1 : 0)} mm</span></h3>
    ${
      ids.length
        ? html`<table class=${classMap({ 'beam-regions': true, old: isOld })}><thead><tr><th scope="col">Region</th><th scope="col">first at</th><th scope="col">inside${before !== undefined ? ', draft' : ''}</th>${before !== undefined ? html`<th scope="col">planned</th>` : nothing}</tr></thead>
      <tbody>${ids.map((id) => {
        const row = of(aperture, id);
        return html`<tr><th scope="row">${named(world, id)}</th><td>${Number.isFinite(row?.first_mm) ? mm(row.first_mm) : '–'}</td>
        <td title=${row ? `${number(row.inside_cm3, 2)} of ${number(row.region_cm3, 2)} cm³` : nothing}><b>${share(row)}</b></td>${before !== undefined ? html`<td class="planned">${share(of(before, id))}</td>` : nothing}</tr>`;
      })}</tbody></table>
      <p class="note">Counted: univels of the region itself, without regions inside it, with their centres in the cylinder, however far along the axis. First at: from the entry.</p>`
        : html`<p class="note">No region lies in it.</p>`
    }</section>`;
}

function crossedBlock(world, { crossed = [], planned, is_draft: isDraft }, isOld) {
  const before = isDraft && planned ? (planned.crossed ?? []) : null;
  if (!crossed.length && !before?.length)
    return html`<section class="block"><h3>Crossed</h3><p class="note">The axis crosses no region.</p></section>`;
  const ids = [...new Set([...crossed, ...(before ?? [])].map(({ region }) => region))];
  const lengthOf = (list, id) => {
    const row = list.find(({ region }) => region === id);
    return row ? mm(row.length_mm) : '–';
  };
  return html`<section class="block"><h3 class="beam-head">Crossed <span class="dim">by the axis</span></h3>
    <table class=${classMap({ 'beam-regions': true, old: isOld })}><thead><tr><th scope="col">Region</th><th scope="col">length${before ? ', draft' : ''}</th>${before ? html`<th scope="col">planned</th>` : nothing}</tr></thead>
    <tbody>${ids.map((id) => html`<tr><th scope="row">${named(world, id)}</th><td><b>${lengthOf(crossed, id)}</b></td>${before ? html`<td class="planned">${lengthOf(before, id)}</td>` : nothing}</tr>`)}</tbody></table></section>`;
}
