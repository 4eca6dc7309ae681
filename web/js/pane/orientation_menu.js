// The orientation figure of a 3-D pane, whose sides are buttons, and the button of the camera's menu.
import { html, nothing, svg } from '../../lib/lit-html.js';
import { repeat } from '../../lib/directives/repeat.js';
import { isTurnable } from '../room/kinds.js';
import { cubeSides } from './orientation.js';
import { icon } from '../parts/icons.js';
import { later } from '../parts/lazy.js';
import { say } from './words.js';

const cameraMenu = later(() => import('./camera_menu.js'));
const edgePx = 36;
const buttonFrom = 0.3; // cosine; a side that is seen more from its edge is too narrow to be hit
const letterFrom = 0.25;
const leastPx = [180, 200]; // of the pane, to have room for the figure

/** @param {object} world {room, ui} @param {import('./pane_actions.js').PaneActions} actions of the pane @param {number[]} size of the pane, px */
export function orientation({ room, ui }, actions, size) {
  const { view } = actions;
  const header = view.painted.value;
  if (!isTurnable(view.kind) || !header || size[0] < leastPx[0] || size[1] < leastPx[1]) return nothing;
  const name = `camera-${view.number}`;
  const isOpen = ui.popover.value === name;
  const seen = cubeSides(header.clip_from_lps_mm);
  const isTouch = ui.isTouch.value;
  const isDisabled = !room.canChange.value;
  const picture = html`<svg class="view-cube" viewBox="-36 -36 72 72" role=${isTouch ? nothing : 'group'} aria-label=${isTouch ? nothing : say.lookFromIn({ view: view.name })} aria-hidden=${isTouch ? 'true' : nothing}>
    ${repeat(
      seen,
      ({ letter }) => letter,
      (side) => face(side, isTouch || isDisabled ? null : (event) => actions.lookFrom(side.name, event.timeStamp)),
    )}</svg>`;
  return html`<div class="view-figure">
    ${isTouch ? nothing : picture}
    <span class="anchor"><button class=${isTouch ? 'view-all touch' : 'view-all'} title=${say.lookFromIs} aria-haspopup="dialog" aria-expanded=${isOpen} @click=${() => ui.toggle(name)}>${isTouch ? picture : icon('camera3d')}<span class="hidden">${say.cameraOf({ view: view.name })}</span></button>
    ${isOpen ? cameraMenu.draw(({ menu }) => menu({ room, ui }, actions, isDisabled)) : nothing}</span></div>`;
}

function face({ letter, name, facing, middle, corners }, act) {
  const isButton = act && facing >= buttonFrom;
  const onKey = (event) => {
    if (event.key !== 'Enter' && event.key !== ' ') return;
    event.preventDefault();
    act(event);
  };
  const at = (point) => point.map((part) => (part * edgePx).toFixed(2)).join();
  return svg`<g class=${isButton ? 'side button' : 'side'} role=${isButton ? 'button' : nothing} tabindex=${isButton ? 0 : nothing} aria-label=${isButton ? say.lookFromSide({ side: say[name] }) : nothing}
    @click=${isButton ? act : nothing} @keydown=${isButton ? onKey : nothing}>
    <polygon points=${corners.map(at).join(' ')} />
    ${facing >= letterFrom ? svg`<text text-anchor="middle" x=${middle[0] * edgePx} y=${middle[1] * edgePx + 4.5}>${letter}</text>` : nothing}</g>`;
}

/** True if the view shows other regions than the scene. */
export const hasOwnRegions = (view) => Boolean(view.document.value.override?.regions) && view.ofKind > 1;
