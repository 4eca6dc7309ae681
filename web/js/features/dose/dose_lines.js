// The labels on isodose lines, over the picture of a slice pane.
import { svg } from '../../../lib/lit-html.js';
import { variables } from '../../parts/mount.js';
import { legendPlace } from './legend_place.js';
import { boxOf } from '../../parts/page_look.js';

const [narrowest, lowest] = [320, 240]; // px: smaller panes have no labels
const leastLuminance = 0.3; // of the letters, on their dark halo
const [awayPx, sparePx] = [24, 3]; // from the middle of the crosshair, where there is a choice from its lines too; from marks and other labels
const marks = [
  '.legend',
  '.overlay .letter',
  '.overlay .scale',
  '.overlay .caption',
  '.overlay .dose-pin',
  '.overlay.pointers > *',
  '.note-pin',
  '.clip-handle',
  '.image-measures > *',
  '.beam-handle',
];
const footPx = 28; // of the strip with scale and window

/**
 * At most one label of a level: the first of the server's places that keeps away from the crosshair and from what else is drawn over the picture.
 * @param {{world: object, view: object, header: object, box: {x, y, width, height}}} what world: that of the pane, of which letters and marks
 *   are kept free; box: of the picture, CSS px
 */
export function lineLabels({ world, view, header, box }) {
  const { doses, host } = world;
  const levels = legendPlace(world).hasValues ? doses.labels.of(view) : [];
  if (!levels.length || host.clientWidth < narrowest || host.querySelector('.picture').clientHeight < lowest) return '';
  const k = box.width / header.full_px[0];
  const taken = takenIn(host);
  const lines = boxesIn(host, '.overlay .crosshair > *');
  const shown = [];
  for (const { id, color, text, labels } of levels) {
    const places = labels
      .map(({ x_px: px, y_px: py, angle_deg: angle, width_px: width, height_px: height }) => {
        const [x, y] = [box.x + px * k, box.y + py * k];
        const [across, up] = extent(width * k, height * k, angle);
        return { x, y, angle, left: x - across / 2, right: x + across / 2, top: y - up / 2, bottom: y + up / 2 };
      })
      .filter((place) => !taken.some((other) => isNear(place, other, other.away)));
    const place =
      places.find((one) => !lines.some((line) => isNear(one, line, awayPx))) ??
      places.find((one) => !lines.some((line) => isNear(one, line, sparePx)));
    if (!place) continue; // the legend says it
    taken.push({ ...place, away: sparePx });
    shown.push({ ...place, id, color, text });
  }
  return svg`<g class="dose-labels">${shown.map(
    ({ id, color, text, x, y, angle }) =>
      svg`<text class="halo dose-line-label" data-level=${id} transform=${`translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${angle.toFixed(1)})`} dy="0.35em" ${variables({ '--color': readable(color) })}>${text}</text>`,
  )}</g>`;
}

const isNear = (a, b, away) => a.left < b.right + away && a.right > b.left - away && a.top < b.bottom + away && a.bottom > b.top - away;

/** The colour, mixed with white until it can be read: blue is too dark for letters. */
export function readable(color) {
  const rgb = [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
  const luminance = (parts) =>
    parts.map((part) => (part / 255) ** 2.2).reduce((sum, part, at) => sum + part * [0.2126, 0.7152, 0.0722][at], 0);
  let mixed = rgb;
  for (let white = 0.1; luminance(mixed) < leastLuminance && white < 1; white += 0.1)
    mixed = rgb.map((part) => Math.round(part + (255 - part) * white));
  return `#${mixed.map((part) => part.toString(16).padStart(2, '0')).join('')}`;
}

/** Width and height of a turned box. */
function extent(width, height, angle) {
  const [c, s] = [Math.abs(Math.cos((angle * Math.PI) / 180)), Math.abs(Math.sin((angle * Math.PI) / 180))];
  return [width * c + height * s, width * s + height * c];
}

/** Boxes of marks, in the px in which labels are drawn: on a wall all of it is scaled. */
function boxesIn(host, names) {
  const element = host.querySelector('.picture');
  const picture = boxOf(element);
  const scale = host.closest('.wall') ? picture.width / element.offsetWidth || 1 : 1;
  return [...host.querySelectorAll(names)].map((mark) => {
    const { left, right, top, bottom } = boxOf(mark);
    return {
      left: (left - picture.left) / scale,
      right: (right - picture.left) / scale,
      top: (top - picture.top) / scale,
      bottom: (bottom - picture.top) / scale,
    };
  });
}

/** Where no label stands: the foot, round the middle of the crosshair, letters, marks of people, of measures and of planes. */
function takenIn(host) {
  const { clientWidth: right, clientHeight: bottom } = host.querySelector('.picture');
  const middles = boxesIn(host, '.overlay .crosshair').map((cross) => crossing(host, cross));
  return [
    { away: 0, left: 0, right, top: bottom - footPx, bottom },
    ...middles.map((middle) => ({ ...middle, away: awayPx })),
    ...boxesIn(host, marks.join()).map((mark) => ({ ...mark, away: sparePx })),
  ];
}

/** Where the lines of the crosshair meet, as a box without a size. */
function crossing(host, cross) {
  const lines = boxesIn(host, '.overlay .crosshair > *');
  const upright = lines.find(({ left, right, top, bottom }) => bottom - top > right - left) ?? cross;
  const level = lines.find(({ left, right, top, bottom }) => bottom - top <= right - left) ?? cross;
  return { left: upright.left, right: upright.right, top: level.top, bottom: level.bottom };
}
