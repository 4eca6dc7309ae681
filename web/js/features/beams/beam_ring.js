// Over pictures along a beam: the numbers of the crosshair, the ring's handle and its words. Crosshair, ticks and ring are in the picture.
import { html, nothing, svg } from '../../../lib/lit-html.js';
import { beamPlane } from '../../room/beam_line.js';
import { add, scale, toPicture } from '../../parts/vec.js';
import { number } from '../../parts/format.js';
import { variables } from '../../parts/mount.js';
import { sliderKey } from '../../parts/slider_keys.js';
import { say } from './pane_words.js';
import { boxOf, placeOf } from '../../parts/page_look.js';

const numbersMm = [20, 40, 80];
const nearMm = [5, 10]; // where those lie outside
const [firstPx, leastPx] = [36, 22]; // from the middle to the first number, between two numbers
const edgePx = 34; // kept free for the letters
const diagonal = Math.SQRT1_2;
const range = { low: 0.1, high: 2000 };
const tidy = (mm) => Math.round(mm * 2) / 2; // a drag goes in halves of a millimetre
/** A place on the screen, px, without the digits in which the matrices of pictures differ though they show the same place: those would be set out anew. */
const placed = (px) => Math.round(px * 10) / 10;

/** The target and the ends of 1 mm to the right and upwards, px in the pane; null where the target lies behind the eye. */
function frameOf({ header, box, beam }) {
  const { right, up } = beamPlane(beam, beam.length);
  const at = (point) => {
    const place = toPicture(header.clip_from_lps_mm, point);
    return place && [box.x + place[0] * box.width, box.y + place[1] * box.height];
  };
  const middle = at(beam.target);
  const [toRight, upwards] = [right, up].map((axis) => middle && at(add(beam.target, scale(axis, 10))));
  if (!middle || !toRight || !upwards) return null;
  return { middle, pxPerMm: Math.hypot(toRight[0] - middle[0], toRight[1] - middle[1]) / 10 };
}

/** 20, 40 and 80 mm beside the crosshair, 5 and 10 very near; in perspective a line that says where they are true. @param {object} place {header, box, pane, beam, ring} */
export function ringNumbers(place, hasCrosshair) {
  const frame = frameOf(place);
  const {
    header,
    pane: [width, height],
  } = place;
  if (!frame) return nothing;
  const {
    middle: [x, y],
    pxPerMm,
  } = frame;
  const isIn = (px, py) => px > edgePx && py > edgePx && px < width - edgePx && py < height - edgePx;
  const isNear = 20 * pxPerMm > Math.min(width, height) / 2 - edgePx;
  const shown = (isNear ? nearMm : numbersMm).reduce(
    (kept, mm) => ((mm - (kept.at(-1) ?? 0)) * pxPerMm >= (kept.length ? leastPx : firstPx) ? [...kept, mm] : kept),
    [],
  );
  const text = (px, py, mm, anchor) =>
    isIn(px, py) ? svg`<text class="halo caption beam-number" x=${placed(px)} y=${placed(py)} text-anchor=${anchor}>${mm}</text>` : nothing;
  return svg`${
    hasCrosshair
      ? shown.map((mm) => {
          const r = mm * pxPerMm;
          return svg`${text(x + r, y + 20, mm, 'middle')}${text(x - r, y + 20, mm, 'middle')}${text(x + 13, y - r + 4, mm, 'start')}${text(x + 13, y + r + 4, mm, 'start')}`;
        })
      : nothing
  }${hasCrosshair && !(header.pixels_per_mm > 0) ? svg`<text class="halo caption beam-depth" x="12" y=${height - 12}>${say.atDepth}</text>` : nothing}`;
}

const handleAt = ({ middle: [x, y], pxPerMm }, ring) => [x + (ring / 2) * pxPerMm * diagonal, y - (ring / 2) * pxPerMm * diagonal];

/** "ring 100 mm, as the aperture": the ring beside the beam's aperture, from which it may differ. */
export function ringWords(ring, { aperture, isShaped }) {
  const isPlanned = aperture && Math.abs(ring - aperture) < 0.05;
  const beside = !aperture
    ? isShaped
      ? say.notRound
      : say.notKnown
    : isPlanned
      ? say.asAperture
      : say.apertureIs({ mm: number(aperture, aperture % 1 ? 1 : 0) });
  return { ring: say.ringOf({ mm: number(ring, ring % 1 ? 1 : 0) }), beside };
}

/** The round handle on the ring, up and to the right. @param {(mm: number, at: number) => void} set */
export function ringHandle(place, isOff, set) {
  const frame = frameOf(place);
  if (!frame) return nothing;
  const {
    ring,
    pane: [width, height],
  } = place;
  const [x, y] = handleAt(frame, ring);
  if (x < 0 || y < 0 || x > width || y > height) return nothing;
  const words = say.ringOf({ mm: number(ring, 1) });
  const onMove = (event) => {
    event.stopPropagation(); // no card at the pointer beside the handle
    if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
    const { left, top } = boxOf(event.currentTarget.closest('.picture'));
    const { x, y } = placeOf(event);
    const mm = (2 * Math.hypot(x - left - frame.middle[0], y - top - frame.middle[1])) / frame.pxPerMm;
    set(Math.min(Math.max(tidy(mm), 1), range.high), event.timeStamp);
  };
  const onDown = (event) => {
    event.stopPropagation();
    if (event.button > 0 || isOff) return;
    event.preventDefault();
    event.currentTarget.setPointerCapture(event.pointerId);
    event.currentTarget.focus({ preventScroll: true });
  };
  const onKey = (event) => {
    const mm = sliderKey(event, ring, range);
    if (mm === null) return;
    event.preventDefault();
    event.stopPropagation();
    set(mm, event.timeStamp);
  };
  return html`<div class="clip-handles"><i class="beam-handle" role="slider" tabindex="0" aria-label=${say.ringName} aria-valuemin=${range.low} aria-valuemax=${range.high} aria-valuenow=${ring} aria-valuetext=${words} aria-disabled=${isOff}
    title=${say.handle({ ring: words })} ${variables({ '--x': `${placed(x)}px`, '--y': `${placed(y)}px` })} @pointerdown=${onDown} @pointermove=${onMove} @keydown=${onKey}></i></div>`;
}
