// A plan of the demo head with three doses: its own, one whose grid is a metre away from the head, and a second one that fits.
import { cpSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gunzipSync, gzipSync } from 'node:zlib';
import { demo } from '../api/daemon.mjs';

/** Writes the plan into a folder of plans. @returns {string} its id */
export function writeStrayDose(folder) {
  const to = join(folder, 'stray-dose');
  mkdirSync(to);
  for (const file of ['ct.nii.gz', 'labels.nii.gz', 'labels.json', 'dose'])
    cpSync(join(demo, 'phantom', file), join(to, file), { recursive: true });
  const far = gunzipSync(readFileSync(join(demo, 'phantom/dose/gamma.nii.gz')));
  for (const at of [268, 292]) far.writeFloatLE(far.readFloatLE(at) + 1000, at); // qoffset_x, and the offset of srow_x
  writeFileSync(join(to, 'far.nii.gz'), gzipSync(far));
  const parts = [
    ['boron', { per_ppm: true }],
    ['fast', {}],
    ['gamma', {}],
  ].map(([quantity, more]) => ({ quantity, ...more, path: `dose/${quantity}.nii.gz` }));
  writeFileSync(
    join(to, 'plan.json'),
    JSON.stringify({
      format: 'beamroom-plan',
      version: 1,
      name: 'Stray dose',
      images: [{ id: 'ct', path: 'ct.nii.gz', modality: 'CT' }],
      regions: [{ path: 'labels.nii.gz', names: 'labels.json' }],
      doses: [
        { id: 'own', unit: 'Gy', per: 'fraction', components: parts },
        { id: 'far', unit: 'Gy', components: [{ quantity: 'total', path: 'far.nii.gz' }] },
        { id: 'near', unit: 'Gy', per: 'fraction', components: [{ quantity: 'total', path: 'dose/gamma.nii.gz' }] },
      ],
    }),
  );
  return 'stray-dose';
}
