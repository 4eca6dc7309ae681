// A plan with a region that cannot be drawn as univels: a chequered cube of 200 voxels a side has 4 million univels that touch nothing, of
// 12 triangles each: 48 million, and the limit is 40 million. Beside it lies a small solid block.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

const side = 200,
  depth = 230;

/** A NIfTI-1 label map of 1 mm voxels, x to the left, y to the back (so that ijk is LPS mm). */
function labelMap() {
  const head = Buffer.alloc(352);
  head.writeInt32LE(348, 0);
  [3, side, side, depth, 1, 1, 1, 1].forEach((n, i) => head.writeInt16LE(n, 40 + 2 * i));
  head.writeInt16LE(2, 70); // uint8
  head.writeInt16LE(8, 72);
  [1, 1, 1, 1].forEach((n, i) => head.writeFloatLE(n, 76 + 4 * i));
  head.writeFloatLE(352, 108);
  head[123] = 2; // mm
  head.writeInt16LE(1, 254); // sform: RAS from ijk
  [
    [-1, 0, 0, 0],
    [0, -1, 0, 0],
    [0, 0, 1, 0],
  ]
    .flat()
    .forEach((n, i) => head.writeFloatLE(n, 280 + 4 * i));
  head.write('n+1\0', 344, 'latin1');
  const voxels = Buffer.alloc(side * side * depth);
  for (let k = 0; k < side; k++)
    for (let j = 0; j < side; j++) for (let i = 0; i < side; i++) voxels[(k * side + j) * side + i] = (i + j + k) % 2;
  for (let k = 205; k < 225; k++) for (let j = 90; j < 110; j++) voxels.fill(2, (k * side + j) * side + 90, (k * side + j) * side + 110);
  return gzipSync(Buffer.concat([head, voxels]), { level: 1 });
}

/** Writes the plan "foam" into a folder of plans: regions foam and block. */
export function writeFoamPlan(folder) {
  const plan = join(folder, 'foam');
  mkdirSync(plan);
  writeFileSync(join(plan, 'labels.nii.gz'), labelMap());
  writeFileSync(
    join(plan, 'names.json'),
    JSON.stringify({
      labels: [
        { value: 1, name: 'foam' },
        { value: 2, name: 'block' },
      ],
    }),
  );
  writeFileSync(
    join(plan, 'plan.json'),
    JSON.stringify({
      format: 'beamroom-plan',
      version: 1,
      name: 'Foam',
      phantom: true,
      regions: [{ path: 'labels.nii.gz', names: 'names.json' }],
    }),
  );
}
