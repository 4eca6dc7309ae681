// On a telephone: which of the four panes is shown (their names in the headers change what is in them) and, as its banner has no room for them, undo and redo.
import { html, nothing } from '../../lib/lit-html.js';
import { segment } from '../parts/fields.js';
import { roving } from '../parts/roving.js';
import { undoButtons } from './undo_buttons.js';
import { say } from './words.js';

export function paneSwitch(world) {
  const { room, ui } = world;
  if (ui.arrangement.value.size !== 'phone') return nothing;
  const panes = segment(
    say.pane,
    ui.panes.four.value.map((number) => [number, room.view(number).name]),
    ui.visible.value[0],
    false,
    (number) => {
      ui.maximised.value = 0;
      ui.active.value = number;
    },
  );
  return html`${panes}<div class="steps" role="toolbar" aria-label=${say.steps} @keydown=${roving}>${undoButtons(world)}</div>`;
}
