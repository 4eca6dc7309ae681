// Cameras: position, target and up direction in patient LPS mm. Pure functions that return new cameras.
import { add, cross, dot, length, rotate, scale, subtract, unit } from './vec.js';

const superior = [0, 0, 1];
const minDistanceMm = 5;
const maxDistanceMm = 20000;
const minHeightMm = 1;
const maxHeightMm = 10000;
const degrees = Math.PI / 180;
const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** For each slice pane: right and up of the picture in LPS, and the axis across the slice. */
export const planes = {
  axial: { right: [1, 0, 0], up: [0, -1, 0], axis: 2, letter: 'S' },
  coronal: { right: [1, 0, 0], up: [0, 0, 1], axis: 1, letter: 'P' },
  sagittal: { right: [0, 1, 0], up: [0, 0, 1], axis: 0, letter: 'L' },
};

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

export function panSlice(camera, kind, dxPx, dyPx, sizePx) {
  const { right, up } = planes[kind];
  return shift(camera, right, up, dxPx, dyPx, sliceHeight(camera) / Math.min(...sizePx));
}

export const sliceHeight = (camera) => camera.height_mm || heightAtTarget(camera);

/** Zooms so that the point at x, y px from the picture's middle (y down) stays where it is. */
export function zoomSlice(camera, kind, factor, [x, y], sizePx) {
  const height_mm = clamp(sliceHeight(camera) / factor, minHeightMm, maxHeightMm);
  const gainedMm = (sliceHeight(camera) - height_mm) / Math.min(...sizePx);
  const { right, up } = planes[kind];
  return { ...shift(camera, right, up, -x, -y, gainedMm), height_mm };
}

/** "perspective, 56° from anterior": the angle of the eye about the patient's long axis. */
export function describe(camera) {
  const { forward } = axes(camera);
  const elevation = Math.asin(clamp(-forward[2], -1, 1)) / degrees;
  if (elevation > 89) return `${camera.projection}, from superior`;
  if (elevation < -89) return `${camera.projection}, from inferior`;
  const turned = Math.round(Math.abs(Math.atan2(-forward[0], forward[1]) / degrees));
  const side = { 0: 'from anterior', 180: 'from posterior' }[turned];
  if (side) return `${camera.projection}, ${side}`;
  return `${camera.projection}, ${turned}° ${forward[0] < 0 ? 'left' : 'right'} of anterior`;
}
