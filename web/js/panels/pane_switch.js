// On a telephone: which of the four panes is shown.
import { nothing } from '../../lib/lit-html.js';
import { segment } from './fields.js';
import { names } from './pane.js';

export function paneSwitch({ room, ui }) {
  if (ui.arrangement.value.size !== 'phone') return nothing;
  return segment('Pane', room.views.map(({ kind, number }) => [number, names[kind]]), ui.visible.value[0], false, (number) => {
    ui.maximised.value = 0;
    ui.active.value = number;
  });
}
