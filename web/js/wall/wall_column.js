// The right column of a wall: the legend of the dose, the colours of images, the colours of a check, the regions that are shown, the value at the crosshair, who is here.
import { html, nothing } from '../../lib/lit-html.js';
import { legendRows } from '../features/dose/legend_rows.js';
import { valueWords } from '../features/dose/dose_probe.js';
import { ofFits } from '../features/fits/feature.js';
import { imageScales } from '../features/image/image_legend.js';
import { ownRegions } from '../room/identity.js';
import { isInSpace } from '../room/kinds.js';
import { crosshair } from '../room/plan.js';
import { position } from '../parts/format.js';
import { icon } from '../parts/icons.js';
import { variables } from '../parts/mount.js';
import { say } from './words.js';

const mostRegions = 9;
const mostPeople = 8;

const swatch = (color, kind = '') => html`<i class=${`wall-swatch ${kind}`} ${variables({ '--color': color })}></i>`;

function legendRow({ quantity, weights, reference, warn, isOld, unit, levels, scale, domain, figures }) {
  const basis = [unit, weights].filter(Boolean).join(', ');
  return html`<section class=${isOld ? 'wall-legend old' : 'wall-legend'}><h2>${quantity}</h2>
    ${basis ? html`<p>${basis}</p>` : nothing}${warn ? html`<p class="warn">${icon('warning', 16)} ${warn}</p>` : nothing}
    ${levels.length ? html`<ul class="wall-levels">${levels.map(({ color, isArea, percent, value }) => html`<li>${swatch(color, isArea ? '' : 'line')}<span>${percent} %</span><b>${value}</b></li>`)}</ul>` : nothing}
    ${scale ? html`<i class="wall-scale" ${variables({ '--scale': scale.gradient })}></i><p class="wall-ends">${scale.ends.map((end) => html`<span>${end}</span>`)}</p>` : nothing}
    ${[reference, domain, figures].filter(Boolean).map((words) => html`<p>${words}</p>`)}</section>`;
}

function legend(world) {
  const { room, doses } = world;
  const rows = legendRows(room.plan.value, room.scene.value, {
    scale: doses.scale.value,
    gamma: doses.gamma.value,
    reference: doses.reference.value,
    isKnown: doses.isOfScene(doses.scale.value.result),
  });
  if (!rows.length) return nothing;
  const mark = ofFits(room)?.wordMark(world, ['dose']) ?? nothing;
  return html`${mark === nothing ? nothing : html`<p class="wall-mark">${mark}</p>`}${rows.map(legendRow)}`;
}

/** The colours of the image shown and of one blended over it, from the lower end of the window to the upper one. */
const images = (world) =>
  imageScales(world).map(
    ({
      name,
      unit,
      gradient,
      ends,
    }) => html`<section class="wall-image"><h2>${say.image({ image: name })}</h2>${unit ? html`<p>${unit}</p>` : nothing}
    <i class="wall-scale" ${variables({ '--scale': gradient })}></i><p class="wall-ends">${ends.map((end) => html`<span>${end}</span>`)}</p></section>`,
  );

/** The colours of the segmentation check, while a slice shows it. */
function check({ room }) {
  const isShown = room.scene.value.check.visible && room.plan.value.regions.length > 0;
  if (!isShown || !room.views.some((view) => view.isOpen.value && !isInSpace(view.kind))) return nothing;
  return html`<section class="wall-check"><h2>${say.check}</h2><ul><li><i class="wall-swatch beyond"></i><span>${say.beyond}</span></li><li><i class="wall-swatch within"></i><span>${say.within}</span></li></ul></section>`;
}

function regions({ room }) {
  const [plan, scene] = [room.plan.value, room.scene.value];
  const shown = ownRegions(plan, scene).filter(({ id }) => scene.regions[id]?.visible);
  if (!shown.length) return nothing;
  const more = shown.length - mostRegions;
  return html`<section><h2>${say.regions}</h2><ul>${shown.slice(0, more > 1 ? mostRegions : shown.length).map(({ id, name }) => html`<li>${swatch(scene.regions[id].color)}<span>${name}</span></li>`)}</ul>
    ${more > 1 ? html`<p>${say.others({ n: more })}</p>` : nothing}</section>`;
}

function atCrosshair({ room, doses, probed }) {
  const scene = room.scene.value;
  const { result, isOld } = doses.here.value;
  const dose = !isOld && doses.isOfScene(result) ? valueWords(result) : '';
  const isValue = dose && Number.isFinite(result.value);
  const innermost = !probed.value.isOld && probed.value.result?.regions[0];
  const region = room.plan.value.regions.find(({ id }) => id === innermost)?.name;
  return html`<section><h2>${say.crosshair}</h2><p>${position(crosshair(scene))}</p>
    ${isValue ? html`<p class="wall-value">${dose}</p>` : dose ? html`<p>${dose}</p>` : nothing}${region ? html`<p class="wall-region">${region}</p>` : nothing}</section>`;
}

/** People of the room, the presenter first; who may not point is counted. */
function here({ room }) {
  const people = room.members.value.filter(({ role, connected }) => role !== 'wall' && connected !== false);
  const named = people.filter(({ role }) => role !== 'observer').sort((a, b) => Number(b.presenting) - Number(a.presenting));
  const isLong = named.length > mostPeople;
  const shown = isLong ? named.slice(0, mostPeople - 1) : named;
  const n = people.length - named.length;
  return html`<section><h2>${say.here}</h2>${people.length ? nothing : html`<p>${say.nobodyHere}</p>`}
    <ul>${shown.map(({ name, color }) => html`<li>${swatch(color, 'dot')}<span>${name}</span></li>`)}</ul>
    ${isLong ? html`<p>${say.others({ n: named.length - shown.length })}</p>` : nothing}${n ? html`<p>${say.observers({ n })}</p>` : nothing}</section>`;
}

/** @param {object} world of wall_page.js */
export function wallColumn(world) {
  const { room } = world;
  if (!room.plan.value || !room.scene.value) return nothing;
  return html`${legend(world)}${images(world)}${check(world)}${regions(world)}${atCrosshair(world)}${here(world)}`;
}
