// The draft as a file: JSON, or a beam card for SERA.
import { html, nothing } from '../../../lib/lit-html.js';
import { draftDocument } from './beam_file.js';
import { beamFacts } from './beam_facts.js';
import { endCompare } from './beam_ui.js';
import { exportFile } from '../../room/exports.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

/** The answer of the draft as it is; null while it is still to come, or there is none. */
const fresh = (world) => {
  const { result, isOld } = beamFacts(world).answer.value;
  return isOld || !result?.is_draft ? null : result;
};

export function exportMenu(world) {
  const { room, ui } = world;
  if (!room.control.mayExport) return nothing;
  const isOpen = ui.popover.value === 'beam-export';
  const answer = isOpen ? fresh(world) : null;
  const save = (make) => (event) => {
    event.currentTarget.closest('.anchor').querySelector('button').focus(); // the item goes
    ui.popover.value = '';
    endCompare(room);
    make();
  };
  const json = () =>
    exportFile(
      world,
      'beam',
      `${room.planId.value}-draft-beam.json`,
      `${JSON.stringify(draftDocument(room.plan.value, room.scene.value, room.planId.value, answer), null, 2)}\n`,
      'application/json',
    );
  const card = () => exportFile(world, 'beam-card', `${room.planId.value}-draft-beam.txt`, answer.card, 'text/plain');
  return html`<span class="anchor"><button aria-haspopup="menu" aria-expanded=${isOpen} title=${say.exportIs} @click=${() => ui.toggle('beam-export')}>${say.export}</button>
    ${
      isOpen
        ? html`<div class="popover beam-export"><div class="menu" role="menu" aria-label=${say.exportDraft}>
      <button role="menuitem" @click=${save(json)}>${icon('download')}<span>${say.exportJson}</span></button>
      <button role="menuitem" ?disabled=${!answer?.card} title=${answer?.card ? nothing : say.notSaid} @click=${save(card)}>${icon('download')}<span>${say.exportCard}</span></button></div></div>`
        : nothing
    }</span>`;
}
