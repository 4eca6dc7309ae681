// Undo and redo in the browser: a drag, a slider and a wheel are one step each; what another program changed stays.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { full, header, missing, shoot, startWorld } from './browser.mjs';

describe('undo and redo', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let page;

  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    page = await world.newPage(`rooms/${room}`);
    for (const view of [1, 2, 3, 4]) await full(page, view);
  });
  after(async () => {
    await world?.stop();
  });

  const button = (verb) => page.locator(`[data-act="${verb}"]`);
  const matrixOf = async (view) => Object.values((await header(page, view)).clip_from_lps_mm);
  const isNear = (a, b) => a.every((value, at) => Math.abs(value - b[at]) < 1e-4 * Math.max(1, Math.abs(b[at])));
  const middle = async (view) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  const drag = async (view, dx, dy) => {
    const [x, y] = await middle(view);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + dx, y + dy, { steps: 6 });
    await page.mouse.up();
  };
  const axial = async () => (await world.scene(room)).image.slices.axial.position_mm;

  it('has nothing to undo at first', async () => {
    assert.equal(await button('undo').isDisabled(), true);
    assert.equal(await button('redo').isDisabled(), true);
  });

  it('takes a whole drag of the camera back and does it again', async () => {
    const before = await matrixOf(1);
    await drag(1, 90, 20);
    const turned = await until(
      () => matrixOf(1),
      (m) => !isNear(m, before),
      60000,
    );
    assert.ok(!isNear(turned, before));
    await full(page, 1);
    const last = await matrixOf(1);
    assert.equal(await button('undo').getAttribute('title'), 'Undo: camera of 3-D (Ctrl+Z)');
    await page.keyboard.press('Control+z');
    assert.ok(
      isNear(
        await until(
          () => matrixOf(1),
          (m) => isNear(m, before),
          60000,
        ),
        before,
      ),
      'as before the drag',
    );
    await page.keyboard.press('Control+Shift+Z');
    assert.ok(
      isNear(
        await until(
          () => matrixOf(1),
          (m) => isNear(m, last),
          60000,
        ),
        last,
      ),
      'as after it',
    );
    await page.keyboard.press('Control+z');
    await until(
      () => matrixOf(1),
      (m) => isNear(m, before),
      60000,
    );
    await full(page, 1);
    assert.equal(await button('undo').isDisabled(), true);
  });

  it('takes slices turned by the wheel back in one step', async () => {
    const from = await axial();
    await page.evaluate(
      ([clientX, clientY]) => {
        // in the page itself: on a busy machine three of the browser's may come further apart than one step lasts
        for (let step = 0; step < 3; step++)
          document
            .elementFromPoint(clientX, clientY)
            .dispatchEvent(new WheelEvent('wheel', { deltaY: 100, clientX, clientY, bubbles: true, cancelable: true }));
      },
      await middle(2),
    );
    await until(axial, (mm) => mm !== from, 60000);
    await page.waitForTimeout(500);
    await page.keyboard.press('Control+z');
    assert.equal(await until(axial, (mm) => mm === from, 60000), from);
    await page.keyboard.press('Control+y');
    await until(axial, (mm) => mm !== from, 60000);
    await page.keyboard.press('Control+z');
    await until(axial, (mm) => mm === from, 60000);
  });

  it('keeps its steps over a reload', async () => {
    const before = (await world.scene(room)).regions.scalp?.visible ?? true;
    await page.locator('[data-key="region:scalp"] .eye').click();
    await until(
      async () => (await world.scene(room)).regions.scalp.visible,
      (is) => is !== before,
    );
    await page.reload();
    await full(page);
    await page.waitForFunction(() => document.querySelector('[data-act="undo"]')?.disabled === false);
    await page.keyboard.press('Control+z');
    await until(
      async () => (await world.scene(room)).regions.scalp.visible,
      (is) => is === before,
    );
  });

  it('names a change in the tool strip, and leaves what another program has changed since', async () => {
    const isVisible = async () => (await world.scene(room)).regions.scalp.visible;
    const becomes = async (wanted) => assert.equal(await until(isVisible, (now) => now === wanted, 60000), wanted);
    await page.locator('[data-region="scalp"] .eye').click();
    await becomes(false);
    assert.equal(await button('undo').getAttribute('title'), 'Undo: visibility of scalp (Ctrl+Z)');
    await shoot(page, 'undo');
    await button('undo').click();
    await becomes(true);
    assert.equal(await button('redo').getAttribute('title'), 'Redo: visibility of scalp (Ctrl+Shift+Z)');
    await button('redo').click();
    await becomes(false);
    const colour = async (regions) => call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { regions }, { 'If-Match': '*' });
    await colour({ scalp: { visible: true } });
    await page.waitForFunction(() => document.querySelector('[data-region="scalp"] .eye').getAttribute('aria-pressed') === 'true');
    await colour({ scalp: { opacity: 0.25 } });
    await button('undo').click(); // nothing to take back: it is as before
    assert.equal(await button('undo').isDisabled(), true);
    const opacity = page.locator('input[aria-label="Opacity of scalp"]');
    await opacity.focus();
    await page.keyboard.press('ArrowRight');
    await until(
      () => world.scene(room),
      (scene) => scene.regions.scalp.opacity > 0.25,
      60000,
    );
    await colour({ scalp: { opacity: 0.75 } });
    await page.waitForFunction(() => document.querySelector('input[aria-label="Opacity of scalp"]').value === '75');
    await page.keyboard.press('Control+z'); // the slider has the focus
    await page.waitForFunction(() =>
      /Not undone: it was changed by somebody else since/.test(document.querySelector('.toasts').textContent),
    );
    assert.equal((await world.scene(room)).regions.scalp.opacity, 0.75);
    assert.deepEqual(world.errors, []);
  });
});
