// Above the panes while a beam is drafted, for every member: whose dose is shown, and what can be done with the draft.
import { html, nothing } from '../../../lib/lit-html.js';
import { chosenBeam } from './beams.js';
import { isComparing as isComparingIn, isDraftOn, toggleCompare, withDraft } from './beam_ui.js';
import { keepDraft, resetDraft } from './beam_actions.js';
import { exportMenu } from './beam_export.js';
import { draftBelongs, draftWords } from './beam_words.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

export function draftBar(world) {
  const { room, ui } = world;
  if (!isDraftOn(room)) return nothing;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const planned = chosenBeam(plan, scene);
  const isOff = !room.canChange.value;
  const isComparing = isComparingIn(room);
  const compare = (event) => {
    if (toggleCompare(room, { view: ui.active.value, at: event.timeStamp })) ui.choose('beam', '');
    else ui.notify('ok', ui.keys.tip(say.youFollow, 'follow'), 'beam');
  };
  const moved = draftWords(plan, withDraft(scene));
  return html`<div class="beam-bars"><div class="beam-bar" role="group" aria-label=${say.draftBeam}>${icon('warning')}<p><span role="status"><b>${say.draftBeamIs}</b> ${draftBelongs(plan, scene)}</span> <span class="beam-moved">${isComparing ? say.comparing({ planned: html`<b>${say.plannedShown}</b>`, moved }) : moved}</span></p>
    ${planned ? html`<button aria-pressed=${isComparing} title=${isComparing ? say.showDraft : say.compareIs} ?disabled=${isOff} @click=${compare}>${isComparing ? say.backToDraft : say.compare}</button>` : nothing}
    <button title=${planned ? say.putAwayUndo : say.putAwayIs} ?disabled=${isOff} @click=${(event) => resetDraft(world, event)}>${planned ? say.reset : say.putAway}</button>
    <button title=${say.keepIs} ?disabled=${isOff} @click=${(event) => keepDraft(world, event)}>${say.keep}</button>${exportMenu(world)}</div></div>`;
}
