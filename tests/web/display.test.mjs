// The page of a display: the presenter's picture on the screen of a meeting room.
import { after, before, describe, it } from 'node:test';
import assert from 'node:assert/strict';
import { call, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, missing, startWorld } from './browser.mjs';

/** Size and pixels of a canvas, as one text. */
const pixels = (page, selector) =>
  page.evaluate((of) => {
    const canvas = document.querySelector(of);
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let hash = 2166136261;
    for (const byte of data) hash = Math.imul(hash ^ byte, 16777619);
    return `${canvas.width} x ${canvas.height}: ${hash}`;
  }, selector);
const letters = (page) =>
  page.evaluate(() => ['left', 'right', 'top', 'bottom'].map((edge) => document.querySelector(`.letter.${edge}`).textContent));
const says = (page, words) => page.waitForFunction((start) => document.querySelector('.age').textContent.startsWith(start), words);
const stateOf = (page) => page.locator('.age').getAttribute('data-state');

describe('the page of a display', { skip: missing && `${missing} is missing` }, () => {
  let world, room, presenter, display;
  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    presenter = await world.newPage(`rooms/${room}`, { viewport: { width: 1440, height: 900 } });
    await full(presenter);
    display = await world.newPage(`display/${room}`, { viewport: { width: 1100, height: 700 } });
    await says(display, 'Live');
  });
  after(async () => {
    if (world) world.daemon.child.kill('SIGCONT');
    await world?.stop();
  });
  const shared = () => pixels(presenter, '[data-view="1"] canvas');
  const same = () =>
    until(
      async () => [await pixels(display, 'canvas'), await shared()],
      ([shown, sent]) => shown === sent,
    );

  it('shows what the presenter sees, with the letters of that picture, and follows', async () => {
    await same();
    const before = await letters(display);
    assert.deepEqual(before, ['RA', 'LP', 'S', 'I'], 'three quarters from the left: anterior and right are on the left');
    const old = await shared();
    await presenter.getByRole('button', { name: 'Look from anterior' }).first().click();
    await until(shared, (now) => now !== old);
    await until(
      () => letters(display),
      (now) => now.join() === 'R,L,S,I',
    );
    await full(presenter);
    await same();
  });

  it('lies whole on the screen, with no words over it but the letters', async () => {
    for (const [width, height] of [
      [1100, 700],
      [1920, 1080],
      [700, 900],
    ]) {
      await display.setViewportSize({ width, height });
      const box = await until(
        () =>
          display.evaluate(() => {
            const { left, top, right, bottom } = document.querySelector('canvas').getBoundingClientRect();
            return {
              left,
              top,
              right,
              bottom,
              head: document.querySelector('header').getBoundingClientRect().bottom,
              foot: document.querySelector('footer').getBoundingClientRect().top,
              ratio: (right - left) / (bottom - top),
              own: document.querySelector('canvas').width / document.querySelector('canvas').height,
            };
          }),
        ({ left, right, top, bottom, head, foot }) =>
          right <= width && bottom <= foot && foot < height && (right - left > width - 3 || bottom - top > foot - head - 3),
      ); // as large as it can be
      assert.ok(box.left >= 0 && box.top >= box.head, JSON.stringify(box));
      assert.ok(Math.abs(box.ratio / box.own - 1) < 0.01, `not stretched: ${JSON.stringify(box)}`);
    }
    assert.match(
      await display.locator('footer').textContent(),
      /crosshair, pointers, notes, measures and the legend of the dose are not in it/,
    );
    assert.match(await display.locator('h1').textContent(), new RegExp(`Snyder head · Room ${room} · 3-D`));
    assert.deepEqual(await axe(display), []);
  });

  it('says of a draft that it is one, in the picture itself', async () => {
    const amber = () =>
      display.evaluate(() => {
        const canvas = document.querySelector('canvas');
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width / 2, canvas.height / 8);
        let n = 0;
        for (let at = 0; at < data.length; at += 4) n += data[at] > 200 && data[at + 1] > 130 && data[at + 1] < 220 && data[at + 2] < 130;
        return n;
      });
    const draft = (enabled) =>
      call(
        `${world.daemon.url}/api/v1/rooms/${room}/scene`,
        'PATCH',
        { beam: { draft: { enabled, line: { entry_mm: [0, -120, 0], target_mm: [0, 0, 0] } } } },
        { 'If-Match': '*' },
      );
    assert.equal(await amber(), 0);
    await draft(true);
    await until(amber, (n) => n > 50);
    await display.screenshot({ path: 'build/test-artifacts/display-draft.png' });
    await draft(false);
    await until(amber, (n) => n === 0);
  });

  it('goes with the pane that a wheel turns, though another one is active', async () => {
    const box = await presenter.locator('#picture-2').boundingBox();
    await presenter.mouse.move(box.x + box.width / 2, box.y + box.height / 3);
    await presenter.mouse.wheel(0, 100);
    await until(
      () => display.locator('h1').textContent(),
      (text) => text.endsWith('· Axial'),
    );
    assert.match(await presenter.locator('.pane.active').getAttribute('data-view'), /^1$/);
    await presenter.locator('#picture-1').focus();
    await presenter.keyboard.press('ArrowLeft');
    await until(
      () => display.locator('h1').textContent(),
      (text) => text.endsWith('· 3-D'),
    );
    await full(presenter);
  });

  it('goes with the view that the presenter works in, unless its address names one', async () => {
    const named = await world.newPage(`display/${room}?view=3d`, { viewport: { width: 900, height: 600 } });
    await says(named, 'Live');
    await presenter.locator('#picture-2').focus();
    await presenter.keyboard.press('ArrowUp'); // the next slice
    await until(
      () => display.locator('h1').textContent(),
      (text) => text.endsWith('· Axial'),
    );
    await full(presenter, 2);
    await until(
      async () => [await pixels(display, 'canvas'), await pixels(presenter, '[data-view="2"] canvas')],
      ([shown, sent]) => shown === sent,
    );
    assert.deepEqual(await letters(display), ['R', 'L', 'A', 'P']);
    assert.match(await named.locator('h1').textContent(), / · 3-D$/);
    await presenter.locator('[aria-label="Maximise Coronal"]').click(); // the others are closed
    await until(
      () => display.locator('h1').textContent(),
      (text) => text.endsWith('· Coronal'),
    );
    await presenter.locator('[aria-label="Restore Coronal"]').click();
    await presenter.locator('#picture-1').focus();
    await presenter.keyboard.press('ArrowLeft');
    await until(
      () => display.locator('h1').textContent(),
      (text) => text.endsWith('· 3-D'),
    );
    await full(presenter);
    await same();
    await named.close();
  });

  it('says when the connection is lost, and goes on when it is back', async () => {
    world.daemon.child.kill('SIGSTOP');
    await says(display, 'Connection lost');
    assert.equal(await stateOf(display), 'lost');
    assert.match(await display.locator('.notice').textContent(), /^Connection lost\. The picture is of \d\d:\d\d:\d\d\.$/);
    assert.deepEqual(await axe(display), []);
    world.daemon.child.kill('SIGCONT');
    await says(display, 'Live');
    await until(
      () => display.locator('.notice').textContent(),
      (text) => text === '',
    );
    await same();
  });

  it('names what it cannot show', async () => {
    const nowhere = await world.newPage('display/aaaa-aaaa');
    await until(
      () => nowhere.locator('.notice').textContent(),
      (text) => /no room "aaaa-aaaa"/.test(text),
    );
    assert.equal(await nowhere.locator('figure').isVisible(), false);
    assert.deepEqual(world.errors, []);
  });
});
