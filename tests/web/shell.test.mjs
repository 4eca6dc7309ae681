// What stands around the panes: keys from anywhere and the list in which they are changed.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { axe } from './axe.mjs';
import { full, missing, shoot, startWorld } from './browser.mjs';

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

  it('keys act on the pane that was active last from the tree, a tool and the page, but not from text and lists of choice', async () => {
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

  it('a key is changed in the list, which can be searched; tooltips follow, a reload keeps it', async () => {
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

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
