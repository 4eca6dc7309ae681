// Cameras: position, target and up direction in patient LPS mm. Pure functions that return new cameras.
import { add, cross, dot, length, rotate, scale, subtract, unit } from '../parts/vec.js';
import { say } from './words.js';

const superior = [0, 0, 1];
const minDistanceMm = 5;
const maxDistanceMm = 20000;
const minHeightMm = 1;
const maxHeightMm = 10000;
const degrees = Math.PI / 180;
const leastTurning = 0.2; // sine of the angle between an axis and the line of sight
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** Directions to look from, with the up direction of each. */
export const presets = {
  anterior: { from: [0, -1, 0], up: superior },
  posterior: { from: [0, 1, 0], up: superior },
  left: { from: [1, 0, 0], up: superior },
  right: { from: [-1, 0, 0], up: superior },
  superior: { from: [0, 0, 1], up: [0, -1, 0] },
  inferior: { from: [0, 0, -1], up: [0, -1, 0] },
};

/** A document's camera, with missing fields from the plan's home camera. */
export function completeCamera(camera, home) {
  const result = { projection: 'perspective', fov_deg: 30, height_mm: null, ...home };
  for (const [name, value] of Object.entries(camera ?? {})) if (value !== null && value !== undefined) result[name] = value;
  // height null has a meaning: as much as perspective shows
  if (camera?.position_mm && camera.height_mm === null) result.height_mm = null;
  return result;
}

export const distance = (camera) => length(subtract(camera.position_mm, camera.target_mm));

/** Unit vectors right, up and forward of the picture. */
export function axes(camera) {
  const forward = unit(subtract(camera.target_mm, camera.position_mm));
  const right = unit(cross(forward, camera.up));
  return { right, up: cross(right, forward), forward };
}

/** Turns around the target: yaw about the patient's long axis, pitch about the picture's right, never over a pole. */
export function orbit(camera, yawDeg, pitchDeg) {
  const { right, up, forward } = axes(camera);
  const elevation = Math.asin(clamp(-dot(forward, superior), -1, 1)) / degrees;
  const pitch = clamp(elevation + pitchDeg, -90, 90) - elevation;
  const turn = (vector) => rotate(rotate(vector, right, -pitch * degrees), superior, yawDeg * degrees);
  const offset = turn(scale(forward, -distance(camera)));
  return { ...camera, position_mm: add(camera.target_mm, offset), up: unit(turn(up)) };
}

/** Turns around the target about one axis of the patient, so that what faces the viewer goes with the drag as far as it can. */
export function orbitAbout(camera, axis, yawDeg, pitchDeg) {
  const { right, up, forward } = axes(camera);
  const moved = cross(axis, scale(forward, -1)); // how what faces the viewer moves
  const [x, y] = [dot(moved, right), dot(moved, up)];
  const size = Math.hypot(x, y);
  const angle = size > leastTurning ? (yawDeg * x + pitchDeg * y) / size : yawDeg; // seen along the axis: by the drag's width
  return turned(camera, axis, angle);
}

/** Turns around the target about an axis in the patient. */
export function turned(camera, axis, angleDeg) {
  const turn = (vector) => rotate(vector, axis, angleDeg * degrees);
  return { ...camera, position_mm: add(camera.target_mm, turn(subtract(camera.position_mm, camera.target_mm))), up: unit(turn(camera.up)) };
}

/** Turns the picture about the line of sight. */
export function roll(camera, angleDeg) {
  const { up, forward } = axes(camera);
  return { ...camera, up: unit(rotate(up, forward, angleDeg * degrees)) };
}

/** Millimetres per pixel at the target; opening angle and height are those of the smaller side. */
export function mmPerPixel(camera, [width, height]) {
  const across = camera.projection === 'parallel' && camera.height_mm ? camera.height_mm : heightAtTarget(camera);
  return across / Math.min(width, height);
}

export const heightAtTarget = (camera) => 2 * distance(camera) * Math.tan((camera.fov_deg * degrees) / 2);

/** Moves the point under the pointer along with it. */
export function pan(camera, dxPx, dyPx, sizePx) {
  const { right, up } = axes(camera);
  return shift(camera, right, up, dxPx, dyPx, mmPerPixel(camera, sizePx));
}

function shift(camera, right, up, dxPx, dyPx, mm) {
  const move = add(scale(right, -dxPx * mm), scale(up, dyPx * mm));
  return { ...camera, position_mm: add(camera.position_mm, move), target_mm: add(camera.target_mm, move) };
}

/** Zooms in by a factor above 1, out by one below. */
export function zoom(camera, factor) {
  const now = distance(camera);
  const next = clamp(now / factor, minDistanceMm, maxDistanceMm);
  const offset = scale(subtract(camera.position_mm, camera.target_mm), next / now);
  const height_mm = camera.height_mm ? clamp(camera.height_mm / factor, minHeightMm, maxHeightMm) : camera.height_mm;
  return { ...camera, position_mm: add(camera.target_mm, offset), height_mm };
}

export function lookFrom(camera, name) {
  const { from, up } = presets[name];
  return { ...camera, position_mm: add(camera.target_mm, scale(from, distance(camera))), up: [...up] };
}

