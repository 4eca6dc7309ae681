// Things that slide along a beam: the beam slice, the clip plane across it, the eye; the range, and the regions on the way. Pure; mm from the entry.
import { alongOf } from '../../room/beam_line.js';
import { clipBox } from '../clip/clip.js';
import { say } from './pane_words.js';

const beyondMm = 10; // before the skin and behind the last region
const tenths = (value) => Math.round(value * 10) / 10 || 0;

/** Where planes along the beam make sense: from before the entry to behind the last region; without bands, over the plan's box. @returns {{low: number, high: number}} */
export function rangeAlong(plan, scene, beam, bands) {
  const ends = bands.length ? bands.flatMap(({ from_mm: from, to_mm: to }) => [from, to]) : reach(clipBox(plan, scene), beam);
  return { low: Math.floor(Math.min(0, ...ends) - beyondMm), high: Math.ceil(Math.max(beam.length, ...ends) + beyondMm) };
}

const reach = ({ low, high }, beam) =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((corner) =>
    alongOf(
      beam,
      low.map((value, axis) => ((corner >> axis) & 1 ? high[axis] : value)),
    ),
  );

/** Round places of numbers, about as many as there is room for. */
export function ticksOf({ low, high }, most) {
  const step = [5, 10, 20, 50, 100, 200, 500, 1000].find((mm) => (high - low) / mm <= most) ?? 2000;
  const first = Math.ceil(low / step) * step;
  return Array.from({ length: Math.floor((high - first) / step) + 1 }, (_, n) => first + n * step);
}

/** The region on the beam's line at a place; '' outside all. */
export const regionAt = (bands, mm) => bands.find(({ from_mm: from, to_mm: to }) => mm >= from && mm <= to)?.region ?? '';

/** True if the clip plane across a beam is of the beam that the scene shows. */
const isClipOfBeam = (scene) => !scene.clip.beam.id || (scene.clip.beam.id === scene.beam.id && !scene.beam.draft.enabled);

/** Choices of the things that the slider moves: [id, name, label of the slider][]. */
export const movers = (isTogether) =>
  isTogether
    ? [
        ['slice', say.sliceAndClip, say.sliceAndClipAlong],
        ['eye', say.eye, say.eyeAlong],
      ]
    : [
        ['slice', say.slice, say.sliceAlong],
        ['clip', say.clipPlane, say.clipPlaneAlong],
        ['eye', say.eye, say.eyeAlong],
      ];

/** Where that is. @param {number} eye of the view */
export const placeOf = (scene, mover, eye) =>
  mover === 'eye' ? eye : mover === 'clip' ? scene.clip.beam.along_mm : scene.beam.slice.along_mm;

/** The patch of the scene that moves slice or clip plane to a place, both where they slide together. */
export function slidPatch(scene, mover, isTogether, mm, { low, high }) {
  const along_mm = tenths(Math.min(Math.max(mm, low), high));
  const slice = { beam: { slice: { along_mm } } };
  const clip = { clip: { beam: isClipOfBeam(scene) ? { along_mm } : { along_mm, id: '' } } };
  return isTogether ? { ...slice, ...clip } : mover === 'clip' ? clip : slice;
}

/** Where a slice that was never moved begins to be looked at: at the target. */
export const firstAlong = ({ slice }, beam) => (slice.along_mm === 0 ? tenths(beam.length) : slice.along_mm);

/** The patch that turns the clip plane before the slice on or off; where they slide together it begins at the slice. */
export function clipInFront(scene, beam, isTogether, isOn) {
  const along_mm = firstAlong(scene.beam, beam);
  const isUntouched = scene.clip.beam.along_mm === 0;
  const clip = {
    clip: {
      beam: { enabled: isOn, ...(isOn && !isClipOfBeam(scene) && { id: '' }), ...(isOn && (isTogether || isUntouched) && { along_mm }) },
    },
  };
  return isOn && isTogether && along_mm !== scene.beam.slice.along_mm ? { ...clip, beam: { slice: { along_mm } } } : clip;
}
