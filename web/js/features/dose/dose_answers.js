// The server's answers to dvh, profile and constraints (proto/packets.json), in the form that the plots draw.
import { figureNames, withSums } from './dose_dvh.js';
import { say } from './data_words.js';

/** Least and most of a figure; one that is known has one value. */
function boundsOf(row, read) {
  const value = read(row);
  if (Number.isFinite(value)) return [value, value];
  const [least, most] = [row.least && read(row.least), row.most && read(row.most)];
  return Number.isFinite(least) ? [least, most ?? Infinity] : [NaN, NaN];
}

const finite = (value) => (Number.isFinite(value) ? value : NaN);

/** Reads the curves of the dose shown and of the one that it is compared with. @returns {DvhAnswer}
 *  @typedef {{unit: string, quantity: string, method: string, missing: string[], reason: string, per: string, left: {region: string, reason: string}[], curves: import('./dose_dvh.js').DvhCurve[]}} DvhAnswer
 *  left: regions without a curve of the dose shown. */
export function readDvh(answer) {
  const rows = answer.without_curves ?? [];
  const without = rows
    .filter(({ region }) => !region)
    .map(({ dose, reason }) => `${dose}: ${reason}`)
    .join('. ');
  return {
    unit: answer.curves[0]?.unit ?? answer.unit ?? '',
    quantity: answer.curves[0]?.quantity ?? answer.quantity ?? '',
    method: answer.method ?? '',
    missing: answer.missing ?? [],
    reason: without || answer.reason || '',
    per: answer.per ?? '',
    left: rows.filter(({ region, dose }) => region && dose === answer.id).map(({ region, reason }) => ({ region, reason })),
    curves: answer.curves.map((row) =>
      withSums({
        region: row.region,
        dose: row.dose,
        of: row.dose === answer.id ? 0 : 1,
        volume: row.volume_cm3,
        cm3: row.volume_cm3 - row.missing_cm3,
        missing: row.missing_cm3,
        univels: row.n_univels,
        isPartial: row.is_partial === true,
        population: row.population ?? '',
        basis: row.basis ?? '',
        high: finite(row.least?.max ?? row.max),
        figures: Object.fromEntries([
          ...['min', 'mean', 'max'].map((name) => [name, boundsOf(row, (of) => of[name])]),
          ...figureNames.map((name) => [name, boundsOf(row, (of) => of.metrics?.[name])]),
        ]),
        conformity: row.conformity ?? [],
        from: row.bin_from,
        width: row.bin_width,
        counts: row.counts_cm3,
      }),
    ),
  };
}

/** Curves in another unit than the scene's quantity are kept apart: they have no place on its axis. isFromEntry, of the page: depths
 *  count from where the line enters the body. @returns {import('./dose_profile.js').Profile} */
export function readProfile(answer) {
  const unit = answer.unit ?? '';
  const curves = answer.reason
    ? []
    : answer.curves.map(({ quantity, unit: own, values, physical, physical_unit: physicalUnit }) => ({
        quantity,
        unit: own,
        values,
        physical,
        physicalUnit,
      }));
  const zero = (answer.isFromEntry && answer.entry_mm) || 0;
  const depthOf = (mm) => (Number.isFinite(mm) ? mm - zero : null);
  const entry = depthOf(answer.entry_mm);
  return {
    unit,
    quantity: answer.quantity ?? '',
    method: answer.method ?? '',
    missing: answer.missing ?? [],
    per: answer.per ?? '',
    reason: answer.reason ?? '',
    zero,
    depths: answer.depths_mm.map(depthOf),
    curves: curves.filter((curve) => curve.unit === unit),
    others: curves.filter((curve) => curve.unit !== unit),
    bands: answer.bands.map(({ region, from_mm: from, to_mm: to }) => ({ region, from: depthOf(from), to: depthOf(to) })),
    entry,
    peak: answer.peak ? { depth: depthOf(answer.peak.depth_mm), value: answer.peak.value } : null,
    advantage: depthOf(answer.advantage_mm),
    advantageReason: answer.advantage?.reason ?? '',
    references: answer.references.map(({ id, name, quantity, unit: own, per, radius_mm: radius, depths_mm: depths, values }) => ({
      name: radius ? say.offAxis({ curve: name || id, mm: radius }) : name || id,
      quantity,
      unit: own,
      per,
      depths: depths.map((depth) => depth + (entry ?? 0)),
      values,
    })),
    doubts: answer.notes.filter((note) => !/^Reference curves/.test(note)),
    notes: answer.notes,
  };
}
