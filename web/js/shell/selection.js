// The inspector's Selection: what was clicked last, wherever it was. A row of the table for each kind.
import { html, nothing } from '../../lib/lit-html.js';
import { drawBeam } from '../features/beams/feature.js';
import { drawBookmark } from '../features/bookmarks/feature.js';
import { clipBlock } from '../features/clip/clip_plane.js';
import { doseBlock, levelBlock } from '../features/dose/dose_block.js';
import { drawingBlocks } from '../features/regions/drawing.js';
import { ofFits } from '../features/fits/feature.js';
import { icon } from '../parts/icons.js';
import { imageBlock } from '../features/image/image.js';
import { measureBlock, measuresBlock } from '../features/measures/measure.js';
import { pictureBlock } from '../features/image/picture.js';
import { obliqueBlock } from '../features/planes/oblique_plane.js';
import { regionBlock } from '../features/regions/region.js';
import { drawTracks } from '../features/tracks/feature.js';
import { volumeBlock } from '../features/image/volume.js';

export { figuresDialog } from '../features/regions/figures.js'; // which a region's block opens

const kinds = {
  view: pictureBlock,
  image: imageBlock,
  volume: volumeBlock,
  region: regionPart,
  dose: doseBlock,
  quantity: doseBlock,
  dosing: doseBlock,
  level: levelBlock,
  beam: (...args) => drawBeam(({ beamBlock }) => beamBlock(...args)),
  kept: (...args) => drawBeam(({ keptBlock }) => keptBlock(...args)),
  curve,
  tracks: (...args) => drawTracks(({ trackBlock }) => trackBlock(...args)),
  track: (...args) => drawTracks(({ segmentBlock }) => segmentBlock(...args)),
  clip: clipBlock,
  oblique: obliqueBlock,
  measure: measureBlock,
  measures: measuresBlock,
  bookmark: (...args) => drawBookmark(({ bookmarkBlock }) => bookmarkBlock(...args)),
};

export function selection(world) {
  const { room, ui } = world;
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene(patch, { view: ui.active.value, at: event.timeStamp });
  return html`${ofFits(room)?.fitBlock(world) ?? nothing}${kinds[ui.selection.value.kind](world, isDisabled, change)}`;
}

const chosen = ({ room, ui }, list) => room.plan.value[list].find(({ id }) => id === ui.selection.value.id);
const facts = (rows) => html`<dl>${rows.filter(Boolean).map(([name, value]) => html`<dt>${name}</dt><dd>${value}</dd>`)}</dl>`;

function regionPart(world, isDisabled, change) {
  return html`${regionBlock(world, chosen(world, 'regions'))}${drawingBlocks(world, isDisabled, change)}`;
}

function curve(world) {
  const shown = chosen(world, 'curves');
  return shown
    ? html`<section class="block"><h3>${icon('curve')} Reference curve ${shown.name || shown.id}</h3>
    ${facts(
      Object.entries(shown)
        .filter(([name, value]) => !['id', 'name'].includes(name) && ['number', 'string'].includes(typeof value) && value !== '')
        .map(([name, value]) => [name.replaceAll('_', ' '), String(value)]),
    )}</section>`
    : nothing;
}
