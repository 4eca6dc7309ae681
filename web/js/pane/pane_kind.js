// The name in a pane's header: a menu of the views that the pane can show and, of an oblique view, of its planes.
import { html, nothing } from '../../lib/lit-html.js';
import { effect } from '../../lib/signals-core.js';
import { beamShown } from '../room/beam_line.js';
import { obliqueView, views } from '../room/layout.js';
import { alongBeam, freeId, maxObliques, newOblique, normalOfAngles, obliqueName, roundedOrigin } from '../room/obliques.js';
import { crosshair } from '../room/plan.js';
import { isOfBeam } from '../room/kinds.js';
import { icon } from '../parts/icons.js';
import { say } from './words.js';
import { menuKeys } from '../parts/roving.js';

const tiltDeg = 60; // of the normal of a new plane over anterior: an axial slice turned by 30 degrees

export function paneKind({ room, ui }, view) {
  const name = `kind-${view.number}`;
  const isOpen = ui.popover.value === name;
  const { plane } = view.document.value;
  const oblique = view.kind === 'oblique' && room.scene.value?.image.obliques?.[plane];
  const words = oblique ? html`<span class="clip-plane-name">${obliqueName(plane, oblique)}</span>` : view.name;
  return html`<span class="anchor view-kind"><h2><button aria-haspopup="menu" aria-expanded=${isOpen} title=${say.showElse} @click=${() => ui.toggle(name)}>${words}<span class="roomy">${icon('chevronDown', 12)}</span></button></h2>
    ${isOpen ? menu({ room, ui }, view) : nothing}</span>`;
}

function menu({ room, ui }, view) {
  const choose = (run) => (event) => {
    const host = event.currentTarget.closest('.panes');
    run(event.timeStamp);
    ui.popover.value = '';
    queueMicrotask(() => host.querySelector(`#picture-${ui.active.value}`)?.focus({ preventScroll: true })); // the pane may be another element now
  };
  const item = (words, isOn, run, isDisabled = false) =>
    html`<button role="menuitemradio" aria-checked=${isOn} ?disabled=${isDisabled} @click=${choose(run)}>${isOn ? icon('check', 12) : html`<i></i>`}<span>${words}</span></button>`;
  const isOff = !room.canChange.value;
  return html`<div class="popover view-kinds"><div class="menu" role="menu" aria-label=${say.paneOf({ view: view.name })} @keydown=${menuKeys}>
    ${views.map(({ name, kind }, index) => (isOfBeam(kind) && !beamShown(room.plan.value, room.scene.value) ? nothing : item(name, index + 1 === view.number, () => ui.showInPlaceOf(view.number, index + 1))))}
    ${view.kind === 'oblique' ? html`<hr>${planeItems(room, view, item, isOff)}` : nothing}</div></div>`;
}

function planeItems(room, view, item, isOff) {
  const obliques = Object.entries(room.scene.value?.image.obliques ?? {});
  const { plane } = view.document.value;
  return html`${obliques.map(([id, oblique]) => item(obliqueName(id, oblique), id === plane, (at) => room.patchView(view.number, { plane: id }, { at }), isOff))}
    ${obliques.length < maxObliques ? item(say.newPlane, false, () => addOblique(room), isOff) : nothing}
    ${
      obliques.some(([id]) => id === plane)
        ? item(
            say.moveHere,
            false,
            (at) =>
              room.patchScene(
                { image: { obliques: { [plane]: { origin_mm: roundedOrigin(crosshair(room.scene.value)) } } } },
                { view: view.number, at },
              ),
            isOff,
          )
        : nothing
    }`;
}

/** A plane through the crosshair, along the first beam if there is one, and the oblique view shows it. */
function addOblique(room) {
  const scene = room.scene.value;
  const [beam] = room.plan.value.beams;
  const { normal = normalOfAngles(0, tiltDeg) } = (beam && alongBeam(beam)) ?? {};
  const id = freeId(scene.image.obliques);
  room.patchScene({ image: { obliques: { [id]: newOblique({ origin_mm: roundedOrigin(crosshair(scene)), normal }, false) } } });
  showOblique(room, id);
}

/** The oblique view shows this plane, now or when it opens. */
export function showOblique(room, plane) {
  const view = room.view(obliqueView);
  if (!view.isOpen.value) return void view.restart({ ...view.document.value, plane });
  if (room.following.isPresenting.value || !room.following.isFollowing.value) return void room.patchView(obliqueView, { plane });
  room.hideView(obliqueView); // another shared view: to open it is not to leave
  view.restart({ ...view.document.value, plane });
  room.showView(obliqueView, view.ownSize);
}

/**
 * When a pane begins to show the oblique view and that has no plane: gives it the scene's first one or, where that is this person's
 * to do, makes one. Once, so that a plane that is taken away does not come back.
 * @returns {() => void} stops
 */
export function giveOblique({ room, ui }) {
  let isGiven = false;
  return effect(() => {
    if (!ui.visible.value.includes(obliqueView)) {
      isGiven = false;
      return;
    }
    if (isGiven || !room.canChange.value || room.link.value.state !== 'open' || !room.plan.value) return;
    isGiven = true;
    queueMicrotask(() => {
      const obliques = room.scene.peek()?.image.obliques;
      if (!obliques || obliques[room.view(obliqueView).document.peek().plane]) return;
      const [first] = Object.keys(obliques);
      if (first) showOblique(room, first);
      else if (room.following.isPresenting.peek()) addOblique(room);
    });
  });
}
