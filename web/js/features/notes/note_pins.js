// The pins of open notes over a picture, numbered as in the list: at their points, fainter the further the slice is away; in 3-D all.
import { html, nothing } from '../../../lib/lit-html.js';
import { heightOver } from '../../room/obliques.js';
import { isResolved, pinStrength, pointOf, threadsOf } from './threads.js';
import { say } from './later_words.js';
import { listed } from '../../parts/format.js';
import { textOf } from './note_words.js';
import { toPicture } from '../../parts/vec.js';
import { variables } from '../../parts/mount.js';

const mostPins = 200; // nearest notes first beyond that, so that a picture stays one

const labelOf = ({ note, number, replies: { length: n }, strength }) =>
  listed(say.pin({ number, name: note.author_name }), n && say.nReplies({ n }), strength < 1 && say.beside);

/** @param {{room, ui}} world @param {{header: object|null, box: object, pane: number[], plane: object|null, tolerance: number}} place plane null: in space */
export function notePins({ room, ui }, { header, box, pane, plane, tolerance }) {
  const plan = room.plan.value;
  if (!header || !plan || pane[0] < 2) return nothing;
  const pins = threadsOf(room.items.notes.value)
    .filter((thread) => !isResolved(thread) || thread.note.id === ui.note.value)
    .flatMap(({ note, number, replies }) => {
      const point = pointOf(note, plan);
      const at = point && toPicture(header.clip_from_lps_mm, point);
      if (!at) return [];
      const [x, y] = [box.x + at[0] * box.width, box.y + at[1] * box.height];
      const strength = plane ? pinStrength(Math.abs(heightOver(plane, point)), tolerance) : 1;
      return strength > 0 && x >= 0 && y >= 0 && x <= pane[0] && y <= pane[1] ? [{ note, number, replies, x, y, strength }] : [];
    })
    .sort((a, b) => b.strength - a.strength)
    .slice(0, mostPins)
    .reverse();
  if (!pins.length) return nothing;
  const open = (id) => {
    ui.note.value = id;
    ui.showTab('notes');
  };
  const keep = (event) => event.stopPropagation(); // the pane takes no press and no key of a pin
  return html`<div class="note-pins">${pins.map(
    ({
      note,
      number,
      replies,
      x,
      y,
      strength,
    }) => html`<button class="note-pin" tabindex="-1" data-note=${note.id} data-chosen=${ui.note.value === note.id} data-off=${strength < 1}
    title=${say.pinIs({ name: note.author_name, text: textOf(note).slice(0, 120) })} aria-label=${labelOf({ note, number, replies, strength })}
    ${variables({ '--x': `${x.toFixed(1)}px`, '--y': `${y.toFixed(1)}px`, '--strength': String(strength.toFixed(2)), '--author': note.author_color })}
    @pointerdown=${keep} @pointerup=${keep} @dblclick=${keep} @keydown=${keep} @click=${() => open(note.id)}>${number}</button>`,
  )}</div>`;
}
