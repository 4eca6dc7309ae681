// The block of Selection for a region, and the dialog that it opens.
import { html } from '../../../lib/lit-html.js';
import { drawingBlocks } from './drawing.js';
import { regionBlock } from './region.js';

export { startComparison } from './comparison.js';
export { figuresDialog } from './figures.js';

function whole(world, isDisabled, change) {
  const { room, ui } = world;
  const region = room.plan.value.regions.find(({ id }) => id === ui.selection.value.id);
  return html`${regionBlock(world, region)}${drawingBlocks(world, isDisabled, change)}`;
}

export const blocks = { region: whole };
