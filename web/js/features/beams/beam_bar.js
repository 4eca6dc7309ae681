// Above the panes while a beam is drafted, for every member: whose dose is shown, and what can be done with the draft.
import { html, nothing } from '../../../lib/lit-html.js';
import { chosenBeam } from './beams.js';
import { isComparing as isComparingIn, isDraftOn, toggleCompare, withDraft } from './beam_ui.js';
import { keepDraft, resetDraft } from './beam_actions.js';
import { exportMenu } from './beam_export.js';
import { draftBelongs, draftWords } from './beam_words.js';
import { icon } from '../../parts/icons.js';

export function draftBar(world) {
  const { room, ui } = world;
  if (!isDraftOn(room)) return nothing;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const planned = chosenBeam(plan, scene);
  const isOff = !room.canChange.value;
  const isComparing = isComparingIn(room);
  const compare = (event) => {
    if (toggleCompare(room, { view: ui.active.value, at: event.timeStamp })) ui.choose('beam', '');
    else ui.notify('ok', 'You follow the presenter. Look for yourself (F) to compare.', 'beam');
  };
  const moved = draftWords(plan, withDraft(scene));
  return html`<div class="beam-bars"><div class="beam-bar" role="group" aria-label="Draft beam">${icon('warning')}<p><span role="status"><b>Draft beam:</b> ${draftBelongs(plan, scene)}</span> <span class="beam-moved">${isComparing ? html`<b>Planned beam shown</b>, draft: ` : nothing}${moved}</span></p>
    ${planned ? html`<button aria-pressed=${isComparing} title=${isComparing ? 'Show the draft again' : 'Show the planned beam in the pictures; press again for the draft'} ?disabled=${isOff} @click=${compare}>${isComparing ? 'Back to the draft' : 'Compare'}</button>` : nothing}
    <button title=${planned ? 'Put the draft away; undo brings it back' : 'Put the draft away'} ?disabled=${isOff} @click=${(event) => resetDraft(world, event)}>${planned ? 'Reset to planned' : 'Put away'}</button>
    <button title="Keep this position in the tree" ?disabled=${isOff} @click=${(event) => keepDraft(world, event)}>Keep</button>${exportMenu(world)}</div></div>`;
}
