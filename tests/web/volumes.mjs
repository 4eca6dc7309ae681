// A made plan of an image of any size and, in it, a region that is a box.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';

/** NIfTI-1 of 16 bit integers, axes along L, P, S; its first voxel at (-50, -40, -30) mm. */
function nifti([nx, ny, nz], stepMm, valueAt) {
  const bytes = Buffer.alloc(352 + 2 * nx * ny * nz);
  bytes.writeInt32LE(348, 0);
  [3, nx, ny, nz, 1, 1, 1, 1].forEach((value, at) => bytes.writeInt16LE(value, 40 + 2 * at));
  bytes.writeInt16LE(4, 70); // signed 16 bit
  bytes.writeInt16LE(16, 72);
  [1, ...stepMm].forEach((value, at) => bytes.writeFloatLE(value, 76 + 4 * at));
  bytes.writeFloatLE(352, 108);
  bytes.writeInt8(2, 123); // mm
  bytes.writeInt16LE(1, 254); // sform, whose world is right, anterior, superior
  [
    [-stepMm[0], 0, 0, 50],
    [0, -stepMm[1], 0, 40],
    [0, 0, stepMm[2], -30],
  ].forEach((row, r) => row.forEach((value, c) => bytes.writeFloatLE(value, 280 + 16 * r + 4 * c)));
  bytes.write('n+1\0', 344, 'latin1');
  for (let k = 0; k < nz; k++)
    for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) bytes.writeInt16LE(valueAt(i, j, k), 352 + 2 * (i + nx * (j + ny * k)));
  return bytes;
}

/** Writes the plan into a folder. @param {{size: number[], stepMm: number[], region?: [number[], number[]]}} how region: its first and last voxel */
export function writeVolume(folder, name, { size, stepMm, region }) {
  const inRegion = (...ijk) => ijk.every((index, at) => index >= region[0][at] && index <= region[1][at]);
  writeFileSync(
    join(folder, 'image.nii'),
    nifti(size, stepMm, (i, j, k) => (i * 7 + j * 3 + k * 11) % 200),
  );
  const plan = { format: 'beamroom-plan', version: 1, name, images: [{ id: 'mr', path: 'image.nii' }] };
  if (region) {
    writeFileSync(
      join(folder, 'labels.nii'),
      nifti(size, stepMm, (i, j, k) => (inRegion(i, j, k) ? 1 : 0)),
    );
    writeFileSync(join(folder, 'names.json'), JSON.stringify({ labels: [{ value: 1, name: 'lesion' }] }));
    plan.regions = [{ path: 'labels.nii', names: 'names.json' }];
  }
  writeFileSync(join(folder, 'plan.json'), JSON.stringify(plan));
}
