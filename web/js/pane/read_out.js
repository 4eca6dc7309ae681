// The card at the pointer: region, image value and position, beside the place that the mouse rests on or a finger held.
import { html, nothing, svg } from '../../lib/lit-html.js';
import { shownImage } from '../room/plan.js';
import { cardOf, placeBeside } from '../parts/place.js';
import { imageValue, number, position, significant, unitText, volume } from '../parts/format.js';
import { variables } from '../parts/mount.js';
import { say } from './words.js';
import { boxOf } from '../parts/page_look.js';

const mouseGap = 16;
const touchGap = 40; // a finger covers what is nearer
const rings = [24, 31];

/** @param {object} world {room, pointed} @param {HTMLElement} host inside the picture */
export function readOut({ room, pointed }, host) {
  const shown = pointed.shown.value;
  const plan = room.plan.peek();
  const scene = room.scene.peek();
  if (!shown || !plan || !scene) return nothing;
  const picture = boxOf(host.parentElement);
  const { name, color, lines, value, width, height } = cardOf(words(shown.facts, plan, scene), picture.width, shown.isHeld);
  const { x, y } = placeBeside(
    shown,
    [width, height],
    [picture.width, picture.height],
    takenIn(host.parentElement, picture),
    shown.isHeld ? touchGap : mouseGap,
  );
  return html`${shown.isHeld ? html`<svg class="rings">${[0, 1].map((layer) => rings.map((r) => svg`<circle class=${layer ? 'ink' : 'under'} cx=${shown.x} cy=${shown.y} r=${r} />`))}</svg>` : nothing}
    <div class="read-out" role=${shown.isHeld ? 'status' : nothing} aria-hidden=${shown.isHeld ? nothing : 'true'} ?data-held=${shown.isHeld}
      ${variables({ '--x': `${x}px`, '--y': `${y}px`, '--width': `${width}px`, '--height': `${height}px` })}>
      <p class="who">${color ? html`<svg class="swatch" viewBox="0 0 12 12" width="12" height="12" aria-hidden="true"><rect width="12" height="12" rx="2.5" fill=${color}/></svg>` : nothing}<b>${name}</b></p>
      ${value ? html`<p class="value"><span>${value.label}</span> <b>${value.text}</b> ${value.unit}</p>` : nothing}
      ${lines.map((line) => html`<p>${line}</p>`)}</div>`;
}

/** The words of the card: the innermost region first. */
export function words({ regions: ids, images, point_lps_mm: point, onSurface, dose }, plan, scene) {
  const regions = ids.map((id) => plan.regions.find((region) => region.id === id)).filter(Boolean);
  const [first, ...outer] = regions;
  const image = shownImage(plan, scene);
  const found = image && images?.find(({ id }) => id === image.id);
  return {
    name: first?.name ?? (plan.regions.length ? say.outside : (image?.modality ?? '')),
    isOutside: !first,
    color: first && (scene.regions[first.id]?.color ?? first.color),
    value: found && found.value !== null ? { label: image.modality, ...imageValue(found.value, image.unit) } : null,
    lines: [
      doseLine(dose),
      outer.length ? say.in({ regions: outer.map((region) => region.name).join(', ') }) : '',
      first && scene.regions[first.id]?.visible === false ? say.hidden : '',
      onSurface && first?.voxels ? volume(first.volume_cm3) : '',
      position(point),
    ].filter(Boolean),
  };
}

/** "4.82 Gy(w), 78.6 %"; '' where the dose is not shown or has no value. */
const doseLine = (answer) =>
  Number.isFinite(answer?.value)
    ? [`${significant(answer.value)} ${unitText(answer.unit)}`, Number.isFinite(answer.percent) ? `${number(answer.percent, 1)} %` : '']
        .filter(Boolean)
        .join(', ')
    : '';

/** Words of the values at the crosshair for a caption. */
export function spoken(result, plan, scene) {
  if (!plan || !scene) return [];
  const { name, isOutside, value } = words(result, plan, scene);
  return [
    plan.regions.length ? (isOutside ? say.outsideWithin : name) : '',
    value ? `${value.label} ${value.text} ${value.unit}`.trim() : '',
  ];
}

/** Boxes that the card must not cover: letters, scale bar, axes figure, legend. */
function takenIn(picture, { left, top }) {
  const marks = [
    ...picture.querySelectorAll('.overlay text, .overlay .figure, .overlay .scale'),
    ...picture.parentElement.querySelectorAll('.legend'),
  ];
  return marks.map((mark) => {
    const box = boxOf(mark);
    return { x: box.left - left, y: box.top - top, width: box.width, height: box.height };
  });
}
