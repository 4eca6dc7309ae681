// Panes and cameras in the browser: the opening camera is home, only what changed is drawn, layouts are kept, what goes together.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { sleep, until } from '../api/daemon.mjs';
import { full, header, later, missing, once, shoot, startWorld } from './browser.mjs';
import { writeLabels } from './labels.mjs';
import { writeVolume } from './volumes.mjs';

describe('panes and cameras', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  let page;
  let room;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-views-'));
    mkdirSync(join(folder, 'image-alone'));
    writeVolume(join(folder, 'image-alone'), 'Image alone', { size: [20, 30, 8], stepMm: [3, 1, 7] });
    mkdirSync(join(folder, 'tiny-region'));
    writeVolume(join(folder, 'tiny-region'), 'Tiny region', {
      size: [60, 50, 40],
      stepMm: [4, 4, 5],
      region: [
        [40, 30, 10],
        [43, 32, 12],
      ],
    });
    mkdirSync(join(folder, 'sides'));
    writeLabels(join(folder, 'sides'), 'Sides', ['left', 'right']); // regions without an image
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
    for (const view of [1, 2, 3, 4]) await full(page, view);
  };
  const matrixOf = async (view) => Object.values((await header(page, view)).clip_from_lps_mm);
  const isNear = (a, b, tolerance = 1e-5) => a.every((value, at) => Math.abs(value - b[at]) <= tolerance * Math.max(1, Math.abs(b[at])));
  const becomes = (view, test) => until(() => matrixOf(view), test, 60000);
  const middle = async (view) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const drag = async (view, dx, dy, { keys = [], from = [0, 0], steps = 6 } = {}) => {
    const [x, y] = await middle(view);
    await page.mouse.move(x + from[0], y + from[1]);
    for (const key of keys) await page.keyboard.down(key);
    await page.mouse.down();
    await page.mouse.move(x + from[0] + dx, y + from[1] + dy, { steps });
    await page.mouse.up();
    for (const key of keys) await page.keyboard.up(key);
  };
  const stats = () => page.evaluate(() => globalThis.beamroom.stats());
  const undo = (page_) => page_.locator('[data-act="undo"]');
  /** Maps patient space to the picture, x and y from -1 to 1. */
  const onPicture = (m, p) => {
    const row = (r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
    return [row(0) / row(3), row(1) / row(3)];
  };

  for (const plan of ['phantom', 'image-alone', 'tiny-region', 'sides'])
    (plan === 'sides' ? once : later)(
      `${plan}: the camera at opening is home, and the first touch moves nothing but what it moves`,
      async () => {
        await open(plan);
        for (const view of plan === 'phantom' ? [1, 2, 3, 4] : [1, 3]) {
          const opening = await matrixOf(view);
          const [x, y] = await middle(view);
          await page.mouse.move(x, y);
          await page.keyboard.down('Shift'); // pans in every pane
          await page.mouse.down();
          await page.mouse.move(x + 5, y); // beyond the slop of a tap
          await page.mouse.up();
          await page.keyboard.up('Shift');
          const touched = await becomes(view, (m) => !isNear(m, opening));
          const { width, height } = await page.locator(`#picture-${view}`).boundingBox();
          const target = (await page.evaluate((n) => globalThis.beamroom.stats().documents[n].camera.target_mm, view)).map(Number);
          const [before, now] = [opening, touched].map((m) => onPicture(m, target));
          assert.ok(
            Math.abs(((now[0] - before[0]) * width) / 2) <= 5.1 && Math.abs(((now[1] - before[1]) * height) / 2) < 0.1,
            `view ${view}: ${before} to ${now}`,
          );
          await page.locator(`#picture-${view}`).focus();
          await page.keyboard.press('r');
          const home = await becomes(view, (m) => isNear(m, opening));
          assert.ok(isNear(home, opening), `view ${view}: reset is the picture of opening`);
        }
      },
    );

  later('a crosshair dragged in one pane draws the two others, and 3-D where it shows a slice that moved', async () => {
    await open();
    const settled = async () => {
      // every still is there, and no more pictures come
      for (let before = -1, { frames } = await stats(); before !== frames; { frames } = await stats()) {
        before = frames;
        await sleep(700);
        for (const view of [1, 2, 3, 4]) await full(page, view);
      }
    };
    const counted = async (act) => {
      await settled();
      const { frames_of: from } = await stats();
      await act();
      await settled();
      const { frames_of: to } = await stats();
      return Object.fromEntries([1, 2, 3, 4].map((view) => [view, to[view] - from[view]]));
    };
    await drag(2, 10, 10);
    await drag(4, 10, 10); // the crosshair is on a voxel now: no slice is moved to one by the drags that follow
    const axial = await counted(() => drag(2, -40, 25, { from: [40, 0] })); // to the middle line; the phantom shows its axial slice in 3-D, which stays
    assert.deepEqual([axial[1], axial[2]], [0, 0], 'what did not change is not drawn');
    assert.ok(axial[3] > 0 && axial[4] > 0);
    const coronal = await counted(() => drag(4, 0, 30)); // along the middle line: the axial slice moves, in its pane and in 3-D
    assert.deepEqual([coronal[3], coronal[4]], [0, 0]);
    assert.ok(coronal[1] > 0 && coronal[2] > 0);
    const { headers, input_to_paint_ms: times } = await stats();
    assert.equal(
      new Set(
        Object.values(headers)
          .filter(Boolean)
          .map(({ scene_revision }) => scene_revision),
      ).size,
      1,
      'all pictures are of the newest revision',
    );
    assert.ok(times.length > 0, 'inputs are answered by the panes that changed');
  });

  later('rolls by Ctrl+Shift drag, Alt drag and keys, looks from each side, fits and resets: each one step to undo', async () => {
    await open();
    const home = await matrixOf(1);
    const acts = [
      ['Ctrl+Shift drag', () => drag(1, 60, 60, { keys: ['Control', 'Shift'], from: [0, -60] })],
      ['Alt drag', () => drag(1, 60, 60, { keys: ['Alt'], from: [0, -60] })],
      ['key', () => page.keyboard.press(',')],
      ['Numpad7', () => page.keyboard.press('Numpad7')],
      ['Shift+Numpad1', () => page.keyboard.press('Shift+Numpad1')],
      ['the cube', () => page.locator('[data-view="1"] [aria-label="Look from left"]').press('Enter')],
      [
        'parallel',
        async () => {
          await page.locator('[data-view="1"] .view-all').click();
          await page.getByRole('dialog', { name: 'Camera' }).getByRole('radio', { name: 'Parallel' }).click();
          await page.keyboard.press('Escape');
        },
      ],
      [
        'fit',
        async () => {
          await page.locator('[data-region="tumour"] button.name').click();
          await page.locator('#picture-1').focus();
          await page.keyboard.press('g');
        },
      ],
    ];
    for (const [name, act] of acts) {
      await page.locator('#picture-1').focus();
      await act();
      const changed = await becomes(1, (m) => !isNear(m, home));
      assert.ok(!isNear(changed, home), name);
      await full(page);
      await undo(page).click();
      assert.ok(isNear(await becomes(1, (m) => isNear(m, home)), home), `${name} is one step`);
      await full(page);
      assert.equal(await undo(page).isDisabled(), true, name);
    }
  });

  later('a quarter of a roll turns the picture with the pointer', async () => {
    await open();
    const before = await matrixOf(1);
    await drag(1, 80, 80, { keys: ['Alt'], from: [0, -80], steps: 12 }); // from 12 o'clock to 3
    const target = await page.evaluate(() => globalThis.beamroom.stats().documents[1].camera.target_mm);
    const up = [target[0], target[1], target[2] + 20];
    const turned = await becomes(1, (m) => Math.abs(onPicture(m, up)[1]) < 0.01);
    const [x] = onPicture(turned, up);
    assert.ok(x > 0.05, `what was above the middle is at its right: ${x}, before ${onPicture(before, up)}`);
    await page.keyboard.press('Control+z');
    await full(page);
  });

  later('the six sides: what lies there faces the eye', async () => {
    await page.locator('[data-view="1"] .view-all').click();
    const dialog = page.getByRole('dialog', { name: 'Camera' });
    for (const [name, axis, sign] of [
      ['anterior', 1, 1],
      ['posterior', 1, -1],
      ['left', 0, -1],
      ['right', 0, 1],
      ['superior', 2, -1],
      ['inferior', 2, 1],
    ]) {
      await dialog.getByRole('button', { name: `Look from ${name}` }).click();
      // the line of sight is the third row of a perspective's w
      const m = await becomes(1, (now) => now[3 + 4 * axis] * sign > 0.999);
      assert.ok(m[3 + 4 * axis] * sign > 0.999, `${name}: ${[m[3], m[7], m[11]]}`);
    }
    await page.keyboard.press('Escape');
  });

  later('the patient axes get numbers at their ticks, which go with the ticks and are undone in one step', async () => {
    await open();
    await page.locator('[data-view="1"] .view-all').click();
    const dialog = page.getByRole('dialog', { name: 'Camera' });
    const box = (name) => dialog.getByRole('checkbox', { name, exact: true });
    const axesAre = (wanted) => until(async () => (await world.scene(room)).axes, wanted, 60000);
    assert.equal(await box('Numbers').count(), 0, 'no axes, no numbers');
    await box('Patient axes').check();
    await box('Ticks').waitFor();
    if (!(await box('Ticks').isChecked())) await box('Ticks').check();
    assert.equal(await box('Numbers').isChecked(), false);
    await box('Numbers').check();
    await axesAre(({ visible, ticks, numbers }) => visible && ticks && numbers);
    await full(page, 1);
    await shoot(page, 'axis-numbers');
    await box('Ticks').uncheck();
    await box('Numbers').waitFor({ state: 'detached' });
    await page.keyboard.press('Escape');
    await page.keyboard.press('Control+z'); // the ticks
    await page.keyboard.press('Control+z'); // the numbers
    await axesAre(({ ticks, numbers }) => ticks && !numbers);
  });

  once('linked slices have as many mm per pixel and the crosshair at one place; one step to undo', async () => {
    await open();
    const scaleOf = async (view) => (await header(page, view)).pixels_per_mm;
    const before = await Promise.all([2, 3, 4].map(scaleOf));
    await page.locator('button[aria-label="Panes"]').click();
    await page.getByRole('checkbox', { name: 'Link zoom' }).check();
    await page.keyboard.press('Escape');
    await page.locator('#picture-2').focus();
    await page.keyboard.press('Control+ArrowLeft');
    for (let n = 0; n < 3; n++) await page.keyboard.press('+');
    const same = (values) => Math.max(...values) - Math.min(...values) < 1e-4 * values[0];
    const zoomed = await until(
      () => Promise.all([2, 3, 4].map(scaleOf)),
      (values) => same(values) && values[0] > before[0] * 1.4,
      60000,
    );
    assert.ok(same(zoomed), String(zoomed));
    for (const view of [2, 3, 4]) await full(page, view);
    const { sagittal, coronal, axial } = (await world.scene(room)).image.slices;
    const point = [sagittal.position_mm, coronal.position_mm, axial.position_mm];
    const places = await Promise.all(
      [2, 3, 4].map(async (view) => {
        const { width, height } = await page.locator(`#picture-${view}`).boundingBox();
        const [x, y] = onPicture(await matrixOf(view), point);
        return [(x * width) / 2, (y * height) / 2];
      }),
    );
    for (const place of places)
      assert.ok(Math.hypot(place[0] - places[0][0], place[1] - places[0][1]) < 1, `px from the middle: ${places.join(' | ')}`);
  });

  later('two 3-D pictures side by side turn alone, and together when linked; the layout is there after a reload', async () => {
    await open();
    await page.locator('[aria-label="Two panes"]').click();
    await page.locator('[data-view="2"] .view-kind button').click();
    await page.getByRole('menuitemradio', { name: '3-D 2' }).click();
    for (const view of [1, 6]) await full(page, view);
    const start = await matrixOf(1);
    assert.ok(isNear(await matrixOf(6), start));
    await page.locator('#picture-6').focus();
    await page.keyboard.press('ArrowLeft');
    await becomes(6, (m) => !isNear(m, start));
    await full(page, 6);
    assert.ok(isNear(await matrixOf(1), start), 'each has its own camera');
    await page.locator('[data-view="6"] .view-all').click();
    await page.getByRole('checkbox', { name: 'Link the 3-D cameras' }).check();
    await page.keyboard.press('Escape');
    const own = await matrixOf(6);
    assert.ok(isNear(await becomes(1, (m) => isNear(m, own)), own), 'linking takes the camera of this one');
    await page.locator('#picture-1').focus();
    await page.keyboard.press('ArrowUp');
    const turned = await becomes(1, (m) => !isNear(m, own));
    assert.ok(isNear(await becomes(6, (m) => isNear(m, turned)), turned));
    await page.locator('[data-view="6"] .view-all').click();
    const { sequence } = await header(page, 6);
    await page.getByRole('checkbox', { name: 'Only targets here' }).check();
    await page.waitForFunction((old) => globalThis.beamroom.stats().headers[6].sequence > old, sequence);
    await page.keyboard.press('Escape');
    assert.match(await page.locator('[data-view="6"] .where').textContent(), /only targets/);
    await full(page, 6);
    await shoot(page, 'views-two-3d');
    assert.equal(await undo(page).getAttribute('title'), 'Undo: regions of 3-D 2 (Ctrl+Z)');
    await page.keyboard.press('Control+z');
    await page.waitForFunction(() => !document.querySelector('[data-view="6"] .where').textContent.includes('only targets'));
    await page.keyboard.press('Control+z');
    assert.ok(isNear(await becomes(6, (m) => isNear(m, own)), own), 'one step takes both back');
    await page.reload();
    await full(page, 6);
    assert.deepEqual(
      await page.evaluate(() => [...document.querySelectorAll('.pane:not([hidden])')].map((pane) => Number(pane.dataset.view))),
      [1, 6],
    );
  });

  once('an oblique pane gets a plane through the crosshair, scrolls along its normal and takes the crosshair', async () => {
    await open();
    await page.locator('#picture-1').focus();
    await page.keyboard.press('Shift+Digit5');
    await full(page, 5);
    const planeOf = async () => Object.values((await world.scene(room)).image.obliques)[0];
    const made = await until(planeOf, Boolean, 60000);
    const { sagittal, coronal, axial } = (await world.scene(room)).image.slices;
    const point = [sagittal.position_mm, coronal.position_mm, axial.position_mm];
    made.origin_mm.forEach((value, at) => assert.ok(Math.abs(value - point[at]) < 1e-3));
    await page.locator('#picture-5').focus();
    for (let n = 0; n < 3; n++) await page.keyboard.press('ArrowUp');
    const moved = await until(planeOf, ({ origin_mm }) => String(origin_mm) !== String(made.origin_mm), 60000);
    const by = moved.origin_mm.map((value, at) => value - made.origin_mm[at]);
    const along = by.reduce((sum, value, at) => sum + value * made.normal[at], 0) / Math.hypot(...made.normal);
    assert.ok(Math.abs(Math.abs(along) - Math.hypot(...by)) < 1e-2, `${by} along ${made.normal}`);
    assert.deepEqual((await world.scene(room)).image.slices, { axial, coronal, sagittal }, 'the crosshair stays');
    await page.locator('.overlay .crosshair.off').waitFor({ state: 'attached' });
    const [x, y] = await middle(5);
    await page.mouse.click(x + 30, y - 20);
    const taken = await until(
      async () => (await world.scene(room)).image.slices,
      ({ axial: now }) => now.position_mm !== axial.position_mm,
      60000,
    );
    const plane = await planeOf();
    const offset = [taken.sagittal, taken.coronal, taken.axial].map(({ position_mm }, at) => position_mm - plane.origin_mm[at]);
    const height = offset.reduce((sum, value, at) => sum + value * plane.normal[at], 0) / Math.hypot(...plane.normal);
    assert.ok(Math.abs(height) < 0.15, `the crosshair lies in the plane, to its 0.1 mm: ${height}`);
    await shoot(page, 'views-oblique');
    const slider = page.locator('[data-view="5"] .slice-slider input');
    assert.match(await slider.getAttribute('aria-label'), /^Oblique slice, [LRPASI]{1,2} in mm$/);
  });

  later("who follows sees the presenter's oblique plane and second 3-D picture, and does not leave by showing them", async () => {
    await open();
    await page.locator('#picture-1').focus();
    await page.keyboard.press('Shift+Digit5');
    await full(page, 5);
    await until(async () => Object.keys((await world.scene(room)).image.obliques)[0], Boolean, 60000);
    const other = await world.newPage(`rooms/${room}`);
    await full(other, 1);
    const standing = async () => (await other.locator('.strip').textContent()).includes('Following');
    await other.locator('#picture-1').focus(); // its button is in the menu of panes when others are in the room
    await other.keyboard.press('Shift+Digit5');
    await full(other, 5);
    assert.equal(await standing(), true);
    await page.locator('#picture-5').focus();
    const first = await matrixOf(5);
    await page.keyboard.press('+');
    const nearer = await becomes(5, (m) => !isNear(m, first));
    const plane = async () => Object.values((await world.scene(room)).image.obliques)[0].origin_mm;
    const start = await plane();
    const { scene_revision: before } = await header(page, 5);
    await page.keyboard.press('ArrowUp');
    await until(plane, (at) => !isNear(at, start));
    // a camera looks at the middle of the plan's box across the plane, wherever that lies: a later picture is of the plane's new place
    await until(
      () => header(other, 5),
      (now) => now.scene_revision > before && isNear(Object.values(now.clip_from_lps_mm), nearer),
    );
    for (const each of [page, other]) {
      await each.locator('[data-view="5"] .view-kind button').click();
      await each.getByRole('menuitemradio', { name: '3-D 2' }).click();
      await full(each, 6);
    }
    assert.equal(await standing(), true);
    await page.locator('#picture-6').focus();
    await page.keyboard.press('Numpad3');
    const left = async () => Object.values((await header(other, 6)).clip_from_lps_mm);
    assert.ok((await until(left, (m) => m[3] < -0.999, 60000))[3] < -0.999, 'from the left');
    assert.ok(Object.values((await header(other, 1)).clip_from_lps_mm)[3] > -0.9, 'the first 3-D picture stays');
    await other.context().close();
  });

  later('with fingers: the figure opens six sides of 44 px, the slice slider and the menus are as large', async () => {
    await open('phantom', { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true });
    const small = (selector) =>
      page.locator(selector).evaluateAll((elements) =>
        elements
          .filter((element) => element.checkVisibility())
          .map((element) => {
            const { width, height } = element.getBoundingClientRect();
            return [element.getAttribute('aria-label') ?? element.textContent.trim(), width, height];
          })
          .filter(([, width, height]) => Math.min(width, height) < 44),
      );
    const start = await matrixOf(1);
    await page.locator('[data-view="1"] .view-all').tap();
    assert.deepEqual(await small('.view-all, .view-menu button, .slice-slider'), []);
    await page.getByRole('button', { name: 'Look from left' }).tap();
    const m = await becomes(1, (now) => !isNear(now, start) && now[3] < -0.999);
    assert.ok(m[3] < -0.999);
    await page.locator('[data-view="3"] .view-kind button').tap();
    assert.deepEqual(await small('.view-kind button'), []);
    await page.getByRole('menuitemradio', { name: 'Oblique' }).tap();
    await full(page, 5);
    await page.locator('.dock button', { hasText: 'Panes' }).tap();
    assert.deepEqual(await small('.view-panes button, .view-panes label'), []);
    await page.getByRole('radio', { name: 'Two panes' }).tap();
    await page.waitForFunction(() => document.querySelectorAll('.pane:not([hidden])').length === 2);
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
