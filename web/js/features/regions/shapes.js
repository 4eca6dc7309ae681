// The queries for the figures of a region's representations.

/** The query of the surface call: everything in this scene that decides a region's shape. */
export function shapeQuery(scene, representation) {
  switch (representation) {
    case 'surface':
      return { representation, algorithm: scene.surface.algorithm };
    case 'outline':
      return { representation, outline: scene.outline.method === 'marching-squares' ? 'marching-squares' : 'traced' };
    case 'points':
    case 'solid':
      return { representation, inner_boundary: String(scene.points.inner_boundary) };
    case 'nurbs':
      return { representation, order: String(scene.nurbs.order), sampling: scene.nurbs.sampling, bins: String(scene.nurbs.bins) };
    default:
      return { representation };
  }
}

/** True for representations that can be saved as a file for other programs. */
export const isExportable = (representation) => ['surface', 'univels', 'nurbs', 'fan'].includes(representation);

/** Difference to the univels' volume, "+0.31 %"; a dash for a shape that encloses no volume. */
export function volumeDifference({ volume_mm3: volume, univel_volume_mm3: univels }) {
  return Number.isFinite(volume) && univels > 0 ? (100 * (volume - univels)) / univels : NaN;
}
