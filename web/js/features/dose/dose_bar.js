// The basis of all dose numbers, in the banner.
import { html, nothing } from '../../../lib/lit-html.js';
import { basisParts } from '../../room/dose.js';
import { ofFits } from '../fits/feature.js';
import { say } from './row_words.js';

/** "Gy(w) per 250 kW-min · blood 15 ppm · weights: BPA example · isodose as brain" */
export function doseBasis({ room }, place) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const basis = plan && scene && basisParts(plan, scene);
  if (!basis) return nothing;
  const rest = [basis.rest[0], ...basis.rest.slice(1).map((part) => part && ` · ${part}`)].join('');
  const mark = ofFits(room)?.wordMark({ room }, ['dose']) ?? nothing;
  return html`<div class=${`dose-basis ${place}`} title=${`${basis.unit}${rest}`}>${place === 'aside' ? html`<span class="dim">${say.basis}</span>` : nothing}
    <span class="dose-basis-words">${mark === nothing ? nothing : html`${mark} · `}<b>${basis.unit}</b>${rest}</span></div>`;
}
