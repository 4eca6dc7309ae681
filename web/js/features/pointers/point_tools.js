// The buttons that point, in the strip of who is not alone in the room.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { icon } from '../../parts/icons.js';
import { pointKey } from './feature.js';
import { say } from './later_words.js';
import { pointMenu } from './look_here.js';

/** For the strip or (isDock) with words below the icons. Nothing for a member alone in the room. */
export function pointTools(world, isDock = false) {
  const { room, ui } = world;
  const { pointers } = room;
  if (!pointers.others.value.length) return nothing;
  const isOn = pointers.isPointing.value;
  const isOpen = ui.popover.value === 'point';
  const press = (event) => {
    pointKey(room, ui, false);
    if (event.detail && pointers.isPointing.peek()) document.querySelector(`#picture-${ui.active.peek()}`)?.focus({ preventScroll: true }); // a mouse: its next key is for the pane
  };
  return html`<span class="anchor point-tools">
    ${
      pointers.mayPoint.value
        ? html`<button class=${classMap({ tool: true, plain: true, on: isOn })} tabindex="-1" title=${ui.keys.tip(isOn ? say.isOn : say.pointIs, 'point')} aria-label=${say.point}
      aria-pressed=${isOn} @click=${press}>${icon('point', isDock ? 20 : 16)}${isDock ? html`<span class="word">${say.point}</span>` : nothing}</button>`
        : nothing
    }
    <button class=${classMap({ tool: true, plain: true, 'point-more': true, on: isOpen })} tabindex="-1" title=${say.pointersMore} aria-label=${say.pointers}
      aria-haspopup="dialog" aria-expanded=${isOpen} @click=${() => ui.toggle('point')}>${icon('chevronDown', isDock ? 16 : 12)}</button>
    ${isOpen ? pointMenu(world, isDock) : nothing}</span>`;
}
