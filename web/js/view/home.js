// The home camera of each kind of view: the whole plan, or whole slices. A camera in the plan's description comes first.
import { planes } from './camera.js';
import { add, dot, scale, subtract, unit, cross } from './vec.js';

const fovDeg = 30;
// From the front, towards the patient's left, from above: the same numbers as in core/scene/camera.c.
const turnDeg = 30;
const riseDeg = 12;
const margin = 1.08;
const sliceDistanceMm = 1000;

const radians = (deg) => deg * (Math.PI / 180);
const diagonal = ({ low, high }) => Math.hypot(...subtract(high, low));

/** From the target to the eye, of unit length. */
function homeDirection() {
  const turn = radians(turnDeg), rise = radians(riseDeg);
  return [Math.cos(rise) * Math.sin(turn), -Math.cos(rise) * Math.cos(turn), Math.sin(rise)];
}

/** Where every corner of a box around the target lies within the opening angle. */
function homeDistance(extent, back) {
  const slope = Math.tan(radians(fovDeg / 2)) / margin;
  const right = unit(cross([0, 0, 1], back)), up = cross(back, right);
  const signs = [-0.5, 0.5];
  const corners = signs.flatMap((x) => signs.flatMap((y) => signs.map((z) => [x * extent[0], y * extent[1], z * extent[2]])));
  return Math.max(1, ...corners.map((d) => Math.max(Math.abs(dot(d, right)), Math.abs(dot(d, up))) / slope + dot(d, back)));
}

/** @param {ReturnType<import('../state/plan.js').readPlan>|null} plan */
export function homeCamera(plan, kind) {
  const given = plan?.home[kind];
  if (given?.position_mm && given.target_mm && given.up) return { height_mm: null, ...given };
  const nowhere = { low: [-100, -100, -100], high: [100, 100, 100] };
  const regions = plan?.bounds ?? nowhere, image = plan?.images[0]?.bounds ?? regions;
  // a lesion without the head around it: the image shows where in the body it is
  const { low, high } = kind !== '3d' || diagonal(regions) < 0.5 * diagonal(image) ? image : regions;
  const target_mm = scale(add(low, high), 0.5);
  const extent = subtract(high, low);
  if (kind === '3d') {
    const back = homeDirection();
    return { position_mm: add(target_mm, scale(back, homeDistance(extent, back))), target_mm, up: [0, 0, 1], projection: 'perspective', fov_deg: fovDeg, height_mm: null };
  }
  const { right, up } = planes[kind];
  const forward = unit(cross(up, right));
  return {
    position_mm: subtract(target_mm, scale(forward, sliceDistanceMm)),
    target_mm,
    up: [...up],
    projection: 'parallel',
    fov_deg: fovDeg,
    height_mm: margin * Math.max(Math.abs(dot(extent, right)), Math.abs(dot(extent, up))),
  };
}
