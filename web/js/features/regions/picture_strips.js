// Between the bars and the panes: the colours of the segmentation check, and regions that pictures leave out, with the reason.
import { html, nothing } from '../../../lib/lit-html.js';
import { nameSome } from '../../parts/format.js';
import { icon } from '../../parts/icons.js';
import { isInSpace } from '../../room/kinds.js';
import { say } from './later_words.js';

const isShown = (view) => view.isOpen.value && view.painted.value !== null;

/** Whether a slice on the screen is checked. */
const isChecked = ({ room }) =>
  room.scene.value.check.visible && room.plan.value.regions.length > 0 && room.views.some((view) => isShown(view) && !isInSpace(view.kind));

const check = () => html`<ul class="picture-strip check-strip" aria-label=${say.checkColours}>
  <li><b>${say.checkColours}</b></li><li><i class="beyond"></i>${say.beyond}</li><li><i class="within"></i>${say.within}</li></ul>`;

/** Lines about the regions that each picture on the screen leaves out; pictures that say the same say it once. @returns {{words: string, region: object, reason: string}[]} */
export function leftOut({ room, refused }) {
  const [scene, plan] = [room.scene.value, room.plan.value];
  const lines = new Map();
  for (const view of room.views.filter(isShown)) {
    const inSpace = isInSpace(view.kind);
    const reasons = inSpace ? refused.value : view.missing.value.reasons;
    const regions = plan.regions.filter(({ id }) => reasons[id]);
    if (!regions.length) continue;
    const isNurbs = regions.every(({ id }) => scene.regions[id]?.representation === 'nurbs');
    const sentence = !inSpace ? say.notChecked : isNurbs ? say.notNurbs : say.notDrawn;
    const nUnnamed = Math.max(0, view.missing.value.n - regions.length);
    const words = sentence({ regions: nameSome([...regions.map(({ name }) => name), ...Array(nUnnamed).fill(say.others)]) });
    lines.set(words, { words, region: regions[0], reason: reasons[regions[0].id] });
  }
  return [...lines.values()];
}

const left = ({ ui }, lines) =>
  html`<div class="picture-strip left-out" role="status">${lines.map(
    ({ words, region, reason }) => html`<p><span class="warn">${icon('warning', 12)}</span><span>${words}</span>
    <button title=${reason} aria-label=${say.whyNot({ region: region.name })} @click=${() => ui.choose('region', region.id)}>${say.why}</button></p>`,
  )}</div>`;

export function pictureStrips(world) {
  const lines = leftOut(world);
  return html`${isChecked(world) ? check() : nothing}${lines.length ? left(world, lines) : nothing}`;
}
