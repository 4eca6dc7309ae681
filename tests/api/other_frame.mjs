// A plan of the demo head with a dose of its own and one that is said to be in another frame of reference.
import { cpSync, mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { demo } from './daemon.mjs';

/** Writes the plan into a folder of plans. @returns {string} its id */
export function writeOtherFrame(folder) {
  const to = join(folder, 'other-frame');
  mkdirSync(to);
  for (const file of ['ct.nii.gz', 'labels.nii.gz', 'labels.json', 'dose'])
    cpSync(join(demo, 'phantom', file), join(to, file), { recursive: true });
  writeFileSync(
    join(to, 'plan.json'),
    JSON.stringify({
      format: 'beamroom-plan',
      version: 1,
      name: 'Other frame',
      images: [{ id: 'ct', path: 'ct.nii.gz', modality: 'CT' }],
      regions: [{ path: 'labels.nii.gz', names: 'labels.json' }],
      doses: [
        { id: 'own', name: 'Field 1', unit: 'Gy', path: 'dose/fast.nii.gz', quantity: 'total', frame_of_reference: 'same' },
        { id: 'boost', name: 'Boost', unit: 'Gy', path: 'dose/gamma.nii.gz', quantity: 'total', frame_of_reference: 'differs' },
      ],
    }),
  );
  return 'other-frame';
}
