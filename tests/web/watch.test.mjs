// The small picture of the presenter beside the views of a member who looks for themselves.
import { after, before, describe, it } from 'node:test';
import assert from 'node:assert/strict';
import { call, renderersOf, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, later, missing, shoot, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';
import { action, chip, enter, matrix, openRoster, row, says, turn } from './people.mjs';

const card = (page) => page.locator('.watch');
const reads = (page, words) =>
  until(
    () => page.locator('.watch-head p').textContent(),
    (text) => words.test(text),
  );
const button = (page, name) => card(page).getByRole('button', { name });
const lettersOf = (page, selector) => page.locator(`${selector} [data-letters]`).first().getAttribute('data-letters');
const width = (page) => page.evaluate(() => document.querySelector('.watch canvas')?.width ?? 0);
const mean = (page, selector) =>
  page.evaluate((of) => {
    const canvas = document.querySelector(of),
      small = new OffscreenCanvas(16, 12),
      context = small.getContext('2d');
    context.drawImage(canvas, 0, 0, 16, 12);
    return [...context.getImageData(0, 0, 16, 12).data];
  }, selector);
/** Largest difference of the pictures of two pages, each reduced to 16 x 12. */
const difference = async (page, selector, other, its) => {
  const [a, b] = await Promise.all([mean(page, selector), mean(other, its)]);
  return Math.max(...a.map((value, index) => Math.abs(value - b[index])));
};
const same = (page, presenter, view) =>
  until(
    () => difference(page, '.watch canvas', presenter, `[data-view="${view}"] canvas`),
    (most) => most < 24,
  );

describe('the small picture of the presenter', { skip: missing && `${missing} is missing` }, () => {
  let world, room, ann, ben;
  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    ann = await enter(world, `rooms/${room}`, 'Ann', { viewport: { width: 1440, height: 900 } });
    await full(ann);
    ben = await enter(world, `rooms/${room}`, 'Ben', { viewport: { width: 1440, height: 900 } });
    await full(ben);
  });
  after(async () => {
    if (world) world.daemon.child.kill('SIGCONT');
    await world?.stop();
  });

  it('comes when a member looks for themselves, with name, letters and the word live, and moves no view of theirs', async () => {
    assert.equal(await card(ben).count(), 0, 'who follows sees the presenter anyway');
    await ben.locator('#picture-1').focus();
    await ben.keyboard.press('f');
    await says(ben, /^On my own/);
    await reads(ben, /^Live · Ann · 3-D$/);
    assert.equal(await lettersOf(ben, '.watch'), await lettersOf(ann, '[data-view="1"]'));
    await same(ben, ann, 1);
    await full(ben);
    const own = await matrix(ben, 1);
    await turn(ann);
    const letters = await lettersOf(ann, '[data-view="1"]');
    await until(
      () => lettersOf(ben, '.watch'),
      (now) => now === letters,
    );
    await same(ben, ann, 1);
    const unsigned = (text) => text.replaceAll('-0.0000', '0.0000');
    assert.equal(unsigned(await matrix(ben, 1)), unsigned(own));
    assert.equal(await card(ann).count(), 0, 'the presenter has none');
  });

  it('goes with the pane that the presenter works in', async () => {
    await ann.locator('#picture-2').focus();
    await reads(ben, /^Live · Ann · Axial$/);
    await until(
      () => lettersOf(ben, '.watch'),
      (now) => now === 'R L A P',
    );
    await same(ben, ann, 2);
    await ann.locator('#picture-1').focus();
    await reads(ben, /^Live · Ann · 3-D$/);
    await same(ben, ann, 1);
    const draft = (enabled) =>
      call(
        `${world.daemon.url}/api/v1/rooms/${room}/scene`,
        'PATCH',
        { beam: { draft: { enabled, line: { entry_mm: [0, -120, 0], target_mm: [0, 0, 0] } } } },
        { 'If-Match': '*' },
      );
    await draft(true);
    await card(ben).getByText('Draft beam', { exact: true }).waitFor();
    await shoot(ben, 'watch-draft');
    await draft(false);
    await until(
      () => card(ben).getByText('Draft beam', { exact: true }).count(),
      (n) => n === 0,
    );
  });

  later('stands in any corner of the panes, over no letter and no words, at every size of window', async () => {
    await until(
      () => ben.locator('.toast').count(),
      (n) => n === 0,
    );
    for (const [wide, high] of [
      [1440, 900],
      [1100, 700],
      [390, 844],
    ]) {
      await ben.setViewportSize({ width: wide, height: high });
      for (let turns = 0; turns < 4; turns++) {
        if (turns || wide !== 1440) await button(ben, /next corner/).click();
        const [at, panes] = await until(
          () => Promise.all([card(ben).boundingBox(), ben.locator('.panes').boundingBox()]),
          ([box, all]) =>
            box && box.x >= all.x && box.y >= all.y && box.x + box.width <= all.x + all.width && box.y + box.height <= all.y + all.height,
        );
        assert.ok(at.width >= 140 && at.width <= 262, `${at.width} px wide`);
        assert.deepEqual(await overlaps(ben), [], `${await card(ben).getAttribute('data-corner')} at ${wide} x ${high}`);
        const hidden = await ben.evaluate(() => {
          const over = document.querySelector('.watch').getBoundingClientRect();
          return [...document.querySelectorAll('.pane:not([hidden]) .letter, .pane:not([hidden]) .scale')]
            .filter((letter) => {
              const box = letter.getBoundingClientRect();
              return box.width && box.left < over.right && over.left < box.right && box.top < over.bottom && over.top < box.bottom;
            })
            .map(({ textContent }) => textContent);
        });
        assert.deepEqual(hidden, [], `letters of the panes under it, ${JSON.stringify({ at, panes })}`);
      }
      await reads(ben, /^Live/);
      await shoot(ben, `watch-${wide}`);
      if (wide === 1440) assert.deepEqual(await axe(ben), []);
    }
    await ben.setViewportSize({ width: 1440, height: 900 });
  });

  it('is folded, closed and shown again by the keyboard', async () => {
    await button(ben, /^Fold/).focus();
    await ben.keyboard.press('Enter');
    await reads(ben, /^Ann presents$/);
    assert.equal(await ben.locator('.watch canvas').count(), 0);
    await button(ben, /^Unfold/).focus();
    await ben.keyboard.press('Enter');
    await reads(ben, /^Live · Ann/);
    await until(
      () => width(ben),
      (px) => px > 16,
    );
    await button(ben, /^Close/).focus();
    await ben.keyboard.press('Enter');
    await until(
      () => card(ben).count(),
      (n) => n === 0,
    );
    await openRoster(ben);
    await action(ben, 'Show presenter').click();
    await reads(ben, /^Live · Ann/);
  });

  later('says when it is old: the renderer has crashed, the server does not answer', async () => {
    process.kill(renderersOf(world.daemon.child.pid)[0], 'SIGKILL');
    await reads(ben, /^Old, of \d\d:\d\d:\d\d · Ann/);
    await reads(ben, /^Live · Ann/);
    world.daemon.child.kill('SIGSTOP');
    await reads(ben, /^Old, of/);
    await until(
      () => card(ben).getAttribute('data-state'),
      (state) => state === 'lost',
    );
    world.daemon.child.kill('SIGCONT');
    await reads(ben, /^Live · Ann/); // also after the connection was lost and made anew
    await turn(ann);
    await same(ben, ann, 1);
  });

  later('belongs to each tab, goes with control, and ends with following', async () => {
    const tab = await ben.context().newPage();
    await tab.goto(`${world.daemon.url}/rooms/${room}`);
    await says(tab, /^Following Ann/);
    await tab.locator('#picture-1').focus();
    await tab.keyboard.press('f');
    await reads(tab, /^Live · Ann/);
    await button(tab, /^Return to Ann/).click();
    await says(tab, /^Following Ann/);
    assert.equal(await card(tab).count(), 0);
    await reads(ben, /^Live · Ann/);
    await tab.close();

    const cem = await enter(world, `rooms/${room}`, 'Cem', { viewport: { width: 1100, height: 700 } });
    await full(cem);
    await openRoster(ann);
    await row(ann, 'Cem').getByRole('button', { name: 'Give control to Cem' }).click();
    await says(cem, /^Presenting/);
    await reads(ben, /^Live · Cem/);
    await cem.close();
    await reads(ben, /^Away · Cem/);
    await button(ben, /^Return to Cem/).click();
    await until(
      () => card(ben).count(),
      (n) => n === 0,
    );
    assert.doesNotMatch(await chip(ben).textContent(), /On my own/);
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
