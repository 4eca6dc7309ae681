// How an image is shown: window, presets by modality; showing another image; a second image blended over it. Pure.
import { shownImage } from './plan.js';
import { say } from './words.js';

export const cullsNothing = -1e12; // proto/scene.json
const narrowest = 1e-15;
const farthest = 1e12; // of a window's centre

export const isCt = ({ unit }) => unit === 'HU';

/** The window and the colour map of an image: the scene's for the one shown, what was kept for another one, else its own first window. */
export function lookOf(plan, scene, image) {
  if (image === shownImage(plan, scene)) return { window: scene.image.window, color_map: scene.image.color_map ?? 'grey' };
  const kept = scene.image.looks?.[image.id];
  return { window: kept?.window ?? image.window, color_map: kept?.color_map ?? 'grey' };
}

/** The window's third number: 1 where it is not stated. */
export const gammaOf = ({ gamma = 1 }) => gamma;

/** The patch that changes window or colour map of an image, shown or not. A look that is kept is written whole. */
export function lookPatch(plan, scene, image, change) {
  if (image === shownImage(plan, scene)) return { image: change };
  const { window, color_map } = lookOf(plan, scene, image);
  return { image: { looks: { [image.id]: { color_map, ...change, window: { ...window, ...change.window } } } } };
}

/** The threshold of slices in 3-D that a new room has for this image: core/scene/snapshot.c, scene_for_plan. */
export function usualCull(image, window = image.window) {
  if (isCt(image)) return -500;
  return image.isInverted ? cullsNothing : Math.max(window.center - 0.45 * window.width, -farthest);
}

/**
 * The patch that shows another image as it was shown last, and keeps the look of the one shown until now. Values in the unit of
 * the old image go with it: the threshold of slices in 3-D.
 */
export function showPatch(plan, scene, image) {
  const old = shownImage(plan, scene);
  const look = lookOf(plan, scene, image);
  const change = { id: image.id, low_values: 'own', ...look, looks: { [old.id]: lookOf(plan, scene, old) } };
  if (gammaOf(look.window) !== gammaOf(scene.image.window)) change.window = { ...look.window, gamma: gammaOf(look.window) };
  if (scene.image.cull_below > cullsNothing) change.cull_below = usualCull(image, look.window);
  if (scene.image.blend?.id === image.id) change.blend = { id: '' };
  return { image: change };
}

/** The image that is blended over the one shown; null: none. */
export function blendedImage(plan, scene) {
  const id = scene?.image?.blend?.id;
  const image = id ? plan?.images.find((other) => other.id === id) : null;
  return image && image !== shownImage(plan, scene) ? image : null;
}

const hounsfield = [
  ['1', say.softTissue, 40, 400],
  ['2', say.lung, -600, 1500],
  ['3', say.brain, 40, 80],
  ['4', say.bone, 480, 2500],
];
const moreHounsfield = [
  [say.head, 45, 125],
  [say.spine, 30, 300],
  [say.abdomen, 40, 350],
  [say.ctBone, 400, 1000],
];
const shares = [
  ['1', '0.1', '99.9'],
  ['2', '1', '99'],
]; // percentiles
const between = (low, high) => ({ center: (low + high) / 2, width: Math.max(high - low, narrowest) });

/**
 * Window presets of an image, the first ones with the key that sets them; 5 is the full range. Presets in HU only for an image
 * in HU, percentiles for any other.
 * @param {{percentiles: Record<string, number>}|null} histogram of the image; without one, percentiles are left out
 * @returns {{key?: string, name: string, center: number, width: number}[]}
 */
export function windowPresets(image, histogram = null) {
  if (!image) return [];
  const full = { key: '5', name: say.fullRange, center: (image.low + image.high) / 2, width: Math.max(image.high - image.low, 0.001) };
  const preset = ([key, name, center, width]) => ({ key, name, center, width });
  if (isCt(image)) return [...hounsfield.map(preset), full, ...moreHounsfield.map(([name, center, width]) => ({ name, center, width }))];
  const at = histogram?.percentiles ?? {};
  const known = shares.filter(([, low, high]) => at[high] > at[low]);
  return [
    ...known.map(([key, low, high]) => ({ key, name: `${low}–${high} %`, ...between(at[low], at[high]) })),
    { key: '3', name: say.asStored, ...image.window },
    full,
  ];
}

/** Centre and width as they are sent: to a thousandth of the width, 0.1 at most. */
export function roundedWindow({ center, width }) {
  const parts = 10 ** Math.max(1, 3 - Math.floor(Math.log10(width)));
  const round = (value) => (Number.isFinite(parts) && Math.abs(value) * parts < 2 ** 53 ? Math.round(value * parts) / parts : value);
  return { center: round(center), width: Math.max(round(width), narrowest) };
}

/** The window after a drag: to the right wider, up darker, by a 250th of the width a pixel. */
export function draggedWindow(image, { center, width }, dx, dy) {
  const least = image && !isCt(image) ? Math.max((image.high - image.low) / 10000, narrowest) : 1;
  const step = Math.max(width, least) / 250;
  return { center: center - dy * step, width: Math.max(width + dx * step, least) };
}

export const isSameWindow = (a, b) =>
  Math.abs(a.center - b.center) <= 6e-4 * Math.max(b.width, 1e-12) && Math.abs(a.width - b.width) <= 6e-4 * Math.max(b.width, 1e-12);

/** The lower and the upper end of a window, and a window from them; the ends are kept apart. */
export const endsOf = ({ center, width }) => ({ low: center - width / 2, high: center + width / 2 });
export function windowFrom(low, high) {
  const [a, b] = [Math.min(low, high), Math.max(low, high)];
  return { center: (a + b) / 2, width: Math.max(b - a, narrowest) };
}
