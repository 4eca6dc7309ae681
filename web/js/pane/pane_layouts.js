// The layouts of the panes as buttons of the strip, and the menu of the panes: layouts with their keys, what moves together.
import { html, nothing } from '../../lib/lit-html.js';
import { classMap } from '../../lib/directives/class-map.js';
import { beamShown } from '../room/beam_line.js';
import { layoutId, layouts } from '../room/layout.js';
import { isInSpace, isTurnable } from '../room/kinds.js';
import { partsOf } from '../features/index.js';
import { checkbox } from '../parts/fields.js';
import { icon } from '../parts/icons.js';
import { say } from './words.js';

/** Those with views of a beam where there is one. */
const layoutsOf = ({ plan, scene }) => layouts.filter(({ id }) => id !== 'beam' || beamShown(plan.value, scene.value));
const extra = ['2x1', 'oblique', 'beam']; // left out where the strip is narrow; they are in the menu
const chosen = ({ arrangement, panes }) => layoutId(arrangement.value.layout, panes.two.value);

export const layoutButtons = ({ room, ui }) =>
  layoutsOf(room).map(({ id, icon: picture, name }, index) => {
    const isOn = chosen(ui) === id;
    return html`<button class=${classMap({ tool: true, plain: true, on: isOn, 'view-extra': extra.includes(id) })} title=${say.layoutIs({ name, n: index + 1 })} aria-label=${name} aria-pressed=${isOn} tabindex="-1" @click=${() => ui.setLayout(id)}>${icon(picture)}</button>`;
  });

/** The 3-D pane that buttons outside of panes act on: the active one, else the first that is shown. */
export function active3d({ room, ui, panes }) {
  const number = [ui.active.value, ...ui.visible.value, 1].find((n) => isTurnable(room.view(n).kind));
  return panes()[number - 1];
}

/** @param {object} world @param {boolean} isDock with a word below the icon */
export function panesMenu(world, isDock = false) {
  const { ui, panes, room } = world;
  const isOpen = ui.popover.value === 'panes';
  const link = (isOn, event) => {
    ui.panes.isZoomLinked.value = isOn;
    const lead = [ui.active.value, ...ui.visible.value].find((n) => !isInSpace(room.view(n).kind));
    if (isOn && lead) panes()[lead - 1].actions.cameras.link(event.timeStamp);
  };
  const act = (run) => (event) => {
    event.currentTarget.closest('.anchor').querySelector('button').focus(); // the item goes
    ui.popover.value = '';
    run();
  };
  return html`<span class="anchor"><button class=${classMap({ tool: true, plain: !isDock, on: isOpen })} tabindex="-1" title=${say.panesIs} aria-label=${say.panes} aria-haspopup="dialog" aria-expanded=${isOpen}
      @click=${() => ui.toggle('panes')}>${icon(isDock ? 'grid' : 'chevronDown', isDock ? 20 : 16)}${isDock ? html`<span class="word">${say.panes}</span>` : nothing}</button>
    ${
      isOpen
        ? html`<div class=${isDock ? 'popover view-panes up' : 'popover view-panes'} role="dialog" aria-label=${say.panes}>
      <div class="menu" role="radiogroup" aria-label=${say.layout}>${layoutsOf(room).map(
        (
          { id, name, icon: picture },
          index,
        ) => html`<button role="radio" aria-checked=${chosen(ui) === id} class=${classMap({ on: chosen(ui) === id })}
        @click=${act(() => ui.setLayout(id))}>${icon(picture)}<span>${name}</span>${isDock ? nothing : html`<kbd>${say.shiftKey({ n: index + 1 })}</kbd>`}</button>`,
      )}</div>
      ${partsOf('panesMenu', world, act)}
      <div class="checks">${checkbox(say.linkZoom, ui.panes.isZoomLinked.value, false, link, say.linkZoomIs)}
        ${checkbox(
          say.linkCameras,
          ui.panes.areCamerasLinked.value,
          false,
          (isOn, event) => {
            ui.panes.areCamerasLinked.value = isOn;
            if (isOn) active3d(world).actions.cameras.link(event.timeStamp);
          },
          say.linkCamerasIs,
        )}</div></div>`
        : nothing
    }</span>`;
}
