// Facts shown beside a dose's numbers: the boron in a total, and a frame of reference other than the image's.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { bin, call, openPlan, realData, startDaemon } from './daemon.mjs';
import { parseStrict } from './strict_json.mjs';

const head = realData && join(realData, 'sera-head');
const phantom = realData && join(realData, 'dicomrt-oncentra-phantom');
const skip = [head, phantom].every((plan) => plan && existsSync(plan)) ? false : 'no real plans on this machine';
let folder, daemon;

/** Gives every RTDOSE another frame of reference (0020,0052) by changing its last digit. */
function shiftFrames(plan) {
  let n = 0;
  for (const name of readdirSync(plan, { recursive: true })) {
    if (!/^RD.*\.dcm$/.test(name)) continue;
    const bytes = readFileSync(join(plan, name));
    const at = bytes.indexOf(Buffer.from([0x20, 0, 0x52, 0]));
    assert.ok(at > 0, `${name} has a frame of reference`);
    const isExplicit = bytes.toString('latin1', at + 4, at + 6) === 'UI';
    const length = isExplicit ? bytes.readUInt16LE(at + 6) : bytes.readUInt32LE(at + 4);
    let last = at + 8 + length - 1;
    if (bytes[last] === 0) last--;
    bytes[last] = bytes[last] === 0x31 ? 0x32 : 0x31;
    writeFileSync(join(plan, name), bytes);
    n++;
  }
  assert.ok(n > 0);
}

before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'beamroom-doses-'));
  cpSync(phantom, join(folder, 'fits'), { recursive: true });
  cpSync(phantom, join(folder, 'shifted'), { recursive: true });
  shiftFrames(join(folder, 'shifted'));
  execFileSync(join(bin, 'beamroom'), ['convert', join(folder, 'shifted'), join(folder, 'converted')]);
  execFileSync(join(bin, 'beamroom'), ['convert', head, join(folder, 'head-converted')]);
  daemon = await startDaemon({ plans: [folder, head] });
});
after(async () => {
  await daemon?.stop();
  if (folder) rmSync(folder, { recursive: true });
});

const centre = (grid) =>
  ['low', 'high'].map((end) => grid.bounds_mm[end]).reduce((low, high) => low.map((value, axis) => (value + high[axis]) / 2));

async function probe(plan, point) {
  const [x, y, z] = point;
  return (await call(`${daemon.url}/api/v1/plans/${plan}/probe?x=${x}&y=${y}&z=${z}`)).json.doses;
}

test('a total says for how much boron it holds: with that much, its components add up to it', { skip }, async () => {
  for (const id of ['sera-head', 'head-converted']) {
    await openPlan(daemon.url, id);
    const plan = (await call(`${daemon.url}/api/v1/plans/${id}`)).json;
    const contours = plan.doses.find((dose) => dose.components.some(({ quantity }) => quantity === 'total'));
    const said = Object.fromEntries(contours.components.map(({ quantity, boron_ppm: ppm }) => [quantity, ppm]));
    assert.equal(said.total, 1, 'the contours were written for 1 ppm (README of the data)');
    assert.ok(Object.entries(said).every(([quantity, ppm]) => quantity === 'total' || ppm === null));
    const tumor = plan.regions.find((region) => region.name === 'tumor');
    const rows = Object.fromEntries(
      (await probe(id, tumor.center_mm)).filter((row) => row.id === contours.id).map((row) => [row.quantity, row]),
    );
    assert.equal(rows.total.boron_ppm, 1);
    assert.equal(rows.gamma.boron_ppm, null);
    const boron = rows.boron ?? rows['blood-boron'];
    const sum =
      boron.value * rows.total.boron_ppm +
      ['gamma', 'nitrogen', 'fast', 'other'].reduce((all, quantity) => all + (rows[quantity]?.value ?? 0), 0);
    assert.ok(Math.abs(sum / rows.total.value - 1) < 2e-3, `${sum} and ${rows.total.value}: values have four digits in the file`);
  }
});

test('a dose in another frame of reference than the image says so in the plan, the probe, the list and a converted plan', {
  skip,
}, async () => {
  for (const [id, frame] of [
    ['fits', 'same'],
    ['shifted', 'differs'],
    ['converted', 'differs'],
  ]) {
    await openPlan(daemon.url, id);
    const plan = (await call(`${daemon.url}/api/v1/plans/${id}`)).json;
    assert.ok(plan.doses.length > 0);
    assert.deepEqual([...new Set(plan.doses.map((dose) => dose.frame_of_reference))], [frame], id);
    assert.equal(
      plan.report.lines.some(({ code }) => code === 'dose.frame-differs'),
      frame === 'differs',
      id,
    );
    const rows = await probe(id, centre(plan.doses[0].components[0].grid));
    assert.equal(rows.length > 0, frame === 'same', `${id}: a dose of another frame is not read out`);
    assert.ok(
      rows.every((row) => row.frame_of_reference === frame),
      id,
    );
  }
  const written = parseStrict(readFileSync(join(folder, 'converted', 'plan.json'), 'utf8'));
  assert.ok(written.doses.every((dose) => dose.frame_of_reference === 'differs'));
  assert.match(
    execFileSync(join(bin, 'beamroom'), ['info', join(folder, 'shifted')], { encoding: 'utf8' }),
    /frame of reference differs from the image's/,
  );
});
