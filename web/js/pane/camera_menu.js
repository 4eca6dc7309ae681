// The menu of a 3-D pane's camera. Loaded when it is first opened.
import { html, nothing } from '../../lib/lit-html.js';
import { live } from '../../lib/directives/live.js';
import { isTarget } from '../room/plan.js';
import { isTurnable } from '../room/kinds.js';
import { hasOwnRegions } from './orientation_menu.js';
import { sides } from './orientation.js';
import { checkbox, segment } from '../parts/fields.js';
import { icon } from '../parts/icons.js';
import { say } from './later_words.js';
import { say as sayAtOnce } from './words.js';

/** @param {object} world {room, ui} @param {import('./pane_actions.js').PaneActions} actions of the pane */
export function menu({ room, ui }, actions, isDisabled) {
  const { cameras } = actions;
  const act = (run) => (event) => run(event.timeStamp);
  const hasTwo = room.views.filter(({ kind, isOpen }) => isTurnable(kind) && isOpen.value).length > 1;
  const scene = room.scene.value;
  const { view } = actions;
  const link = (isOn, event) => {
    ui.panes.areCamerasLinked.value = isOn;
    if (isOn) cameras.link(event.timeStamp);
  };
  return html`<div class="popover view-menu" role="dialog" aria-label=${say.camera}>
    <div class="view-sides" role="group" aria-label=${say.lookFrom}>${sides.map(
      ({
        letter,
        name,
      }) => html`<button ?disabled=${isDisabled} aria-label=${sayAtOnce.lookFromSide({ side: sayAtOnce[name] })} title=${sayAtOnce.lookFromSide({ side: sayAtOnce[name] })}
      @click=${act((at) => cameras.lookFrom(name, at))}>${letter}</button>`,
    )}</div>
    <div class="view-acts">
      <button ?disabled=${isDisabled} title=${ui.keys.tip(say.fitIs, 'fit')} @click=${act((at) => cameras.fit(at))}>${say.fit}</button>
      <button ?disabled=${isDisabled} title=${ui.keys.tip(say.resetIs, 'reset')} @click=${act((at) => cameras.reset(at))}>${say.reset}</button>
      <button ?disabled=${isDisabled} title=${say.rollLeftIs} aria-label=${say.rollLeft} @click=${act((at) => cameras.roll(5, at))}>${icon('rollLeft')}</button>
      <button ?disabled=${isDisabled} title=${say.rollRightIs} aria-label=${say.rollRight} @click=${act((at) => cameras.roll(-5, at))}>${icon('rollRight')}</button></div>
    ${segment(
      say.projection,
      [
        ['perspective', say.perspective],
        ['parallel', say.parallel],
      ],
      cameras.value.projection,
      isDisabled,
      (id, event) => cameras.setProjection(id, event.timeStamp),
    )}
    <div class="checks">${scene?.axes ? axesChoice(scene.axes, isDisabled, (axes, event) => room.patchScene({ axes }, { view: actions.view.number, at: event.timeStamp })) : nothing}
      ${view.ofKind > 1 ? onlyTargets(room, view, isDisabled) : nothing}
      ${checkbox(sayAtOnce.linkCameras, ui.panes.areCamerasLinked.value, false, link, hasTwo ? sayAtOnce.linkCamerasIs : say.linkCamerasHow)}</div></div>`;
}

const axesForms = [
  ['middle', say.axesMiddle],
  ['crosshair', say.axesCrosshair],
  ['box', say.axesBox],
  ['corner', say.axesCorner],
];

/** The patient's axes: whether, where, with what. */
function axesChoice({ visible, form, letters, ticks, numbers }, isDisabled, change) {
  const set = (name) => (value, event) => change({ [name]: value }, event);
  return html`${checkbox(say.axes, visible, isDisabled, set('visible'), say.axesIs)}${
    visible
      ? html`<select aria-label=${say.axesForm} ?disabled=${isDisabled} @change=${(event) => change({ form: event.target.value }, event)}>${axesForms.map(
          ([id, name]) => html`<option value=${id} .selected=${live(id === form)}>${name}</option>`,
        )}</select>${checkbox(say.axesLetters, letters, isDisabled, set('letters'))}${form === 'corner' ? nothing : checkbox(say.axesTicks, ticks, isDisabled, set('ticks'), say.axesTicksAre)}${ticks && form !== 'corner' ? checkbox(say.axesNumbers, numbers, isDisabled, set('numbers'), say.axesNumbersAre) : nothing}`
      : nothing
  }`;
}

/** A second 3-D picture beside the first: the same scene, without what lies around the targets. */
function onlyTargets(room, view, isDisabled) {
  const regions = room.plan.value?.regions ?? [];
  if (!regions.some(isTarget)) return nothing;
  const hidden = Object.fromEntries(regions.map((region) => [region.id, { visible: isTarget(region) }]));
  return checkbox(
    say.onlyTargets,
    hasOwnRegions(view),
    isDisabled,
    (isOn, event) => room.patchView(view.number, { override: { regions: isOn ? hidden : null } }, { at: event.timeStamp }),
    say.onlyTargetsIs,
  );
}
