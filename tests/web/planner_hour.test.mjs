// One planner's hour, from the start page to the picture that comes back, at each size of window the page is made for.
import assert from 'node:assert/strict';
import { cpSync, existsSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { textOfPng } from '../../web/js/net/png.js';
import { call, realData, until } from '../api/daemon.mjs';
import { bytesOf, full, header, missing, newer, shoot, startWorld } from './browser.mjs';

const sizes = {
  '2560x1440': { viewport: { width: 2560, height: 1440 } },
  '2560x1440@2': { viewport: { width: 2560, height: 1440 }, deviceScaleFactor: 2 },
  '1600x1000': { viewport: { width: 1600, height: 1000 } },
  '1440x900': { viewport: { width: 1440, height: 900 } },
  '1280x720': { viewport: { width: 1280, height: 720 } },
  '1180x820': { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true },
  '820x1180': { viewport: { width: 820, height: 1180 }, hasTouch: true, isMobile: true },
  '390x844': { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
};
const kinds = ['3-D', 'Axial', 'Sagittal', 'Coronal'];
const head = realData && existsSync(join(realData, 'sera-head')) ? join(realData, 'sera-head') : '';
// Volume and centre of the tumour as the data state them: ../shared/data/sera-head/README.md, there (PA, RL, IS) in cm. Of the phantom the plan is asked.
const subject = head
  ? { plan: 'sera-head', region: 'tumor', cm3: 67.15, centre: [24.9, 38.4, -64.9] }
  : { plan: 'phantom', region: 'tumour' };

describe("one planner's hour", { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  let plan;
  let region;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-hour-'));
    if (head) cpSync(head, join(folder, 'sera-head'), { recursive: true });
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  /** The hands of somebody at this window: mouse and keys, or fingers. */
  async function handsOn(page, isTouch) {
    const devtools = isTouch && (await page.context().newCDPSession(page));
    const touch = (type, points) =>
      devtools.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y]) => ({ x, y, id: 0 })) });
    await page.evaluate(() => {
      globalThis.clicks = 0;
      addEventListener(
        'click',
        () => {
          globalThis.clicks += 1;
        },
        true,
      );
    });
    /** On a busy machine a tap may last as long as a long press, which clicks nothing: again then. */
    const tap = async (locator, nTries = 5) => {
      const before = await page.evaluate(() => globalThis.clicks);
      await locator.tap();
      const isDone = await page
        .waitForFunction((n) => globalThis.clicks > n, before, { timeout: 3000 })
        .then(
          () => true,
          () => false,
        );
      if (isDone) return;
      assert.ok(nTries > 1, `nothing can be tapped: ${locator}`);
      await tap(locator, nTries - 1);
    };
    return {
      press: (locator) => (isTouch ? tap(locator) : locator.click()),
      async drag([x, y], dx, dy, steps = 10) {
        const places = Array.from({ length: steps }, (_, at) => [x + (dx * (at + 1)) / steps, y + (dy * (at + 1)) / steps]);
        if (isTouch) {
          await touch('touchStart', [[x, y]]);
          for (const place of places) await touch('touchMove', [place]);
          return touch('touchEnd', []);
        }
        await page.mouse.move(x, y);
        await page.mouse.down();
        for (const place of places) await page.mouse.move(...place);
        return page.mouse.up();
      },
      /** Rests at a place until done() is fulfilled: a mouse that stands still, a finger that presses. */
      async rest([x, y], done) {
        if (isTouch) await touch('touchStart', [[x, y]]);
        else await page.mouse.move(x - 30, y).then(() => page.mouse.move(x, y, { steps: 3 }));
        await done();
        if (isTouch) await touch('touchEnd', []);
      },
    };
  }

  /** Placeholders that are wider than their fields. */
  const cutPlaceholders = (page) =>
    page.evaluate(() =>
      [...document.querySelectorAll('input[placeholder]')]
        .filter((field) => field.checkVisibility())
        .flatMap((field) => {
          const { fontSize, fontFamily, paddingLeft, paddingRight } = getComputedStyle(field);
          const pen = Object.assign(document.createElement('canvas').getContext('2d'), { font: `${fontSize} ${fontFamily}` });
          const [needed, room] = [
            pen.measureText(field.placeholder).width,
            field.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight) - (field.type === 'search' ? 16 : 0),
          ]; // a search field keeps room for its cross
          return needed > room ? [`${field.placeholder}: ${needed} px in ${room}`] : [];
        }),
    );

  for (const [size, options] of Object.entries(sizes)) {
    it(`at ${size}${options.hasTouch ? ' with fingers' : ''}`, async () => {
      const page = await world.newPage('', options);
      const { press, drag, rest } = await handsOn(page, options.hasTouch);
      const shot = (name) => shoot(page, `hour-${size}-${name}`);
      const button = (name) => page.getByRole('button', { name, exact: typeof name === 'string' });
      const isThere = async (locator) => (await locator.count()) > 0 && locator.first().isVisible();
      const pressIfThere = async (locator) => {
        const isFound = await isThere(locator);
        if (isFound) await press(locator.first());
        return isFound;
      };

      // ---- panels and panes, wherever this size has them ----------------------------------------------------------------
      const picture = (view) => page.locator(`#picture-${view}`);
      /** Takes away what lies over the pictures and shows the pane. */
      const toPane = async (view) => {
        const isNarrow = options.viewport.width < 1400;
        for (const name of ['Close the sheet', 'Close Regions', ...(isNarrow ? ["Fold the plan's parts", 'Fold the inspector'] : [])])
          await pressIfThere(button(name));
        const panes = page.getByRole('radiogroup', { name: 'Pane', exact: true });
        if (await isThere(panes)) await press(panes.getByRole('radio', { name: kinds[view - 1], exact: true }));
        await picture(view).waitFor();
        await sized(view);
        await full(page, view);
      };
      /** Until the picture has the size of its pane. */
      const sized = (view) =>
        page.waitForFunction((n) => {
          const painted = globalThis.beamroom.stats().headers[n];
          const box = document.querySelector(`#picture-${n}`).getBoundingClientRect();
          return (
            painted &&
            Math.abs(painted.width_px / devicePixelRatio - box.width) <= 1 &&
            Math.abs(painted.height_px / devicePixelRatio - box.height) <= 1
          );
        }, view);
      /** Selects the region in the list of regions, so that the inspector shows it. */
      const toRegion = async () => {
        const block = page.getByRole('heading', { name: new RegExp(`^Region ${region.name}\\b`) });
        if (await isThere(block)) return;
        const row = page.locator(`[data-region="${region.id}"] button.name`);
        if (!(await isThere(row))) {
          await press(page.getByRole('button', { name: /^(Show the plan's parts|Regions|Parts)$/ }).first());
          await pressIfThere(page.getByRole('tab', { name: 'Regions', exact: true }));
          await row.waitFor();
        }
        if (!(await isThere(page.locator('[data-region].selected')))) await press(row);
        if (!(await isThere(block))) await pressIfThere(button("Fold the plan's parts"));
        if (!(await isThere(block))) await pressIfThere(button('Show the inspector'));
        await block.waitFor();
      };

      // ---- what is expected ----------------------------------------------------------------------------------------------
      let room;
      const scene = () => world.scene(room);
      const styleOf = async () => (await scene()).regions[region.id];
      const crosshairOf = ({ image: { slices } }) => [slices.sagittal, slices.coronal, slices.axial].map(({ position_mm: mm }) => mm);
      const comes = async (ask, suits, words) => assert.ok(suits(await until(ask, suits)), `${words}: ${JSON.stringify(await ask())}`);
      const matrixOf = async (view) => Object.values((await header(page, view)).clip_from_lps_mm);
      const revisionOf = async (view) => (await header(page, view)).scene_revision;
      const isNear = (a, b, tolerance) => a.every((value, at) => Math.abs(value - b[at]) <= tolerance);
      /** Until the picture shows the scene as it is now. */
      const settled = async (view) => {
        const { headers } = await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`);
        await newer(page, view, Number(JSON.parse(headers.get('etag'))) - 1);
        await full(page, view);
      };
      /** Place in the window of a patient point in a picture. */
      const placeOf = async (view, point) => {
        const box = await picture(view).boundingBox();
        const m = await matrixOf(view);
        const row = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
        return [box.x + ((row(0) / row(3) + 1) / 2) * box.width, box.y + ((1 - row(1) / row(3)) / 2) * box.height];
      };
      const middleOf = async (view) => {
        const box = await picture(view).boundingBox();
        return [box.x + box.width / 2, box.y + box.height / 2];
      };
      /** Degrees about the patient's long axis from which the eye looks: w grows along the line of sight. */
      const azimuthOf = async () => {
        const m = await matrixOf(1);
        return (Math.atan2(m[7], m[3]) * 180) / Math.PI;
      };
      const colourAt = (view, [x, y]) =>
        page.evaluate(
          ([n, left, top]) => {
            const canvas = document.querySelector(`#picture-${n} canvas`);
            const box = canvas.getBoundingClientRect();
            return [
              ...canvas
                .getContext('2d')
                .getImageData(((left - box.x) * canvas.width) / box.width, ((top - box.y) * canvas.height) / box.height, 1, 1).data,
            ].slice(0, 3);
          },
          [view, x, y],
        );

      // ---- a plan is opened from the start page --------------------------------------------------------------------------
      const { name: planName } = (await call(`${world.daemon.url}/api/v1/plans`)).json.plans.find(({ id }) => id === subject.plan);
      await pressIfThere(button('Not now'));
      // where an earlier size has left a room, the row goes on with it, and offers a new one
      const opens = button(`Open ${planName}`).or(button(`New room on ${planName}`));
      await opens.waitFor();
      assert.deepEqual(await cutPlaceholders(page), []);
      await shot('start');
      await press(opens);
      await page.waitForURL(/\/rooms\/[a-z0-9-]+$/);
      room = /rooms\/([a-z0-9-]+)/.exec(page.url())[1];
      await full(page, 1);
      ({ json: plan } = await call(`${world.daemon.url}/api/v1/plans/${subject.plan}`));
      region = plan.regions.find(({ id }) => id === subject.region);
      if (subject.cm3)
        assert.ok(
          Math.abs(region.volume_cm3 - subject.cm3) < 0.005 && isNear(region.center_mm, subject.centre, 0.05),
          'as stated with the data',
        );
      const step = plan.images[0].grid.spacing_mm;
      // signs without words stand in the middle of their buttons
      const off = await page
        .getByRole('toolbar')
        .locator('button')
        .evaluateAll((buttons) =>
          buttons
            .filter((button) => button.checkVisibility() && !button.innerText.trim())
            .flatMap((button) => {
              const [outer, inner] = [button, button.querySelector('svg')].map((part) => part.getBoundingClientRect());
              const [dx, dy] = [
                inner.x + inner.width / 2 - outer.x - outer.width / 2,
                inner.y + inner.height / 2 - outer.y - outer.height / 2,
              ];
              return Math.hypot(dx, dy) > 1 ? [`${button.title}: ${dx}, ${dy} px`] : [];
            }),
        );
      assert.deepEqual(off, []);
      await shot('opened');

      // ---- the 3-D picture is turned: 0.4 degrees a pixel -----------------------------------------------------------------
      await toPane(1);
      const azimuth = await azimuthOf();
      await drag(await middleOf(1), 100, 0);
      const turnedBy = async () => (((await azimuthOf()) - azimuth + 540) % 360) - 180;
      await comes(turnedBy, (degrees) => Math.abs(degrees + 40) < 0.5, "turned by 100 px, 40 degrees, to the patient's right");
      await full(page, 1);

      // ---- one region alone, the crosshair in its middle ------------------------------------------------------------------
      await toRegion();
      await press(button('Solo'));
      await comes(scene, ({ regions }) => plan.regions.every(({ id }) => regions[id].visible === (id === region.id)), 'it is alone');
      await press(button('Go to centre'));
      await comes(
        scene,
        (now) => isNear(crosshairOf(now), region.center_mm, Math.max(...step) / 2 + 0.1),
        'the crosshair is in its middle',
      );
      await settled(1);
      await shot('alone');

      // ---- the methods are compared ---------------------------------------------------------------------------------------
      await press(button('Compare methods'));
      const compared = page.getByRole('dialog', { name: 'Methods compared' });
      await compared.locator('button:enabled', { hasText: 'CSV' }).waitFor();
      const univels = compared.getByRole('row', { name: /Univels/ });
      assert.match(await univels.textContent(), new RegExp(`${region.volume_cm3.toFixed(2)} cm³0\\.00 %`), 'univels enclose what they are');
      await shot('compared');
      await press(compared.getByRole('button', { name: 'Close' }));
      await compared.waitFor({ state: 'detached' });

      // ---- it is shown in another way ---------------------------------------------------------------------------------------
      await toRegion();
      const before = await styleOf();
      await press(page.getByRole('radiogroup', { name: 'Shown as' }).getByRole('radio', { name: 'Univels' }));
      await comes(styleOf, ({ representation }) => representation === 'univels', 'as univels');
      const opacity = page.getByRole('spinbutton', { name: 'Opacity in per cent', exact: true });
      await opacity.fill('100');
      await opacity.press('Enter');
      await comes(styleOf, ({ opacity: value }) => value === 1, 'opaque');
      const changed = await styleOf();
      await settled(1);
      await shot('shown-as');
      await toPane(1);
      const wanted = [1, 3, 5].map((at) => parseInt(changed.color.slice(at, at + 2), 16));
      const likeness = (colour) =>
        colour.reduce((sum, value, at) => sum + value * wanted[at], 0) / Math.hypot(...colour) / Math.hypot(...wanted);
      await comes(
        async () => colourAt(1, await placeOf(1, region.center_mm)),
        (colour) => likeness(colour) > 0.97,
        `in its middle the picture has its colour ${changed.color}, lighter or darker`,
      );
      await shot('univels');

      // ---- undone and done again ----------------------------------------------------------------------------------------------
      const undo = page.getByRole('button', { name: /^Undo/ });
      const redo = page.getByRole('button', { name: /^Redo/ });
      await press(undo);
      await comes(styleOf, ({ opacity: value }) => value === before.opacity, 'the opacity is back');
      await press(undo);
      await comes(styleOf, ({ representation }) => representation === before.representation, 'the representation is back');
      await press(redo);
      await press(redo);
      await comes(styleOf, (now) => JSON.stringify(now) === JSON.stringify(changed), 'both again');

      // ---- crosshair and slices ------------------------------------------------------------------------------------------------
      await toPane(2);
      const point = [region.center_mm[0] - 20, region.center_mm[1] - 15, crosshairOf(await scene())[2]];
      const place = await placeOf(2, point);
      if (options.hasTouch) await page.touchscreen.tap(...place);
      else await page.mouse.click(...place);
      // a voxel's middle is the goal; a pixel of the picture may be larger than a voxel
      const pixelMm = 1 / (await header(page, 2)).pixels_per_mm;
      await comes(
        scene,
        (now) => isNear(crosshairOf(now), point, Math.max(step[0], step[1]) / 2 + pixelMm),
        `the crosshair is at ${point}`,
      );
      const [, , slice] = crosshairOf(await scene());
      if (options.hasTouch) {
        // a finger on the slider, a fifth from its top: as exact as half its thumb
        const slider = page.getByRole('slider', { name: /^Axial slice/ });
        const [low, high] = await slider.evaluate(({ min, max }) => [Number(min), Number(max)]);
        const { x, y, width, height } = await slider.boundingBox();
        await page.touchscreen.tap(x + width / 2, y + height / 5);
        const there = high - (high - low) / 5;
        await comes(
          scene,
          (now) => Math.abs(crosshairOf(now)[2] - there) <= step[2] / 2 + ((high - low) * 12) / height,
          `a slice at ${there} mm`,
        );
        await press(undo);
        await comes(scene, (now) => crosshairOf(now)[2] === slice, 'the slice of before');
      } else {
        await page.mouse.wheel(0, -100); // with two pixels to one of the page it is told 50, and half of wheelDeltaY, as a page at 200 % is
        await comes(scene, (now) => Math.abs(crosshairOf(now)[2] - slice - step[2]) < 0.1, `one slice up from ${slice} mm`);
      }
      await full(page, 2);

      // ---- window: wider to the right, brighter upwards -------------------------------------------------------------------------
      const old = (await scene()).image.window;
      await press(button('Window'));
      await drag(await middleOf(2), 60, -30);
      await comes(
        scene,
        ({ image: { window } }) => window.width > old.width && window.center > old.center - 1e-6,
        `another window than ${JSON.stringify(old)}`,
      );
      await press(button('Crosshair'));
      await full(page, 2);
      const { window } = (await scene()).image;
      const isRoomy = (await picture(2).boundingBox()).width >= 360; // the width from which a picture has its window's text
      const words = await picture(2).locator('.overlay:not(.clip-lines, .pointers)').textContent();
      assert.equal(
        words.includes(`C ${window.center.toFixed(0)}  W ${window.width.toFixed(0)}`),
        isRoomy,
        `${words} says ${JSON.stringify(window)}`,
      );

      // ---- values at the pointer --------------------------------------------------------------------------------------------------
      const card = page.locator('[data-view="2"] .read-out');
      const target = [region.center_mm[0], region.center_mm[1], crosshairOf(await scene())[2]];
      await rest(await placeOf(2, target), () => card.waitFor());
      const text = await card.innerText();
      assert.match(text, new RegExp(`^${region.name}\\b`));
      const numbers = /L (\S+)\s+P (\S+)\s+S (\S+) mm/.exec(text.replaceAll('−', '-')).slice(1).map(Number);
      assert.ok(isNear(numbers, target, 2 * pixelMm + 0.1), `${numbers} at ${target}`);
      await shot('pointed');

      // ---- a picture to keep, and one for the report ----------------------------------------------------------------------------
      await toPane(1);
      await picture(1).focus();
      const menu = async (name) => {
        await press(button('Snapshot'));
        await press(page.getByRole('menuitem', { name }));
      };
      await press(button('Snapshot'));
      await page.getByRole('menu', { name: 'Snapshot' }).waitFor();
      await shot('menu');
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        press(page.getByRole('menuitem', { name: 'Save the active pane as PNG' })),
      ]);
      assert.match(download.suggestedFilename(), new RegExp(`^${subject.plan}-3d-\\d{8}T\\d{6}Z\\.png$`));
      const bytes = await bytesOf(download);
      writeFileSync(`build/test-artifacts/hour-${size}-snapshot.png`, bytes);
      assert.ok(bytes.readUInt32BE(16) >= 1200, 'wide enough for paper');
      const kept = await scene();
      const keptMatrix = await matrixOf(1);
      const record = JSON.parse(await textOfPng(bytes, 'beamroom'));
      assert.equal(record.plan.id, subject.plan);
      assert.deepEqual(record.scene, kept);

      await menu(/Add it to the report/);
      await page.getByText('In the report to print: 1 picture').waitFor();
      await menu(/Report to print/);
      const report = page.getByRole('dialog', { name: 'Report to print' });
      await report.getByLabel('Caption of Figure 1').fill(`The ${region.name} alone, as univels`);
      await report.getByRole('button', { name: 'Print or save as PDF' }).and(page.locator(':enabled')).waitFor();
      assert.match(
        await report
          .getByRole('row', { name: new RegExp(`^${region.name} `) })
          .first() // the table of regions; that of its histograms comes when it is answered
          .innerText(),
        new RegExp(`\\b${region.volume_cm3.toFixed(2)}\\b`),
      );
      const [label, field] = await Promise.all(
        [report.getByText('Figure 1.', { exact: true }), report.getByLabel('Caption of Figure 1')].map((part) => part.boundingBox()),
      );
      assert.ok(label.y + label.height + 3 <= field.y, 'the frame of the field with the focus covers no text above it');
      if (options.hasTouch) {
        const heights = await report
          .getByRole('button')
          .evaluateAll((buttons) => buttons.map((button) => button.getBoundingClientRect().height));
        assert.ok(Math.min(...heights) >= 44, `buttons for fingers: ${heights} px high`);
      }
      await shot('report');
      await report.getByRole('table').last().scrollIntoViewIfNeeded();
      const torn = await report
        .getByRole('table')
        .last()
        .locator('td, tbody th')
        .evaluateAll((cells) =>
          cells
            .filter((cell) => {
              const range = document.createRange();
              range.selectNodeContents(cell);
              return new Set([...range.getClientRects()].map(({ y }) => Math.round(y))).size > 1;
            })
            .map((cell) => cell.textContent),
        );
      assert.deepEqual(torn, [], 'figures stand in one line');
      await shot('report-figures');
      await press(report.getByRole('button', { name: 'Close' }));
      await report.waitFor({ state: 'detached' });

      // ---- later, another scene: the picture brings the one in it back ------------------------------------------------------------
      const revision = await revisionOf(1);
      const patch = {
        regions: Object.fromEntries(plan.regions.map(({ id }) => [id, { visible: true, opacity: 0.5, representation: 'surface' }])),
        image: { window: { width: 1 } },
      };
      assert.equal((await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', patch, { 'If-Match': '*' })).status, 200);
      await newer(page, 1, revision);
      await drag(await middleOf(1), -60, 20);
      await comes(
        () => matrixOf(1),
        (m) => !isNear(m, keptMatrix, 1e-3),
        'turned away',
      );
      await page.evaluate(
        (data) => {
          const transfer = new DataTransfer();
          transfer.items.add(new File([Uint8Array.from(data)], 'kept.png'));
          document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
        },
        [...bytes],
      );
      await page.getByText('Scene and view are as in the picture').waitFor();
      await comes(scene, (now) => JSON.stringify(now) === JSON.stringify(kept), 'the scene is as it was');
      await comes(
        () => matrixOf(1),
        (m) => isNear(m, keptMatrix, 1e-4),
        'the view is as it was',
      );
      await full(page, 1);
      await shot('back');
      assert.deepEqual(world.errors, []);
      await page.context().close();
    });
  }
});
