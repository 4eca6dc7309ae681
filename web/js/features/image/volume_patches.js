// Patches that show an image or its volume, with a transfer function that fits. Pure.
import { mergePatch } from '../../wire/merge.js';
import { cullsNothing, isCt, lookOf, showPatch } from '../../room/image_look.js';
import { shownImage } from '../../room/plan.js';
import { presetPoints, presetsOfImage } from './volume_presets.js';

/** The transfer function that fits another image: the first preset where the unit is another one, else the same parts of the window. */
function pointsFor(points, old, oldWindow, image, window) {
  if (!isCt(old) && !isCt(image))
    return points.map((point) => ({
      ...point,
      value: window.center + ((point.value - oldWindow.center) * window.width) / oldWindow.width,
    }));
  if (isCt(old) === isCt(image)) return points;
  const [first] = presetsOfImage(image);
  return first ? presetPoints(first, window) : points;
}

/** The patch that shows another image, its volume's values with it. */
export function showPatchWithVolume(plan, scene, image) {
  const old = shownImage(plan, scene);
  const patch = showPatch(plan, scene, image);
  const { volume } = scene.image;
  if (!volume || (old.unit === 'HU' && image.unit === 'HU')) return patch;
  const points = pointsFor(volume.points, old, scene.image.window, image, lookOf(plan, scene, image).window);
  return mergePatch(patch, { image: { volume: volume.cull_below > cullsNothing ? { points, cull_below: cullsNothing } : { points } } });
}

/** The patch that shows or hides the volume; where it has no transfer function yet, with the first preset. */
export function visiblePatch(plan, scene, isVisible) {
  const image = shownImage(plan, scene);
  const [first] = image ? presetsOfImage(image) : [];
  const isEmpty = !scene.image.volume.points.length;
  return {
    image: {
      volume: { visible: isVisible, ...(isVisible && isEmpty && first ? { points: presetPoints(first, scene.image.window) } : {}) },
    },
  };
}

export const isSamePoints = (a, b) =>
  a.length === b.length &&
  a.every(
    (point, at) =>
      point.color === b[at].color &&
      Math.abs(point.opacity - b[at].opacity) < 1e-6 &&
      Math.abs(point.value - b[at].value) <= 1e-6 * Math.max(Math.abs(b[at].value), 1e-9),
  );
