// Panes along a beam: the camera stays on the beam until it is left, the ring has its true size, slice and clip plane slide, and who follows sees it.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, later, missing, newer, once, shoot, startWorld } from './browser.mjs';
import { writeVolume } from './volumes.mjs';

// the phantom's beam, from plan.json: straight down the patient, so that anterior is up and the patient's left is at the left
const [entry, target, aperture] = [[0, 0, 88], [0, 0, 10], 100];
const length = 78;
const [eye, slicePane] = [7, 8];

describe('panes along a beam', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  let page;
  let room;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-beam-'));
    mkdirSync(join(folder, 'no-beam'));
    writeVolume(join(folder, 'no-beam'), 'No beam', {
      size: [30, 30, 20],
      stepMm: [4, 4, 5],
      region: [
        [10, 10, 5],
        [20, 20, 12],
      ],
    });
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const open = async (plan = 'phantom', options = {}) => {
    await page?.context().close();
    room = await world.newRoom(plan);
    page = await world.newPage(`rooms/${room}`, options);
    await full(page, 1);
  };
  const openEye = async (options) => {
    await open('phantom', options);
    await page.locator('#picture-1').focus();
    await page.keyboard.press('b');
    await full(page, eye);
    await page.locator('.beam-foot').waitFor();
    await fits(eye);
  };
  const matrixOf = async (view, of = page) => Object.values((await header(of, view)).clip_from_lps_mm);
  const document = (view) => page.evaluate((n) => globalThis.beamroom.stats().documents[n], view);
  const scene = async () => world.scene(room);
  /** Where a patient point is on a picture, -1 to 1, and how it is in front of the eye. */
  const onPicture = (m, p) => {
    const row = (r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    return [row(0) / row(3), row(1) / row(3)];
  };
  /** The picture has the size of its pane: the foot has been drawn, and a picture that fits above it. */
  const fits = async (view, of = page) => {
    const { width, height } = await of.locator(`#picture-${view}`).boundingBox();
    await of.waitForFunction(
      ([n, w, h]) => {
        const { width_px: across, height_px: down, scale_percent: percent } = globalThis.beamroom.stats().headers[n];
        return percent === 100 && Math.abs(across - w) <= 1 && Math.abs(down - h) <= 1;
      },
      [view, width, height],
    );
  };
  /** px of the screen for 1 mm to the picture's right, at the target. */
  const scaleOf = async (view, of = page) => {
    const { width, height } = await of.locator(`#picture-${view}`).boundingBox();
    const { width_px: across, height_px: down, clip_from_lps_mm: m } = await header(of, view);
    const shownPx = across * Math.min(width / across, height / down); // a shared picture is shown as large as fits
    return (onPicture(Object.values(m), [target[0] - 10, target[1], target[2]])[0] * shownPx) / 2 / 10;
  };
  const isNear = (a, b, tolerance = 1e-4) => a.every((value, at) => Math.abs(value - b[at]) <= tolerance * Math.max(1, Math.abs(b[at])));
  const middle = async (view) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const drag = async ([x, y], [toX, toY]) => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(toX, toY, { steps: 5 });
    await page.mouse.up();
  };
  const shown = (of = page) =>
    of.evaluate(() => [...globalThis.document.querySelectorAll('.pane:not([hidden])')].map((pane) => Number(pane.dataset.view)));
  const ring = (on = page) => on.getByRole('button', { name: 'Ring', exact: true });

  once('key B looks along the beam, with anterior up as it runs down the patient; a drag turns nothing, R is home', async () => {
    await openEye();
    assert.ok((await shown()).includes(eye));
    const home = await matrixOf(eye);
    const { width, height } = await page.locator(`#picture-${eye}`).boundingBox();
    const part = (120 * (await scaleOf(eye))) / Math.min(width, height);
    assert.ok(Math.abs(part - 0.7) < 0.01, `60 mm about the axis fill 70 % of the smaller side, not ${part}`);
    assert.ok(
      isNear(onPicture(home, target), [0, 0]) && isNear(onPicture(home, entry), [0, 0]),
      'entry and target lie one behind the other, in the middle',
    );
    const [left, up] = [onPicture(home, [10, 0, 10]), onPicture(home, [0, -10, 10])];
    assert.ok(left[0] < 0 && Math.abs(left[1]) < 1e-6 && up[1] > 0 && Math.abs(up[0]) < 1e-6);
    assert.match(await page.locator(`[data-view="${eye}"] .pane-head`).textContent(), /camera locked to beam/);
    const [x, y] = await middle(eye);
    await drag([x, y], [x + 60, y + 30]);
    await page.getByText('The camera is locked to the beam.').waitFor();
    assert.equal((await document(eye)).camera.position_mm ?? null, null, 'no camera was sent');
    await page.mouse.wheel(0, -100);
    const zoomed = await until(
      () => scaleOf(eye),
      (now) => now > 1.05 * (onPicture(home, [-10, 0, 10])[0] * 1),
      60000,
    );
    assert.ok(isNear(onPicture(await matrixOf(eye), target), [0, 0]), 'about the target');
    assert.ok(zoomed > 0);
    await page.locator(`#picture-${eye}`).focus();
    await page.keyboard.press('r');
    await until(
      () => matrixOf(eye),
      (m) => isNear(m, home),
      60000,
    );
    await page.keyboard.press('b');
    await full(page, 1);
    assert.deepEqual(await shown(), [1, 2, 3, 4]);
    assert.deepEqual(world.errors, []);
  });

  once('the ring keeps the target as large as it was, follows its handle and the keys, and unlocking shows the same picture', async () => {
    await openEye();
    const before = await scaleOf(eye);
    await ring().click();
    await until(
      () => header(page, eye),
      ({ pixels_per_mm: scale }) => scale > 0,
      60000,
    );
    await full(page, eye);
    assert.equal((await document(eye)).beam.aperture_mm, aperture);
    const scale = await scaleOf(eye);
    assert.ok(Math.abs(scale / before - 1) < 2e-3, `${scale} px per mm after ${before}`);
    const handle = page.getByRole('slider', { name: 'Ring', exact: true });
    const at = await handle.boundingBox();
    const [x, y] = await middle(eye);
    const half = (aperture / 2) * scale * Math.SQRT1_2;
    assert.ok(
      Math.abs(at.x + at.width / 2 - x - half) < 1 && Math.abs(y - at.y - at.height / 2 - half) < 1,
      'up and to the right, on the ring',
    );
    await drag([x + half, y - half], [x + 30 * scale * Math.SQRT1_2, y - 30 * scale * Math.SQRT1_2]);
    const {
      beam: { aperture_mm: mm },
    } = await until(
      () => document(eye),
      ({ beam }) => beam.aperture_mm !== aperture,
      60000,
    );
    assert.ok(Math.abs(mm - 60) <= 0.5 + 1 / scale, `${mm} mm`); // a half millimetre, and a pixel on both sides
    await handle.press('Shift+ArrowUp');
    await page.getByText(`ring ${mm + 10} mm`, { exact: true }).waitFor();
    assert.deepEqual(await axe(page), []);
    await until(
      () => document(eye),
      ({ beam }) => beam.aperture_mm === mm + 10,
      60000,
    );
    await full(page, eye);
    await page.getByRole('treeitem', { name: /^beam-1/ }).click();
    await page.getByText('Regions in the ring').waitFor();
    assert.equal(
      await page.locator('.beam-table tr', { hasText: 'Aperture' }).locator('td').textContent(),
      `${aperture}.0 mm`,
      'a ring that is drawn changes nothing of the beam',
    );
    await shoot(page, 'beam-eye-1600x1000');
    const points = [entry, target, [30, -20, 10], [-40, 30, 60], [10, 10, -50]];
    /** Where they are in halves of the smaller side: the 3-D pane has no foot, so its picture is a little higher. */
    const places = async (view) => {
      const { width_px: across, height_px: down, clip_from_lps_mm: m } = await header(page, view);
      return points.flatMap((point) =>
        onPicture(Object.values(m), point).map((value, axis) => (value * [across, down][axis]) / Math.min(across, down)),
      );
    };
    const locked = await places(eye);
    await page.locator('.beam-lock').click();
    await page.locator('#picture-1').waitFor();
    await until(
      () => places(1),
      (now) => isNear(now, locked, 1e-3),
      60000,
    );
    assert.ok(!(await shown()).includes(eye));
    const { scene_revision: before3d } = await header(page, 1);
    await call(
      `${world.daemon.url}/api/v1/rooms/${room}/scene`,
      'PATCH',
      { beam: { slice: { visible: true, along_mm: 20 } } },
      { 'If-Match': '*' },
    );
    await newer(page, 1, before3d);
    await page.locator('#picture-1').press(']'); // in other panes the keys move the slice that is shown
    await until(scene, ({ beam }) => beam.slice.along_mm === 21, 60000);
    assert.deepEqual(world.errors, []);
  });

  later('slice and clip plane slide together or apart, by keys, field and wheel; the pair of panes stays over a reload', async () => {
    await openEye();
    await page.locator(`#picture-${eye}`).focus();
    await page.keyboard.press('Shift+Digit7');
    assert.deepEqual(await shown(), [eye, slicePane]);
    await until(scene, ({ beam }) => beam.slice.along_mm === length, 60000); // it was never moved: at the target
    await full(page, slicePane);
    await page.keyboard.press('Shift+BracketRight');
    await page.keyboard.press('BracketLeft');
    const { clip } = await until(scene, ({ beam }) => beam.slice.along_mm === length + 9, 60000);
    assert.equal(clip.beam.along_mm, length + 9, 'in the same patch');
    await page.getByLabel('slide together').uncheck();
    await page.getByLabel('Along the beam in mm').fill('40.25');
    await page.getByLabel('Along the beam in mm').press('Enter');
    const apart = await until(scene, ({ beam }) => beam.slice.along_mm === 40.3, 60000);
    assert.equal(apart.clip.beam.along_mm, length + 9);
    await page.getByLabel('clip in front').check();
    await page.getByLabel('slice', { exact: true }).check();
    await until(scene, ({ clip: { beam }, beam: { slice } }) => beam.enabled && slice.visible, 60000);
    const [x, y] = await middle(slicePane);
    await page.mouse.move(x, y);
    await page.mouse.wheel(0, -100); // as in other slices: forwards
    const { beam } = await until(scene, ({ beam: { slice } }) => slice.along_mm !== 40.3, 60000);
    assert.ok(beam.slice.along_mm > 40.3);
    await until(
      () => page.locator(`[data-view="${slicePane}"] .where`).textContent(),
      (words) => words.startsWith(`${beam.slice.along_mm.toFixed(1)} mm from source end, `),
      60000,
    );
    await shoot(page, 'beam-eye-and-slice-1600x1000');
    await page.reload();
    await full(page, slicePane);
    assert.deepEqual(await shown(), [eye, slicePane]);
    await page.getByLabel('slide together').waitFor();
    assert.equal(await page.getByLabel('slide together').isChecked(), false);
    assert.deepEqual(world.errors, []);
  });

  later('without a beam there are no such panes; one whose draft is switched off shows something else and says so', async () => {
    await open('no-beam');
    const menu = async () => {
      await page.locator('[data-view="1"] h2 button').click();
      const words = await page.locator('.view-kinds button').allTextContents();
      await page.keyboard.press('Escape');
      return words.map((word) => word.trim());
    };
    assert.ok(!(await menu()).some((word) => /beam/i.test(word)));
    await page.locator('#picture-1').focus();
    await page.keyboard.press('b');
    await page.getByText('This plan has no beam.').waitFor();
    const draft = (enabled) =>
      call(
        `${world.daemon.url}/api/v1/rooms/${room}/scene`,
        'PATCH',
        { beam: { draft: { enabled, line: { entry_mm: [60, -80, 40], target_mm: [60, 60, 45] } } } },
        { 'If-Match': '*' },
      );
    assert.equal((await draft(true)).status, 200);
    await until(menu, (words) => words.includes('Beam slice'), 60000);
    await page.locator('#picture-1').focus();
    await page.keyboard.press('b');
    await full(page, eye);
    await page.getByText('camera locked to draft beam').waitFor();
    await draft(false);
    await page.getByText('There is no beam: the pane shows something else now.').waitFor();
    assert.deepEqual(await shown(), [1, 2, 3, 4]);
    assert.deepEqual(world.errors, []);
  });

  later("who follows sees the presenter's beam's eye, and is alone after a zoom of their own", async () => {
    await openEye();
    const other = await world.newPage(`rooms/${room}`, { viewport: { width: 1280, height: 800 } });
    await full(other, 1);
    await other.locator('#picture-1').focus();
    await other.keyboard.press('b');
    await full(other, eye);
    await ring().click();
    await page.locator(`#picture-${eye}`).focus();
    for (let n = 0; n < 3; n++) await page.keyboard.press('+');
    await until(
      () => header(other, eye),
      ({ pixels_per_mm: scale }) => scale > 0,
      60000,
    );
    const scale = await until(
      () => header(page, eye),
      ({ pixels_per_mm: now }) => now > 0,
      60000,
    );
    await full(page, eye);
    const { camera } = await document(eye);
    await until(
      () => matrixOf(eye, other),
      async (m) => isNear(m, await matrixOf(eye)),
      60000,
    );
    assert.ok(scale);
    await full(other, eye);
    const before = await scaleOf(eye, other);
    const theirs = await matrixOf(eye);
    await other.locator(`#picture-${eye}`).focus();
    await other.keyboard.press('+');
    await other.getByText('On your own.').waitFor();
    const after = await until(
      () => scaleOf(eye, other),
      (now) => Math.abs(now / before - 1) > 0.05,
      60000,
    );
    assert.ok(Math.abs(after / before - 1.15) < 0.01, `${after / before}`); // as the picture was, and one step
    assert.deepEqual(await matrixOf(eye), theirs, "the presenter's picture stays");
    assert.deepEqual((await document(eye)).camera, camera);
    await other.context().close();
    assert.deepEqual(world.errors, []);
  });
});
