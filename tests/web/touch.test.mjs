// Fingers on the pictures: what a tablet sends, through the real browser and the real daemon.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { full, header, later, missing, newer, once, shoot, startWorld } from './browser.mjs';

const tablet = { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true };

describe('fingers', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let page;
  let touch; // (type, points) as the screen tells the browser

  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
  });

  const open = async () => {
    room = await world.newRoom();
    page = await world.newPage(`rooms/${room}`, tablet);
    for (const view of [1, 2]) await full(page, view);
    const devtools = await page.context().newCDPSession(page);
    touch = (type, points) => devtools.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  };
  const middle = async (view) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  /** Fingers from their first places to their last, in steps. */
  const gesture = async (from, to, { steps = 8 } = {}) => {
    await touch('touchStart', from);
    for (let step = 1; step <= steps; step++)
      await touch(
        'touchMove',
        from.map(([x, y], finger) => [x + ((to[finger][0] - x) * step) / steps, y + ((to[finger][1] - y) * step) / steps]),
      );
    await touch('touchEnd', []);
  };
  const matrixOf = async (view) => Object.values((await header(page, view)).clip_from_lps_mm);
  /** Until a picture with another matrix has come to rest. */
  const turned = async (view, before) => {
    await page.waitForFunction(
      ([n, old]) =>
        Object.values(globalThis.beamroom.stats().headers[n].clip_from_lps_mm).some((value, at) => Math.abs(value - old[at]) > 1e-4),
      [view, before],
    );
    await full(page, view);
    return matrixOf(view);
  };
  /** Where in the picture, px from its left and top, a patient point is. */
  const pixelOf = async (view, point) => {
    const { width, height } = await page.locator(`#picture-${view}`).boundingBox();
    const m = await matrixOf(view);
    const row = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
    return [((row(0) / row(3) + 1) / 2) * width, ((1 - row(1) / row(3)) / 2) * height];
  };
  const halfVoxelPx = 1; // the crosshair snaps to voxels of 1 mm, which are less than 2 px here
  const crosshairOf = async () => {
    const { sagittal, coronal, axial } = (await world.scene(room)).image.slices;
    return [sagittal.position_mm, coronal.position_mm, axial.position_mm];
  };
  /** Waits until what is asked for comes as near as that: the last step of a gesture may still be on its way. */
  const comesNear = async (ask, expected, tolerance, words) => {
    const isNear = (found) => found.every((value, at) => Math.abs(value - expected[at]) <= tolerance);
    const found = await until(ask, isNear, 60000);
    assert.ok(isNear(found), `${words}: ${found}, expected ${expected}`);
  };

  once('one finger turns the 3-D picture as a mouse does: 225 px are 90 degrees', async () => {
    await open();
    const [x, y] = await middle(1);
    const before = await matrixOf(1);
    await gesture([[x - 112, y]], [[x + 113, y]], { steps: 15 });
    await turned(1, before);
    await page.waitForFunction(() => document.querySelector('[data-view="1"] [data-letters]').dataset.letters === 'PR AL S I');
    await page.context().close();
  });

  once('two fingers move the 3-D picture with them and zoom it, and turn nothing', async () => {
    await open();
    const [x, y] = await middle(1);
    const before = await matrixOf(1);
    await gesture(
      [
        [x - 40, y],
        [x + 40, y],
      ],
      [
        [x - 10, y + 30],
        [x + 70, y + 30],
      ],
    );
    const moved = await until(
      () => matrixOf(1),
      (m) => m[12] > before[12] && m[13] < before[13],
      60000,
    );
    assert.ok(moved[12] > before[12] && moved[13] < before[13], 'to the right and down, as the fingers');
    assert.equal(await page.locator('[data-view="1"] [data-letters]').getAttribute('data-letters'), 'RA LP S I', 'not turned');
    await gesture(
      [
        [x - 40, y],
        [x + 40, y],
      ],
      [
        [x - 80, y],
        [x + 80, y],
      ],
    );
    // perspective: w at the patient's origin is its distance to the eye along the line of sight; moving leaves it, twice the spread lessens it
    const zoomed = await until(
      () => matrixOf(1),
      (m) => m[15] < before[15] * 0.75,
      60000,
    );
    assert.ok(zoomed[15] < before[15] * 0.75, `nearer: ${before[15]} mm, then ${zoomed[15]} mm`);
    await page.context().close();
  });

  once('one finger on a slice takes the crosshair along, in all panes', async () => {
    await open();
    const box = await page.locator('#picture-2').boundingBox();
    const [x, y] = await middle(2);
    const { scene_revision: revision } = await header(page, 2);
    await gesture([[x - 50, y - 40]], [[x + 30, y + 20]]);
    await comesNear(
      async () => pixelOf(2, await crosshairOf()),
      [x + 30 - box.x, y + 20 - box.y],
      1 + halfVoxelPx,
      'the crosshair is under the finger',
    );
    const point = await crosshairOf();
    await newer(page, 4, revision);
    assert.match(
      await page.locator('[data-view="4"] .where').textContent(),
      new RegExp(`P ${String(Math.abs(point[1]).toFixed(1)).replace('.', '\\.')}|P .${Math.abs(point[1]).toFixed(1)}`),
    );
    await page.setViewportSize({ width: 820, height: 1180 });
    await page.waitForFunction(() => document.querySelector('.banner').clientWidth === 820);
    const isWhole = (element) => element.scrollWidth <= element.clientWidth && element.scrollHeight <= element.clientHeight;
    assert.ok(await page.locator('.plan-name h1 > span').first().evaluate(isWhole), 'the name of the plan, upright');
    await page.context().close();
  });

  later('two fingers on a slice move and zoom it about the point between them; the crosshair stays in the patient', async () => {
    await open();
    const box = await page.locator('#picture-2').boundingBox();
    const [x, y] = await middle(2);
    const point = await crosshairOf();
    const at = await pixelOf(2, point);
    await gesture(
      [
        [x - 40, y],
        [x + 40, y],
      ],
      [
        [x - 15, y + 35],
        [x + 65, y + 35],
      ],
    );
    await comesNear(() => pixelOf(2, point), [at[0] + 25, at[1] + 35], 1.5, 'the picture moved with the fingers');
    const held = await pixelOf(2, point);
    await gesture(
      [
        [x - 40, y],
        [x + 40, y],
      ],
      [
        [x - 80, y],
        [x + 80, y],
      ],
    );
    const about = [x - box.x, y - box.y];
    await comesNear(
      () => pixelOf(2, point),
      held.map((value, axis) => about[axis] + 2 * (value - about[axis])),
      2.5,
      'twice as large about the middle of the fingers',
    );
    assert.deepEqual(await crosshairOf(), point);
    await shoot(page, 'touch-slice');
    await page.context().close();
  });

  later('a finger that is left of two does nothing', async () => {
    await open();
    const [x, y] = await middle(1);
    const before = await matrixOf(1);
    await touch('touchStart', [
      [x - 40, y],
      [x + 40, y],
    ]);
    await touch('touchMove', [
      [x - 40, y + 20],
      [x + 40, y + 20],
    ]);
    await turned(1, before);
    const held = await page.evaluate(() => JSON.stringify(globalThis.beamroom.stats().headers[1].clip_from_lps_mm));
    await touch('touchEnd', [[x - 40, y + 20]]); // what is still down
    for (let step = 1; step <= 6; step++) await touch('touchMove', [[x - 40 + 20 * step, y + 20]]);
    await touch('touchEnd', []);
    await page.locator('[data-view="1"] button[aria-label="Maximise 3-D"]').tap(); // a round trip after it: the size changes
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[1].width_px > 800);
    assert.equal(await page.locator('[data-view="1"] [data-letters]').getAttribute('data-letters'), 'RA LP S I', held);
    await page.context().close();
  });

  later('a finger that rests sets the crosshair there and shows the probe', async () => {
    await open();
    const box = await page.locator('#picture-2').boundingBox();
    const [x, y] = [box.x + box.width / 2 + 20, box.y + box.height / 2 + 10];
    const { scene_revision: revision } = await header(page, 2);
    await touch('touchStart', [[x, y]]);
    await newer(page, 2, revision);
    await touch('touchEnd', []);
    await comesNear(
      async () => pixelOf(2, await crosshairOf()),
      [20 + box.width / 2, 10 + box.height / 2],
      1 + halfVoxelPx,
      'under the finger',
    );
    await page.context().close();
  });

  later('every control is large enough for a finger', async () => {
    await open();
    const small = () =>
      page.evaluate(() =>
        [...document.querySelectorAll('.room button, .room a.button')]
          .filter((button) => button.checkVisibility())
          .map((button) => ({
            name: button.getAttribute('aria-label') ?? button.textContent.trim(),
            height: button.getBoundingClientRect().height,
          }))
          .filter(({ height }) => height < 44 && height > 1),
      );
    const holds = async (where) =>
      assert.deepEqual(
        (await small()).filter(({ name }) => !/^(Full|Live|Reduced|Stale|Link|Disconnected)/.test(name)),
        [],
        where,
      );
    await holds('at first');
    await page.locator('.dock button', { hasText: 'Parts' }).tap();
    await page.locator('[role="tab"]', { hasText: 'Regions' }).tap();
    await holds('the regions');
    await shoot(page, 'touch-tree');
    await page.locator('[data-region="tumour"] button.name').tap();
    for (const tab of ['Selection', 'Probe', 'Plan']) {
      await page.locator('[role="tab"]', { hasText: tab }).tap();
      await holds(tab);
    }
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
