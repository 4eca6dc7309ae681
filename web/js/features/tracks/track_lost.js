// Lost particles: where each was lost, and the camera that flies there.
import { html, nothing } from '../../../lib/lit-html.js';
import { crosshairPatch, shownImage } from '../../room/plan.js';
import { isTurnable } from '../../room/kinds.js';
import { add, subtract } from '../../parts/vec.js';
import { number, position } from '../../parts/format.js';
import { icon, swatch } from '../../parts/icons.js';
import { say } from './later_words.js';

/** "brain"; outside all regions. */
export const placeWords = (plan, region) =>
  region === null ? say.outside : (plan.regions.find(({ id }) => id === region)?.name ?? region);

/** Puts the crosshair to a point, and the point into the middle of a 3-D pane, which keeps its direction. */
export function flyTo({ room, ui, panes }, point, event) {
  const at = event.timeStamp;
  const [plan, scene] = [room.plan.value, room.scene.value];
  const turnable = [ui.active.value, ...ui.visible.value].find(
    (number) => ui.visible.value.includes(number) && isTurnable(room.view(number).kind),
  );
  room.patchScene(crosshairPatch(plan, shownImage(plan, scene), point, { isFree: true }), { view: ui.active.value, at });
  if (!turnable) return void ui.notify('ok', say.noPane, 'tracks');
  const { cameras } = panes()[turnable - 1].actions;
  const camera = cameras.value;
  cameras.set({ ...camera, position_mm: add(camera.position_mm, subtract(point, camera.target_mm)), target_mm: point }, at);
}

export const flyButton = (world, point, words, label = words) =>
  html`<button class="track-fly" aria-label=${label} ?disabled=${!world.room.canChange.value}
    @click=${(event) => flyTo(world, point, event)}>${icon('target')}${words}</button>`;

export function lostBlock(world, { lost, lost_left_out: leftOut, counts }) {
  const plan = world.room.plan.value;
  if (!counts.lost) return nothing;
  const color = (region) => plan.regions.find(({ id }) => id === region)?.color;
  return html`<section class="block"><h3>${say.lost} <span class="dim">${number(counts.lost)}</span></h3>
    <p class="note">${say.whereLost}</p>
    <ol class="track-lost">${lost.map(
      ({ segment, region, from_lps_mm: point }) => html`<li data-segment=${segment}><span class="track-where">
        <span>${region === null ? icon('warning', 12) : swatch(color(region))} ${placeWords(plan, region)}</span>
        <span class="dim">${position(point)}</span></span>
      ${flyButton(world, point, say.flyTo, say.flyToLost({ number: segment }))}</li>`,
    )}</ol>
    ${leftOut ? html`<p class="note">${say.notListed({ count: number(leftOut), n: leftOut })}</p>` : nothing}</section>`;
}
