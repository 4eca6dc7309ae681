// The pictures that docs/figures.md makes by one command each, from the demo plan: pixels counted against its geometry, from the
// front or from above, in parallel projection.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { centreOf, readPng } from './png.mjs';

const bin = join(process.env.BEAMROOM_BIN ?? 'build/release', 'beamroom');
const pixelsPerMm = 300 / 240;
const from = (position_mm, up) => JSON.stringify({ camera: { position_mm, target_mm: [0, 0, 0], up, projection: 'parallel', height_mm: 240 } });
const front = from([0, -500, 0], [0, 0, 1]);
const above = from([0, 0, 500], [0, -1, 0]);

// mm along L, P, S: core/phantom/head.c, after Goorley, Kiger and Zamenhof 2002
const ellipse = (a, b) => Math.PI * a * b;
const scalp = { front: ellipse(73, 88), above: ellipse(73, 103) };
const cranium = { front: ellipse(68, 83) };
// the marker, a sphere of 5 mm around L 76: what of it is beyond the scalp's edge at L 73, which is almost straight there
const marker = ellipse(5, 5);
const markerBeyondScalp = 25 * (Math.PI - Math.acos(3 / 5)) + 3 * 4;

const isDrawn = ([r, g, b]) => Math.max(r, g, b) > 40; // the background is 15, 17, 20
const isGrey = ([r, g, b]) => isDrawn([r, g, b]) && Math.max(r, g, b) - Math.min(r, g, b) <= 4;

// all that is not air is opaque, in one colour
const tissue = ['--scene', JSON.stringify({ image: { volume: { points: [
  { value: -450, color: '#ff8000', opacity: 0 }, { value: -450, color: '#ff8000', opacity: 0.9 }] } } })];

let folder;
let plan;
before(() => {
  folder = mkdtempSync(join(tmpdir(), 'beamroom-figures-'));
  plan = join(folder, 'head');
  assert.equal(spawnSync(bin, ['phantom', plan, '--size', '128x128x96']).status, 0);
});
after(() => rmSync(folder, { recursive: true, force: true }));

/** The picture of `beamroom render` with these options. */
function picture(view, ...options) {
  const out = join(folder, 'figure.png');
  const { status, stderr } = spawnSync(bin, ['render', plan, '-o', out, '--size', '400x300', '--view', view, ...options], { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return readPng(readFileSync(out));
}

/** mm2 of the picture whose pixels suit. */
const area = (shown, suits) => centreOf(shown, suits).n / pixelsPerMm ** 2;

/** Within 2 %: voxels of 2 mm are rounded at the edge of an ellipse of 70 mm and more. */
function assertArea(shown, suits, expected) {
  const found = area(shown, suits);
  assert.ok(Math.abs(found - expected) < 0.02 * expected, `${found.toFixed(0)} mm2 instead of ${expected.toFixed(0)}`);
}

describe('the figures of the thesis, by one command each', () => {
  it('15: the surface of a region', () => {
    const shown = picture(front, '--show', 'scalp', '--slices', 'none');
    assertArea(shown, isDrawn, scalp.front);
    assert.equal(centreOf(shown, isGrey).n, 0);
  });

  it('16: a slice, without the air around the head', () => {
    const shown = picture(above, '--show', 'none', '--slices', 'axial=0');
    assertArea(shown, isGrey, scalp.above + markerBeyondScalp);
    assertArea(shown, isDrawn, scalp.above + markerBeyondScalp);
  });

  it('17: the volume, without the air, by slices', () => {
    const shown = picture(front, '--show', 'none', '--slices', 'none', '--volume', 'slices=-450', '--window', '0/2000');
    assertArea(shown, isGrey, scalp.front + markerBeyondScalp);
    assertArea(shown, isDrawn, scalp.front + markerBeyondScalp);
  });

  it('18: the volume with a higher limit: bone, and the marker free beside it', () => {
    const low = picture(front, '--show', 'none', '--slices', 'none', '--volume', 'slices=-450', '--window', '0/2000');
    const high = picture(front, '--show', 'none', '--slices', 'none', '--volume', 'slices=500', '--window', '0/2000');
    assertArea(high, isGrey, cranium.front + marker);
    // soft tissue before the skull is 60 HU, the skull 950: greys 0.53 and 0.98 of white
    assert.ok(low.at(200, 150)[0] < 170 && high.at(200, 150)[0] > 210, `${low.at(200, 150)} ${high.at(200, 150)}`);
  });

  it('17 by rays: lit, in the colours of the transfer function, and no larger', () => {
    const shown = picture(front, '--show', 'none', '--slices', 'none', ...tissue, '--volume', 'ray');
    assertArea(shown, isDrawn, scalp.front + markerBeyondScalp);
    assertArea(shown, ([r, , b]) => r > 2 * b && r > 40, scalp.front + markerBeyondScalp);
  });

  // Cut through the middle: from above, the rim of the ellipse at S 0, from the front half of the scalp.
  const cut = ['--show', 'scalp,brain', '--slices', 'none', '--clip', 'axial-high=0'];
  it('23: cut across, hollow', () => {
    assertArea(picture(front, ...cut, '--no-caps'), isDrawn, scalp.front / 2);
    const shown = picture(above, ...cut, '--no-caps');
    assertArea(shown, isDrawn, scalp.above);
    assert.ok(area(shown, isGrey) < 0.02 * scalp.above, 'nothing grey: no image');
  });

  it('24: the same cut, closed with the image', () => {
    assertArea(picture(front, ...cut), isDrawn, scalp.front / 2);
    const shown = picture(above, ...cut);
    assertArea(shown, isGrey, scalp.above);
    assertArea(shown, isDrawn, scalp.above);
  });

  it('a volume that is cut shows the image in the cut', () => {
    const options = ['--show', 'none', '--slices', 'none', ...tissue, '--volume', 'ray', '--clip', 'axial-high=0', '--window', '0/2000'];
    assertArea(picture(above, ...options), isGrey, scalp.above + markerBeyondScalp);
    assert.ok(area(picture(above, ...options, '--no-caps'), isGrey) < 0.5 * scalp.above);
  });

  it('from any direction: the head is as wide from the side as it is long', () => {
    const options = ['--show', 'scalp', '--slices', 'none', '--view', JSON.stringify({ camera: { projection: 'parallel', height_mm: 240 } })];
    const ways = { '0,0': ellipse(73, 88), '90,0': ellipse(103, 88), '0,90': ellipse(73, 103) };
    for (const [way, expected] of Object.entries(ways)) assertArea(picture('{}', ...options, '--from', way), isDrawn, expected);
  });

  // Half way between axial and coronal, the scalp is cut along its half axes of 73 mm and of 1 / sqrt(((1 / 88)^2 + (1 / 103)^2) / 2)
  it('an oblique slice, alone and in space', () => {
    const oblique = 1 / Math.sqrt((1 / 88 ** 2 + 1 / 103 ** 2) / 2);
    const options = ['--plane', '0,1,1@0,0,0', '--show', 'none', '--slices', 'none', '--scene', '{"image":{"window":{"center":-500,"width":10}}}']; // half way from air
    const { position_mm: _, ...flat } = JSON.parse(front).camera;
    assertArea(picture(JSON.stringify({ camera: flat }), ...options), isDrawn, ellipse(73, oblique) + markerBeyondScalp);
    const { camera } = JSON.parse(from([0, -500, -500], [0, 0, 1])); // square on
    assertArea(picture(JSON.stringify({ kind: '3d', camera }), ...options), isDrawn, ellipse(73, oblique) + markerBeyondScalp);
  });
});
