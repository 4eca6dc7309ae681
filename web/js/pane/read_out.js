// The card at the pointer: region, image value and position, beside the place that the mouse rests on or a finger held. Loaded before the first click.
import { html, nothing, svg } from '../../lib/lit-html.js';
import { cardOf, placeBeside } from '../parts/place.js';
import { variables } from '../parts/mount.js';
import { words } from './pointed_words.js';
import { boxOf } from '../parts/page_look.js';

const mouseGap = 16;
const touchGap = 40; // a finger covers what is nearer
const rings = [24, 31];

/** @param {object} world {room, pointed} @param {HTMLElement} host inside the picture */
export function readOut({ room, pointed }, host) {
  const shown = pointed.shown.value;
  const plan = room.plan.peek();
  const scene = room.scene.peek();
  if (!shown || !plan || !scene) return nothing;
  const picture = boxOf(host.parentElement);
  const { name, color, lines, value, width, height } = cardOf(words(shown.facts, plan, scene), picture.width, shown.isHeld);
  const { x, y } = placeBeside(
    shown,
    [width, height],
    [picture.width, picture.height],
    takenIn(host.parentElement, picture),
    shown.isHeld ? touchGap : mouseGap,
  );
  return html`${shown.isHeld ? html`<svg class="rings">${[0, 1].map((layer) => rings.map((r) => svg`<circle class=${layer ? 'ink' : 'under'} cx=${shown.x} cy=${shown.y} r=${r} />`))}</svg>` : nothing}
    <div class="read-out" role=${shown.isHeld ? 'status' : nothing} aria-hidden=${shown.isHeld ? nothing : 'true'} ?data-held=${shown.isHeld}
      ${variables({ '--x': `${x}px`, '--y': `${y}px`, '--width': `${width}px`, '--height': `${height}px` })}>
      <p class="who">${color ? html`<svg class="swatch" viewBox="0 0 12 12" width="12" height="12" aria-hidden="true"><rect width="12" height="12" rx="2.5" fill=${color}/></svg>` : nothing}<b>${name}</b></p>
      ${value ? html`<p class="value"><span>${value.label}</span> <b>${value.text}</b> ${value.unit}</p>` : nothing}
      ${lines.map((line) => html`<p>${line}</p>`)}</div>`;
}

/** Boxes that the card must not cover: letters, scale bar, axes figure. */
function takenIn(picture, { left, top }) {
  const marks = [...picture.querySelectorAll('.overlay text, .overlay .figure, .overlay .scale')];
  return marks.map((mark) => {
    const box = boxOf(mark);
    return { x: box.left - left, y: box.top - top, width: box.width, height: box.height };
  });
}
