// The representations of a region and the surface algorithms by name, every method worth comparing, and the table of their figures.
import { say } from './method_words.js';

/** @type {[string, string, string][]} word, name, description */
export const representations = [
  ['surface', say.surface, say.surfaceIs],
  ['univels', say.univels, say.univelsIs],
  ['outline', say.outlines, say.outlinesIs],
  ['points', say.points, say.pointsIs],
  ['solid', say.solid, say.solidIs],
  ['nurbs', say.nurbs, say.nurbsIs],
  ['fan', say.fan, say.fanIs],
];

export const algorithms = [
  ['smooth', say.smooth, say.smoothIs],
  ['marching-cubes', say.cubes, say.cubesIs],
  ['eight-cell', say.eightCell, say.eightCellIs],
];

/** Every method worth comparing, with its query. @returns {{name: string, query: Record<string, string>}[]} */
export function methods(scene) {
  const nurbs = (order, sampling) => ({ representation: 'nurbs', order: String(order), sampling, bins: String(scene.nurbs.bins) });
  return [
    { name: say.ofSmooth, query: { representation: 'surface', algorithm: 'smooth' } },
    { name: say.ofCubes, query: { representation: 'surface', algorithm: 'marching-cubes' } },
    { name: say.ofEightCell, query: { representation: 'surface', algorithm: 'eight-cell' } },
    { name: say.ofUnivels, query: { representation: 'univels' } },
    { name: say.ofFan, query: { representation: 'fan' } },
    { name: say.ofLinear, query: nurbs(2, 'traces') },
    { name: say.ofQuadratic, query: nurbs(3, 'traces') },
    { name: say.ofCubic, query: nurbs(4, 'traces') },
    { name: say.ofDegreeBins, query: nurbs(4, 'degree-bins') },
    { name: say.ofTraced, query: { representation: 'outline', outline: 'traced' } },
    { name: say.ofSquares, query: { representation: 'outline', outline: 'marching-squares' } },
    { name: say.ofPoints, query: { representation: 'points', inner_boundary: 'false' } },
    { name: say.ofInnerPoints, query: { representation: 'points', inner_boundary: 'true' } },
    { name: say.ofSolid, query: { representation: 'solid', inner_boundary: 'false' } },
  ];
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
