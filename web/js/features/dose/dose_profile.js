// Doses along a line as the page needs them: which lines there are, what is read off the curves, and the files that carry them.
import { csvText } from '../../parts/csv.js';
import { say } from './data_words.js';

/**
 * @typedef {object} Line a beam, from its entry to its target and on, or a distance measure
 * @property {string} key "beam beam-1", "measure a" @property {string} name @property {'beam'|'measure'} kind @property {string} id @property {number[]} from @property {number[]} to LPS mm
 *
 * @typedef {object} Profile
 * @property {string} unit @property {number} zero mm from the line's first point to where depths count from: to the body for a beam, 0 for a measure @property {number[]} depths mm
 * @property {{quantity: string, unit: string, values: (number|null)[], physical: (number|null)[]|null, physicalUnit: string|null}[]} curves in the unit; null: no value there; the
 *   first one is that of the scene's quantity; of a weighted dose a component is its part of the sum, and physical without the weight
 * @property {object[]} others the same in other units
 * @property {{region: string, from: number, to: number}[]} bands
 * @property {number|null} entry where the line enters the body @property {{depth: number, value: number}|null} peak @property {number|null} advantage @property {string} advantageReason why there is none
 * @property {{name: string, quantity: string, unit: string, per: string, depths: number[], values: (number|null)[]}[]} references curves of a phantom, their depths from the entry on
 * @property {string[]} doubts whether the dose belongs to the image @property {string[]} notes these and what is to be said of the references
 */

/** Colours and dashes of the components, css px. */
export const looks = {
  weighted: { color: '#f4f6f8', dash: [], name: say.total },
  total: { color: '#f4f6f8', dash: [], name: say.total },
  'weighted-total': { color: '#f4f6f8', dash: [], name: say.total },
  isoeffective: { color: '#f4f6f8', dash: [], name: say.isoeffective },
  boron: { color: '#c58bff', dash: [], name: say.boron },
  'blood-boron': { color: '#c58bff', dash: [1, 3], name: say.bloodBoron },
  gamma: { color: '#58cfc3', dash: [7, 3], name: say.gamma },
  nitrogen: { color: '#c3cc55', dash: [2, 3], name: say.nitrogen },
  fast: { color: '#a3b1c6', dash: [8, 3, 2, 3], name: say.fast },
  other: { color: '#d9a27f', dash: [4, 2], name: say.other },
};
export const lookOf = (quantity) => looks[quantity] ?? { color: '#b9c0c9', dash: [], name: quantity.replaceAll('-', ' ') };

/** @returns {Line[]} */
export function linesOf(plan, scene) {
  const beams = (plan?.beams ?? []).map((beam) => ({
    key: `beam ${beam.id}`,
    kind: 'beam',
    id: beam.id,
    name: beam.name || beam.id,
    from: beam.entry_mm,
    to: beam.target_mm,
  }));
  const distances = Object.entries(scene?.measures ?? {}).filter(([, { kind, points }]) => kind === 'distance' && points.length === 2);
  return [
    ...beams,
    ...distances.map(
      ([
        id,
        {
          name,
          points: [a, b],
        },
      ]) => ({ key: `measure ${id}`, kind: 'measure', id, name: name || say.distance, from: a.at_mm, to: b.at_mm }),
    ),
  ].filter(({ from, to }) => Math.hypot(...from.map((mm, axis) => to[axis] - mm)) > 1e-6);
}

const direction = ({ from, to }) => {
  const d = from.map((mm, axis) => to[axis] - mm);
  const length = Math.hypot(...d);
  return d.map((mm) => mm / length);
};

/** The depth of a point along a line, and how far beside the line it is. */
export function depthOf(line, point) {
  const d = direction(line);
  const r = point.map((mm, axis) => mm - line.from[axis]);
  const depth = r.reduce((sum, mm, axis) => sum + mm * d[axis], 0);
  return { depth, asideMm: Math.hypot(...r.map((mm, axis) => mm - depth * d[axis])) };
}

export const pointAt = (line, depth) => direction(line).map((mm, axis) => line.from[axis] + depth * mm);

/** Linear between the points of a curve; null outside them, and beside a point without a value. */
export function valueAt(depths, values, depth) {
  if (!(depth >= depths[0] && depth <= depths.at(-1))) return null;
  const next = Math.max(
    1,
    depths.findIndex((mm) => mm >= depth),
  );
  const [a, b] = [values[next - 1], values[next]];
  if (a === null || b === null || !Number.isFinite(a) || !Number.isFinite(b)) return depth === depths[next] ? b : null;
  return a + ((b - a) * (depth - depths[next - 1])) / (depths[next] - depths[next - 1]);
}

/** Curves over one list of depths: those of the profile and, at depths of their own, references. */
export function aligned(profile, references = []) {
  if (!references.length) return { depths: profile.depths, lists: profile.curves.map(({ values }) => values) };
  const [low, high] = [profile.depths[0], profile.depths.at(-1)];
  const depths = [
    ...new Set([...profile.depths, ...references.flatMap((curve) => curve.depths.filter((depth) => depth >= low && depth <= high))]),
  ].sort((a, b) => a - b);
  return {
    depths,
    lists: [...profile.curves, ...references].map((curve) =>
      depths.map((depth) => valueAt(curve.depths ?? profile.depths, curve.values, depth)),
    ),
  };
}

/** Reference curves that have one axis: of the same file and unit. @returns {{key: string, name: string, unit: string, curves: object[]}[]} */
export function referenceGroups(references) {
  const groups = new Map();
  for (const curve of references) {
    const key = `${curve.name}\n${curve.unit}`;
    groups.set(key, { key, name: curve.name, unit: curve.unit, curves: [...(groups.get(key)?.curves ?? []), curve] });
  }
  return [...groups.values()];
}

export function profileCsv(profile, { words, regionName }) {
  const band = (depth) =>
    profile.bands
      .filter(({ from, to }) => depth >= from && depth <= to)
      .map(({ region }) => regionName(region))
      .reduce((one, two) => (one ? say.and({ one, two }) : two), '');
  const columns = [...profile.curves, ...profile.others].flatMap(({ quantity, unit, values, physical, physicalUnit }) => [
    { name: quantity, unit, values },
    ...(physical ? [{ name: say.csvWithoutWeight({ quantity }), unit: physicalUnit, values: physical }] : []),
  ]);
  return csvText([
    ...words.map(({ name, values }) => [name, ...values]),
    ...profile.notes.map((note) => [say.csvNote, note]),
    [],
    ...[
      [say.csvEntry, profile.entry],
      [say.csvPeak, profile.peak?.depth],
      [say.csvAdvantage, profile.advantage ?? profile.advantageReason],
    ],
    [],
    [say.csvDepth, ...columns.map(({ name, unit }) => `${name} (${unit})`), say.csvRegion],
    ...profile.depths.map((depth, index) => [depth, ...columns.map(({ values }) => values[index]), band(depth)]),
    ...profile.references.flatMap((curve) => [
      [],
      [say.csvPhantom({ curve: curve.name, quantity: curve.quantity })],
      [say.csvDepth, `${curve.quantity} (${curve.unit})`],
      ...curve.depths.map((depth, index) => [depth, curve.values[index]]),
    ]),
  ]);
}

export const profileJson = (profile, { words, regionName }) =>
  JSON.stringify(
    {
      ...Object.fromEntries(words.map(({ id, values }) => [id, values.join(', ')])),
      ...profile,
      bands: profile.bands.map((band) => ({ ...band, region_name: regionName(band.region) })),
    },
    null,
    1,
  );
