// The home camera of each kind of view: the whole plan, or whole slices. The server works it out (core/scene/camera.c) and draws by
// it what has no camera yet: only with the same numbers does the first touch not move the picture.
import { isInSpace } from './kinds.js';

const nowhere = {
  position_mm: [0, -1000, 0],
  target_mm: [0, 0, 0],
  up: [0, 0, 1],
  projection: 'perspective',
  fov_deg: 30,
  height_mm: null,
};

/** @param {ReturnType<import('./plan.js').readPlan>|null} plan null: none is loaded, and nothing is drawn */
export function homeCamera(plan, kind) {
  const home = plan?.home ?? {};
  const given = home[kind] ?? (kind === 'oblique' ? obliqueHome(home) : null);
  return given ? { height_mm: null, ...given } : { ...nowhere, ...(isInSpace(kind) ? {} : { projection: 'parallel', height_mm: 216 }) };
}

/** Only target and height count: as high as the highest of the three other panes, so that turning the plane changes no scale. */
function obliqueHome({ axial, coronal, sagittal }) {
  return axial && { ...axial, height_mm: Math.max(...[axial, coronal, sagittal].map((camera) => camera?.height_mm ?? 0)) };
}
