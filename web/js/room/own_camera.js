// The camera of an own view that starts where the shared picture was: the same mm per pixel in a pane of another size.
import { alongOf } from './beam_line.js';
import { completeCamera, heightAtTarget, sliceHeight } from './camera.js';
import { homeCamera } from './home.js';
import { isInSpace } from './kinds.js';
import { eyeOf } from '../parts/vec.js';

const maxFovDeg = 120; // scene.json
const maxHeightMm = 10000;
const degrees = Math.PI / 180;

const extentMm = (camera, kind) => {
  if (!isInSpace(kind)) return sliceHeight(camera);
  return camera.projection === 'parallel' && camera.height_mm ? camera.height_mm : heightAtTarget(camera);
};

/**
 * The extent across the smaller side of the own view, divided by that of the shared one. The shared picture is shown as
 * large as it fits into the own pane.
 * @param {object} camera of the shared view, complete @param {[number, number]} sharedSize in px
 * @param {import('../wire/frame.js').FrameHeader|null} header of the picture on the screen, which may show an older camera
 * @param {[number, number]} ownSize in px
 */
export function widening(camera, kind, sharedSize, header, ownSize) {
  const full = header?.full_px ?? sharedSize;
  const shrunk = Math.min(ownSize[0] / full[0], ownSize[1] / full[1]); // own px per px of the shared view
  const own = Math.min(...ownSize);
  if (header?.pixels_per_mm > 0) return own / (header.pixels_per_mm * shrunk) / extentMm(camera, kind);
  return own / (Math.min(...full) * shrunk);
}

/** The camera whose extent across the smaller side is this much wider; the eye stays where it is. */
export function widen(camera, kind, factor) {
  if (isInSpace(kind) && camera.projection !== 'parallel') {
    const fov = (2 * Math.atan(factor * Math.tan((camera.fov_deg * degrees) / 2))) / degrees;
    return { ...camera, fov_deg: Math.min(Math.max(fov, 1), maxFovDeg) };
  }
  return { ...camera, height_mm: Math.min(extentMm(camera, kind) * factor, maxHeightMm) };
}

/** The camera as which a beam's-eye view widens: with an aperture ring it is parallel, whatever it says. */
export const asShown = (camera, beam) => ((beam?.aperture_mm ?? null) === null ? camera : { ...camera, projection: 'parallel' });

/**
 * Fields that a beam's-eye view keeps beside its camera. An eye that is where the whole plan is seen would move with the opening angle: it stays where the picture has it.
 * @param {object|undefined} beam of the document @param {object|null} line the beam shown
 */
export function ownBeam(beam, header, line) {
  if (!line || !header || header.pixels_per_mm > 0 || (beam?.along_mm ?? null) !== null) return beam ?? {};
  return { ...beam, along_mm: alongOf(line, eyeOf(header.clip_from_lps_mm)) };
}

/** A view's camera with the plan's home camera in place of missing fields. */
export const wholeCamera = (document, plan) => completeCamera(document.camera, homeCamera(plan, document.kind));
