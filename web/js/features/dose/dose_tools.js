// Dose in the strip: isodose lines and wash, where the plan has a dose.
import { html, nothing } from '../../../lib/lit-html.js';
import { classMap } from '../../../lib/directives/class-map.js';
import { icon } from '../../parts/icons.js';
import { say } from './words.js';

/** @param {(part: string, at: number) => void} toggle @param {string} size '' in the strip, else that of the dock */
export function doseTools({ room, ui }, toggle, size = '') {
  const [plan, scene] = [room.plan.value, room.scene.value];
  if (!plan?.doses.length || !scene || size === 'phone') return nothing;
  const isDock = Boolean(size);
  return [
    ['lines', 'isodose', say.isodose, say.isodoseIs],
    ['wash', 'wash', say.wash, say.washIs],
  ].map(([part, picture, word, title]) => {
    const { visible } = scene.dose[part];
    return html`<button class=${classMap({ tool: true, plain: !isDock, on: visible })} tabindex="-1" title=${ui.keys.tip(title, part)} aria-label=${word} aria-pressed=${visible} ?disabled=${!room.canChange.value}
      @click=${(event) => toggle(part, event.timeStamp)}>${icon(picture, isDock ? 20 : 16)}${isDock ? html`<span class="word">${word}</span>` : nothing}</button>`;
  });
}
