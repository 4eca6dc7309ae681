// A plan of two regions without an image: a ball, and two balls side by side on the same slices.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

const side = 40; // univels of 1 mm

/** A label map as NIfTI-1: 1 a ball, 2 two balls side by side on the same slices. */
function labels() {
  const bytes = Buffer.alloc(352 + side ** 3);
  bytes.writeInt32LE(348, 0);
  [3, side, side, side, 1, 1, 1, 1].forEach((value, at) => bytes.writeInt16LE(value, 40 + 2 * at));
  bytes.writeInt16LE(2, 70); // unsigned bytes
  bytes.writeInt16LE(8, 72);
  [1, 1, 1, 1].forEach((value, at) => bytes.writeFloatLE(value, 76 + 4 * at));
  bytes.writeFloatLE(352, 108);
  bytes.writeInt8(2, 123); // mm
  bytes.writeInt16LE(1, 254); // sform
  [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ].forEach((row, r) => row.forEach((value, c) => bytes.writeFloatLE(value, 280 + 16 * r + 4 * c)));
  bytes.write('n+1\0', 344, 'latin1');
  for (let k = 0; k < side; k++)
    for (let j = 0; j < side; j++)
      for (let i = 0; i < side; i++) {
        const within = (x, y, z, radius) => Math.hypot(i - x, j - y, k - z) < radius;
        bytes[352 + i + side * (j + side * k)] = within(20, 12, 20, 8) ? 1 : within(10, 30, 20, 6) || within(28, 30, 20, 6) ? 2 : 0;
      }
  return bytes;
}

/** Writes the plan into a folder. @param {[string, string]} names of the ball and of the two */
export function writeLabels(folder, name, names) {
  writeFileSync(join(folder, 'labels.nii'), labels());
  writeFileSync(join(folder, 'names.json'), JSON.stringify({ labels: names.map((region, at) => ({ value: at + 1, name: region })) }));
  writeFileSync(
    join(folder, 'plan.json'),
    JSON.stringify({ format: 'beamroom-plan', version: 1, name, regions: [{ path: 'labels.nii', names: 'names.json' }] }),
  );
}
