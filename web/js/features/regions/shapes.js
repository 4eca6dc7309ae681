// The representations of a region, and the queries for their figures.

/** @type {[string, string, string][]} word, name, description */
export const representations = [
  ['surface', 'Surface', 'Triangles, by the surface algorithm'],
  ['univels', 'Univels', 'Boxes of true size, as a Monte Carlo code sees them'],
  ['outline', 'Outlines', 'Traced around the region, slice by slice'],
  ['points', 'Points', 'A point for every univel of the border'],
  ['solid', 'Solid', 'Points that cover their univel, shaded in advance'],
  ['nurbs', 'NURBS', 'A spline surface through samples of the outlines'],
  ['fan', 'Fan', 'Triangles between neighbouring border univels'],
];

export const algorithms = [
  ['smooth', 'Smooth', 'Without stair steps, nowhere further from the univels than a stated distance'],
  ['marching-cubes', 'Cubes', 'Marching cubes: midway between inside and outside'],
  ['eight-cell', '8-cell', 'Through the centres of the outermost univels'],
];

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

/** Every method worth comparing, with its query. @returns {{name: string, query: Record<string, string>}[]} */
export function methods(scene) {
  const nurbs = (order, sampling) => ({ representation: 'nurbs', order: String(order), sampling, bins: String(scene.nurbs.bins) });
  return [
    { name: 'Surface, smooth', query: { representation: 'surface', algorithm: 'smooth' } },
    { name: 'Surface, marching cubes', query: { representation: 'surface', algorithm: 'marching-cubes' } },
    { name: 'Surface, 8-cell', query: { representation: 'surface', algorithm: 'eight-cell' } },
    { name: 'Univels', query: { representation: 'univels' } },
    { name: 'Fan', query: { representation: 'fan' } },
    { name: 'NURBS, linear, traces', query: nurbs(2, 'traces') },
    { name: 'NURBS, quadratic, traces', query: nurbs(3, 'traces') },
    { name: 'NURBS, cubic, traces', query: nurbs(4, 'traces') },
    { name: 'NURBS, cubic, degree bins', query: nurbs(4, 'degree-bins') },
    { name: 'Outlines, traced', query: { representation: 'outline', outline: 'traced' } },
    { name: 'Outlines, marching squares', query: { representation: 'outline', outline: 'marching-squares' } },
    { name: 'Points', query: { representation: 'points', inner_boundary: 'false' } },
    { name: 'Points, inner boundary too', query: { representation: 'points', inner_boundary: 'true' } },
    { name: 'Solid', query: { representation: 'solid', inner_boundary: 'false' } },
  ];
}

/** Difference to the univels' volume, "+0.31 %"; a dash for a shape that encloses no volume. */
export function volumeDifference({ volume_mm3: volume, univel_volume_mm3: univels }) {
  return Number.isFinite(volume) && univels > 0 ? (100 * (volume - univels)) / univels : NaN;
}

/** The table of figures; units are in the heading. */
export function figureRows(rows) {
  const columns = [
    'triangles',
    'vertices',
    'lines',
    'points',
    'ms',
    'draw_ms',
    'frames_per_second',
    'area_mm2',
    'volume_mm3',
    'univel_volume_mm3',
    'distance_mean_mm',
    'distance_max_mm',
  ];
  return [
    ['region', 'method', ...columns, 'refused'],
    ...rows.map(({ region, name, result, error }) => [region, name, ...columns.map((column) => result?.[column]), error]),
  ];
}
