// The tasks of docs/guide as somebody does them in the page: one tour for each picture or two. The pictures of the guide are made by them
// (docs/guide/pictures.mjs), and a long test walks them and holds the guide's words to what they have seen (guide.test.mjs).
import { openPlan, until } from '../api/daemon.mjs';
import { writeOtherFrame } from '../api/other_frame.mjs';
import { full, header, newer } from './browser.mjs';
import { action, enter, openRoster, says } from './people.mjs';
import { writeStrayDose } from './stray_dose.mjs';
import { writeThreeImages } from './three_images.mjs';

/** Writes the plans of the tours beside the demo plan. @param {string} folder of plans */
export function guidePlans(folder) {
  writeOtherFrame(folder);
  writeStrayDose(folder);
  writeThreeImages(folder);
}

/** A wide window, as a picture of 1200 x 750 px. */
export const size = { viewport: { width: 1440, height: 900 }, deviceScaleFactor: 1200 / 1440 };

/** Everything that can be read on a page now: text, names of controls, tooltips, placeholders, choices. */
export const wordsOn = (page) =>
  page.evaluate(() => {
    const named = ['aria-label', 'title', 'placeholder'];
    const attributes = [...document.querySelectorAll('*')].flatMap((element) => named.map((name) => element.getAttribute(name) ?? ''));
    const choices = [...document.querySelectorAll('option')].map((option) => option.textContent);
    return [document.body.innerText, document.body.textContent, ...attributes, ...choices].join('\n');
  });

const button = (page, name) => page.getByRole('button', { name, exact: true });
/** Until the pictures are at rest, in the size of their panes. */
const settled = async (page, views = [1, 2, 3, 4]) => {
  for (const view of views) {
    await page.waitForFunction((n) => {
      const { badges, headers } = globalThis.beamroom.stats();
      const box = document.querySelector(`#picture-${n}`)?.getBoundingClientRect(); // none before the room is drawn
      return box && badges[n] === 'full' && Math.abs(headers[n].width_px / devicePixelRatio - box.width) <= 1.5;
    }, view);
  }
};
const tab = (page, name) => page.getByRole('tab', { name, exact: typeof name === 'string' }).click();
const row = (page, key) => page.locator(`[data-key="${key}"]`);
const eye = (page, key) => row(page, key).locator('.eye').click();
const toastsGone = async (page) => {
  for (const cross of await page.locator('.toast [aria-label="Dismiss"]').all()) await cross.click().catch(() => {});
};

/** Drags in a picture, from one part of its width and height to another. */
async function drag(page, view, [u, v], [s, t]) {
  const { x, y, width, height } = await page.locator(`#picture-${view}`).boundingBox();
  await page.mouse.move(x + width * u, y + height * v);
  await page.mouse.down();
  for (let step = 1; step <= 8; step++)
    await page.mouse.move(x + width * (u + ((s - u) * step) / 8), y + height * (v + ((t - v) * step) / 8));
  await page.mouse.up();
}

/** The crosshair to the middle of a region. */
async function toRegion(page, region) {
  await row(page, `region:${region}`).locator('button.name').click();
  await button(page, 'Go to centre').click();
  await settled(page);
}

/**
 * Each tour: (stage) => Promise. stage.page(plan) opens a room of a plan, stage.enter(address, name) lets a second person in, stage.shot(page, name, part)
 * is a moment that the guide has a picture of, of the whole page or of a part, stage.look(page) one whose words count.
 * @type {Record<string, (stage: object) => Promise<void>>}
 */
