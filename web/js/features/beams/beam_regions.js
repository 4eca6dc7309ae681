// Regions that a beam meets: those in its aperture and the lengths of those that its axis crosses.
import { swatch } from '../../parts/icons.js';
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { mm } from './beam_words.js';
import { number } from '../../parts/format.js';
import { say } from './later_words.js';

/** @param {object|null} facts the answer to the question beam; null: not here yet */
export function regionBlocks(world, facts, isOld) {
  return facts ? html`${apertureBlock(world, facts, isOld)}${crossedBlock(world, facts, isOld)}` : nothing;
}

const share = (row) => (row && Number.isFinite(row.share) ? `${number(row.share * 100, 1)} %` : '–');

function named({ room, ui }, id) {
  const region = room.plan.value.regions.find((other) => other.id === id);
  const color = room.scene.value.regions[id]?.color ?? region?.color;
  return html`${color ? swatch(color) : nothing}<button class="link" @click=${() => ui.choose('region', id)}>${region?.name ?? id}</button>`;
}

const openings = { jaws: say.ofJaws, leaves: say.ofLeaves, blocks: say.ofBlocks };

function shapeWords({ diameter_mm: mm, opening, is_ring: isRing }) {
  if (opening) return { title: say.inOpening, shape: openings[opening], counted: say.countedInOpening };
  const diameter = number(mm, mm % 1 ? 1 : 0);
  return isRing
    ? { title: say.inRing, shape: say.cylinderDrawn({ diameter }), counted: say.counted }
    : { title: say.inAperture, shape: say.cylinder({ diameter }), counted: say.counted };
}

function apertureBlock(world, { aperture, planned, is_draft: isDraft }, isOld) {
  if (!aperture) return html`<section class="block"><h3>${say.inAperture}</h3><p class="note">${say.notCounted}</p></section>`;
  const before = isDraft && planned ? planned.aperture : undefined;
  const ids = [
    ...aperture.regions,
    ...(before?.regions ?? []).filter(({ region }) => !aperture.regions.some((other) => other.region === region)),
  ].map(({ region }) => region);
  const of = (list, id) => list?.regions.find(({ region }) => region === id);
  const { title, shape, counted } = shapeWords(aperture);
  return html`<section class="block"><h3 class="beam-head">${title} <span class="dim">${shape}</span></h3>
    ${
      ids.length
        ? html`<table class=${classMap({ 'beam-regions': true, old: isOld })}><thead><tr><th scope="col">${say.region}</th><th scope="col">${say.firstAt}</th><th scope="col">${before !== undefined ? say.insideDraft : say.inside}</th>${before !== undefined ? html`<th scope="col">${say.plannedColumn}</th>` : nothing}</tr></thead>
      <tbody>${ids.map((id) => {
        const row = of(aperture, id);
        return html`<tr><th scope="row">${named(world, id)}</th><td>${Number.isFinite(row?.first_mm) ? mm(row.first_mm) : '–'}</td>
        <td title=${row ? say.insideOf({ inside: number(row.inside_cm3, 2), whole: number(row.region_cm3, 2) }) : nothing}><b>${share(row)}</b></td>${before !== undefined ? html`<td class="planned">${share(of(before, id))}</td>` : nothing}</tr>`;
      })}</tbody></table>
      <p class="note">${counted}</p>`
        : html`<p class="note">${say.noRegion}</p>`
    }</section>`;
}

function crossedBlock(world, { crossed = [], planned, is_draft: isDraft }, isOld) {
  const before = isDraft && planned ? (planned.crossed ?? []) : null;
  if (!crossed.length && !before?.length)
    return html`<section class="block"><h3>${say.crossed}</h3><p class="note">${say.crossesNone}</p></section>`;
  const ids = [...new Set([...crossed, ...(before ?? [])].map(({ region }) => region))];
  const lengthOf = (list, id) => {
    const row = list.find(({ region }) => region === id);
    return row ? mm(row.length_mm) : '–';
  };
  return html`<section class="block"><h3 class="beam-head">${say.crossed} <span class="dim">${say.byAxis}</span></h3>
    <table class=${classMap({ 'beam-regions': true, old: isOld })}><thead><tr><th scope="col">${say.region}</th><th scope="col">${before ? say.lengthDraft : say.lengthColumn}</th>${before ? html`<th scope="col">${say.plannedColumn}</th>` : nothing}</tr></thead>
    <tbody>${ids.map((id) => html`<tr><th scope="row">${named(world, id)}</th><td><b>${lengthOf(crossed, id)}</b></td>${before ? html`<td class="planned">${lengthOf(before, id)}</td>` : nothing}</tr>`)}</tbody></table></section>`;
}
