// Sizes of windows: nothing that matters is cut, whatever the window.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { full, header, isDue, later, missing, newer, once, shoot, startWorld } from './browser.mjs';
import { writeLabels } from './labels.mjs';
import { overlaps } from './overlap.mjs';
import { sizes as roomSizes, states } from './room_states.mjs';

const sizes = [
  [1600, 1000],
  [1280, 720],
  [1180, 820],
  [800, 500],
  [820, 1180],
]; // 800 x 500: 1600 x 1000 at 200 %

describe('sizes of windows', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-layout-'));
    mkdirSync(join(folder, 'a-head-with-a-very-long-name'));
    writeFileSync(
      join(folder, 'a-head-with-a-very-long-name/plan.json'),
      JSON.stringify({
        format: 'beamroom-plan',
        version: 1,
        name: 'PHANTOM_with_a_name_that_nobody_can_break',
        images: [{ id: 'ct', path: 'ct.nii' }],
      }),
    );
    writeFileSync(join(folder, 'a-head-with-a-very-long-name/ct.nii'), 'no image at all');
    mkdirSync(join(folder, 'beams'));
    writeFileSync(
      join(folder, 'beams/plan.json'),
      JSON.stringify({
        format: 'beamroom-plan',
        version: 1,
        name: 'Beams alone',
        beams: [{ id: 'b1', entry_mm: [0, -100, 0], target_mm: [0, 0, 0], aperture_mm: 120 }],
      }),
    );
    mkdirSync(join(folder, 'sides'));
    writeLabels(join(folder, 'sides'), 'Sides', ['Optic_nerve_of_the_orbit_left', 'Optic_nerve_of_the_orbit_right']);
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  /** Elements that reach out of what they stand in. */
  const cut = (page, selector, inside) =>
    page.evaluate(
      ([what, where]) =>
        [...document.querySelectorAll(what)]
          .filter((element) => element.checkVisibility())
          .flatMap((element) => {
            const box = element.getBoundingClientRect();
            const outer = element.closest(where).getBoundingClientRect();
            return box.right > outer.right + 0.5 || box.left < outer.left - 0.5 || element.scrollWidth > element.clientWidth + 1
              ? [`${element.textContent.trim().slice(0, 40)} ${box.left}..${box.right} in ${outer.left}..${outer.right}`]
              : [];
          }),
      [selector, inside],
    );

  for (const [width, height] of sizes.filter(([size]) => isDue(size === 1600))) {
    it(`a room at ${width} x ${height}: the line on research use is whole, every pane has its letters`, async () => {
      const page = await world.newPage(`rooms/${await world.newRoom()}`, { viewport: { width, height } });
      const visible = await page.evaluate(() =>
        [...document.querySelectorAll('.pane:not([hidden])')].map((pane) => Number(pane.dataset.view)),
      );
      for (const view of visible) await full(page, view);
      assert.deepEqual(await cut(page, '.research', '.status'), []);
      for (const view of visible) {
        await page.waitForFunction((n) => {
          // the picture has the size of its pane
          const { width_px, height_px } = globalThis.beamroom.stats().headers[n];
          const { width, height } = document.querySelector(`#picture-${n}`).getBoundingClientRect();
          return Math.abs(width_px - width) <= 1 && Math.abs(height_px - height) <= 1;
        }, view);
        const box = await page.locator(`#picture-${view}`).boundingBox();
        assert.ok(box.height > height / 6, `pane ${view} is ${box.height} px high`);
      }
      await shoot(page, `layout-${width}x${height}`);
      await page.context().close();
    });

    it(`the list of plans at ${width} x ${height}: names and buttons stay in their rows`, async () => {
      const page = await world.newPage('', { viewport: { width, height } });
      await page.locator('[data-plan] .refusal').waitFor();
      assert.deepEqual(await cut(page, '.research', '.status'), []);
      assert.deepEqual(await cut(page, '.plan button', '.plan-row'), []);
      assert.deepEqual(await cut(page, '.plan .title', '.plan-row'), []);
      await shoot(page, `layout-start-${width}x${height}`);
      await page.context().close();
    });
  }

  later('a pane maximised while all four are being drawn, and back: the other three come anew', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`);
    for (const view of [1, 2, 3, 4]) await full(page, view);
    const { scene_revision: revision } = await header(page, 2);
    for (let turn = 0; turn < 3; turn++) {
      await page.locator('[data-region="scalp"] .eye').click(); // all four are asked for
      await page.locator('[aria-label="Maximise 3-D"]').click(); // three of them are closed before they came
      await full(page);
      await page.locator('[aria-label="Restore 3-D"]').click();
    }
    for (const view of [1, 2, 3, 4]) {
      await page.waitForFunction(([n, old]) => globalThis.beamroom.stats().headers[n].scene_revision === old + 3, [view, revision]);
      await full(page, view);
    }
    await page.context().close();
  });

  for (const [size, options] of Object.entries(roomSizes).filter(() => isDue(false)))
    it(`${size}: in no state does text lie over text, a letter or a control, and panes are as wide as they have to be`, async () => {
      const page = await world.newPage(`rooms/${await world.newRoom()}`, options);
      await full(page);
      for (const [name, act] of states[size]) {
        await act(page);
        await settled(page);
        assert.deepEqual(await overlaps(page), [], name);
        assert.deepEqual(await cut(page, '.tabs > .icon-button, .panel-head .icon-button', '.room'), [], `${name}: a panel can be closed`);
        for (const { view, width, layout } of await panes(page))
          if (size === 'wide' || size === 'compact')
            assert.ok(
              width >= (layout === 'row' ? 190 : layout === '1+3' && view > 1 ? 250 : 420) - 0.5,
              `${name}: pane ${view} is ${width} px wide`,
            );
        await shoot(page, `layout-${size}-${name.replaceAll(' ', '-').toLowerCase()}`);
      }
      await page.context().close();
    });

  const panes = (page) =>
    page.evaluate(() =>
      [...document.querySelectorAll('.pane:not([hidden])')].map((pane) => ({
        view: Number(pane.dataset.view),
        width: pane.getBoundingClientRect().width,
        layout: document.querySelector('.room').dataset.layout,
      })),
    );

  /** Until every picture is at rest. */
  const settled = (page) =>
    page.waitForFunction(() =>
      [...document.querySelectorAll('.pane:not([hidden])')].every(
        (pane) => globalThis.beamroom.stats().badges[pane.dataset.view] === 'full',
      ),
    );

  later('panels never make one of four panes narrower than 420 px, at any width of a desk', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`, roomSizes.wide);
    await full(page);
    for (const width of [1920, 1433, 1400, 1399, 1280, 1209, 1208, 1100]) {
      await page.setViewportSize({ width, height: 800 });
      for (const isOpen of [true, false]) {
        const button = page.locator(isOpen ? '[aria-label="Show the inspector"]' : '[aria-label="Fold the inspector"]');
        if (await button.isVisible()) await button.click();
        for (const pane of await panes(page))
          assert.ok(
            pane.width >= 419.5,
            `window ${width}, inspector ${isOpen ? 'open' : 'folded'}: pane ${pane.view} is ${pane.width} px wide`,
          );
      }
    }
    await page.context().close();
  });

  once('what was clicked is in sight in the inspector: its head stands at the top', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`, roomSizes.compact);
    await full(page);
    await page.locator('[data-section="regions"]').click();
    for (const id of ['scalp', 'tumour']) {
      await page.locator(`[data-region="${id}"] button.name`).click();
      const head = page.locator('#tab-panel h3').first();
      assert.match(await head.textContent(), new RegExp(id));
      assert.ok((await head.boundingBox()).y < 150, id);
      await page.locator('#tab-panel').evaluate((panel) => {
        panel.scrollTop = panel.scrollHeight;
      }); // the next choice begins at the top again
    }
    await page.context().close();
  });

  once('regions are found by a part of their names, hidden all at once, and left to the targets', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`, roomSizes.wide);
    await full(page);
    const shown = async () =>
      Object.entries((await world.scene(room)).regions)
        .filter(([, { visible }]) => visible)
        .map(([id]) => id)
        .sort();
    const press = async (name) => {
      const { scene_revision: revision } = await header(page, 1);
      await page.getByRole('button', { name }).click();
      await newer(page, 1, revision);
      await full(page);
      assert.equal((await header(page, 1)).scene_revision, revision + 1, `${name} is one change`);
    };
    const all = await shown();
    await press('Hide all');
    assert.deepEqual(await shown(), []);
    await press('Show only targets');
    assert.deepEqual(await shown(), ['target', 'tumour']);
    await press('Hide all');
    await press('Show all');
    assert.deepEqual(await shown(), all);
    await page.getByRole('searchbox', { name: 'Find a region' }).fill('RA');
    assert.deepEqual(await page.locator('[data-region]').evaluateAll((rows) => rows.map((row) => row.dataset.region)), [
      'cranium',
      'brain',
    ]);
    await page.context().close();
  });

  once('a name that is cut loses its middle, never its end', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom('sides')}`, roomSizes.wide);
    await full(page);
    for (const side of ['left', 'right']) {
      const row = page.locator('[data-region]', { hasText: side }).first();
      const [start, end] = await row
        .locator('.clip span')
        .evaluateAll((spans) => spans.map((span) => ({ text: span.textContent, isCut: span.scrollWidth > span.clientWidth + 1 })));
      assert.ok(start.isCut, `${start.text} is cut`);
      assert.deepEqual(end.isCut, false);
      assert.ok(end.text.endsWith(side));
      assert.equal(await row.locator('button.name').getAttribute('title'), `Optic_nerve_of_the_orbit_${side}`);
    }
    await page.context().close();
  });

  for (const [size, options] of Object.entries(roomSizes))
    later(`${size}: the comparison of methods shows its table in the window`, async () => {
      const page = await world.newPage(`rooms/${await world.newRoom()}`, options);
      await full(page);
      if (size === 'compact') await page.locator('[data-section="regions"]').click();
      if (size === 'tablet' || size === 'phone') {
        await page.locator('.dock button', { hasText: 'Parts' }).click();
        await page.getByRole('tab', { name: 'Regions' }).click();
      }
      await page.locator('[data-region="tumour"] button.name').click();
      await page.locator('button', { hasText: 'Compare methods' }).click();
      await page.locator('[aria-label="Methods compared"] tbody tr', { hasText: 'Univels' }).locator('td', { hasText: 'cm³' }).waitFor();
      const dialog = await page.locator('[aria-label="Methods compared"]').boundingBox();
      const { width, height } = options.viewport;
      assert.ok(dialog.x >= 0 && dialog.x + dialog.width <= width && dialog.y + dialog.height <= height, `${size}: within the window`);
      if (size === 'tablet') await shoot(page, 'layout-compare-1180');
      await page.context().close();
    });

  later('a plan of beams alone says that there is nothing to draw, and nothing runs through the words', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom('beams')}`);
    for (const view of [1, 2]) {
      await full(page, view);
      await page.locator(`[data-view="${view}"] .cover.quiet`, { hasText: 'nothing to' }).waitFor();
    }
    assert.equal(await page.locator('.overlay .crosshair, .overlay .marker').count(), 0);
    await shoot(page, 'layout-beams');
    await page.context().close();
  });

  later('the load report of a plan that is refused says why', async () => {
    const page = await world.newPage();
    await page.locator('[data-plan="a-head-with-a-very-long-name"]').click();
    await page.locator('.load-report .report', { hasText: 'Refused' }).waitFor();
    assert.match(await page.locator('.load-report .report').textContent(), /ct\.nii/);
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
