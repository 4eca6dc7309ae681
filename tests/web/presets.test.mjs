// Presets of beam, dose and volume on the page: one click each, one step of undo; what the plan lacks is said. The tool that moves a beam is on after one click.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { full, missing, shoot, startWorld } from './browser.mjs';

describe('presets', { skip: missing && `${missing} is not there` }, () => {
  let world, room, page;
  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    page = await world.newPage(`rooms/${room}`);
    await full(page, 1);
  });
  after(async () => {
    await world?.stop();
  });

  const comes = async (pick, expected) =>
    assert.deepEqual(
      await until(
        async () => pick(await world.scene(room)),
        (value) => JSON.stringify(value) === JSON.stringify(expected),
        30000,
      ),
      expected,
    );
  const told = (words) => page.locator('.toast', { hasText: words }).waitFor();

  it("the menu of the panes shows the beam's eye with its ring in one click, and one step of undo takes the scene back", async () => {
    const before = await world.scene(room);
    await page.getByRole('button', { name: 'Panes', exact: true }).click();
    await page.locator('.beam-presets button', { hasText: "Beam's eye with aperture" }).click();
    await told("Beam's eye with aperture: ring of 100 mm");
    await full(page, 7);
    assert.equal(await page.evaluate(() => globalThis.beamroom.stats().documents[7].beam.aperture_mm), 100);
    await comes(({ regions }) => regions.tumour.opacity, 1);
    await comes(({ regions }) => regions.scalp.opacity, 0.25);
    await shoot(page, 'presets');
    await page.keyboard.press('Control+z');
    await comes((now) => now, before);
  });

  it('the tree has them, too, and they are found by keys', async () => {
    await page.locator('[data-key="preset:all"]').click();
    await page.locator('[role=tree]').focus();
    for (let step = 0; step < 3; step++) await page.keyboard.press('ArrowDown');
    await page.keyboard.press('Enter');
    await told('Clipped volume with wash');
    await comes(({ image, dose }) => [image.volume.visible, dose.wash.volume], [true, true]);
    await page.keyboard.press('Control+z');
    await comes(({ image }) => image.volume.visible, false);
  });

  it('the tool that moves a beam is on after one click, and a drag in a pane makes a draft', async () => {
    await page.getByRole('button', { name: 'Move beam' }).click();
    await page.locator('[data-view="2"] .beam-handle').first().waitFor();
    await full(page, 2);
    const { x, y, width, height } = await page.locator('#picture-2').boundingBox();
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + width / 2 + 40, y + height / 2, { steps: 4 });
    await page.mouse.up();
    await comes(({ beam }) => beam.draft.enabled, true);
    assert.deepEqual(world.errors, []);
  });
});
