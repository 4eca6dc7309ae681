// Part of the inspector's Selection of the 3-D picture: turning by itself, and the axis that drags turn about.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, signal } from '../../../lib/signals-core.js';
import * as cameras from '../../room/camera.js';
import { numberField, segment } from '../../parts/fields.js';
import { active3d } from '../../pane/pane_layouts.js';
import { say } from './later_words.js';

const superior = [0, 0, 1];
const mostDegPerS = 90;
const longestStepS = 0.25; // after a wait the picture goes on, and does not jump
const noPictureMs = 1000;
/** How it turns the next time: of this browser's page alone. */
const choice = { axis: signal('patient'), degPerS: signal(15) };

const wantsCalm = () => globalThis.matchMedia?.('(prefers-reduced-motion: reduce)').matches ?? false;

/** The camera after a part of a second. */
export function turnedFor(camera, axis, degPerS, seconds) {
  const about = axis === 'patient' ? superior : cameras.axes(camera).up;
  return cameras.turned(camera, about, degPerS * Math.min(seconds, longestStepS));
}

/**
 * Turns a view, a step for each picture that comes, until something is dragged or turned in a pane, Esc, a hidden tab, or another presenter.
 * No step of it is one of undo. Sets world.turning, which says so in the pane's header.
 */
export function startTurning(world, { clock = () => performance.now(), page = document, frames = globalThis } = {}) {
  const { room } = world;
  const { actions } = active3d(world);
  const { view } = actions;
  let last = clock();
  let isFirst = true;
  let waiting = 0;
  let due = 0;
  world.turning.value?.stop();
  const isOthers = () => !isFirst && room.following.isFollowing.value && !room.following.isPresenting.value;
  const step = () => {
    due = 0;
    clearTimeout(waiting);
    if (page.hidden || !room.canChange.value || !view.isOpen.value || isOthers()) return stop();
    const now = clock();
    actions.cameras.set(turnedFor(actions.camera, choice.axis.value, choice.degPerS.value, (now - last) / 1000), 0, false);
    last = now;
    isFirst = false;
    waiting = setTimeout(step, noPictureMs);
  };
  const onKey = (event) => {
    if (event.key !== 'Escape') return;
    event.stopPropagation();
    stop();
  };
  const onPane = (event) => event.target.closest?.('.pane-body') && stop();
  const onHidden = () => page.hidden && stop();
  const unwatch = effect(() => {
    if (view.painted.value && !due) due = frames.requestAnimationFrame(step);
  });
  function stop() {
    unwatch();
    clearTimeout(waiting);
    frames.cancelAnimationFrame(due);
    page.removeEventListener('keydown', onKey, true);
    page.removeEventListener('pointerdown', onPane, true);
    page.removeEventListener('wheel', onPane, true);
    page.removeEventListener('visibilitychange', onHidden);
    if (world.turning.value?.stop === stop) world.turning.value = null;
  }
  page.addEventListener('keydown', onKey, true);
  page.addEventListener('pointerdown', onPane, true);
  page.addEventListener('wheel', onPane, { capture: true, passive: true });
  page.addEventListener('visibilitychange', onHidden);
  world.turning.value = { view: view.number, stop, words: say.turning, how: say.turningIs };
}

const locks = [
  ['', say.lockFree, say.lockFreeIs],
  ['L', 'L', say.lockL],
  ['P', 'P', say.lockP],
  ['S', 'S', say.lockS],
];

export function turningBlock(world, isDisabled) {
  const { ui, turning } = world;
  const isOn = turning.value !== null;
  const isCalm = wantsCalm();
  const setSpeed = (value) => {
    choice.degPerS.value = Math.min(Math.max(value, -mostDegPerS), mostDegPerS);
  };
  return html`<section class="block turning"><h3>${say.turnItself}</h3>
    <dl class="image-rows"><dt>${say.turnAbout}</dt><dd>${segment(
      say.turnAbout,
      [
        ['patient', say.turnPatient, say.turnPatientIs],
        ['picture', say.turnPicture, say.turnPictureIs],
      ],
      choice.axis.value,
      isDisabled,
      (axis) => {
        choice.axis.value = axis;
      },
    )}</dd><dt>${say.turnSpeed}</dt><dd>${numberField(say.turnSpeedIs, choice.degPerS.value, '°/s', isDisabled, setSpeed)}</dd></dl>
    <div class="buttons"><button ?disabled=${isDisabled || (isCalm && !isOn)} aria-pressed=${isOn} class=${isOn ? 'on' : ''} title=${say.turningIs} @click=${() => (isOn ? turning.value?.stop() : startTurning(world))}>${isOn ? say.turnStop : say.turnStart}</button></div>
    ${isCalm ? html`<p class="note">${say.turnCalm}</p>` : nothing}
    <dl class="image-rows"><dt>${say.lock}</dt><dd>${segment(say.lock, locks, ui.turnLock.value, isDisabled, (axis) => {
      ui.turnLock.value = axis;
    })}</dd></dl></section>`;
}
