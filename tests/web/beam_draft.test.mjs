// A beam on the page and its draft: rows, read-outs, dragging in panes of every kind, keys, numbers, the bar for everybody, compare, keep, export;
// the scene on the server says what happened, and the matrix of each picture where it has to.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { bytesOf, full, header, later, missing, shoot, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';

const planned = { entry: [0, 0, 88], target: [0, 0, 10] }; // of the demo phantom: straight down the patient's axis
const near = (actual, expected, tolerance, words) =>
  expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${words}: ${actual} is not ${expected}`));
const unit = (v) => v.map((part) => part / Math.hypot(...v));

describe('beams and their drafts', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let page;

  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    page = await world.newPage(`rooms/${room}`, { viewport: { width: 1440, height: 900 } });
    for (const view of [1, 2, 3, 4]) await full(page, view);
  });
  after(async () => {
    await world?.stop();
  });

  const beam = async () => (await world.scene(room)).beam;
  /** Until the draft on the server passes. */
  const comes = async (test, words) => {
    const value = await until(beam, test, 30000);
    assert.ok(test(value), `${words}: ${JSON.stringify(value)}`);
    return value.draft.line;
  };
  const panel = (words, tag = 'button') => page.locator('#tab-panel').locator(tag, { hasText: words });
  const bar = (words) => page.locator('.beam-bar button', { hasText: words });
  const row = (id) => page.locator(`[data-key="${id}"]`);
  const cell = (name, column) =>
    page
      .locator('.beam-table tr', { has: page.locator(`th:text-is("${name}")`) })
      .locator('td')
      .nth(column);
  const drag = async (view, [dx, dy]) => {
    const { x, y, width, height } = await page.locator(`#picture-${view}`).boundingBox();
    const [x0, y0] = [x + width / 2 + 90, y + height / 2 - 70]; // no handle is there: the chosen point moves by as much as the pointer
    await page.mouse.move(x0, y0);
    await page.mouse.down();
    for (let step = 1; step <= 4; step++) await page.mouse.move(x0 + (dx * step) / 4, y0 + (dy * step) / 4);
    await page.locator('.room > [data-pending]').first().waitFor(); // panels wait for the pictures, though the press took the focus from a button
    await page.mouse.up();
  };
  const matrixOf = async (view) => {
    const m = Object.values((await header(page, view)).clip_from_lps_mm);
    const row4 = (r, p) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    return { clip: (p) => [0, 1].map((r) => row4(r, p) / row4(3, p)), w: (p) => row4(3, p), forward: unit([m[3], m[7], m[11]]) };
  };
  /** Until the picture is at rest in the pane's size of now: the bar takes a part of it. */
  const settled = async (view) => {
    await page.waitForFunction((n) => {
      const { width, height } = document.querySelector(`#picture-${n}`).getBoundingClientRect();
      const { headers, badges } = globalThis.beamroom.stats();
      return badges[n] === 'full' && headers[n].width_px === Math.round(width) && headers[n].height_px === Math.round(height);
    }, view);
  };

  it('a row shows and hides the beam, and Selection has its numbers as the server says them', async () => {
    await row('beam:beam-1').locator('.eye').click();
    await comes(({ looks }) => looks['beam-1']?.visible === true && looks['beam-1'].opening === true, 'its line and opening are on');
    await row('beam:beam-1').click();
    await cell('Source end to target', 0).filter({ hasText: '78.0 mm' }).waitFor(); // 88 - 10
    const { json } = await call(`${world.daemon.url}/api/v1/plans/phantom/beam?room=${room}`, 'GET');
    assert.equal(await cell('Angles φ, θ', 0).innerText(), '0.0°, 0.0°'); // from superior
    assert.equal(await cell('Skin gap', 0).innerText(), `${Math.abs(json.gap_mm).toFixed(1)} mm`);
    assert.equal(await cell('Depth to target', 0).innerText(), `${json.depth_mm.toFixed(1)} mm`);
    assert.equal(await page.locator('.beam-bar').count(), 0);
    await row('preset:all').click(); // the presets are loaded when they are unfolded
    await page.locator('[data-key^="preset:"][aria-level="3"]').first().waitFor();
    await row('preset:all').click();
  });

  it('a draft begins where the planned beam is, and everybody reads whose dose is shown', async () => {
    const other = await world.newPage(`rooms/${room}`, { viewport: { width: 1200, height: 800 } });
    await panel('Draft a new position').click();
    const line = await comes(({ draft }) => draft.enabled, 'it is drafted');
    assert.deepEqual([line.entry_mm, line.target_mm], [planned.entry, planned.target]);
    for (const one of [page, other]) {
      await one.locator('.beam-bar').waitFor();
      assert.match(await one.locator('.beam-bar p').innerText(), /Draft beam: dose shown belongs to the planned beam\s+as planned/);
    }
    await other.context().close();
    assert.deepEqual(await page.locator('.beam-table thead th').allInnerTexts(), ['Geometry', 'Draft', 'Planned']);
  });

  it('dragged in a slice pane the target follows the pointer in the plane of the pane, and that is one step of undo', async () => {
    await panel('Move target').click();
    await page.locator('[data-view="2"] .beam-handle[data-part="target"]').waitFor();
    await settled(2);
    const pxPerMm = (await header(page, 2)).pixels_per_mm;
    await drag(2, [26, 13]);
    const line = await comes(
      ({ draft }) => draft.line.target_mm[0] > 0 && Math.abs(draft.line.target_mm[1] - 13 / pxPerMm) < 0.05,
      'it came as far as the pointer',
    );
    near(line.target_mm, [26 / pxPerMm, 13 / pxPerMm, 10], 0.05, 'axial: right on the screen is left of the patient, down is posterior');
    assert.deepEqual(line.entry_mm, planned.entry);
    // a pane of a half pixel is drawn by whole ones: 0.2 %
    const moved = Math.hypot(line.target_mm[0], line.target_mm[1]);
    const direction = (Math.atan2(moved, 78) * 180) / Math.PI;
    await page.locator('.beam-moved', { hasText: `target moved ${moved.toFixed(1)} mm, direction ${direction.toFixed(1)}°` }).waitFor();
    await cell('Angles φ, θ', 0)
      .filter({ hasText: `${direction.toFixed(1)}°, ` })
      .waitFor(); // φ: the planned beam comes from superior
    assert.match(await page.locator('[title^="Undo"]').first().getAttribute('title'), /draft beam/);
    await page.keyboard.press('Control+z');
    await comes(({ draft }) => draft.enabled && draft.line.target_mm.join() === planned.target.join(), 'the whole drag is undone');
    await page.keyboard.press('Control+y');
    await comes(({ draft }) => Math.abs(draft.line.target_mm[0] - line.target_mm[0]) < 1e-9, 'and done again');
  });

  it('in 3-D the entry moves with the pointer in the plane parallel to the screen', async () => {
    await panel('Move source end').click();
    await settled(1);
    const [{ clip, w }, { width, height }] = [await matrixOf(1), await page.locator('#picture-1').boundingBox()];
    await drag(1, [-30, 20]);
    const expected = clip(planned.entry).map((value, at) => value + [(2 * -30) / width, (-2 * 20) / height][at]);
    const line = await comes(
      ({ draft }) => Math.hypot(...clip(draft.line.entry_mm).map((value, at) => value - expected[at])) < 1e-3,
      'it stands under the pointer',
    );
    assert.ok(Math.abs(w(line.entry_mm) - w(planned.entry)) < 0.01, 'as far from the eye as before');
  });

  it("in the beam's-eye view the target is dragged across the beam, and the entry stays", async () => {
    await panel("Beam's eye").click();
    await panel('Move target').click();
    await settled(7);
    const before = (await beam()).draft.line;
    const [{ clip }, { width, height }] = [await matrixOf(7), await page.locator('#picture-7').boundingBox()];
    await drag(7, [24, -12]);
    const expected = clip(before.target_mm).map((value, at) => value + [(2 * 24) / width, (2 * 12) / height][at]);
    const line = await comes(
      ({ draft }) => Math.hypot(...clip(draft.line.target_mm).map((value, at) => value - expected[at])) < 1e-3,
      'as the picture was at the press',
    );
    assert.deepEqual(line.entry_mm, before.entry_mm);
    const axis = unit(before.target_mm.map((value, at) => value - before.entry_mm[at]));
    assert.ok(Math.abs(axis.reduce((sum, part, at) => sum + part * (line.target_mm[at] - before.target_mm[at]), 0)) < 0.01, 'not along it');
  });

  later('by keys the chosen point moves along the axes of the focused pane, and Esc ends that', async () => {
    await page.locator('#picture-2').focus();
    const { target_mm: from } = (await beam()).draft.line;
    await page.keyboard.press('ArrowLeft');
    await comes(({ draft }) => Math.abs(draft.line.target_mm[0] - (from[0] - 1)) < 2e-3, 'to patient right');
    await page.locator('[data-view="2"] .beam-handle[data-part="target"]').focus();
    await page.keyboard.press('Shift+ArrowDown');
    await comes(({ draft }) => Math.abs(draft.line.target_mm[1] - (from[1] + 10)) < 2e-3, 'to posterior, by 10 mm');
    await page.keyboard.press('Escape');
    await page.waitForFunction(() => document.querySelectorAll('.beam-handle').length === 0);
    const { axial } = (await world.scene(room)).image.slices;
    await page.locator('#picture-2').focus();
    await page.keyboard.press('ArrowUp');
    assert.notEqual(
      (
        await until(
          () => world.scene(room),
          ({ image }) => image.slices.axial.position_mm !== axial.position_mm,
        )
      ).image.slices.axial.position_mm,
      axial.position_mm,
      'the slice again',
    );
  });

  later('numbers set entry, target and aperture, and a draft without a length is refused', async () => {
    const fill = async (label, value) => {
      await page.locator(`[aria-label="${label}"]`).fill(value);
      await page.keyboard.press('Enter');
    };
    for (const [at, letter] of ['L', 'P', 'S'].entries()) {
      await fill(`Target, ${letter} in mm`, ['3', '4', '10'][at]);
      await fill(`Source end, ${letter} in mm`, ['3', '4', '110'][at]);
    }
    await comes(({ draft }) => draft.line.target_mm.join() === '3,4,10' && draft.line.entry_mm.join() === '3,4,110', 'both points');
    await cell('Source end to target', 0).filter({ hasText: '100.0 mm' }).waitFor();
    await page.locator('.beam-moved', { hasText: /^target moved 5\.0 mm$/ }).waitFor(); // parallel to the planned one
    await fill('Aperture of the draft in mm', '60');
    await page.locator('.beam-regions').first().waitFor();
    await panel('cylinder of 60 mm', 'span').waitFor();
    await fill('Source end, S in mm', '10');
    await page.locator('.toasts', { hasText: 'the same point' }).waitFor();
    assert.deepEqual((await beam()).draft.line.entry_mm, [3, 4, 110]);
  });

  later('angles, a skin gap, the way through the crosshair and the shortest one place the entry; the target stays', async () => {
    const ask = async () => (await call(`${world.daemon.url}/api/v1/plans/phantom/beam?room=${room}`, 'GET')).json;
    const fill = async (label, value) => {
      await page.locator(`[aria-label="${label}"]`).fill(value);
      await page.keyboard.press('Enter');
    };
    const { gap_mm: before } = await ask();
    await fill('Skin gap in mm', '20');
    const skin = 110 - before; // the axis runs along S
    await comes(({ draft }) => Math.abs(draft.line.entry_mm[2] - (skin + 20)) < 2e-3, `20 mm before the skin at S ${skin}`);
    await cell('Skin gap', 0).filter({ hasText: '20.0 mm' }).waitFor();
    await fill('Angle φ in degrees', '90');
    await comes(({ draft }) => Math.abs(draft.line.entry_mm[2] - 10) < 2e-3, 'level with the target');
    await cell('Angles φ, θ', 0)
      .filter({ hasText: /^90\.0°/ })
      .waitFor();
    await fill('Angle θ in degrees', '90');
    const far = skin + 20 - 10;
    const line = await comes(({ draft }) => draft.line.entry_mm[1] < 0 && Math.abs(draft.line.entry_mm[0] - 3) < 2e-3, 'from anterior');
    near(line.entry_mm, [3, 4 - far, 10], 2e-3, 'as far as before');
    const { image } = await world.scene(room);
    const point = ['sagittal', 'coronal', 'axial'].map((axis) => image.slices[axis].position_mm);
    await panel('Through the crosshair').click();
    const off = ({ entry_mm: entry }) => {
      // of the crosshair beside the axis, mm
      const axis = unit(entry.map((value, at) => value - [3, 4, 10][at]));
      const to = point.map((value, at) => value - [3, 4, 10][at]);
      const along = to.reduce((sum, part, at) => sum + part * axis[at], 0);
      return along > 0 ? Math.hypot(...to.map((part, at) => part - along * axis[at])) : Infinity;
    };
    await comes(({ draft }) => off(draft.line) < 0.01, 'the crosshair is between entry and target');
    const { depth_mm: deep } = await ask();
    await panel('Shortest path').click();
    await comes(({ draft }) => off(draft.line) > 0.01, 'another way');
    assert.ok((await ask()).depth_mm < deep, 'nearer to the skin');
    assert.deepEqual((await beam()).draft.line.target_mm, [3, 4, 10]);
    for (const [at, letter] of ['L', 'P', 'S'].entries()) await fill(`Source end, ${letter} in mm`, ['3', '4', '110'][at]);
    await comes(({ draft }) => draft.line.entry_mm.join() === '3,4,110', 'as before');
  });

  it('while the planned beam is compared every picture has it and the scene says so; pressed again the draft is back', async () => {
    await bar('Compare').click();
    await page.locator('.beam-moved', { hasText: 'Planned beam shown' }).waitFor();
    await comes(({ draft }) => draft.enabled && draft.shows_planned, 'the draft is kept');
    assert.equal(
      await cell('Target, mm', 1)
        .innerText()
        .then((text) => text.replace(/\s+/g, ' ')),
      'L 0.0 P 0.0 S 10.0',
    );
    await shoot(page, 'beam-compare');
    await bar('Back to the draft').click();
    await comes(({ draft }) => draft.enabled && !draft.shows_planned, 'the draft again');
  });

  later('a draft is kept under a name, reset, and taken up again', async () => {
    await bar('Keep').click();
    await page.locator('[aria-label="Name of the kept draft"]').fill('From above');
    await page.keyboard.press('Enter');
    await comes(({ kept }) => kept['draft-1']?.name === 'From above' && kept['draft-1'].target_mm.join() === '3,4,10', 'it is kept');
    await bar('Reset to planned').click();
    await comes(({ draft }) => !draft.enabled, 'the planned beam again');
    await page.waitForFunction(() => document.querySelectorAll('.beam-bar').length === 0);
    await row('kept:draft-1').click();
    await panel('Draft it').click();
    await comes(({ draft }) => draft.enabled && draft.line.entry_mm.join() === '3,4,110', 'it is the draft');
    assert.match((await row('kept:draft-1').innerText()).replace(/\n/g, ''), /From above/);
  });

  later('the draft is exported as JSON with plan, frame and both lines, and as a card for SERA', async () => {
    const save = async (words) => {
      await bar('Export').click();
      await page.locator('.beam-export button:not([disabled])', { hasText: words }).waitFor();
      const [file] = await Promise.all([page.waitForEvent('download'), page.locator('.beam-export button', { hasText: words }).click()]);
      return (await bytesOf(file)).toString();
    };
    const text = await save('SERA beam card');
    assert.match(text, /^ +1\.0000000E\+01 +0\.0000000E\+00 /m); // distance in cm, φ
    const file = JSON.parse(await save('JSON'));
    assert.deepEqual(
      [file.plan.id, file.draft.name, file.draft.target_lps_mm, file.draft.length_mm, file.planned.target_lps_mm, file.moved.target_mm],
      ['phantom', 'From above', [3, 4, 10], 100, planned.target, 5],
    );
    assert.deepEqual(file.frame.units, { length: 'mm', angle: 'degree' });
    near(
      [file.draft.sera.phi_deg, ...[10, 3, -4].map((mm) => mm / 10)],
      [0, file.draft.sera.target_cm[2], file.draft.sera.target_cm[1], file.draft.sera.target_cm[0]],
      1e-9,
      'as SERA has it: PA, RL, IS',
    );
  });

  later('the report to print says under the picture whose dose it shows', async () => {
    const menu = async (words) => {
      await page.locator('[aria-label="Snapshot"]').click();
      await page.locator('.snapshots button', { hasText: words }).click();
    };
    await menu('Add it to the report');
    await page.locator('.toasts', { hasText: 'In the report to print: 1 picture' }).waitFor();
    await menu(/^\s*Report to print/);
    await page
      .locator('.printout figure .values', { hasText: /^Draft beam: dose shown belongs to the planned beam, target moved 5\.0 mm\.$/ })
      .waitFor();
    await page.locator('.printout [aria-label="Close"]').click();
  });

  later('nothing lies over anything, and the rules of accessibility hold', async () => {
    await page.keyboard.press('Escape'); // the message
    await row('beam:').click();
    await panel('Move target').click();
    await settled(2);
    await page.waitForFunction(() => !document.querySelector('.toasts .toast'));
    assert.deepEqual(await overlaps(page), []);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'beam-draft');
    assert.deepEqual(world.errors, []);
  });
});