/** Changes the projection so that the picture at the target keeps its size. */
export function project(camera, projection) {
  if (projection === camera.projection) return camera;
  if (projection === 'parallel') return { ...camera, projection, height_mm: heightAtTarget(camera) };
  const wanted = camera.height_mm ? distance(camera) * (camera.height_mm / heightAtTarget(camera)) : distance(camera);
  const offset = scale(unit(subtract(camera.position_mm, camera.target_mm)), clamp(wanted, minDistanceMm, maxDistanceMm));
  return { ...camera, projection, height_mm: null, position_mm: add(camera.target_mm, offset) };
}

// ---- slice panes: always parallel, only target and height count --------------------------------------------------------

/** @param {import('./obliques.js').Plane} plane of the pane */
export function panSlice(camera, { right, up }, dxPx, dyPx, sizePx) {
  return shift(camera, right, up, dxPx, dyPx, sliceHeight(camera) / Math.min(...sizePx));
}

export const sliceHeight = (camera) => camera.height_mm || heightAtTarget(camera);

/** Zooms so that the point at x, y px from the picture's middle (y down) stays where it is. */
export function zoomSlice(camera, { right, up }, factor, [x, y], sizePx) {
  const height_mm = clamp(sliceHeight(camera) / factor, minHeightMm, maxHeightMm);
  const gainedMm = (sliceHeight(camera) - height_mm) / Math.min(...sizePx);
  return { ...shift(camera, right, up, -x, -y, gainedMm), height_mm };
}

// ---- framing, and moving several panes together -----------------------------------------------------------------------

const margin = 1.08; // extent of the picture over that of the box
const corners = ({ low, high }) => [0, 1, 2, 3, 4, 5, 6, 7].map((at) => low.map((value, axis) => ((at >> axis) & 1 ? high[axis] : value)));
const middleOf = ({ low, high }) => scale(add(low, high), 0.5);

/** Looks at a box from the same side, as near as shows all of it. @param {{low: number[], high: number[]}} box */
export function fit(camera, box) {
  const { right, up, forward } = axes(camera);
  const target_mm = middleOf(box);
  const slope = Math.tan((camera.fov_deg * degrees) / 2) / margin;
  const offsets = corners(box).map((corner) => subtract(corner, target_mm));
  const across = (offset) => Math.max(Math.abs(dot(offset, right)), Math.abs(dot(offset, up)));
  const away = clamp(Math.max(...offsets.map((offset) => across(offset) / slope - dot(offset, forward))), minDistanceMm, maxDistanceMm);
  const height_mm =
    camera.projection === 'parallel' ? clamp(2 * margin * Math.max(...offsets.map(across)), minHeightMm, maxHeightMm) : null;
  return { ...camera, target_mm, position_mm: subtract(target_mm, scale(forward, away)), height_mm };
}

/** Fits a slice pane's camera to the box. */
export function fitSlice(camera, { right, up }, box) {
  const target_mm = middleOf(box);
  const across = corners(box)
    .map((corner) => subtract(corner, target_mm))
    .map((offset) => Math.max(Math.abs(dot(offset, right)), Math.abs(dot(offset, up))));
  return {
    ...camera,
    position_mm: add(camera.position_mm, subtract(target_mm, camera.target_mm)),
    target_mm,
    height_mm: clamp(2 * margin * Math.max(...across), minHeightMm, maxHeightMm),
  };
}

const keptInside = 0.45; // of the picture's smaller side: as far from the middle as the crosshair may come

/**
 * The camera of another slice pane that is to go with this one: as many mm per pixel, and the crosshair as far right of and above the
 * middle, in mm, as far as it stays in the picture.
 * @param {object} camera @param {object} plane @param {number[]} sizePx of the pane that leads @param {object} other its camera
 * @param {object} otherPlane @param {number[]} otherPx @param {number[]} crosshair
 */
export function linkedSlice(camera, plane, sizePx, other, otherPlane, otherPx, crosshair) {
  const height_mm = clamp((sliceHeight(camera) * Math.min(...otherPx)) / Math.min(...sizePx), minHeightMm, maxHeightMm);
  const offset = subtract(crosshair, camera.target_mm);
  const [right, up] = [plane.right, plane.up].map((axis) => clamp(dot(offset, axis), -keptInside * height_mm, keptInside * height_mm));
  const target_mm = subtract(crosshair, add(scale(otherPlane.right, right), scale(otherPlane.up, up)));
  return { ...other, position_mm: add(other.position_mm, subtract(target_mm, other.target_mm)), target_mm, height_mm };
}

/** "perspective, 56° from anterior": the angle of the eye about the patient's long axis. */
export function describe(camera) {
  const { forward } = axes(camera);
  const elevation = Math.asin(clamp(-forward[2], -1, 1)) / degrees;
  const projection = camera.projection === 'parallel' ? say.parallel : say.perspective;
  if (elevation > 89) return say.fromSuperior({ projection });
  if (elevation < -89) return say.fromInferior({ projection });
  const turned = Math.round(Math.abs(Math.atan2(-forward[0], forward[1]) / degrees));
  const words = { 0: say.fromAnterior, 180: say.fromPosterior }[turned] ?? (forward[0] < 0 ? say.leftOfAnterior : say.rightOfAnterior);
  return words({ projection, n: turned });
}