export const tours = {
  async 'the first plan'({ world, shot, look }) {
    await openPlan(world.daemon.url, 'phantom');
    const page = await world.newPage('', size);
    await page.locator('[data-plan="phantom"] .as-text').click();
    await page.locator('.load-report .report').waitFor();
    await shot(page, 'start');
    await button(page, 'Upload').click();
    await page.locator('.upload-card').waitFor();
    await look(page);
    await page
      .locator('input[aria-label="Files of a plan"]')
      .setInputFiles({ name: 'head.tar', mimeType: 'application/x-tar', buffer: Buffer.alloc(1024) });
    await page.locator('[data-upload] input[name="name"]').waitFor();
    await look(page);
    await button(page, 'Cancel').click();
    await page.locator('input[name="name"]').fill('Dr Ann');
    await button(page, 'Save name').click();
    await button(page, 'Open Phantom: modified Snyder head').click();
    await settled(page);
    await page.locator('#saved', { hasText: 'Saved' }).waitFor();
    await shot(page, 'room');
  },

  async 'reading a folder'({ room, shot }) {
    const page = await room('stray-dose');
    await page.locator('.banner .chip').click();
    await page.getByText('Load report').first().scrollIntoViewIfNeeded();
    await page.locator('.report').first().scrollIntoViewIfNeeded();
    await shot(page, 'report-of-loading');
  },

  async looking({ room, shot, look }) {
    const page = await room('phantom');
    await toRegion(page, 'tumour');
    await row(page, 'image:ct').locator('button.name').click();
    await button(page, 'Window').click();
    await drag(page, 2, [0.4, 0.5], [0.45, 0.5]);
    await button(page, 'Crosshair').click();
    await settled(page);
    const { x, y, width, height } = await page.locator('#picture-2').boundingBox();
    await page.mouse.move(x + width * 0.5, y + height * 0.42);
    await page.mouse.move(x + width * 0.52, y + height * 0.42, { steps: 4 });
    await page.locator('[data-view="2"] .read-out').waitFor();
    await shot(page, 'looking');
    await page.locator('button[aria-label="Panes"]').click();
    await page.getByRole('button', { name: 'Clipped volume with wash' }).waitFor();
    await look(page);
    await page.getByRole('button', { name: 'Clipped volume with wash' }).click();
    await settled(page);
    await look(page);
    await toastsGone(page);
    await button(page, 'Maximise 3-D').click();
    await settled(page, [1]);
    await shot(page, 'volume');
    await page.getByRole('button', { name: '3-D picture', exact: true }).click();
    await page.locator('.block.lights').waitFor();
    await look(page);
  },

  async 'two images'({ room, look }) {
    const page = await room('three-images');
    await row(page, 'image:ct').locator('button.name').click();
    await page.getByText('Second image over it').waitFor();
    await look(page);
  },

  async regions({ room, shot, look }) {
    const page = await room('phantom');
    await toRegion(page, 'tumour');
    await page.locator('.figures', { hasText: 'Made of' }).waitFor();
    await shot(page, 'regions');
    await button(page, 'Compare methods').click();
    const compared = page.getByRole('dialog', { name: 'Methods compared' });
    await compared.locator('button:enabled', { hasText: 'CSV' }).waitFor();
    await shot(page, 'methods', compared);
    await compared.getByRole('button', { name: 'Close' }).click();
  },

  async 'cutting and planes'({ room, shot, look }) {
    const page = await room('phantom');
    await toRegion(page, 'tumour');
    await row(page, 'section:clip').click();
    for (const id of ['sagittal_high', 'axial_high']) await eye(page, `clip:${id}`);
    await page.getByText('Not cut by clip planes').waitFor();
    await look(page);
    await row(page, 'clip:axial_high').locator('button.name').click();
    await settled(page);
    await row(page, 'clip:axial_high').scrollIntoViewIfNeeded();
    await shot(page, 'cutting');
    await row(page, 'section:planes').click();
    await row(page, 'oblique:').locator('button.name').click();
    await look(page);
  },

  async dose({ room, shot, look }) {
    const page = await room('phantom');
    await toRegion(page, 'tumour');
    await page.locator('[data-dose="goorley"] .eye').click();
    await page.locator('[data-dose="goorley"] button.name').click();
    const { scene_revision: old } = await header(page, 2);
    await page.locator('#tab-panel [aria-label="Weights of"]').selectOption({ label: 'as brain' });
    await page.locator('#tab-panel [aria-label="Reference: what 100 % is"]').selectOption('region-max brain');
    await page.locator('.dose-legend', { hasText: 'brain max' }).waitFor();
    for (const view of [1, 2, 3, 4]) await newer(page, view, old + 1);
    await page.locator('.dose-legend.old, .dose-legend .old').first().waitFor({ state: 'detached' });
    await settled(page);
    await shot(page, 'dose');
    await tab(page, 'Probe');
    await page.locator('.dose-table').waitFor();
    await look(page);
    await page.locator('button[aria-label="Panes"]').click();
    await page.getByRole('button', { name: '90 % surface over the target' }).click();
    await settled(page);
    await toastsGone(page);
    await row(page, 'level:preset-90').or(page.locator('[data-key^="level:"]')).first().locator('button.name').click();
    await button(page, 'Maximise 3-D').click();
    await settled(page, [1]);
    await shot(page, 'surface');
  },

  async 'dose in numbers'({ room, shot, look }) {
    const page = await room('phantom');
    await toRegion(page, 'tumour');
    await button(page, 'Plots of dose').click();
    await page.locator('.chart-dvh canvas').waitFor();
    await page.locator('.chart-profile canvas').waitFor();
    await page.locator('.chart-dvh .u-over').hover({ position: { x: 150, y: 60 } });
    await look(page);
    await page.locator('.tools').hover();
    await settled(page);
    await shot(page, 'plots');
    await page.locator('[aria-label="Choices of the histogram"]').click();
    await look(page);
    await button(page, 'Close the plots').click();
    await tab(page, 'Plan');
    for (const [region, metric, side, limit] of [
      ['brain', 'max', 'at-most', '10'],
      ['tumour', 'D95%', 'at-least', '20'],
    ]) {
      await page.getByRole('button', { name: 'Add a limit' }).click();
      await look(page);
      await page.locator('#limit-region').selectOption(region);
      await page.locator('#limit-quantity').selectOption('weighted');
      await page.locator('#limit-metric').fill(metric);
      await page.locator('#limit-limit').fill(limit);
      await page.locator('#limit-side').selectOption(side);
      await page.getByRole('button', { name: 'Add it' }).click();
    }
    await page.locator('.chart-verdict').nth(1).waitFor();
    await until(
      () => page.locator('.chart-verdict').allTextContents(),
      (all) => all.every((text) => !/not known/.test(text)),
    );
    await settled(page);
    await shot(page, 'limits', page.locator('.chart-limits'));
  },

  async 'two doses'({ room, look }) {
    const page = await room('stray-dose');
    await page.locator('[data-dose="own"] .eye').click();
    await page.locator('[data-dose="own"] button.name').click();
    await page.locator('#tab-panel [aria-label="Quantity"]').selectOption('total');
    await page.locator('#tab-panel [aria-label="Second dose"]').selectOption('near');
    await page.getByRole('radiogroup', { name: 'Comparison' }).getByRole('radio', { name: 'Gamma' }).click();
    await page.getByText('Pass rate').waitFor();
    await look(page);
  },

  async 'what fits what'({ room, shot, look }) {
    const page = await room('other-frame');
    await page.locator('[data-dose="boost"] .eye').click();
    await page.locator('.fit-bar').waitFor();
    await tab(page, 'Plan');
    await page.locator('.fit-table').waitFor();
    await look(page);
    await page.getByRole('button', { name: 'Use it all the same …' }).click();
    await page.locator('.fit-block').waitFor();
    await page.getByLabel('Why it may be used').selectOption('compared-on-anatomy');
    await page.getByLabel('In your words, at least 10 letters').fill('Skull and ventricles agree within 2 mm.');
    await settled(page);
    await shot(page, 'fits');
    await until(
      async () => {
        const use = page.getByRole('button', { name: 'Use it in this room' });
        if (await use.isEnabled({ timeout: 1000 }).catch(() => false)) await use.click({ timeout: 1000 }).catch(() => {}); // gone once it is used
        return page.locator('.pane-head .fit-mark').count();
      },
      (n) => n > 0,
    );
    await settled(page);
    await page.locator('.dose-legend').waitFor();
    await shot(page, 'accepted');
  },

  async beam({ room, shot, look }) {
    const page = await room('phantom');
    await row(page, 'beam:beam-1').locator('button.name').click();
    await page.locator('.beam-table').waitFor();
    await look(page);
    await page.locator('button[aria-label="Panes"]').click();
    await page.getByRole('button', { name: "Beam's eye with aperture" }).click();
    await page.locator('.beam-foot').waitFor();
    await toastsGone(page);
    await settled(page, [7, 2, 3, 4]);
    await page.getByText('Regions in the aperture').waitFor();
    await shot(page, 'beam');
    await button(page, 'Draft a new position').click();
    await page.locator('.beam-bar').waitFor();
    const angle = page.getByLabel('Angle φ in degrees');
    await until(() => angle.isEnabled(), Boolean);
    await angle.fill('25');
    await angle.press('Enter');
    await until(
      () => page.locator('.beam-moved').textContent(),
      (text) => /direction/.test(text),
    );
    await page.keyboard.press('Escape');
    await page.locator('#picture-7').focus();
    await page.keyboard.press('b');
    await settled(page);
    await shot(page, 'draft');
  },

  async tracks({ room, look }) {
    const page = await room('phantom');
    await page.locator('[data-key^="tracks:"] button.name').first().click();
    await look(page);
  },

  async 'measuring and notes'({ room, shot, look }) {
    const page = await room('phantom');
    await toRegion(page, 'tumour');
    await button(page, 'Measure').click();
    await look(page);
    await drag(page, 2, [0.4, 0.42], [0.58, 0.42]);
    await page.locator('[data-view="2"] [data-measure]').first().waitFor();
    await page.keyboard.press('Escape');
    await tab(page, 'Probe');
    await button(page, 'Pin these values').click();
    await page.getByText('Pinned').waitFor();
    await look(page);
    await page.locator('#picture-2').focus();
    await page.keyboard.press('n');
    await page.locator('#note-field-new').fill('Is the margin enough on this side?');
    await look(page);
    await page.keyboard.press('Control+Enter');
    await page.locator('.notes > li', { hasText: 'Is the margin' }).waitFor();
    await settled(page);
    await shot(page, 'notes');
  },

  async meeting({ room, person, shot, look }) {
    const ann = await room('phantom', 'Dr Ann');
    await toRegion(ann, 'tumour');
    await button(ann, 'Invite').click();
    await ann.locator('#invite-role').waitFor();
    await ann.locator('.invite-form button', { hasText: 'Make link' }).click();
    const link = await until(() => ann.locator('#invite-made').inputValue(), Boolean);
    await look(ann);
    await ann.keyboard.press('Escape');
    const ben = await person(link.slice(link.indexOf('rooms/')), 'Ben');
    await settled(ben);
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('p');
    await ann.locator('.point-tools [aria-pressed="true"]').waitFor();
    const { x, y } = await ann.locator('#picture-2').boundingBox();
    await until(
      async () => {
        const [px, py] = [x + 300 + Math.random() * 4, y + 150];
        await ann.mouse.move(px, py);
        return ben.locator('.person-pointer').count();
      },
      (n) => n > 0,
    );
    await look(ann);
    await ann.getByRole('button', { name: 'Pointers', exact: true }).click();
    await look(ann);
    await ann.keyboard.press('Escape');
    await ben.locator('#picture-1').focus();
    for (let n = 0; n < 4; n++) await ben.keyboard.press('ArrowLeft');
    await says(ben, /^On my own/);
    await ben.locator('.watch canvas, [aria-label="Picture of the presenter"]').first().waitFor();
    await settled(ben);
    await shot(ben, 'meeting');
    await openRoster(ben);
    await look(ben);
    await action(ben, 'Request control').click();
    await ann.locator('.request-line', { hasText: 'Ben requests control' }).waitFor();
    await look(ben);
    await openRoster(ann);
    await shot(ann, 'people');
    await openRoster(ben);
    await look(ben);
    await ann.keyboard.press('Escape');
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('Shift+P');
    await ben.getByRole('button', { name: 'Come', exact: true }).waitFor();
    await look(ben);
  },

  async 'report and record'({ room, shot, look }) {
    const page = await room('phantom', 'Dr Ann');
    await toRegion(page, 'tumour');
    await page.locator('#picture-1').focus();
    await button(page, 'Snapshot').click();
    await page.getByRole('menuitem', { name: 'Add it to the report to print' }).waitFor();
    await look(page);
    await page.getByRole('menuitem', { name: 'Add it to the report to print' }).click();
    await page.getByText('In the report to print: 1 picture').waitFor();
    await button(page, 'Snapshot').click();
    await page.getByRole('menuitem', { name: /^Report to print/ }).click();
    const report = page.getByRole('dialog', { name: 'Report to print' });
    await report.getByLabel('Caption of Figure 1').fill('The tumour, seen from the left');
    await report.getByRole('button', { name: 'Print or save as PDF' }).and(page.locator(':enabled')).waitFor();
    await shot(page, 'report');
    await report.getByRole('button', { name: 'Close' }).click();
    await page.getByRole('treeitem', { name: /^Save this view/ }).click();
    await look(page);
    await page.getByLabel('Name of the view').fill('Margin');
    await button(page, 'Save').click();
    await page.getByLabel('Link to it').waitFor();
    await look(page);
    await tab(page, 'Record');
    await page.getByRole('heading', { name: 'Checklist' }).waitFor();
    await page.locator('.checks > li').first().getByRole('button', { name: 'OK' }).click();
    await page.getByRole('combobox', { name: 'Decision' }).selectOption('accept');
    await page.getByLabel('In words').fill('As shown');
    await button(page, 'Write down').click();
    await page
      .getByText(/^Kept \d\d:\d\d/)
      .last()
      .waitFor();
    await toastsGone(page);
    await shot(page, 'record');
  },

  async 'recording and replay'({ room, shot, look }) {
    const page = await room('phantom', 'Dr Ann');
    await openRoster(page);
    await look(page);
    await action(page, 'Record meeting').click();
    await page.locator('.chip-recorded:visible').waitFor();
    await look(page);
    await toRegion(page, 'tumour');
    await openRoster(page);
    await look(page);
    await action(page, 'End recording').click();
    await page.locator('.chip-recorded').first().waitFor({ state: 'detached' });
    await openRoster(page);
    const play = page.getByRole('button', { name: /^Play the recording/ }).locator('visible=true');
    await play.waitFor();
    await look(page);
    const opened = page.context().waitForEvent('page');
    await play.click();
    const replay = await opened;
    await full(replay);
    await openRoster(replay);
    await replay.locator('.replay-transport:visible').waitFor();
    await replay.getByText('In the meeting at this time').locator('visible=true').waitFor();
    await shot(replay, 'replay');
    await look(replay);
  },

  async keys({ room, keys, look }) {
    const page = await room('phantom');
    await button(page, 'Help').click();
    await page.locator('.help dl:not(.look-choice)').waitFor();
    await look(page);
    keys(
      await page.locator('.help').evaluate((list) => {
        const text = (name) => [...list.querySelectorAll(name)].map((element) => element.textContent.trim());
        const commands = text('.help-keys li > span').map((what, at) => [text('.help-key')[at].split(/\s+/).join(', '), what]);
        return [...commands, ...text('dl:not(.look-choice) dt').map((key, at) => [key, text('dl:not(.look-choice) dd')[at]])];
      }),
    );
  },
};

/**
 * Walks the tours one after the other. @param {object} world of browser.mjs @param {object} how
 * {names: of the tours, [] for all; shot(page, name), keys(rows): what is done at such a moment; between(name): called before each}
 * @returns {Promise<string>} all words that were seen
 */
export async function walk(world, { names = [], shot = async () => {}, keys = () => {}, between = () => {} } = {}) {
  const seen = [];
  const look = async (page) => {
    seen.push(await wordsOn(page));
  };
  for (const [name, tour] of Object.entries(tours)) {
    if (names.length && !names.includes(name)) continue;
    between(name);
    const pages = [];
    const person = async (address, who) => {
      const page = await enter(world, address, who, size);
      pages.push(page);
      return page;
    };
    await tour({
      world: { ...world, newPage: async (...args) => pages[pages.push(await world.newPage(...args)) - 1] },
      person,
      room: async (plan, who = 'Dr Ann') => {
        const page = await person(`rooms/${await world.newRoom(plan)}`, who);
        await settled(page);
        return page;
      },
      look,
      keys,
      shot: async (page, picture, part = page) => {
        await look(page);
        await shot(part, picture);
      },
    });
    for (const page of pages) await page.context().close();
  }
  return seen.join('\n');
}
