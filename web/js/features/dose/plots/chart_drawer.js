// The drawer of the room page with the plots of dose: below the panes, beside them, or in a sheet.
import { html, nothing } from '../../../../lib/lit-html.js';
import { dvhPart } from './chart_dvh.js';
import { profilePart } from './chart_profile.js';
import { icon } from '../../../parts/icons.js';
import { say } from './words.js';

const ready = ({ room }) => Boolean(room.plan.value && room.scene.value);

export function drawer(world) {
  const { ui } = world;
  if (!ready(world)) return html`<p class="empty">${say.loading}</p>`;
  const { drawer: place, size } = ui.arrangement.value;
  const isRight = place === 'right';
  const dock = (isOnRight) => {
    ui.isDrawerRight.value = isOnRight;
  };
  const close = html`${size === 'wide' ? html`<button class="icon-button small" title=${isRight ? say.below : say.beside} aria-label=${isRight ? say.plotsBelow : say.plotsBeside} @click=${() => dock(!isRight)}>${icon(isRight ? 'drawer' : 'panel', 12)}</button>` : nothing}
    <button class="icon-button small" title=${ui.keys.tip(say.close, 'drawer')} aria-label=${say.closePlots} @click=${() => ui.toggleDrawer()}>${icon('close', 12)}</button>`;
  return html`${dvhPart(world, { isInline: isRight })}${profilePart(world, { isInline: isRight, close })}`;
}

export const sheet = (world) =>
  html`<div class="chart-sheet">${dvhPart(world, { isInline: false })}${profilePart(world, { isInline: false })}</div>`;
