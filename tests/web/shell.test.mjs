// Around the panes: keys from anywhere and the list in which they are changed.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, later, missing, once, shoot, startWorld } from './browser.mjs';
import { load } from './unit/page.mjs';

const { toPicture } = await load('parts/vec.js');

describe('around the panes', { skip: missing && `${missing} is not there` }, () => {
  let world;

  before(async () => {
    world = await startWorld();
  });
  after(() => world?.stop());

  const open = async (options) => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`, options);
    await full(page);
    return page;
  };
  const wash = (page) => page.locator('.tools').getByRole('button', { name: 'Wash', exact: true });
  const isWashOn = (page) => wash(page).getAttribute('aria-pressed');

  once('keys act on the pane that was active last from the tree, a tool and the page, but not from text and lists of choice', async () => {
    const page = await open();
    const isMaximised = (view) => page.locator(`[data-view="${view}"] .icon-button[aria-pressed="true"]`).count();
    const tool = () => page.locator('.tools .tool[aria-pressed="true"] .word').textContent();
    await page.locator('#picture-3').click({ position: { x: 40, y: 60 } });
    await page.getByRole('treeitem', { name: /brain/i }).first().click();
    await page.keyboard.press('m');
    assert.equal(await tool(), 'Measure', 'from the tree');
    await page.getByRole('button', { name: 'Zoom', exact: true }).click();
    await page.keyboard.press('w');
    assert.equal(await tool(), 'Window', 'from a tool');
    assert.ok(await page.locator('[data-view="3"] .pane-head.active').isVisible(), 'its header says which');
    await page.keyboard.press('Escape');
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('Enter');
    assert.equal(await isMaximised(3), 1, 'from nowhere, Enter is the pane’s');
    await page.keyboard.press('Enter');
    const choice = page.locator('.tree select').first();
    await choice.focus();
    await page.keyboard.press('m');
    assert.equal(await tool(), 'Crosshair', 'a list of choice has its letters');
    await page.context().close();
  });

  later('a key is changed in the list, which can be searched; tooltips follow, a reload keeps it', async () => {
    const page = await open();
    const key = (name) => page.locator(`[data-command="${name}"] .help-key`);
    await page.keyboard.press('?');
    await page.locator('.help-search input').fill('caps');
    assert.equal(await page.locator('.help-keys li').count(), 1);
    await page.locator('.help-search input').fill('');
    await shoot(page, 'help-keys');
    await key('wash').click();
    await page.keyboard.press('m');
    assert.match(await page.getByRole('alert').textContent(), /M is the key of “Measure/);
    await page.getByRole('button', { name: 'Leave it' }).click();
    assert.equal(
      await key('wash')
        .textContent()
        .then((text) => text.trim()),
      'D',
    );
    await key('wash').click();
    await page.keyboard.press('5');
    assert.match(await page.getByRole('alert').textContent(), /fixed meaning/);
    await page.keyboard.press('x');
    assert.equal(
      await key('wash')
        .textContent()
        .then((text) => text.trim()),
      'X',
    );
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('Escape');
    assert.equal(await wash(page).getAttribute('title'), 'Wash of dose (X)');
    await page.reload();
    await full(page);
    assert.equal(await isWashOn(page), 'false');
    await page.keyboard.press('d');
    await page.keyboard.press('x');
    await page.waitForFunction(() => document.querySelector('.tools [aria-label="Wash"]').ariaPressed === 'true');
    await page.keyboard.press('?');
    await page.getByRole('button', { name: 'All back to standard' }).click();
    await page.getByLabel('Single keys', { exact: true }).uncheck();
    await page.keyboard.press('Escape');
    await page.keyboard.press('d');
    assert.equal(await isWashOn(page), 'true', 'single keys are off');
    assert.equal(await wash(page).getAttribute('title'), 'Wash of dose');
    await page.context().close();
  });

  later('splitters are dragged, moved by keys, put back and kept; panes get pictures of their new size', async () => {
    const page = await open();
    const width = (selector) => page.locator(selector).evaluate((element) => Math.round(element.getBoundingClientRect().width));
    const bar = (name) => page.getByRole('separator', { name });
    const drag = async (name, dx, dy = 0) => {
      const box = await bar(name).boundingBox();
      const [x, y] = [box.x + box.width / 2, box.y + box.height / 2 - (dx ? 60 : 0)]; // not where two cross
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + dx / 2, y + dy / 2);
      await page.mouse.move(x + dx, y + dy);
      await page.mouse.up();
    };
    await page.mouse.move(300, 300); // what is loaded before the first click
    await drag('Width of the tree', 60);
    assert.equal(await width('.room > .tree'), 332);
    await drag('Width of the tree', 400);
    assert.equal(await width('.room > .tree'), 420);
    await bar('Width of the inspector').focus();
    await page.keyboard.press('ArrowLeft');
    assert.equal(await width('.room > .inspector'), 336);
    await page.keyboard.press('Home');
    assert.equal(await width('.room > .inspector'), 280);
    assert.ok(await page.locator('.inspector [role="tablist"]').evaluate((tabs) => tabs.scrollWidth <= tabs.clientWidth), 'tabs are whole');
    await drag('Widths of the panes', -120);
    const narrow = await width('[data-view="1"]');
    assert.ok(narrow < (await width('[data-view="2"]')) - 200);
    await page.waitForFunction(() =>
      [1, 2, 3, 4].every((n) => {
        const box = document.querySelector(`#picture-${n}`).getBoundingClientRect();
        const { full_px: px } = globalThis.beamroom.stats().headers[n];
        return Math.abs(px[0] - box.width) <= 1 && Math.abs(px[1] - box.height) <= 1;
      }),
    );
    await full(page);
    await shoot(page, 'splitters');
    assert.deepEqual(await axe(page), []);
    await page.reload();
    await full(page);
    assert.deepEqual([await width('.room > .tree'), await width('.room > .inspector'), await width('[data-view="1"]')], [420, 280, narrow]);
    await page.mouse.move(500, 300);
    await bar('Width of the tree').dblclick();
    assert.equal(await width('.room > .tree'), 272);
    await bar('Widths of the panes').focus();
    await page.keyboard.press('Enter');
    assert.equal(await width('[data-view="1"]'), await width('[data-view="2"]'));
    await page.setViewportSize({ width: 820, height: 1180 });
    await page.waitForFunction(() => document.querySelector('.room').dataset.size === 'tablet');
    assert.equal(await page.getByRole('separator').count(), 0);
    await page.context().close();
  });

  later('the page is drawn larger, and what is pointed at stays under the pointer; it is kept', async () => {
    const page = await open({ viewport: { width: 2880, height: 1620 } });
    const axial = page.locator('#picture-2');
    const before = await axial.boundingBox();
    await page.keyboard.press('?');
    await page.getByRole('radio', { name: '200 %' }).click();
    await page.keyboard.press('Escape');
    await page.waitForFunction(
      () => document.querySelector('.room').dataset.size === 'wide' && document.documentElement.hasAttribute('data-scaled'),
    );
    const banner = await page.locator('.banner').boundingBox();
    assert.deepEqual([banner.width, banner.height], [2880, 104], 'twice 52, and as wide as the window');
    await page.waitForFunction(() => {
      const box = document.querySelector('#picture-2').getBoundingClientRect();
      return Math.abs(globalThis.beamroom.stats().headers[2].full_px[0] - box.width) <= 2;
    });
    await full(page, 2);
    const now = await axial.boundingBox();
    assert.ok(now.width < before.width, 'panels have taken their part');
    await axial.click({ position: { x: now.width * 0.6, y: now.height * 0.45 } });
    const room = new URL(page.url()).pathname.split('/').at(-1);
    const clicked = async () => {
      const { slices } = (await world.scene(room)).image;
      const point = [slices.sagittal, slices.coronal, slices.axial].map(({ position_mm: mm }) => mm);
      return toPicture((await header(page, 2)).clip_from_lps_mm, point);
    };
    const [x, y] = await until(clicked, ([across]) => Math.abs(across - 0.6) < 0.02);
    assert.ok(Math.abs(x - 0.6) < 0.02 && Math.abs(y - 0.45) < 0.02, `the crosshair is where the click was: ${x} ${y}`);
    await shoot(page, 'page-200');
    await page.reload();
    await full(page);
    assert.equal((await page.locator('.banner').boundingBox()).height, 104);
    await page.context().close();
  });

  later('light colours: the pictures stay dark, contrast is enough, and the system is followed', async () => {
    const page = await open({ colorScheme: 'light' });
    const ground = (selector) =>
      page
        .locator(selector)
        .first()
        .evaluate((element) => getComputedStyle(element).backgroundColor);
    const [tree, pane] = [await ground('.room > .tree'), await ground('.pane')];
    await page.keyboard.press('?');
    await page.getByRole('radio', { name: 'Light' }).click();
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('Escape');
    assert.notEqual(await ground('.room > .tree'), tree);
    assert.equal(await ground('.pane'), pane);
    await page.keyboard.press('d');
    await page.getByRole('treeitem', { name: /brain/i }).first().click();
    await full(page);
    await shoot(page, 'page-light');
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('v');
    await page.locator('.chart-plot').first().waitFor();
    await shoot(page, 'page-light-plots');
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('?');
    await page.getByRole('radio', { name: 'As the system' }).click();
    assert.equal(await page.evaluate(() => document.documentElement.dataset.colours), 'light');
    await page.goto(world.daemon.url);
    await page.getByText('Modified Snyder').first().waitFor();
    await shoot(page, 'page-light-start');
    assert.deepEqual(await axe(page), []);
    await page.emulateMedia({ colorScheme: 'dark' });
    await page.waitForFunction(() => document.documentElement.dataset.colours === 'dark');
    await page.context().close();
  });

  once('a tool has the whole picture: a measure begins on a pin; menus stand in their boxes and in the window', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    await page.keyboard.press('n');
    await page.locator('textarea').fill('Here.');
    await page.keyboard.press('Control+Enter');
    const pin = page.locator('#picture-2 .note-pin');
    await pin.waitFor();
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('m');
    const box = await pin.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + 60, box.y + 40, { steps: 3 });
    await page.mouse.up();
    const made = async () => Object.keys((await world.scene(room)).measures).length;
    assert.equal(await until(made, Boolean), 1);
    await page.keyboard.press('Escape');
    await page.getByRole('button', { name: 'Panes', exact: true }).click();
    const menu = page.locator('.view-panes');
    await menu.getByText('Clipped volume with wash').waitFor();
    assert.ok(await menu.evaluate((element) => element.scrollWidth <= element.clientWidth), 'the keys are in the box');
    await page.keyboard.press('Escape');
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForFunction(() => {
      const name = document.querySelector('[data-size="phone"] .plan-name h1 > span:first-child'); // plans are told apart by the ends of their names
      return (
        name?.textContent === 'Phantom: modified Snyder head' &&
        name.scrollHeight <= name.clientHeight &&
        name.scrollWidth <= name.clientWidth
      );
    });
    await page.getByRole('button', { name: 'Snapshot' }).click();
    await page.locator('.snapshots').waitFor();
    await page.waitForFunction(() => document.querySelector('.snapshots').getBoundingClientRect().left >= 0);
    await page.context().close();
  });

  once('a duplicated tab is a second member, and throws the first out only when asked to', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    const kept = await page.evaluate(() => Object.entries(sessionStorage));
    const twin = await page.context().newPage();
    await twin.addInitScript((entries) => {
      if (!sessionStorage.length) for (const [key, value] of entries) sessionStorage.setItem(key, value);
    }, kept); // as the browser copies it
    await twin.goto(page.url());
    await full(twin);
    await twin.waitForFunction(() => document.querySelectorAll('.members .member').length === 1);
    assert.equal(await page.locator('.card.ended').count(), 0, 'the first is still in');
    await twin.getByRole('button', { name: 'Go on here instead' }).click();
    await page.locator('.card.ended').waitFor();
    await full(twin);
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
