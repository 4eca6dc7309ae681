// The room page as screen readers get it: axe-core finds nothing, in any state and at any size; the keyboard; forced colours.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { axe } from './axe.mjs';
import { full, isDue, missing, once, startWorld } from './browser.mjs';
import { cutSegments } from './overlap.mjs';
import { codesOn } from './plain_words.mjs';
import { sizes, states } from './room_states.mjs';

describe('the room page for screen readers and keyboards', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
  });

  // All sizes in the long suite; the quick one has the panels of dose at the smallest (dose.test.mjs).
  for (const [size, options] of Object.entries(sizes).filter(() => isDue(false)))
    it(`${size}: axe-core finds nothing in any state, and no word is one of programs`, async () => {
      const page = await world.newPage(`rooms/${await world.newRoom()}`, options);
      await full(page);
      for (const [name, act] of states[size]) {
        await act(page);
        assert.deepEqual(await axe(page), [], name);
        assert.deepEqual(await codesOn(page), [], name);
        assert.deepEqual(await cutSegments(page), [], name);
      }
      await page.context().close();
    });

  /** Elements that Tab reaches, from the head of the page to its end. */
  const tabStops = async (page) => {
    const stops = [];
    await page.evaluate(() => document.activeElement?.blur());
    for (let n = 0; n < 200; n++) {
      await page.keyboard.press('Tab');
      const stop = await page.evaluate(() => {
        const { activeElement: element } = document;
        if (!element || element === document.body || element.dataset.stop) return null;
        element.dataset.stop = 'seen';
        return element.getAttribute('aria-label') ?? element.textContent.trim().slice(0, 30);
      });
      if (stop === null) break;
      stops.push(stop);
    }
    return stops;
  };

  once('the tree is one tab stop, and so is the strip', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`, sizes.wide);
    await full(page);
    const stops = await tabStops(page);
    assert.ok(stops.length > 10 && stops.length < 40, `${stops.length}: ${stops.join(' | ')}`);
    assert.equal(stops.filter((stop) => stop === 'Parts of the plan').length, 1);
    assert.ok(!stops.some((stop) => /Opacity of|Show |Window$/.test(stop)), stops.join(' | '));
    await page.context().close();
  });

  once('every function of a row is reached by keys', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`, sizes.wide);
    await page.evaluate(() => localStorage.setItem('beamroom keys', JSON.stringify({ areSinglesOff: true }))); // then letters find rows
    await page.reload();
    await full(page);
    const tree = page.locator('[role="tree"]');
    const current = () => page.evaluate(() => document.activeElement.getAttribute('aria-activedescendant'));
    await page.locator('[data-key^="tracks:"]').first().waitFor(); // its rows come later
    await tree.focus();
    assert.equal(await current(), 'row-section:images');
    await page.keyboard.press('End');
    assert.equal(await current(), 'row-bookmark:'); // where a view is saved
    for (const above of ['row-section:saved', 'row-section:clip']) {
      await page.keyboard.press('ArrowUp');
      assert.equal(await current(), above);
    }
    await page.keyboard.press('ArrowUp');
    assert.match(await current(), /^row-tracks:/);
    await page.keyboard.press('ArrowLeft');
    assert.equal(await current(), 'row-section:tracks');
    await page.keyboard.press('ArrowLeft');
    assert.equal(await page.locator('[data-key="section:tracks"]').getAttribute('aria-expanded'), 'false');
    await page.keyboard.press('Home');
    await page.evaluate(() => {
      // at once: letters that come a while apart are searched for one by one
      for (const key of 'scal')
        document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true }));
    });
    assert.equal(await current(), 'row-region:scalp');
    const style = async () => (await world.scene(room)).regions.scalp;
    const until = async (test) => {
      while (!test(await style())) await page.waitForTimeout(30);
    };
    await page.keyboard.press('Space');
    await until(({ visible }) => !visible);
    await page.keyboard.press('Space');
    await until(({ visible }) => visible);
    const { opacity } = await style();
    await page.keyboard.press('Shift+ArrowLeft');
    await until((now) => Math.abs(now.opacity - (opacity - 0.05)) < 0.001);
    await page.keyboard.press('Enter');
    assert.match(await page.locator('#tab-panel h3').first().textContent(), /scalp/);
    for (const label of ['Colour', 'Opacity', 'Order, higher lies on top'])
      assert.equal(await page.locator(`#tab-panel [aria-label="${label}"]`).count(), 1, label);
    await page.context().close();
  });

  once('with forced colours what is pressed, chosen or active differs by its border', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`, {
      ...sizes.wide,
      forcedColors: 'active',
      reducedMotion: 'reduce',
    });
    await full(page);
    await page.locator('[data-region="tumour"] button.name').click();
    const border = (selector, pseudo) =>
      page
        .locator(selector)
        .first()
        .evaluate((element, of) => {
          const { borderBottomWidth, borderLeftWidth, borderBottomColor } = getComputedStyle(element, of);
          return [borderBottomWidth, borderLeftWidth, borderBottomColor].join(' ');
        }, pseudo);
    for (const [on, off] of [
      ['[aria-label="Crosshair"]', '[aria-label="Zoom"]'],
      ['[aria-label="Four panes"]', '[aria-label="One pane"]'],
      ['[role="tab"][aria-selected="true"]', '[role="tab"][aria-selected="false"]'],
      ['[role="radio"][aria-checked="true"]', '[role="radio"][aria-checked="false"]'],
      ['.row.selected', '.row:not(.selected)'],
    ])
      assert.notEqual(await border(on), await border(off), on);
    assert.equal((await border('.pane.active', '::after')).split(' ')[0], '3px');
    assert.equal(await page.locator('[aria-label="Zoom"]').evaluate((button) => getComputedStyle(button).transitionDuration), '0s');
    await page.setViewportSize(sizes.compact.viewport);
    await page.locator('[data-section="doses"]').click();
    const looks = (selector) =>
      page
        .locator(selector)
        .first()
        .evaluate((element) => {
          const { borderBottomColor, borderBottomWidth, backgroundImage } = getComputedStyle(element);
          return { border: `${borderBottomWidth} ${borderBottomColor}`, hasDot: backgroundImage !== 'none' };
        });
    const [chosen, other] = [await looks('.dose-radio.on'), await looks('.dose-radio:not(.on)')];
    assert.deepEqual([chosen.hasDot, other.hasDot], [true, false], 'the chosen quantity has the dot');
    assert.notEqual(chosen.border, other.border);
    assert.equal(other.border.split(' ')[0], '1px', 'nor has one that is not chosen the edge of what is on'); // 1.5 px at ratio 1
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
