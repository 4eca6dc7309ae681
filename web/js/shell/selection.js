// The inspector's Selection: what was clicked last, wherever it was. What it shows of each kind is a feature's.
import { html } from '../../lib/lit-html.js';
import { features, partsOf } from '../features/index.js';

export function selection(world) {
  const { room, ui } = world;
  const { kind } = ui.selection.value;
  const isDisabled = !room.canChange.value;
  const change = (patch, event) => room.patchScene(patch, { view: ui.active.value, at: event.timeStamp });
  const { blocks: parts } = features.find(({ kinds }) => kinds && kind in kinds);
  return html`${partsOf('aboveBlock', world)}${parts.draw(({ blocks }) => blocks[kind](world, isDisabled, change))}`;
}

/** Loads what most selections need, before the first click. */
export function loadBlocks() {
  for (const { isSoon, blocks } of features) if (isSoon) blocks.load();
}
