// Regions in the tree, in the picture's legend and in dialogs: what the page says about what is and is not drawn.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call } from '../api/daemon.mjs';
import { writeFoamPlan } from '../api/foam_plan.mjs';
import { Client } from '../api/ws_client.mjs';
import { overPictures } from './anatomy.mjs';
import { full, header, later, missing, newer, once, shoot, startWorld } from './browser.mjs';
import { writeLabels } from './labels.mjs';

describe('regions on the page', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-regions-'));
    mkdirSync(join(folder, 'balls'));
    writeLabels(join(folder, 'balls'), 'Balls', ['ball', 'pair']);
    writeFoamPlan(folder);
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const choose = async (page, label, name) => {
    const { scene_revision: revision } = await header(page, 1);
    await page.locator(`[aria-label="${label}"] >> text="${name}"`).click();
    await newer(page, 1, revision);
  };

  once('a region that degree bins cannot show is named in the picture and in the tree, with the reason, and is no file', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom('balls')}`);
    await full(page);
    await page.locator('[data-region="pair"] button.name').click();
    await choose(page, 'Shown as', 'NURBS');
    await page.locator('button', { hasText: 'All regions like this' }).click();
    await page.locator('[aria-label="Download the surface"]').waitFor();
    assert.equal(await page.locator('.left-out').count(), 0, 'traces can show both');
    await choose(page, 'Control points', 'Degree bins');
    const legend = page.locator('.left-out');
    await legend.waitFor();
    assert.match(await legend.textContent(), /Not shown as NURBS: pair/);
    assert.equal(await legend.locator('p').count(), 1, 'slices show its outline all the same');
    assert.deepEqual(await overPictures(page), []);
    assert.match(await page.locator('[data-region="pair"] .refused').getAttribute('aria-label'), /2 pieces/);
    assert.equal(await page.locator('[data-region="ball"] .refused').count(), 0);
    await shoot(page, 'regions-refused');
    await page.locator('[data-region="ball"] button.name').click();
    await legend.locator('button').click(); // why: the figures of the one that is missing
    await page.locator('.figures.err', { hasText: '2 pieces' }).waitFor();
    assert.equal(await page.locator('[aria-label="Download the surface"]').count(), 0, 'what cannot be built is no file');
    await page.locator('[data-region="pair"] .eye').click(); // hidden: nothing is missing
    await legend.waitFor({ state: 'detached' });
    await page.context().close();
  });

  const patch = (room, body) => call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', body, { 'If-Match': '*' });

  later(
    'a region beyond the limit of triangles is named in the picture and in the tree, with the reason, until it is shown in another way',
    async () => {
      const room = await world.newRoom('foam');
      await patch(room, { regions: { foam: { visible: false } } });
      const page = await world.newPage(`rooms/${room}`);
      await full(page);
      assert.equal(await page.locator('.left-out').count(), 0);
      await patch(room, { regions: { foam: { visible: true, representation: 'univels' }, block: { representation: 'univels' } } });
      const legend = page.locator('.left-out');
      await legend.waitFor();
      assert.match(await legend.textContent(), /Not drawn: foam/);
      assert.match(await legend.locator('button').getAttribute('title'), /foam.*40000000/);
      assert.match(await page.locator('[data-region="foam"] .refused').getAttribute('aria-label'), /40000000/);
      assert.equal(await page.locator('[data-region="block"] .refused').count(), 0);
      await full(page); // the picture of the others is whole, and at rest
      await shoot(page, 'regions-beyond-limit');
      await patch(room, { regions: { foam: { visible: false } } });
      await legend.waitFor({ state: 'detached' });
      await page.context().close();
    },
  );

  once('a view that cannot be drawn says so in its place, also to who comes later, until it can be', async () => {
    const room = await world.newRoom('balls');
    const other = await Client.open(world.daemon.url, `/api/v1/rooms/${room}/ws`); // the first one presents
    const look = (position_mm) =>
      other.send({ type: 'view.patch', view: 1, patch: { camera: { position_mm, target_mm: [0, 0, 0], up: [0, 0, 1] } } });
    other.send({ type: 'hello', protocol: 2 });
    other.send({ type: 'view.open', view: 1, document: { size_px: [64, 64] }, follow: true });
    await other.message('members');
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    look([0, 0, 0]);
    const words = (of) => of.locator('[data-view="1"] .cover .refusal', { hasText: 'cannot be drawn' });
    await words(page).waitFor();
    await words(page).waitFor();
    assert.match(await words(page).textContent(), /position and target are the same point/);
    const late = await world.newPage(`rooms/${room}`);
    await words(late).waitFor();
    await shoot(page, 'view-cannot-be-drawn');
    look([0, -500, 0]);
    await words(page).waitFor({ state: 'detached' });
    await words(late).waitFor({ state: 'detached' });
    other.cut();
    await page.context().close();
    await late.context().close();
  });

  once("the tree shows every region's volume; the slider takes its place under the pointer and the focus", async () => {
    const page = await world.newPage(`rooms/${await world.newRoom('balls')}`);
    await full(page);
    const volume = page.locator('[data-region="ball"] .volume');
    // 4/3 pi 8^3 mm3 = 2.14 cm3, less or more by how a ball of 8 univels is cut into boxes: 2 %
    assert.ok(Math.abs(parseFloat(await volume.textContent()) - 2.145) < 0.045, await volume.textContent());
    assert.match(await volume.textContent(), / cm³$/);
    assert.ok(await volume.isVisible());
    const slider = page.locator('[data-region="ball"] input.mini');
    assert.equal(await slider.evaluate((input) => getComputedStyle(input).opacity), '0');
    await slider.focus();
    assert.equal(await slider.evaluate((input) => getComputedStyle(input).opacity), '1');
    assert.equal(await volume.isVisible(), false);
    await page.keyboard.press('ArrowLeft');
    await page.waitForFunction(() => document.querySelector('[data-region="ball"] .percent input').value === '99');
    await page.context().close();
  });

  later('the colours of the check have a legend above the panes while a slice is shown', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom('balls')}`);
    await full(page);
    await page.locator('[data-region="ball"] button.name').click();
    const legends = page.getByRole('list', { name: 'Colours of the check' });
    assert.equal(await legends.count(), 0);
    await page.locator('label', { hasText: 'Mark where surface and univels differ' }).click();
    await legends.waitFor();
    assert.deepEqual(await overPictures(page), []);
    await page.locator('[aria-label="Maximise 3-D"]').click();
    await legends.waitFor({ state: 'detached' });
    await page.context().close();
  });

  once('a dialog takes the focus and gives it back', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom('balls')}`);
    await full(page);
    await page.locator('[data-region="ball"] button.name').click();
    const opener = page.locator('button', { hasText: 'Compare methods' });
    await opener.focus();
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => document.activeElement?.getAttribute('role') === 'dialog');
    await page.keyboard.press('Escape');
    await page.waitForFunction(() => document.activeElement?.textContent.trim() === 'Compare methods');
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
