// Images on the page: window presets, numbers, drag, each image's own look, colours, a second image; the volume and its transfer function by mouse, keys and fingers.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { isDeepStrictEqual } from 'node:util';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { readPng } from '../api/png.mjs';
import { axe } from './axe.mjs';
import { overPictures } from './anatomy.mjs';
import { full, header, later, missing, once, shoot, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';
import { sizes } from './room_states.mjs';
import { histogram, percentiles, windows, writeThreeImages } from './three_images.mjs';

/** Part of a scene as the server writes it: a window that is given without gamma has 1. */
const withGamma = (part) =>
  Object.fromEntries(
    Object.entries(part).map(([name, value]) => {
      if (name === 'window') return [name, { gamma: 1, ...value }];
      return [name, name === 'looks' || value?.window ? withGamma(value) : value];
    }),
  );

describe('images on the page', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  let plan;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-images-'));
    plan = writeThreeImages(folder);
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const open = async (options = sizes.wide, { isMadeUp = false } = {}) => {
    const room = await world.newRoom(plan);
    const page = await world.newPage('', options);
    if (isMadeUp) await page.route(/\/histogram$/, (route) => route.fulfill({ json: histogram }));
    await page.goto(`${world.daemon.url}/rooms/${room}`);
    await full(page, options === sizes.phone ? 1 : 2);
    const image = async () => (await world.scene(room)).image;
    const comes = async (wanted, words) => {
      const expected = withGamma(wanted);
      const pick = (found) => Object.fromEntries(Object.keys(expected).map((name) => [name, found[name]]));
      const found = await until(image, (now) => isDeepStrictEqual(pick(now), expected), 20000);
      assert.deepEqual(pick(found), expected, words);
    };
    return { room, page, image, comes };
  };
  const row = (page, key) => page.locator(`[data-key="${key}"] button.name`).click();
  const preset = (page, name) => page.getByRole('group', { name: 'Window presets', exact: true }).getByRole('button', { name }).click();
  const enter = async (page, label, value) => {
    await page.getByLabel(label, { exact: true }).fill(String(value));
    await page.getByLabel(label, { exact: true }).press('Enter');
  };

  once('presets by modality, keys, numbers and a drag set the window on the server, and the threshold of slices in 3-D', async () => {
    const { page, comes } = await open();
    await row(page, 'image:ct');
    await preset(page, 'Bone 4');
    await comes({ window: { center: 480, width: 2500 } });
    await preset(page, 'Head');
    await comes({ window: { center: 45, width: 125 } });
    await page.locator('#picture-2').focus();
    await page.keyboard.press('2');
    await comes({ window: { center: -600, width: 1500 } });
    await enter(page, 'Window centre', 50);
    await enter(page, 'Window width', 500);
    await comes({ window: { center: 50, width: 500 } });
    await enter(page, 'Window low', 0);
    await comes({ window: { center: 150, width: 300 } }, 'the upper end of 300 stays');
    await enter(page, 'Window high', 250);
    await comes({ window: { center: 125, width: 250 } });
    await page.locator('#picture-2').focus();
    await page.keyboard.press('w');
    const box = await page.locator('#picture-2').boundingBox();
    await page.mouse.move(box.x + 100, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 150, box.y + 100); // in one step: 50 px widen by 50 / 250 of the width
    await page.mouse.up();
    await comes({ window: { center: 125, width: 300 } });
    await row(page, 'image:mr');
    const [lowest, low, high, highest] = percentiles(0.1, 1, 99, 99.9);
    await preset(page, '1–99 %');
    await comes({ window: { center: (low + high) / 2, width: high - low } });
    await page.locator('#picture-2').focus();
    await page.keyboard.press('1');
    await comes({ window: { center: (lowest + highest) / 2, width: highest - lowest } }, 'between 0.1 and 99.9 %');
    await row(page, 'image:ct');
    await page.getByLabel('Leave out below').uncheck();
    await comes({ cull_below: -1e12 });
    await page.getByLabel('Leave out below').check();
    await comes({ cull_below: -500 });
    await enter(page, 'Leave out values below', -200);
    await comes({ cull_below: -200 });
    await page.context().close();
  });

  once('each image keeps its own window and colours; choosing one is one step to undo', async () => {
    const { page, comes, image } = await open();
    await row(page, 'image:ct');
    await preset(page, 'Lung 2');
    await row(page, 'image:pet');
    await comes({ id: 'pet', window: windows.pet, color_map: 'grey' });
    await page.getByLabel('Colours', { exact: true }).selectOption('hot-iron');
    await comes({ color_map: 'hot-iron' });
    await row(page, 'image:ct');
    await comes({ id: 'ct', window: { center: -600, width: 1500 }, color_map: 'grey' });
    assert.equal(await page.getByLabel('Colours', { exact: true }).inputValue(), 'grey', 'the CT stays grey');
    await enter(page, 'Window gamma', 1.4);
    await comes({ window: { center: -600, width: 1500, gamma: 1.4 } });
    assert.match(await page.locator('[data-view="2"] .overlay').first().textContent(), /W 1\D?500 HU\s+γ 1\.4/, 'the pane says so');
    await preset(page, 'Head');
    await comes({ window: { center: 45, width: 125, gamma: 1.4 } }, 'a preset keeps it');
    await preset(page, 'Lung 2');
    const before = await image();
    await row(page, 'image:pet');
    await comes({ id: 'pet', window: windows.pet, color_map: 'hot-iron' });
    await page.getByRole('button', { name: /^Undo/ }).click();
    await until(image, ({ id }) => id === 'ct', 20000);
    assert.deepEqual(await image(), before);
    await page.context().close();
  });

  later('the 3-D picture turns by itself until Esc or a drag, and undo knows nothing of it; lights are for everybody', async () => {
    const { room, page } = await open();
    await page.getByRole('button', { name: '3-D picture', exact: true }).click();
    const badge = page.locator('.pane-head .badge.turning');
    const act = (name) => page.locator('.block.turning').getByRole('button', { name, exact: true }).click();
    const seen = () => page.locator('[data-view="1"] .where').textContent();
    const turns = async () => {
      await act('Turn by itself');
      await badge.waitFor();
      const before = await seen();
      await until(seen, (now) => now !== before, 20000);
    };
    await enter(page, 'Degrees a second; less than 0 the other way', 60);
    await turns();
    await page.keyboard.press('Escape');
    await badge.waitFor({ state: 'detached' });
    await turns();
    const box = await page.locator('#picture-1').boundingBox();
    await page.mouse.move(box.x + 80, box.y + 80);
    await page.mouse.down();
    assert.equal(await badge.count(), 0, 'a drag stops it');
    await page.mouse.up();
    assert.equal(await page.getByRole('button', { name: /^Undo/ }).isDisabled(), true, 'no step to undo');
    await enter(page, 'Around, as a number', -60);
    await page.locator('.block.lights').getByRole('radio', { name: 'Patient' }).click();
    const lights = async () => (await world.scene(room)).lights;
    const expected = { frame: 'patient', azimuth_deg: -60, elevation_deg: 34.6, intensity: 1, ambient: 0.3 };
    assert.deepEqual(await until(lights, (now) => isDeepStrictEqual(now, expected), 20000), expected);
    await page.getByRole('button', { name: /^Undo/ }).click();
    await until(lights, ({ frame }) => frame === 'viewer', 20000);
    await page.locator('.block.lights').getByRole('button', { name: 'As usual' }).click();
    await until(lights, ({ azimuth_deg }) => azimuth_deg === 31.2, 20000);
    await shoot(page, 'image-lights');
    assert.deepEqual(await axe(page), []);
    await page.context().close();
  });

  later('who follows sees the presenter’s picture turn by itself, and stand as it stands when that stops', async () => {
    const { room, page } = await open();
    const follower = await world.newPage(`rooms/${room}`);
    await full(follower, 1);
    const matrix = async (one) => Object.values((await header(one, 1)).clip_from_lps_mm);
    const before = await matrix(follower);
    await page.getByRole('button', { name: '3-D picture', exact: true }).click();
    await enter(page, 'Degrees a second; less than 0 the other way', 40);
    await page.locator('.block.turning').getByRole('button', { name: 'Turn by itself', exact: true }).click();
    const seen = [before];
    for (
      let n = 0;
      n < 3;
      n++ // each picture from another side than those before
    )
      seen.push(
        await until(
          () => matrix(follower),
          (now) => seen.every((old) => !isDeepStrictEqual(old, now)),
        ),
      );
    assert.equal(await follower.locator('.pane-head .badge.turning').count(), 0, 'it is not the follower’s page that turns it');
    await page.keyboard.press('Escape');
    await page.locator('.pane-head .badge.turning').waitFor({ state: 'detached' });
    await full(page, 1);
    const last = await matrix(page);
    await until(
      () => matrix(follower),
      (now) => now.every((value, at) => Math.abs(value - last[at]) < 1e-4 * Math.max(1, Math.abs(last[at]))),
    );
    assert.equal(await follower.getByRole('button', { name: /^Undo/ }).isDisabled(), true);
    await follower.context().close();
    await page.context().close();
  });

  once('the background of 3-D pictures is chosen for all, with letters that can be read on it, and undone', async () => {
    const { room, page } = await open();
    const background = async () => (await world.scene(room)).space.background;
    const onLight = (view) => page.locator(`#picture-${view} .overlay .on-light .letter`).count();
    assert.equal(await background(), '#08090b');
    await page.getByRole('button', { name: '3-D picture', exact: true }).click();
    await page.getByRole('radiogroup', { name: 'Background', exact: true }).getByRole('radio', { name: 'white' }).click();
    await until(background, (now) => now === '#ffffff');
    await page.locator('#picture-1 .overlay .on-light .letter').first().waitFor();
    assert.equal(await onLight(2), 0, 'slices keep theirs');
    await full(page, 1);
    await shoot(page, 'image-background');
    assert.deepEqual(await axe(page), []);
    const picture = await fetch(`${world.daemon.url}/api/v1/rooms/${room}/snapshot?view=${encodeURIComponent('{"size_px":[320,240]}')}`);
    assert.deepEqual(readPng(Buffer.from(await picture.arrayBuffer())).at(2, 2), [255, 255, 255]);
    await page.getByRole('button', { name: /^Undo/ }).click();
    await until(background, (now) => now === '#08090b');
    await page.locator('#picture-1 .overlay .on-light').waitFor({ state: 'detached' });
    await page.context().close();
  });

  once('nothing turns by itself where the browser asks for less motion', async () => {
    const { page } = await open({ ...sizes.wide, reducedMotion: 'reduce' });
    await page.getByRole('button', { name: '3-D picture', exact: true }).click();
    assert.equal(await page.getByRole('button', { name: 'Turn by itself' }).isDisabled(), true);
    await page.getByText('This browser asks for less motion').waitFor();
    await page.context().close();
  });

  later('a second image is blended with its own window, colours and opacity', async () => {
    const { page, comes, image } = await open();
    await row(page, 'image:ct');
    await page.getByLabel('Second image', { exact: true }).selectOption({ label: 'PET pet' });
    await comes({ id: '', blend: { id: 'pet', opacity: 0.5 } });
    await enter(page, 'Opacity of the second image in per cent', 30);
    await comes({ blend: { id: 'pet', opacity: 0.3 } });
    await page.getByLabel('Second image colours', { exact: true }).selectOption('hot-iron');
    await enter(page, 'Second image window high', 2000);
    await comes({ window: windows.ct, looks: { pet: { window: { center: 1000, width: 2000 }, color_map: 'hot-iron' } } });
    const legend = page.locator('.image-legend');
    assert.match(await legend.textContent(), /PET 30 %.*0.*2\D?000 Bq\/ml/s, 'its colours are explained above the panes');
    assert.deepEqual(await overPictures(page), []);
    await full(page, 2);
    await shoot(page, 'image-blend');
    await row(page, 'image:pet');
    await comes(
      { id: 'pet', window: { center: 1000, width: 2000 }, color_map: 'hot-iron', blend: { id: '', opacity: 0.3 } },
      'as it was blended, and not over itself',
    );
    assert.equal((await image()).looks.ct.window.center, 40);
    await page.context().close();
  });

  it('a wall explains the colours of images, and those of PET in greys too, with their domain and unit', async () => {
    const room = await world.newRoom(plan);
    const wall = await world.newPage(`display/${room}`, { viewport: { width: 1920, height: 1080 } });
    await wall.locator('.wall-column', { hasText: 'At the crosshair' }).waitFor();
    const patched = async (image) => {
      const { status, text } = await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { image }, { 'If-Match': '*' });
      assert.equal(status, 200, text);
    };
    const scales = () =>
      wall.evaluate(() =>
        [...document.querySelectorAll('.wall-image')].map((section) => ({
          words: section.innerText.split(/\n+/),
          colours: getComputedStyle(section.querySelector('.wall-scale')).backgroundImage.match(/rgb\([^)]*\)/g),
        })),
      );
    const shows = async (wanted) => {
      const found = await until(
        scales,
        (all) =>
          isDeepStrictEqual(
            all.map(({ words }) => words),
            wanted,
          ),
        20000,
      );
      assert.deepEqual(
        found.map(({ words }) => words),
        wanted,
      );
      return found.map(({ colours }) => [colours[0], colours.at(-1)]);
    };
    assert.deepEqual(await scales(), [], 'a CT in greys has its window in the heads of the panes');
    await patched({ color_map: 'viridis' });
    const ofCt = ['Image CT', 'HU', '−160', '240']; // 40 ± 200
    assert.deepEqual(await shows([ofCt]), [['rgb(68, 1, 84)', 'rgb(253, 231, 37)']]); // the ends of matplotlib's viridis
    await patched({ low_values: 'white' });
    const turned = ['rgb(253, 231, 37)', 'rgb(68, 1, 84)'];
    assert.deepEqual(
      await until(
        () => shows([ofCt]),
        ([ends]) => isDeepStrictEqual(ends, turned),
      ),
      [turned],
    );
    await patched({ low_values: 'black', blend: { id: 'pet', opacity: 0.3 } });
    await shows([ofCt, ['Image PET 30 %', 'Bq/ml', '0', '1000']]);
    await wall.waitForFunction(() =>
      globalThis.wall.room.views.slice(1, 4).every(({ painted, behindSince }) => painted.value?.is_still && !behindSince.value),
    );
    await shoot(wall, 'wall-image');
    await patched({ id: 'pet', color_map: 'grey', blend: { id: '' }, window: windows.pet });
    assert.deepEqual(await shows([['Image PET', 'Bq/ml', '0', '1000']]), [['rgb(0, 0, 0)', 'rgb(255, 255, 255)']]);
    const sides = await wall.evaluate(() => {
      const { scrollHeight, clientHeight, scrollWidth, clientWidth } = document.querySelector('.wall-column');
      return [scrollHeight <= clientHeight, scrollWidth <= clientWidth];
    });
    assert.deepEqual(sides, [true, true], 'nothing of the column is cut');
    assert.deepEqual(await axe(wall), []);
    await wall.context().close();
  });

  // ---- the volume ------------------------------------------------------------------------------------------------------------

  const points = [
    [0, 0],
    [300, 0.25],
    [800, 0.64],
  ].map(([value, opacity]) => ({ value, color: '#808080', opacity }));
  const volumeOf = async (image) => (await image()).volume;
  /** Where the values vary least within the two classes, which is where they vary most between them. */
  const leastWithin = ({ low, high, counts }) => {
    const bin = (high - low) / counts.length;
    const spread = (part) => {
      const n = part.reduce((sum, [, count]) => sum + count, 0);
      const mean = part.reduce((sum, [value, count]) => sum + value * count, 0) / (n || 1);
      return part.reduce((sum, [value, count]) => sum + count * (value - mean) ** 2, 0);
    };
    const values = counts.map((count, at) => [low + (at + 0.5) * bin, count]);
    const all = counts.slice(1).map((_, at) => spread(values.slice(0, at + 1)) + spread(values.slice(at + 1)));
    const first = all.indexOf(Math.min(...all));
    const last = all.findLastIndex((one) => one <= Math.min(...all) * (1 + 1e-12));
    return { at: low + (1 + (first + last) / 2) * bin, bin };
  };
  /** The volume's Selection with three points that the test knows. */
  const openVolume = async (options, toRow = (page) => row(page, 'volume:')) => {
    const opened = await open(options, { isMadeUp: true });
    const { page, room, image } = opened;
    await toRow(page);
    await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { image: { volume: { points } } }, { 'If-Match': '*' });
    await page.locator('.image-plot [role="option"]').nth(2).waitFor();
    await page.waitForFunction(() =>
      document.querySelector('.image-plot [role="option"]').getAttribute('aria-label').startsWith('Point 1: 0 HU'),
    );
    const plot = page.locator('.image-plot');
    await plot.scrollIntoViewIfNeeded();
    const box = await plot.boundingBox();
    const centre = async (index) => {
      const dot = await plot.locator('.dot').nth(index).boundingBox();
      return [dot.x + dot.width / 2, dot.y + dot.height / 2];
    };
    /** The value at a place of the plot: the axis from two points, of which the values are known. */
    const [[x0], [x2]] = [await centre(0), await centre(2)];
    const valueAt = (x) => ((x - x0) / (x2 - x0)) * 800;
    const opacityAt = (y) => ((box.y + box.height - y) / box.height) ** 2;
    const changed = async (test, words) => {
      const found = await until(() => volumeOf(image), test, 20000);
      assert.ok(test(found), `${words}: ${JSON.stringify(found.points)}`);
      return found;
    };
    return { ...opened, plot, box, centre, valueAt, opacityAt, changed };
  };
  const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance;

  later(
    'a point follows the mouse while it is dragged, and the drag is one step to undo; a double click adds one; presets and switches are set',
    async () => {
      const { page, centre, valueAt, opacityAt, changed, box, image } = await openVolume();
      const [x, y] = await centre(1);
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 10, y - 10);
      await changed((volume) => volume.points[1].value > 300, 'while it is dragged');
      await page.mouse.move(x + 30, y - 20, { steps: 5 });
      await page.mouse.up();
      await changed(
        ({ points: [, { value, opacity }] }) => near(value, valueAt(x + 30), 1) && near(opacity, opacityAt(y - 20), 0.02),
        `to ${valueAt(x + 30)}, ${opacityAt(y - 20)}`,
      );
      await page.getByRole('button', { name: /^Undo: transfer function/ }).click();
      await changed(({ points: list }) => JSON.stringify(list) === JSON.stringify(points), 'back in one step');
      const at = [box.x + box.width * 0.3, box.y + box.height * 0.2];
      const { length } = (await volumeOf(image)).points;
      await page.mouse.dblclick(...at);
      await changed(
        ({ points: list }) =>
          list.length === length + 1 && list.some(({ value, opacity }) => near(value, valueAt(at[0]), 10) && near(opacity, 0.64, 0.02)),
        `added at ${valueAt(at[0])}`,
      );
      await shoot(page, 'image-volume');
      // the rest of the volume
      const panel = page.locator('#tab-panel');
      await panel.getByLabel('Visible').check();
      await panel.getByRole('button', { name: 'Skin' }).click();
      const skin = await until(
        () => volumeOf(image),
        ({ points: list }) => list[0].value === -500,
        20000,
      );
      assert.deepEqual([skin.visible, skin.points.length], [true, 4]);
      await panel.getByLabel('Shaded').uncheck();
      await panel.getByLabel('Cut by clip planes').uncheck();
      await panel.getByRole('radio', { name: 'Nearest' }).click();
      await panel.getByRole('radio', { name: 'Slices' }).click();
      const { cull_below: threshold } = await until(
        () => volumeOf(image),
        ({ cull_below: below }) => below > -1e12,
        20000,
      );
      const least = leastWithin(histogram);
      assert.ok(Math.abs(threshold - least.at) <= least.bin, `${threshold}, by the variance within the classes ${least.at}`);
      await panel.getByRole('slider', { name: 'Threshold of the volume' }).fill('-500');
      await enter(page, 'Number of slices', 64);
      const { points: _, ...rest } = await until(
        () => volumeOf(image),
        ({ steps }) => steps === 64,
        20000,
      );
      assert.deepEqual(rest, {
        visible: true,
        method: 'slices',
        shaded: false,
        interpolation: 'nearest',
        cull_below: -500,
        steps: 64,
        clipped: false,
      });
      await page.context().close();
    },
  );

  later('every point is chosen, moved, added, removed and coloured by keys, and in a table', async () => {
    const { page, plot, changed } = await openVolume();
    await plot.focus();
    await page.keyboard.press('Home');
    await page.keyboard.press('PageDown');
    assert.equal(await plot.getAttribute('aria-activedescendant'), 'transfer-1');
    assert.match(await page.locator('.image-chosen').textContent(), /Point 2: 300 HU, 25 % stopped by 1 mm/);
    await page.keyboard.press('ArrowUp'); // the square root of 0.25 is 0.5, a hundredth more 0.51
    const {
      points: [, { value: before }],
    } = await changed(({ points: [, { opacity }] }) => near(opacity, 0.51 ** 2, 1e-4), 'up');
    await page.keyboard.press('ArrowRight');
    const {
      points: [, { value: coarse }],
    } = await changed(({ points: [, { value }] }) => value > before, 'right');
    await page.keyboard.press('Shift+ArrowRight');
    await changed(({ points: [, { value }] }) => near(value - coarse, (coarse - before) / 10, 0.01), 'with Shift a tenth of the way');
    await page.keyboard.press('Insert');
    await changed(({ points: list }) => list.length === 4, 'added');
    await page.keyboard.press('Delete');
    await changed(({ points: list }) => list.length === 3, 'removed');
    await page.getByText('3 points as a table').click();
    await enter(page, 'Value of point 3', 900);
    await enter(page, 'Opacity of point 3 in per cent', 90);
    await page.getByLabel('Colour of point 3').fill('#ff0000');
    await changed(
      ({ points: list }) => JSON.stringify(list[2]) === JSON.stringify({ value: 900, color: '#ff0000', opacity: 0.9 }),
      'in the table',
    );
    await page.context().close();
  });

  const toVolume = async (page) => {
    await page.locator('.dock button', { hasText: 'Parts' }).tap();
    await page.getByRole('tab', { name: 'Images', exact: true }).tap();
    await page.locator('[data-key="volume:"] button.name').tap();
  };

  later('a finger drags a point, also when it comes down 20 px beside it', async () => {
    const { page, centre, valueAt, changed } = await openVolume(sizes.tablet, toVolume);
    const devtools = await page.context().newCDPSession(page);
    const touch = (type, places) =>
      devtools.send('Input.dispatchTouchEvent', { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
    const [x, y] = await centre(1);
    await touch('touchStart', [[x + 20, y]]);
    for (const part of [0.25, 0.5, 0.75, 1]) await touch('touchMove', [[x + 20 + 40 * part, y]]);
    await touch('touchEnd', []);
    await changed(({ points: [, { value }] }) => near(value, valueAt(x + 60), 2), `to ${valueAt(x + 60)}`);
    await page.context().close();
  });

  for (const [size, options] of Object.entries(sizes))
    later(`${size}: axe-core finds nothing and no text lies over another, in the Selection of image and volume`, async () => {
      const { page } = await open(options);
      const isTouch = Boolean(options.hasTouch);
      const choose = async (key) => {
        if (isTouch) {
          await page.locator('.dock button', { hasText: 'Parts' }).tap();
          await page.getByRole('tab', { name: 'Images', exact: true }).tap();
        } else if (size === 'compact' && !(await page.locator('.section-pane').count()))
          await page.locator('[data-section="images"]').click();
        await page.locator(`[data-key="${key}"] button.name`).click();
      };
      const settled = () =>
        page.waitForFunction(() =>
          [...document.querySelectorAll('.pane:not([hidden])')].every(
            (pane) => globalThis.beamroom.stats().badges[pane.dataset.view] === 'full',
          ),
        );
      const check = async (state) => {
        await settled();
        assert.deepEqual(await overlaps(page), [], state);
        assert.deepEqual(await axe(page), [], state);
        if (isTouch)
          assert.deepEqual(
            await page
              .locator('#tab-panel :is(button, select, .field input, input[type="color"])')
              .evaluateAll((all) =>
                all
                  .filter((one) => one.checkVisibility() && one.getBoundingClientRect().height < 43.5)
                  .map((one) => one.getAttribute('aria-label') ?? one.textContent),
              ),
            [],
            `${state}: for fingers`,
          );
        await shoot(page, `image-${size}-${state}`);
      };
      await choose('image:pet');
      await page.getByLabel('Second image', { exact: true }).selectOption({ label: 'MR mr' });
      await page.getByLabel('Opacity of the second image', { exact: true }).waitFor();
      await check('pet');
      await choose('volume:');
      await page.locator('.image-points summary').click();
      await check('volume');
      await page.context().close();
    });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
