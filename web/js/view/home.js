// The home camera of each kind of view: the whole plan, or whole slices. A camera in the plan's description comes first.
import { planes } from './camera.js';
import { add, dot, scale, subtract, unit, cross } from './vec.js';

const fovDeg = 30;
const margin = 1.08;
const sliceDistanceMm = 1000;

/** @param {ReturnType<import('../state/plan.js').readPlan>|null} plan */
export function homeCamera(plan, kind) {
  const given = plan?.home[kind];
  if (given?.position_mm && given.target_mm && given.up) return { height_mm: null, ...given };
  const { low, high } = (kind !== '3d' && plan?.images[0]?.bounds) || plan?.bounds || { low: [-100, -100, -100], high: [100, 100, 100] };
  const target_mm = scale(add(low, high), 0.5);
  const extent = subtract(high, low);
  if (kind === '3d') {
    // far enough that the nearer corners of the box are within the opening angle
    const slope = Math.tan((fovDeg / 2) * (Math.PI / 180)) / margin;
    const distance = Math.max(extent[0], extent[2]) / 2 / slope + extent[1] / 2;
    return { position_mm: add(target_mm, [0, -distance, 0]), target_mm, up: [0, 0, 1], projection: 'perspective', fov_deg: fovDeg, height_mm: null };
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
