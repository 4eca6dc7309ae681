// Clip planes and oblique planes on the page: by row, by number, by the handle of a line, by keys and fingers; the scene on the server says what happened.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, later, missing, once, shoot, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';
import { sizes } from './room_states.mjs';

describe('clip planes and oblique planes', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let page;

  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
  });

  const open = async (options = sizes.wide, sections = ['clip']) => {
    room = await world.newRoom();
    page = await world.newPage(`rooms/${room}`, options);
    for (const view of [1, 2, 3, 4]) await full(page, view);
    for (const id of sections) await page.locator(`[data-key="section:${id}"]`).click();
  };
  const scene = () => world.scene(room);
  /** Until a field of the scene on the server is near to a value. */
  const comes = async (pick, expected, tolerance = 0, words = '') => {
    const isThere = (value) => (typeof expected === 'number' ? Math.abs(value - expected) <= tolerance : value === expected);
    const value = await until(async () => pick(await scene()), isThere, 30000);
    assert.ok(isThere(value), `${words}: ${value}, expected ${expected}`);
  };
  const eye = (id) => page.locator(`[data-key="clip:${id}"] .eye`);
  const handle = (view, id) => page.locator(`[data-view="${view}"] .clip-handle[data-plane="${id}"]`);
  const middleOf = async (locator) => {
    const { x, y, width, height } = await locator.boundingBox();
    return [x + width / 2, y + height / 2];
  };
  /** Where a patient point is in the window, px, by the matrix of the picture on the screen. */
  const pixelOf = async (view, point) => {
    const { x, y, width, height } = await page.locator(`#picture-${view}`).boundingBox();
    const m = Object.values((await header(page, view)).clip_from_lps_mm);
    const row = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
    return [x + ((row(0) / row(3) + 1) / 2) * width, y + ((1 - row(1) / row(3)) / 2) * height];
  };
  const drag = async ([x, y], [dx, dy]) => {
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let step = 1; step <= 4; step++) await page.mouse.move(x + (dx * step) / 4, y + (dy * step) / 4);
    await page.mouse.up();
  };
  /** Until the handle stands at this height of its pane, px of the window. */
  const handleAt = async (view, id, axis, expected, words) => {
    const value = await until(
      async () => (await middleOf(handle(view, id)))[axis],
      (at) => Math.abs(at - expected) < 1,
      30000,
    );
    assert.ok(Math.abs(value - expected) < 1, `${words}: ${value}, expected ${expected}`);
  };

  once('a plane is turned on in its row, begins at the crosshair, and its line stands there in the panes that it cuts', async () => {
    await open();
    const { image } = await scene();
    await eye('axial_high').click();
    await comes((now) => now.clip.axial_high.enabled, true);
    await comes((now) => now.clip.axial_high.position_mm, image.slices.axial.position_mm, 0.05, 'the crosshair');
    const position = (await scene()).clip.axial_high.position_mm;
    for (const view of [3, 4])
      await handleAt(view, 'axial_high', 1, (await pixelOf(view, [0, 0, position]))[1], `the line in pane ${view}`);
    assert.equal(await handle(2, 'axial_high').count(), 0, 'an axial plane is no line in the axial pane');
    assert.equal(await page.locator('[data-view="3"] .clip-dim').count(), 1);
  });

  once('a number moves it, and the lines in all panes follow', async () => {
    const field = page.locator('[aria-label="Position of Axial, below in mm"]');
    await field.fill('21.5');
    await field.press('Enter');
    await comes((now) => now.clip.axial_high.position_mm, 21.5, 1e-9);
    for (const view of [3, 4]) await handleAt(view, 'axial_high', 1, (await pixelOf(view, [0, 0, 21.5]))[1], `the line in pane ${view}`);
  });

  once('dragged by its handle in one pane it follows the pointer, in the other panes too, and is one step of undo', async () => {
    const { pixels_per_mm: pxPerMm } = await header(page, 3);
    const start = await middleOf(handle(3, 'axial_high'));
    await page.waitForTimeout(450); // what follows sooner on the number is one step with it
    await drag(start, [10, 60]); // down: inferior
    const moved = 21.5 - 60 / pxPerMm;
    await comes((now) => now.clip.axial_high.position_mm, moved, 0.051 + 0.5 / pxPerMm, '60 px further down');
    const { position_mm: position } = (await scene()).clip.axial_high;
    for (const view of [3, 4])
      await handleAt(view, 'axial_high', 1, (await pixelOf(view, [0, 0, position]))[1], `the line in pane ${view}`);
    assert.equal(await page.locator('[data-key="clip:axial_high"]').getAttribute('aria-selected'), 'true');
    assert.match(await page.locator('[aria-label^="Undo"], [title^="Undo"]').first().getAttribute('title'), /clip axial high/);
    await page.keyboard.press('Control+z');
    await comes((now) => now.clip.axial_high.position_mm, 21.5, 1e-9, 'undone at once');
  });

  once('by keys the handle moves by 1 mm, with Shift by 10, and to the ends of the plan', async () => {
    await handle(3, 'axial_high').focus();
    await page.keyboard.press('ArrowUp');
    await comes((now) => now.clip.axial_high.position_mm, 22.5, 1e-9);
    await page.keyboard.press('Shift+ArrowDown');
    await comes((now) => now.clip.axial_high.position_mm, 12.5, 1e-9);
    assert.match(await handle(3, 'axial_high').getAttribute('aria-valuetext'), /^S 12\.5 mm$/);
    const low = Number(await handle(4, 'axial_high').getAttribute('aria-valuemin'));
    await page.keyboard.press('Home'); // to the end of the image, which the first picture of the body does not reach
    await comes((now) => now.clip.axial_high.position_mm, low, 1e-9);
    assert.equal((await scene()).image.slices.axial.position_mm > low, true, 'the slice did not move with the keys');
  });

  once('in Selection the other end of the axis is set, and flip keeps the other side', async () => {
    await page.locator('[aria-label="Axial, keeps above, S in mm"]').fill('-40');
    await page.keyboard.press('Enter');
    await comes((now) => now.clip.axial_low.position_mm, -40, 1e-9);
    await page.locator('[aria-label="Axial, keeps below, S in mm"]').fill('30');
    await page.keyboard.press('Enter');
    await comes((now) => now.clip.axial_high.position_mm, 30, 1e-9);
    await page.locator('#tab-panel button', { hasText: 'Flip' }).click();
    await comes((now) => now.clip.axial_low.position_mm, 30, 1e-9);
    await comes((now) => [now.clip.axial_low.enabled, now.clip.axial_high.enabled].join(), 'true,false');
    await page.locator('#tab-panel label', { hasText: 'tumour' }).click();
    await comes((now) => now.regions.tumour.clipped, false);
    await page.locator('#tab-panel label', { hasText: 'Outlines' }).click();
    await comes((now) => now.clip.cap.outlines, true);
    await page.locator('#tab-panel label', { hasText: 'Region colours' }).click();
    await comes((now) => now.clip.cap.regions, true);
    const isWhole = await page
      .locator('[data-key="clip:caps"] .name')
      .evaluate((name) => name.scrollWidth <= name.clientWidth + 1 && name.getBoundingClientRect().width > 40);
    assert.ok(isWhole, 'the row keeps its name, however much caps show');
  });

  once('C turns all planes off and on again, K their caps', async () => {
    await eye('sagittal_high').click();
    await comes((now) => now.clip.sagittal_high.enabled, true);
    await page.locator('#picture-1').focus();
    const on = (now) =>
      Object.keys(now.clip)
        .filter((id) => now.clip[id].enabled)
        .join();
    await page.keyboard.press('c');
    await comes(on, '');
    await page.keyboard.press('c');
    await comes(on, 'axial_low,sagittal_high');
    await page.locator('[data-key="clip:switch"] button', { hasText: 'All off' }).click();
    await comes(on, '');
    await page.locator('[data-key="clip:switch"] button', { hasText: 'On again' }).click();
    await comes(on, 'axial_low,sagittal_high');
    await page.locator('#picture-1').focus();
    await page.keyboard.press('k');
    await comes((now) => [now.clip.axial_low.cap, now.clip.sagittal_high.cap].join(), 'false,false');
    await page.locator('[aria-label="Help"]').click();
    assert.match(await page.locator('.help-keys').textContent(), /All clip planes off.*Caps of the clip planes/s);
    await page.keyboard.press('Escape');
  });

  once('the free plane turns by its second handle about the point that stays, by a quarter turn of the pointer', async () => {
    await eye('free').click();
    await page.locator('[data-key="clip:free"] button.name').click();
    for (const [name, value, direction] of [
      ['Tilt', '0', '0,-1,0'],
      ['Turn', '90', '1,0,0'],
    ]) {
      await page.locator(`[aria-label="${name} in degrees"]`).fill(value);
      await page.keyboard.press('Enter');
      await comes((now) => now.clip.free.normal.map((part) => Math.round(part * 1e3) / 1e3 || 0).join(), direction);
    }
    const { origin_mm: origin } = (await scene()).clip.free;
    const pivot = await pixelOf(2, origin); // the crosshair, which lies in the axial slice
    const turn = page.locator('[data-view="2"] .clip-turn');
    const [x, y] = await middleOf(turn); // at the lower end of an upright line
    assert.ok(Math.abs(x - pivot[0]) < 1 && y > pivot[1]);
    const radius = Math.min(y - pivot[1], 60);
    await drag([x, y], [pivot[0] + radius - x, pivot[1] - y]); // to the right of the pivot: a quarter turn
    // the line turns from anterior-posterior to right-left, counter-clockwise as seen from the feet: its normal from left to anterior
    await comes((now) => now.clip.free.normal.map((part) => Math.round(part * 50) / 50 || 0).join(), '0,-1,0');
    const after = (await scene()).clip.free.origin_mm;
    for (const axis of [0, 1, 2]) assert.ok(Math.abs(after[axis] - origin[axis]) < 0.01, `${after} is the pivot ${origin}`);
    await page.keyboard.press('Shift+ArrowLeft'); // the handle has the focus
    await comes((now) => Math.abs(now.clip.free.normal[0]), Math.sin(Math.PI / 18), 0.02, '10 degrees');
  });

  once('oblique planes are made by three points and by a line in a pane, renamed, and deleted', async () => {
    await page.locator('[data-key="section:planes"]').click();
    const make = () => page.locator('[data-key="oblique:"] button.name').click();
    const way = (name) => page.locator('#tab-panel button', { hasText: name }).click();
    const near = (actual, expected, tolerance, words) =>
      expected.forEach((value, at) => assert.ok(Math.abs(actual[at] - value) <= tolerance, `${words}: ${actual}, expected ${expected}`));
    const made = async (id) => until(async () => (await scene()).image.obliques?.[id], Boolean, 30000);
    const { slices } = (await scene()).image;
    const [s, l] = [slices.axial.position_mm, slices.sagittal.position_mm];

    await make();
    await way('Three points');
    // two in the axial slice, (0, 0) and (40, 30), one in the sagittal: 50 mm above the first
    for (const [view, point] of [
      [2, [0, 0, s]],
      [2, [40, 30, s]],
      [3, [l, 0, s + 50]],
    ]) {
      await page.mouse.click(...(await pixelOf(view, point)));
      await page.waitForTimeout(50);
    }
    const [a, b] = [
      [40, 30, 0],
      [l, 0, 50],
    ];
    const normal = [a[1] * b[2], -a[0] * b[2], -a[1] * b[0]]; // a x b
    const size = Math.hypot(...normal) * Math.sign(normal[1]); // nearest to coronal: to the posterior side
    near(
      (await made('plane-1')).normal,
      normal.map((part) => part / size),
      0.02,
      'through the points: a pixel is 0.7 mm',
    );

    await make();
    await way('Line');
    const [from, to] = [await pixelOf(2, [-40, -40, s]), await pixelOf(2, [40, 0, s])];
    await drag(from, [to[0] - from[0], to[1] - from[1]]);
    const line = await made('plane-2'); // along (2, 1, 0), upright on the axial slice: across it (-1, 2, 0)
    near(line.normal, [-1 / Math.sqrt(5), 2 / Math.sqrt(5), 0], 0.02, 'across the line');
    near(line.origin_mm, [0, -20, s], 1, 'the middle of the line');
    assert.equal(await page.locator('[data-view="2"] .clip-line.oblique').count(), 2, 'lines of both in the axial pane');

    await page.locator('[aria-label="Name of the plane"]').fill('Optic nerve');
    await page.keyboard.press('Enter');
    await comes((now) => now.image.obliques['plane-2'].name, 'Optic nerve');
    await full(page, 2);
    await shoot(page, 'clip-planes');
    await way('Delete');
    await comes((now) => Object.keys(now.image.obliques).join(), 'plane-1');
    await page.keyboard.press('Control+z');
    await comes((now) => now.image.obliques['plane-2']?.name, 'Optic nerve');
  });

  once(
    'in its own pane an oblique plane has letters of its direction, the wheel moves it along its normal, and a click puts the crosshair on it',
    async () => {
      await page.locator('button[aria-label="Show Optic nerve in a pane"]').click();
      for (const view of [1, 5]) await full(page, view);
      const pane = page.locator('[data-view="5"]');
      assert.match(await pane.locator('h2').textContent(), /Optic nerve/);
      const { origin_mm: before, normal } = (await scene()).image.obliques['plane-2'];
      // normal (-1, 2, 0) / sqrt 5: right is (2, 1, 0) / sqrt 5, with cosines 0.89 to the left and 0.45 to the posterior
      assert.equal(await pane.locator('[data-letters]').getAttribute('data-letters'), 'RA LP S I');
      const [x, y] = await middleOf(page.locator('#picture-5'));
      await page.mouse.move(x, y);
      for (let notch = 0; notch < 3; notch++) await page.mouse.wheel(0, -100); // three voxels of 1 mm, on
      const along = (from, to) => to.reduce((sum, value, axis) => sum + (value - from[axis]) * normal[axis], 0);
      await comes((now) => along(before, now.image.obliques['plane-2'].origin_mm), 3, 0.01);
      const { origin_mm: origin } = (await scene()).image.obliques['plane-2'];
      assert.ok(Math.abs(Math.hypot(...origin.map((value, axis) => value - before[axis])) - 3) < 0.01, 'along the normal and nowhere else');
      const { slices } = (await scene()).image;
      await page.mouse.click(x + 30, y + 20);
      await comes((now) => now.image.slices.sagittal.position_mm !== slices.sagittal.position_mm, true);
      const { sagittal, coronal, axial } = (await scene()).image.slices;
      const point = [sagittal.position_mm, coronal.position_mm, axial.position_mm];
      assert.ok(Math.abs(along(origin, point)) < 0.09, `${point} lies on the plane, to 0.1 mm along each axis`);
      const at = await pixelOf(5, point);
      assert.ok(Math.hypot(at[0] - x - 30, at[1] - y - 20) < 1, `${at} is where the click was`);
      assert.equal(await pane.locator('.clip-handle[data-plane="plane-2"]').count(), 0, 'no line of its own');
      assert.equal(await pane.locator('.clip-handle[data-plane="sagittal_high"]').count(), 1, 'the clip planes cut it too');
      await page.locator('[aria-label="Four panes"]').click();
    },
  );

  once('with planes that cut, one chosen and others made, axe-core finds nothing and no text lies over text', async () => {
    await page.emulateMedia({ forcedColors: 'active' });
    await eye('coronal_low').click();
    await page.locator('[data-key="clip:free"] button.name').click();
    await page.locator('#tab-panel button', { hasText: 'Along the beam' }).click();
    await page.locator('[data-key="oblique:"] button.name').click();
    await page.locator('.clip-angles button').click();
    await page.locator('[aria-label="Name of the plane"]').waitFor();
    for (const view of [1, 2, 3, 4]) await full(page, view);
    const border = (locator) => locator.first().evaluate((element) => getComputedStyle(element).borderTopWidth);
    await shoot(page, 'clip-forced-colours');
    assert.notEqual(
      await border(page.locator('.clip-cap[aria-pressed="true"]')),
      await border(page.locator('.clip-cap[aria-pressed="false"]')),
      'a cap that is on differs by its border',
    );
    await page.emulateMedia({ forcedColors: 'none' }); // in forced colours contrast is the browser's
    assert.deepEqual(await axe(page), []);
    assert.deepEqual(await overlaps(page), []);
    await page.context().close();
  });

  later('a finger drags the handle on a tablet, and no handle is smaller than a finger', async () => {
    await open(sizes.tablet, []);
    await page.locator('.dock button', { hasText: 'Parts' }).tap();
    await page.getByRole('tab', { name: 'Clip', exact: true }).tap();
    await eye('axial_high').tap();
    await comes((now) => now.clip.axial_high.enabled, true);
    await shoot(page, 'clip-tablet');
    await page.locator('[aria-label="Close the sheet"]').tap();
    const big = page.locator('[data-view="4"]');
    await big.locator('[aria-label="Maximise Coronal"]').tap();
    await full(page, 4);
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[4].width_px > 800);
    await full(page, 4);
    const before = (await scene()).clip.axial_high.position_mm;
    const { width, height } = await handle(4, 'axial_high').boundingBox();
    assert.ok(width >= 44 && height >= 44, `${width} x ${height}`);
    await handleAt(4, 'axial_high', 1, (await pixelOf(4, [0, 0, before]))[1], 'in the larger picture');
    const [x, y] = await middleOf(handle(4, 'axial_high'));
    const devtools = await page.context().newCDPSession(page);
    const touch = (type, points) =>
      devtools.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([px, py]) => ({ x: px, y: py })) });
    await touch('touchStart', [[x + 8, y + 8]]);
    for (let step = 1; step <= 4; step++) await touch('touchMove', [[x + 8, y + 8 + 20 * step]]);
    await touch('touchEnd', []);
    // the picture's px per mm, of the pane: its px by the device's ratio
    const pxPerMm = (await pixelOf(4, [0, 0, 0]))[1] - (await pixelOf(4, [0, 0, 1]))[1];
    await comes((now) => now.clip.axial_high.position_mm, before - 80 / pxPerMm, 0.051 + 1 / pxPerMm, '80 px down');
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
