// The words of the clip planes that cut a pane's slice, as chips in the head of the pane: never on its picture.
import { html, nothing } from '../../../lib/lit-html.js';
import { number } from '../../parts/format.js';
import { say } from './later_words.js';

const wordsOf = {
  axial_high: [say.keepsBelow, say.below],
  axial_low: [say.keepsAbove, say.above],
  sagittal_high: [say.keepsRight, say.right],
  sagittal_low: [say.keepsLeft, say.left],
  coronal_low: [say.keepsBehind, say.behind],
  coronal_high: [say.keepsBefore, say.before],
  beam: [say.keepsAlong, say.along],
  free: [() => say.keepsFree, () => say.keepsFree],
};

/** "keeps below S −34"; of several planes without the first word. @param {{id: string, position: number}} plane */
export const chipWords = ({ id, position }, isOne) =>
  wordsOf[id][isOne ? 0 : 1]({ mm: number(position, Math.abs(position - Math.round(position)) < 0.05 ? 0 : 1) });

/** @param {{id, name, text, position, isChosen}[]} clips whose lines the pane has @param {(id: string) => void} choose */
export function clipChips(clips, choose) {
  if (!clips.length) return nothing;
  return html`<span class="clip-chips">${clips.map(
    (
      clip,
    ) => html`<button class=${clip.isChosen ? 'clip-chip chosen' : 'clip-chip'} tabindex="-1" title=${say.clipIs({ plane: clip.name, position: clip.text })}
      @click=${() => choose(clip.id)}>${chipWords(clip, clips.length === 1)}</button>`,
  )}</span>`;
}
