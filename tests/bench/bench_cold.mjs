// Wait of a planner who opens a patient for the first time: from the request to open to the first picture of a DICOM folder with 200
// slices of 512 x 512, 12 regions as contours and a dose, from a daemon that has just started. Files are in the system's cache.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, rmSync } from 'node:fs';
import { call, startDaemon } from '../api/daemon.mjs';

const python = process.env.PYTHON ?? '/usr/bin/python3';
const plans = 'build/bench/plans';
const plan = `${plans}/rt`;
if (!existsSync(`${plan}/RD`)) {
  rmSync(plan, { recursive: true, force: true });
  mkdirSync(plan, { recursive: true });
  for (const script of ['dicom_make.py', 'rt_make.py'])
    if (spawnSync(python, [`tests/bench/${script}`, plan], { stdio: 'inherit' }).status !== 0) {
      rmSync(plan, { recursive: true, force: true });
      process.exit(77); // no pydicom here
    }
}

const times = [];
for (let run = 0; run < 3; run++) {
  const daemon = await startDaemon({ plans: [plans] });
  const began = performance.now();
  const opened = await call(`${daemon.url}/api/v1/plans/rt/open`, 'POST');
  if (opened.status !== 202) throw new Error(`open: ${opened.text}`);
  const answer = await fetch(`${daemon.url}/api/v1/plans/rt/render`, {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ view: { kind: '3d', size_px: [1024, 768] }, format: 'jpeg' }),
  });
  await answer.arrayBuffer();
  if (answer.status !== 200) throw new Error(`render: ${answer.status}`);
  times.push(performance.now() - began);
  const document = (await call(`${daemon.url}/api/v1/plans/rt`)).json;
  if (document.images.length !== 1 || document.regions.length !== 12 || document.doses.length !== 1)
    throw new Error('the plan lacks parts');
  await daemon.stop();
}
times.sort((a, b) => a - b);
console.log(
  JSON.stringify({
    name: 'request to first picture, CT 512 x 512 x 200, 12 regions, dose',
    value: Number(times[1].toFixed(1)),
    unit: 'ms',
    note: 'median of 3 daemons, DICOM, nothing cached but the files; at most 1500 asked for',
  }),
);
