// A plan with three images of the demo head: a CT, an MR and a PET, each with a window of its own.
import { cpSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { demo } from '../api/daemon.mjs';

export const windows = { ct: { center: 40, width: 400 }, mr: { center: 50, width: 300 }, pet: { center: 500, width: 1000 } };
/** A histogram that the editor's axis is known for, instead of the server's. */
export const histogram = {
  low: -1000,
  high: 1800,
  counts: Array.from({ length: 280 }, (_, bin) => (bin === 0 ? 100000 : Math.round(500 * Math.exp(-(((bin - 105) / 20) ** 2))))),
  percentiles: { 0.1: -990, 1: -500, 50: 0, 99: 700, 99.9: 1200 },
};

/** Writes the plan into a folder of plans. @returns {string} its id */
export function writeThreeImages(folder) {
  const to = join(folder, 'three-images');
  mkdirSync(to);
  for (const file of ['ct.nii.gz', 'labels.nii.gz', 'labels.json']) cpSync(join(demo, 'phantom', file), join(to, file));
  const image = (id, modality, value_unit) => ({ id, path: 'ct.nii.gz', modality, value_unit, window: windows[id] });
  writeFileSync(
    join(to, 'plan.json'),
    JSON.stringify({
      format: 'beamroom-plan',
      version: 1,
      name: 'Three images',
      images: [image('ct', 'CT', 'HU'), image('mr', 'MR', ''), image('pet', 'PET', 'Bq/ml')],
      regions: [{ path: 'labels.nii.gz', names: 'labels.json' }],
    }),
  );
  return 'three-images';
}

/** Percentiles of the images' values: the smallest that so many percent of the voxels do not exceed. */
export function percentiles(...percents) {
  const bytes = gunzipSync(readFileSync(join(demo, 'phantom/ct.nii.gz')));
  const values = new Int16Array(bytes.buffer, bytes.byteOffset + bytes.readFloatLE(108), bytes.length / 2 - bytes.readFloatLE(108) / 2)
    .slice()
    .sort();
  return percents.map((percent) => values[Math.ceil((percent / 100) * values.length) - 1]);
}
