// Pointing, as far as every page has it: the buttons of the strip, keys P and Shift+P. The rest is loaded when somebody else is in the room.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { effect } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { later } from '../../parts/lazy.js';

const panels = later(() => import('./later.js'), 'js/features/pointers/point.css');

/** @param {object} world {room, ui, api, clock, panes, storage} @returns {() => void} stops */
function startPointers(world) {
  let stop = null;
  const stopEffect = effect(() => {
    if (!world.room.pointers.shown.value.length) return;
    if (!panels.loaded.value) return void panels.load();
    stop ??= panels.loaded.value.start(world);
  });
  return () => {
    stopEffect();
    stop?.();
  };
}

/** Why this person cannot point now; '' when they can. */
function refusal({ pointers }) {
  if (!pointers.others.peek().length) return 'You are alone in this room: nobody sees where you point.';
  return pointers.mayPoint.peek() ? '' : 'You are here as an observer: observers do not point.';
}

/** Key P: pointing on or off; with Shift it asks everybody to look here. */
function pointKey(room, ui, isAsking) {
  const why = refusal(room);
  if (why) return void ui.notify('ok', why, 'point');
  if (isAsking) panels.loaded.peek()?.askToLook({ room, ui });
  else room.pointers.isPointing.value = !room.pointers.isPointing.peek();
}

/** The pointing buttons, for the strip or (isDock) with words below the icons. Nothing for a member alone in the room. */
function pointTools(world, isDock = false) {
  const { room, ui } = world;
  const { pointers } = room;
  if (!pointers.others.value.length) return nothing;
  const isOn = pointers.isPointing.value;
  const isOpen = ui.popover.value === 'point';
  const title = isOn ? 'The others see where you point (P)' : 'Point: the others see where (P)';
  const press = (event) => {
    pointKey(room, ui, false);
    if (event.detail && pointers.isPointing.peek()) document.querySelector(`#picture-${ui.active.peek()}`)?.focus({ preventScroll: true }); // a mouse: its next key is for the pane
  };
  return html`<span class="anchor point-tools">
    ${
      pointers.mayPoint.value
        ? html`<button class=${classMap({ tool: true, plain: true, on: isOn })} tabindex="-1" title=${title} aria-label="Point" aria-pressed=${isOn}
      @click=${press}>${icon('point', isDock ? 20 : 16)}${isDock ? html`<span class="word">Point</span>` : nothing}</button>`
        : nothing
    }
    <button class=${classMap({ tool: true, plain: true, 'point-more': true, on: isOpen })} tabindex="-1" title="Look here, pointers of the others" aria-label="Pointers" aria-haspopup="dialog" aria-expanded=${isOpen}
      @click=${() => ui.toggle('point')}>${icon('chevronDown', isDock ? 16 : 12)}</button>
    ${isOpen ? panels.loaded.value?.pointMenu(world, isDock) : nothing}</span>`;
}

/** @type {import('../index.js').Feature} */
export const pointers = {
  keys: { p: ({ room, ui }, at, { shiftKey }) => pointKey(room, ui, shiftKey) },
  strip: { meet: pointTools },
  start: startPointers,
};
