// Panes along a beam, as far as every page has them: which pane shows the beam's eye, and what a pane shows whose beam has gone.
import { effect, untracked } from '../../../lib/signals-core.js';
import { mergePatch } from '../../wire/merge.js';
import { beamShown } from '../../room/beam_line.js';
import { beamSliceView, beamView } from '../../room/layout.js';
import { isOfBeam, isTurnable } from '../../room/kinds.js';
import { say } from './words.js';

/** The 3-D view that takes the place of the beam's eye: the one that stood there, else one that no pane shows. */
export function spaceInstead({ room, ui }) {
  const free = room.views.filter(({ kind, number }) => isTurnable(kind) && !ui.visible.value.includes(number)).map(({ number }) => number);
  return free.includes(ui.beforeBeam) || !free.length ? ui.beforeBeam : free[0];
}

/** Shows it there, and gives it the focus that its pane may have had. */
export function showInstead(ui, from, to) {
  ui.showInPlaceOf(from, to);
  queueMicrotask(() => document.querySelector(`#picture-${to}`)?.focus({ preventScroll: true }));
}

/** The view of the beam's eye starts fitted to the ring or to what lies about the axis, if it was never shown. */
async function fitFirst(room) {
  const { fittedEye, isUntouched } = await import('./beam_eye.js');
  const [plan, view] = [room.plan.peek(), room.view(beamView)];
  const beam = beamShown(plan, room.scene.peek());
  if (!beam || !isUntouched(view.document.peek())) return;
  const patch = fittedEye(plan, beam, view.document.peek());
  if (!view.isOpen.peek()) view.restart(mergePatch(view.document.peek(), patch));
  else if (room.following.isPresenting.peek()) room.patchView(beamView, patch);
}

/** Fits it whatever has a pane show it: a key, a menu, a layout. @returns {() => void} stops */
export const fitBeamEye = ({ room, ui }) =>
  effect(() => {
    if (ui.visible.value.includes(beamView) && room.plan.value && room.scene.value?.beam) untracked(() => void fitFirst(room));
  });

/** Key B: a 3-D pane, the active one if it is one, becomes the beam's eye, and that 3-D again. */
export async function toggleBeamEye(room, ui) {
  if (ui.visible.value.includes(beamView)) return void showInstead(ui, beamView, spaceInstead({ room, ui }));
  if (!beamShown(room.plan.value, room.scene.value)) return void ui.notify('ok', say.noBeam, 'beam');
  const from = [ui.active.value, ...ui.visible.value].find((number) => isTurnable(room.view(number).kind)) ?? ui.active.value;
  if (isTurnable(room.view(from).kind)) ui.beforeBeam = from;
  await fitFirst(room).catch(() => {}); // a module that does not load: as before
  showInstead(ui, from, beamView);
}

/** Keys [ and ] in panes of other kinds move what they show of the beam slice: it and, where they slide together, the clip plane. */
async function slideBeam(room, ui, mm, at) {
  const { slidPatch, rangeAlong } = await import('./beam_along.js');
  const [plan, scene] = [room.plan.value, room.scene.value];
  const beam = beamShown(plan, scene);
  if (beam)
    room.patchScene(
      slidPatch(scene, 'slice', ui.panes.isBeamTogether.value, scene.beam.slice.along_mm + mm, rangeAlong(plan, scene, beam, [])),
      { view: ui.active.value, at },
    );
}

/** True while something of that is shown. */
const isBeamCut = ({ views, scene: { value: scene } }) =>
  scene?.beam && (scene.beam.slice.visible || scene.clip.beam.enabled || views[beamSliceView - 1].isOpen.value);

/** The action of one of these keys; null: another key, or nothing to move. */
export function beamKey({ room, ui }, { code, shiftKey }, at) {
  const by = { BracketLeft: -1, BracketRight: 1 }[code];
  return by && isBeamCut(room) ? () => slideBeam(room, ui, by * (shiftKey ? 10 : 1), at) : null;
}

/** Panes of a beam that there is not any more, or not in this plan, show something else, and the page says so. @returns {() => void} stops */
export function leaveBeam({ room, ui }) {
  return effect(() => {
    const shown = ui.visible.value.filter((number) => isOfBeam(room.view(number).kind));
    const [plan, scene] = [room.plan.value, room.scene.value];
    if (!shown.length || !plan || !scene?.beam || beamShown(plan, scene)) return;
    queueMicrotask(() => {
      for (const number of shown) {
        const free = room.views.find((other) => !isOfBeam(other.kind) && !ui.visible.peek().includes(other.number));
        ui.showInPlaceOf(number, number === beamSliceView && free ? free.number : spaceInstead({ room, ui }));
      }
      ui.notify('ok', plan.beams.length ? say.beamGone : say.noBeamNow, 'beam');
    });
  });
}
