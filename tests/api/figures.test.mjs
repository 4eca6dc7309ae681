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
const from = (position_mm, up) =>
  JSON.stringify({ camera: { position_mm, target_mm: [0, 0, 0], up, projection: 'parallel', height_mm: 240 } });
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
const tissue = [
  '--scene',
  JSON.stringify({
    image: {
      volume: {
        points: [
          { value: -450, color: '#ff8000', opacity: 0 },
          { value: -450, color: '#ff8000', opacity: 0.9 },
        ],
      },
    },
  }),
];

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
  const { status, stderr } = spawnSync(bin, ['render', plan, '-o', out, '--size', '400x300', '--view', view, ...options], {
    encoding: 'utf8',
  });
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

  // One level in one colour, opaque: its wash on a slice through S 50, its line around that, its surface above that
  const level = (percent) => ['--tissue', 'brain', '--quantity', 'gamma', '--level', `${percent}=#00ff00`];
  const isGreen = ([r, g, b]) => g > r + 60 && g > b + 60;
  it('19: dose as colour on a slice, smaller for higher levels, and its line at its edge', () => {
    const slice = ['--show', 'none', '--slices', 'axial=50'];
    const [low, high] = [30, 60].map((percent) => picture(above, ...slice, ...level(percent), '--wash', 'bands=1'));
    assert.ok(area(high, isGreen) > 100 && area(low, isGreen) > area(high, isGreen) + 500, `${area(low, isGreen)} ${area(high, isGreen)}`);
    assert.ok(area(low, isDrawn) < 1.02 * area(picture(above, ...slice), isDrawn), 'nothing beside the slice');
    // the dose is round about the beam, which comes from above at L 0, P 0: a line of 6 px, whose
    // edges are soft, and the wash's circle
    const line = picture(above, ...slice, ...level(30), '--lines', '--scene', '{"dose":{"lines":{"width_px":6}}}');
    const radius = Math.sqrt(area(low, isGreen) / Math.PI);
    const length = area(line, isGreen) / (6 / pixelsPerMm);
    assert.ok(Math.abs(length - 2 * Math.PI * radius) < 0.2 * 2 * Math.PI * radius, `${length} mm of line around a circle of ${radius} mm`);
  });

  it('20: dose as colour on a surface leaves its outline as it is', () => {
    const surface = ['--show', 'brain', '--slices', 'none'];
    const plain = picture(front, ...surface),
      washed = picture(front, ...surface, ...level(30), '--wash', 'bands=1', '--texture', 'dose');
    assert.equal(area(washed, isDrawn), area(plain, isDrawn));
    assert.ok(area(plain, isGreen) === 0 && area(washed, isGreen) > 500);
    // the beam comes from above: the dose is in the upper half
    const { y } = centreOf(washed, isGreen);
    assert.ok(y < 150, `${y}`);
  });

  it('21: isodose surfaces lie inside each other', () => {
    const [low, high] = [30, 60].map((percent) =>
      picture(front, '--show', 'none', '--slices', 'none', ...level(percent), '--isodoses', 'univels'),
    );
    assert.ok(area(high, isDrawn) > 100 && area(low, isDrawn) > area(high, isDrawn) + 500);
    // to the sides and below; above, the dose's mask ends both
    const edges = (shown) => {
      const found = { left: 400, right: 0, bottom: 0 };
      for (let y = 0; y < 300; y++)
        for (let x = 0; x < 400; x++)
          if (isDrawn(shown.at(x, y))) Object.assign(found, { left: Math.min(found.left, x), right: Math.max(found.right, x), bottom: y });
      return found;
    };
    const [outer, inner] = [low, high].map(edges);
    assert.ok(outer.left < inner.left && outer.right > inner.right && outer.bottom > inner.bottom, JSON.stringify([outer, inner]));
  });

  it('an option about dose that cannot be read, or names what the plan does not have, is refused with its name', () => {
    const fails = (...options) => spawnSync(bin, ['render', plan, '-o', join(folder, 'none.png'), ...options], { encoding: 'utf8' }).stderr;
    assert.match(fails('--level', 'hot'), /--level 'hot' is not a number/);
    assert.match(fails('--wash', 'rainbow'), /--wash 'rainbow' is not bands or smooth/);
    assert.match(fails('--reference', 'point=1,2'), /--reference 'point=1,2' is not/);
    assert.match(fails('--ppm', 'many'), /--ppm 'many' is not a number/);
    assert.match(fails('--dose', 'mine'), /dose/);
    assert.match(fails('--accept', 'dose:none'), /--accept 'dose:none' is not THING=WITH/);
    assert.match(fails('--accept', 'dose:none=image:ct'), /names a part that the plan does not have/);
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

  const isColoured = ([r, g, b]) => Math.max(r, g, b) > 60 && Math.max(r, g, b) - Math.min(r, g, b) > 40;
  it('25: tracks, in the colours of their classes, most of them above, where the beam comes from', () => {
    const all = picture(front, '--show', 'none', '--slices', 'none', '--tracks');
    const neutrons = picture(front, '--show', 'none', '--slices', 'none', '--tracks=neutron');
    const { n, y } = centreOf(all, isColoured);
    assert.ok(n > centreOf(neutrons, isColoured).n + 100 && y < 150, `${n} pixels about the line ${y}`);
  });

  // The beam comes from above, S 88: its picture shows what one from above shows, turned, and no ring or cross lies beyond the scalp.
  const eye = (more) => JSON.stringify({ camera: { height_mm: 240 }, beam: { crosshair: false, ...more } });
  it('26 and 27: along the beam, in parallel projection with its ring', () => {
    const shown = picture(eye(), '--show', 'scalp', '--slices', 'none', '--ring', '100');
    assertArea(shown, isDrawn, scalp.above);
    // the ring, white, is 50 mm off the middle; between its ticks, on the diagonals
    const isWhite = ([r, g, b]) => Math.min(r, g, b) > 225;
    for (const [dx, dy] of [
      [1, 1],
      [-1, 1],
      [1, -1],
      [-1, -1],
    ]) {
      const onWay = Array.from({ length: 400 }, (_, step) => 20 + step / 4);
      const found = onWay.filter((px) =>
        isWhite(shown.at(Math.floor(200 + dx * px * Math.SQRT1_2), Math.floor(150 + dy * px * Math.SQRT1_2))),
      );
      const middleMm = found.reduce((sum, px) => sum + px, 0) / found.length / pixelsPerMm;
      assert.ok(Math.abs(middleMm - 50) < 0.8, `a ring ${middleMm} mm off the middle`); // a pixel
    }
    // a perspective camera close by sees less of it than one far away
    const [near, far] = [0, -300].map((along) =>
      area(picture(eye({ along_mm: along }), '--show', 'brain', '--slices', 'none', '--kind', 'beam'), isDrawn),
    );
    assert.ok(near > 1.5 * far, `${near} ${far}`);
  });

  it('28: cut across the beam, and the beam slice there', () => {
    const across = ['--show', 'scalp,brain', '--slices', 'none', '--clip', 'beam=88'];
    assertArea(picture(front, ...across), isDrawn, scalp.front / 2);
    assertArea(picture(above, ...across, '--no-caps', '--beam-slice', '88'), isGrey, scalp.above + markerBeyondScalp);
    const pane = picture(
      JSON.stringify({ camera: { height_mm: 240 } }),
      '--kind',
      'beam-slice',
      '--show',
      'none',
      '--beam-slice',
      '88',
      '--scene',
      '{"image":{"window":{"center":-500,"width":10}}}',
    );
    assertArea(pane, isDrawn, scalp.above + markerBeyondScalp);
  });

  it('a volume that is cut shows the image in the cut', () => {
    const options = ['--show', 'none', '--slices', 'none', ...tissue, '--volume', 'ray', '--clip', 'axial-high=0', '--window', '0/2000'];
    assertArea(picture(above, ...options), isGrey, scalp.above + markerBeyondScalp);
    assert.ok(area(picture(above, ...options, '--no-caps'), isGrey) < 0.5 * scalp.above);
  });

  it('from any direction: the head is as wide from the side as it is long', () => {
    const options = [
      '--show',
      'scalp',
      '--slices',
      'none',
      '--view',
      JSON.stringify({ camera: { projection: 'parallel', height_mm: 240 } }),
    ];
    const ways = { '0,0': ellipse(73, 88), '90,0': ellipse(103, 88), '0,90': ellipse(73, 103) };
    for (const [way, expected] of Object.entries(ways)) assertArea(picture('{}', ...options, '--from', way), isDrawn, expected);
  });

  // Half way between axial and coronal, the scalp is cut along its half axes of 73 mm and of 1 / sqrt(((1 / 88)^2 + (1 / 103)^2) / 2)
  it('an oblique slice, alone and in space', () => {
    const oblique = 1 / Math.sqrt((1 / 88 ** 2 + 1 / 103 ** 2) / 2);
    const options = [
      '--plane',
      '0,1,1@0,0,0',
      '--show',
      'none',
      '--slices',
      'none',
      '--scene',
      '{"image":{"window":{"center":-500,"width":10}}}',
    ]; // half way from air
    const { position_mm: _, ...flat } = JSON.parse(front).camera;
    assertArea(picture(JSON.stringify({ camera: flat }), ...options), isDrawn, ellipse(73, oblique) + markerBeyondScalp);
    const { camera } = JSON.parse(from([0, -500, -500], [0, 0, 1])); // square on
    assertArea(picture(JSON.stringify({ kind: '3d', camera }), ...options), isDrawn, ellipse(73, oblique) + markerBeyondScalp);
  });
});
