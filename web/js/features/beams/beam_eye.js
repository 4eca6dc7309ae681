// The camera of a beam's-eye view: where its eye is, what it shows, and the patches that change it. Pure; LPS, mm. The server's side is core/scene/camera.c.
import { add, dot, scale, subtract } from '../../parts/vec.js';
import { beamPlane, beamPoint } from '../../room/beam_line.js';
import { firstImage } from '../../room/plan.js';

const margin = 1.08; // home_margin
const usualFovDeg = 30; // scene.json
const [leastFovDeg, mostFovDeg, leastMm, mostMm] = [1, 120, 1, 10000];
const nearestMm = 5; // of the eye before the target, for the target to be what the 3-D camera turns about
const degrees = Math.PI / 180;
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
const rounded = (value) => Math.round(value * 1000) / 1000 || 0;
const slope = (fovDeg) => Math.tan((fovDeg / 2) * degrees);
const angleOf = (tangent) => clamp((2 * Math.atan(tangent)) / degrees, leastFovDeg, mostFovDeg);

const ringRoom = 1.25; // extent of the picture over the ring's diameter, at least
export const usualRingMm = 100; // where the beam has no aperture

const fovOf = (view) => view.camera?.fov_deg ?? usualFovDeg;
/** With a ring it always is. */
export const isParallel = (view) => (view.beam?.aperture_mm ?? null) !== null || view.camera?.projection === 'parallel';

const diagonal = ({ low, high }) => Math.hypot(...high.map((value, axis) => value - low[axis]));

/** The box that the home camera frames: that of the regions, of the first image where that is more than twice as long. */
function homeBox(plan) {
  const image = firstImage(plan)?.bounds ?? plan.bounds;
  return diagonal(plan.bounds) < 0.5 * diagonal(image) ? image : plan.bounds;
}

/** So far before the target that the whole plan is seen. */
function homeMm(plan, beam, fovDeg) {
  const { right, up, normal } = beamPlane(beam, beam.length);
  const { low, high } = homeBox(plan);
  const distances = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => {
    const d = subtract(
      low.map((value, axis) => ((corner >> axis) & 1 ? high[axis] : value)),
      beam.target,
    );
    return Math.max(Math.abs(dot(d, right)), Math.abs(dot(d, up))) * (margin / slope(fovDeg)) + dot(d, normal);
  });
  return Math.max(1, ...distances);
}

/** The eye's place on the beam. */
export const eyeAlong = (plan, beam, view) => view.beam?.along_mm ?? beam.length - homeMm(plan, beam, fovOf(view));

/** The extent at the target across the smaller side of the picture; of perspective 0 where the target lies behind the eye. */
function extentMm(plan, beam, view) {
  const fov = fovOf(view);
  if (!isParallel(view)) return 2 * Math.max(0, beam.length - eyeAlong(plan, beam, view)) * slope(fov);
  return view.camera?.height_mm ?? 2 * homeMm(plan, beam, fov) * slope(fov);
}

/** The patch that zooms in by a factor above 1; the eye stays. */
export function zoomedEye(plan, beam, view, factor) {
  if (isParallel(view)) return { camera: { height_mm: clamp(extentMm(plan, beam, view) / factor, leastMm, mostMm) } };
  return { camera: { fov_deg: angleOf(slope(fovOf(view)) / factor) }, beam: { along_mm: rounded(eyeAlong(plan, beam, view)) } };
}

/** The patch that sets the ring's diameter, null for none. Switching it changes the projection, and the target keeps its size where the ring has room then. */
export function ringPatch(plan, beam, view, diameterMm) {
  const beamPatch = { aperture_mm: diameterMm };
  const was = isParallel(view);
  const is = isParallel({ ...view, beam: { ...view.beam, ...beamPatch } });
  if (was === is) return { beam: beamPatch };
  const extent = extentMm(plan, beam, view);
  if (is) return { beam: beamPatch, camera: { height_mm: clamp(Math.max(extent, ringRoom * diameterMm), leastMm, mostMm) } };
  const eye = eyeAlong(plan, beam, view);
  const camera =
    beam.length - eye > nearestMm ? { fov_deg: angleOf(extent / 2 / (beam.length - eye)), height_mm: null } : { height_mm: null };
  return { beam: { ...beamPatch, along_mm: rounded(eye) }, camera };
}

/** The whole plan again; ring and projection stay. */
const homeEye = () => ({ camera: { fov_deg: usualFovDeg, height_mm: null }, beam: { along_mm: null } });

const [filled, aroundMm] = [0.7, 60]; // part of the picture's smaller side; about the axis, without a ring

/** The diameter of what the first picture is fitted to: the ring, else the regions as far as they lie within 60 mm of the axis. */
function fittedMm(plan, beam, view) {
  const ring = view.beam?.aperture_mm ?? null;
  if (ring !== null) return ring;
  const { right, up } = beamPlane(beam, beam.length);
  const { low, high } = plan.bounds;
  const reach = [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => {
    const d = subtract(
      low.map((value, axis) => ((corner >> axis) & 1 ? high[axis] : value)),
      beam.target,
    );
    return Math.hypot(dot(d, right), dot(d, up));
  });
  return 2 * Math.min(aroundMm, Math.max(...reach));
}

/** The camera that a beam's-eye view starts with: the ring, or the regions about the axis, fills 70 % of the smaller side. Ring and projection stay. */
export function fittedEye(plan, beam, view) {
  const home = { ...view, camera: { ...view.camera, ...homeEye().camera }, beam: { ...view.beam, ...homeEye().beam } };
  const zoomed = zoomedEye(plan, beam, home, extentMm(plan, beam, home) / (fittedMm(plan, beam, view) / filled));
  return { camera: { ...homeEye().camera, ...zoomed.camera }, beam: { ...homeEye().beam, ...zoomed.beam } };
}

/** True for a view whose camera nobody has moved. */
export const isUntouched = (view) =>
  (view.camera?.height_mm ?? null) === null && fovOf(view) === usualFovDeg && (view.beam?.along_mm ?? null) === null;

/** The camera of a 3-D view with the same picture: it turns about the beam's target, about a point before the eye where that is behind it. */
export function cameraAsSeen(plan, beam, view) {
  const eye = eyeAlong(plan, beam, view);
  const position_mm = beamPoint(beam, eye);
  const parallel = isParallel(view);
  const away = beam.length - eye >= nearestMm ? beam.length - eye : 100;
  return {
    position_mm,
    target_mm: add(position_mm, scale(beam.direction, away)),
    up: beamPlane(beam, 0).up,
    projection: parallel ? 'parallel' : 'perspective',
    fov_deg: fovOf(view),
    height_mm: parallel ? extentMm(plan, beam, view) : null,
  };
}
