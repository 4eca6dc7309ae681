// The one dose legend of a room: where it stands, what is left out first, and that no words but those of pictures lie over anatomy.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { overPictures } from './anatomy.mjs';
import { axe } from './axe.mjs';
import { full, later, missing, once, shoot, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';
import { writeStrayDose } from './stray_dose.mjs';

const sizes = {
  1024: { viewport: { width: 1024, height: 768 } },
  1280: { viewport: { width: 1280, height: 720 } },
  1920: { viewport: { width: 1920, height: 1080 } },
  2560: { viewport: { width: 2560, height: 1440 } },
  tablet: { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true },
  upright: { viewport: { width: 820, height: 1180 }, hasTouch: true, isMobile: true },
  phone: { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
};
const colours = ['#ff0000', '#00ff00', '#0000ff', '#ffff00', '#ff00ff', '#00ffff'];
const clips = {
  axial_high: { enabled: true, position_mm: 44 },
  sagittal_high: { enabled: true, position_mm: 30 },
  coronal_low: { enabled: true, position_mm: -20 },
};

/** n levels from 95 % down instead of the usual six. */
const levels = (n) => ({
  ...Object.fromEntries([1, 2, 3, 4, 5, 6].map((at) => [`level-${at}`, null])),
  ...Object.fromEntries(
    Array.from({ length: n }, (_, at) => [
      `own-${at + 1}`,
      {
        value: 95 - 7.5 * at,
        unit: 'percent',
        color: colours[at % 6],
        visible: true,
        line: true,
        wash: true,
        surface: false,
        opacity: 0.4,
      },
    ]),
  ),
});

describe('the dose legend', { skip: missing && `${missing} is not there` }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-legend-'));
  let world;
  let page;

  before(async () => {
    writeStrayDose(folder);
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    rmSync(folder, { recursive: true });
  });

  /** A page on a new room with this change of its scene. */
  const open = async (plan, patch, options) => {
    const room = await world.newRoom(plan);
    const { status, json } = await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', patch, { 'If-Match': '*' });
    assert.equal(status, 200, JSON.stringify(json));
    page = await world.newPage(`rooms/${room}`, options);
    await page.locator('.dose-legend').waitFor();
    await page.waitForFunction(() => !document.querySelector('.legend-row.old'));
    return room;
  };
  const washed = (more = {}, n = 6) => ({
    dose: { lines: { visible: true }, wash: { visible: true }, ...(n === 6 ? {} : { levels: levels(n) }) },
    ...more,
  });

  /** Every level with its value lies inside the strip or column, and nothing of it is cut. */
  const isWhole = () =>
    page.evaluate(() => {
      const outer = document.querySelector('.dose-legend').getBoundingClientRect();
      const parts = [...document.querySelectorAll('.dose-legend .legend-levels li > *')];
      return (
        parts.length > 0 &&
        parts.every((part) => {
          const box = part.getBoundingClientRect();
          return (
            part.scrollWidth <= part.clientWidth + 1 &&
            box.left >= outer.left &&
            box.right <= outer.right + 0.5 &&
            box.top >= outer.top &&
            box.bottom <= outer.bottom + 0.5
          );
        })
      );
    });

  /** No strip, column or bar shares an area with a picture. */
  const standsBeside = () =>
    page.evaluate(() => {
      const legend = document.querySelector('.dose-legend').getBoundingClientRect();
      return [...document.querySelectorAll('.pane:not([hidden])')].every((pane) => {
        const box = pane.getBoundingClientRect();
        return legend.left >= box.right - 1 || legend.right <= box.left + 1 || legend.top >= box.bottom - 1 || legend.bottom <= box.top + 1;
      });
    });

  later('with wash, a draft and three clip planes no words but those of pictures lie over one', async () => {
    await open('phantom', washed({ clip: clips }), { viewport: { width: 1440, height: 900 } });
    for (const view of [1, 2, 3, 4]) await full(page, view);
    await page.locator('[data-key="beam:beam-1"] button.name').click();
    await page.getByRole('button', { name: 'Draft a new position' }).click();
    await page.locator('.beam-bar').waitFor();
    for (const view of [1, 2, 3, 4]) await full(page, view);
    await page.locator('[data-view="4"] .clip-chip').nth(1).waitFor();
    assert.deepEqual(await overPictures(page), []);
    assert.deepEqual(await page.locator('[data-view="2"] .clip-chip').allTextContents(), ['right of L 30', 'behind P −20']);
    assert.deepEqual(await page.locator('[data-view="4"] .clip-chip').allTextContents(), ['below S 44', 'right of L 30']);
    const cut = await page
      .locator('.clip-chip')
      .evaluateAll((chips) => chips.filter((chip) => chip.scrollWidth > chip.clientWidth + 1).map((chip) => chip.textContent));
    assert.deepEqual(cut, [], 'at 1440 every chip is whole');
    assert.equal(await standsBeside(), true);
    assert.deepEqual(await overlaps(page), []);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'legend-anatomy');
    await page.context().close();
  });

  once('levels are never cut: the words of the reference go first, whole; the tooltip keeps all', async () => {
    await open('phantom', washed({}, 12), { viewport: { width: 1440, height: 900 } });
    assert.equal(await isWhole(), true);
    assert.equal(await page.locator('.legend-levels li:not(.legend-unit)').count(), 12);
    assert.match(await page.locator('.legend-words').getAttribute('title'), /^Weighted total, .*100 % = [\d.]+ Gy\(w\), body max$/);
    const halves = () =>
      page.evaluate(() => {
        const outer = document.querySelector('.legend-words').getBoundingClientRect();
        const parts = [...document.querySelectorAll('.legend-words > span')].map((part) => part.getBoundingClientRect());
        return parts.map((box) => (box.top >= outer.bottom ? 'gone' : box.right <= outer.right + 0.5 ? 'whole' : 'cut'));
      });
    for (const width of [1440, 1500, 1560, 1800, 2200]) {
      await page.setViewportSize({ width, height: 900 });
      const shown = await until(halves, (now) => !now.includes('cut'), 5000);
      assert.ok(!shown.includes('cut'), `${width}: ${shown}`);
      assert.ok(
        shown.indexOf('gone') < 0 || !shown.slice(shown.indexOf('gone')).includes('whole'),
        `${width}: the last words go first: ${shown}`,
      );
      assert.equal(await isWhole(), true, width);
    }
    assert.deepEqual(await halves(), ['whole', 'whole'], 'a wide window has room for all');
    await page.context().close();
  });

  later('dragged by its grip it stands as a column right of the panes, is kept, and is offered from 1600 px alone', async () => {
    const room = await open('phantom', washed(), { viewport: { width: 1700, height: 900 } });
    const strip = page.locator('.dose-legend.in-strip');
    const column = page.locator('.dose-legend.in-column');
    const panes = async () => (await page.locator('.panes').boundingBox()).width;
    const before = await panes();
    const drag = async (to) => {
      const { x, y, width, height } = await page.locator('.legend-grip').boundingBox();
      await page.mouse.move(x + width / 2, y + height / 2);
      await page.mouse.down();
      await page.mouse.move(...to, { steps: 5 });
      await page.mouse.up();
    };
    const main = await page.locator('.room > main').boundingBox();
    await drag([main.x + main.width - 40, 400]);
    await column.waitFor();
    assert.equal(before - (await panes()), 128);
    assert.equal((await column.boundingBox()).width, 128);
    assert.equal(await standsBeside(), true);
    assert.equal(await isWhole(), true);
    await page.reload();
    await column.waitFor();
    await page.locator('.legend-grip').click();
    await page.getByRole('radiogroup', { name: 'Stands' }).getByRole('radio', { name: 'right of panes', checked: true }).waitFor();
    assert.deepEqual(await axe(page), []);
    await page.setViewportSize({ width: 1440, height: 900 });
    await strip.waitFor();
    assert.equal(await page.getByRole('radiogroup', { name: 'Stands' }).count(), 0);
    await page.setViewportSize({ width: 1700, height: 900 });
    await column.waitFor();
    await drag([main.x + 300, main.y + 10]);
    await strip.waitFor();
    await page.locator('.legend-grip').focus();
    await page.keyboard.press('ArrowRight');
    await column.waitFor();
    await page.keyboard.press('ArrowUp');
    await strip.waitFor();
    assert.equal((await world.scene(room)).dose.wash.visible, true, 'a place of a person is no change of the scene');
    await page.context().close();
  });

  once(
    'a difference has a strip of its own with ends, arrows, domain and counts; gamma its criteria; the words follow the mode at once',
    async () => {
      await open(
        'stray-dose',
        {
          dose: {
            id: 'own',
            quantity: 'total',
            lines: { visible: true },
            wash: { visible: true },
            compare: { id: 'near', mode: 'difference' },
          },
        },
        { viewport: { width: 1600, height: 900 } },
      );
      const rows = page.locator('.legend-row');
      const strip = (kind) => page.locator(`.legend-row[data-kind="${kind}"]`);
      await strip('difference')
        .locator('.legend-domain', { hasText: /voxels/ })
        .waitFor();
      assert.equal(await rows.count(), 2, 'levels as lines, and the difference');
      const words = await strip('difference').textContent();
      assert.match(words, /near − own, Gy/);
      assert.match(words, /≤ −.*0.*≥ \+/s);
      assert.match(words, /in the body, from 10 %; [\d\s]+ of [\d\s]+ voxels/);
      assert.match(words, /mean .*, rms /);
      await page.locator('[data-dose="own"] button.name').click();
      await page.getByRole('radiogroup', { name: 'Comparison' }).getByRole('radio', { name: 'Gamma' }).waitFor();
      await page.evaluate(() => {
        globalThis.seen = [];
        new MutationObserver(() =>
          globalThis.seen.push([...document.querySelectorAll('.legend-row')].map((row) => row.dataset.kind).join()),
        ).observe(document.querySelector('.legends'), { subtree: true, childList: true, attributes: true, characterData: true });
        const choices = [...document.querySelectorAll('#tab-panel [role="radiogroup"][aria-label="Comparison"] [role="radio"]')];
        choices.find((choice) => choice.textContent === 'Gamma').click();
      });
      await strip('gamma').waitFor();
      assert.ok(!(await page.evaluate(() => globalThis.seen)).some((kinds) => kinds === ''), 'it never goes meanwhile');
      const gamma = strip('gamma');
      await gamma.locator('.legend-domain', { hasText: /% pass/ }).waitFor();
      assert.match(await gamma.textContent(), /1 passes up to here/);
      assert.match(await gamma.textContent(), /3 %, 2 mm|2 %, 2 mm|\d %, [\d.]+ mm/);
      await page.context().close();
    },
  );

  once('a level has at most one label in a pane, away from crosshair, letters, scale and other labels; none in small panes', async () => {
    const room = await open(
      'phantom',
      { dose: { quantity: 'gamma', lines: { visible: true }, levels: { 'level-1': { value: 20 } } } },
      { viewport: { width: 1920, height: 1080 } },
    );
    const labels = page.locator('[data-view="2"] .dose-line-label');
    await labels.first().waitFor();
    const found = await page.evaluate(() => {
      const boxes = (names) => [...document.querySelectorAll(names)].map((one) => one.getBoundingClientRect());
      const gap = (a, b) => Math.hypot(Math.max(a.left - b.right, b.left - a.right, 0), Math.max(a.top - b.bottom, b.top - a.bottom, 0));
      return [2, 3, 4].map((view) => {
        const pane = `[data-view="${view}"]`;
        const own = boxes(`${pane} .dose-line-label`);
        const lines = boxes(`${pane} .crosshair line`);
        const upright = lines.find(({ width }) => width < 2);
        const level = lines.find(({ height }) => height < 2);
        const middle = { left: upright.left, right: upright.right, top: level.top, bottom: level.bottom };
        const picture = document.querySelector(`${pane} .picture`).getBoundingClientRect();
        return {
          ids: [...document.querySelectorAll(`${pane} .dose-line-label`)].map((one) => one.dataset.level),
          cross: Math.min(...own.map((label) => gap(label, middle))),
          marks: Math.min(...own.flatMap((label) => boxes(`${pane} :is(.letter, .scale, .caption)`).map((mark) => gap(label, mark)))),
          apart: Math.min(...own.flatMap((label, at) => own.slice(0, at).map((other) => gap(label, other)))),
          foot: Math.min(...own.map((label) => picture.bottom - label.bottom)),
        };
      });
    });
    for (const { ids, cross, marks, apart, foot } of found) {
      assert.equal(new Set(ids).size, ids.length, String(ids));
      assert.ok(cross >= 23 && marks > 0 && apart > 0 && foot >= 26, JSON.stringify({ cross, marks, apart, foot })); // of letters, whose boxes are less exact than the places
    }
    await page.locator('.legend-grip').click();
    await page.getByRole('radiogroup', { name: 'Lines' }).getByRole('radio', { name: 'without' }).click();
    await labels.first().waitFor({ state: 'detached' });
    await page.getByRole('radiogroup', { name: 'Lines' }).getByRole('radio', { name: 'with values' }).click();
    await labels.first().waitFor();
    await page.setViewportSize({ width: 1280, height: 560 });
    await labels.first().waitFor({ state: 'detached' });
    assert.equal((await world.scene(room)).dose.lines.visible, true);
    await page.context().close();
  });

  later('outlines are as wide in px of the page whatever the pixels of the screen', async () => {
    const widths = [];
    for (const deviceScaleFactor of [1, 2]) {
      await open(
        'phantom',
        washed({ dose: { lines: { visible: true, width_px: 4 }, wash: { visible: false }, quantity: 'gamma' }, outline: { width_px: 4 } }),
        {
          viewport: { width: 1280, height: 720 },
          deviceScaleFactor,
        },
      );
      await full(page, 2);
      assert.equal(await page.evaluate(() => globalThis.beamroom.stats().documents[2].pixel_ratio ?? 1), deviceScaleFactor);
      // from the left edge to the right through the picture's upper part: the longest run of one bright colour is the scalp's outline cut across
      const share = await page.evaluate(() => {
        const canvas = document.querySelector('[data-view="2"] canvas');
        const { data, width } = canvas.getContext('2d').getImageData(0, Math.round(canvas.height / 2), canvas.width, 1);
        let first = 0;
        while (first < width && data[4 * first] + data[4 * first + 1] + data[4 * first + 2] < 150) first += 1;
        const colour = [0, 1, 2].map((part) => data[4 * (first + 3) + part]);
        let last = first + 3; // its edge is soft
        while (last < width && [0, 1, 2].every((part) => Math.abs(data[4 * last + part] - colour[part]) < 60)) last += 1;
        return (last - first) / width;
      });
      widths.push(share * (await page.locator('#picture-2').boundingBox()).width);
      await page.context().close();
    }
    assert.ok(Math.abs(widths[0] - widths[1]) < 1.2 && widths[0] > 3, `${widths} px`); // edges are soft
  });

  once('on a telephone it has swatches alone, and a tap shows the list', async () => {
    await open('phantom', washed(), sizes.phone);
    assert.equal(
      await page
        .locator('.dose-legend')
        .textContent()
        .then((words) => words.trim()),
      '',
    );
    assert.equal(await page.locator('.dose-legend.phone i').count(), 6);
    await page.locator('.dose-legend.phone button').click();
    await page.locator('.legend-list .legend-levels li').nth(6).waitFor();
    assert.deepEqual(await axe(page), []);
    assert.deepEqual(await overlaps(page), []);
    await shoot(page, 'legend-phone');
    await page.context().close();
    assert.deepEqual(world.errors, []);
  });

  for (const [size, options] of Object.entries(sizes))
    for (const n of [1, 6, 12])
      later(`${size}, ${n} levels: nothing lies over a picture, nothing is cut`, async () => {
        await open('phantom', washed({ clip: clips }, n), options);
        await full(page, size === 'phone' ? 1 : 2);
        assert.deepEqual(await overPictures(page), []);
        assert.equal(await standsBeside(), true);
        if (size !== 'phone') assert.equal(await isWhole(), true);
        assert.deepEqual(await overlaps(page), []);
        await shoot(page, `legend-${size}-${n}`);
        await page.context().close();
      });
});
