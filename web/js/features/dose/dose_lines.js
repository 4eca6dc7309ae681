// The labels on isodose lines, over the picture of a slice pane.
import { svg } from '../../../lib/lit-html.js';
import { variables } from '../../parts/mount.js';

const sparePx = 2;
const narrowest = 240; // px: narrower panes have no labels
const leastLuminance = 0.3; // of the letters, on their dark halo

/**
 * @param {{doses: object, view: object, host: HTMLElement, header: object, box: {x, y, width, height}}} what host: the pane, of which letters and
 *   legends are kept free; box: of the picture, CSS px
 */
export function lineLabels({ doses, view, host, header, box }) {
  const levels = doses.labels.of(view);
  if (!levels.length || host.clientWidth < narrowest) return '';
  const k = box.width / header.full_px[0];
  const taken = takenIn(host);
  return svg`<g class="dose-labels">${levels.map(({ id, color, text, labels }) =>
    labels.map(({ x_px: px, y_px: py, angle_deg: angle, width_px: width, height_px: height }) => {
      const [x, y] = [box.x + px * k, box.y + py * k];
      const [across, up] = extent(width * k, height * k, angle);
      const isFree = taken.every(
        (other) =>
          x + across / 2 + sparePx < other.left ||
          x - across / 2 - sparePx > other.right ||
          y + up / 2 + sparePx < other.top ||
          y - up / 2 - sparePx > other.bottom,
      );
      return isFree
        ? svg`<text class="halo dose-line-label" data-level=${id} transform=${`translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${angle.toFixed(1)})`} dy="0.35em" ${variables({ '--color': readable(color) })}>${text}</text>`
        : '';
    }),
  )}</g>`;
}

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

/** Boxes that no label may cover, in CSS px of the picture. */
function takenIn(host) {
  const picture = host.querySelector('.picture').getBoundingClientRect();
  return [...host.querySelectorAll('.legend, .overlay .letter, .overlay .scale, .overlay .caption')].map((mark) => {
    const { left, right, top, bottom } = mark.getBoundingClientRect();
    return { left: left - picture.left, right: right - picture.left, top: top - picture.top, bottom: bottom - picture.top };
  });
}
