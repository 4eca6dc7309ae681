// A meeting of three: join, present, follow, leave, return, lose the connection, take over. Screenshots stay in build/test-artifacts/.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { sleep } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, missing, shoot, startWorld } from './browser.mjs';
import { startProxy } from './proxy.mjs';

const sizes = [
  ['1600x1000', { viewport: { width: 1600, height: 1000 } }],
  ['1280x720', { viewport: { width: 1280, height: 720 } }],
  ['1180x820-touch', { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true }],
  ['390x844-touch', { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }],
];

/** Until this holds; fails with the last value after 30 s. */
async function until(what, holds, of = async () => undefined) {
  let last;
  for (const end = Date.now() + 30000; Date.now() < end; await sleep(50)) {
    last = await of();
    if (await holds(last)) return last;
  }
  throw new assert.AssertionError({ message: `${what}: ${JSON.stringify(last)}` });
}

const chip = (page) => page.locator('.room-chip:visible');
const says = (page, words) =>
  until(
    `the chip says ${words}`,
    (text) => words.test(text),
    async () => (await chip(page).textContent()).replace(/\s+/g, ' ').trim(),
  );
const act = (page) => chip(page).locator('.chip-act');
/** The panes that are shown: all four, on a phone one. */
const shown = (page) => page.evaluate(() => [...document.querySelectorAll('.pane:not([hidden])')].map((pane) => Number(pane.dataset.view)));
const allFull = (...pages) => Promise.all(pages.map(async (page) => Promise.all((await shown(page)).map((view) => full(page, view)))));
/** Shows this pane, on a phone in place of the one that is shown. */
async function toPane(page, view) {
  if ((await shown(page)).includes(view)) return;
  await page
    .locator('[aria-label="Pane"] button')
    .nth(view - 1)
    .tap();
  await page.locator(`#picture-${view}`).waitFor();
  await full(page, view);
}
const matrix = async (page, view) =>
  Object.values((await header(page, view)).clip_from_lps_mm)
    .map((value) => value.toFixed(4))
    .join(' ');
const seen = (page) =>
  page.evaluate(() =>
    JSON.stringify(
      [1, 2, 3, 4].map((n) => {
        if (!globalThis.beamroom.stats().headers[n]) return null; // a pane that a phone has not shown yet
        const { sequence, scene_revision, clip_from_lps_mm, width_px, height_px } = globalThis.beamroom.stats().headers[n];
        return [sequence, scene_revision, width_px, height_px, Object.values(clip_from_lps_mm)];
      }),
    ),
  );
const shows = (page, view, expected) =>
  until(
    `view ${view} shows the same`,
    async (now) => now === (await expected()),
    () => matrix(page, view),
  );
/** "S 33.9 mm": the position in the header of a slice pane. */
const place = (page, view) => page.locator(`[data-view="${view}"] .where`).textContent();

async function drag(page, view, dx, dy) {
  await toPane(page, view);
  const box = await page.locator(`#picture-${view}`).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const isTouch = await page.evaluate(() => matchMedia('(pointer: coarse)').matches);
  if (!isTouch) {
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + dx, y + dy, { steps: 6 });
    return void (await page.mouse.up());
  }
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) =>
    session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([px, py]) => ({ x: px, y: py, id: 0 })) });
  await touch('touchStart', [[x, y]]);
  for (let step = 1; step <= 6; step++) await touch('touchMove', [[x + (dx * step) / 6, y + (dy * step) / 6]]);
  await touch('touchEnd', []);
}

/** The size of a pane in px of the screen, as the page measures it. */
const paneSize = async (page, view) =>
  page.evaluate((n) => {
    const { width, height } = document.querySelector(`#picture-${n}`).getBoundingClientRect();
    return [Math.round(width * devicePixelRatio), Math.round(height * devicePixelRatio)];
  }, view);

/** Until the pictures have the sizes of their panes, as those of a member on their own have. */
async function ownSizes(page) {
  for (const view of await shown(page)) {
    const size = await paneSize(page, view);
    await until(
      `own size of view ${view}`,
      ({ width_px, height_px, scale_percent }) =>
        scale_percent === 100 && Math.abs(width_px - size[0]) <= 1 && Math.abs(height_px - size[1]) <= 1,
      () => header(page, view),
    );
  }
}

/** The words and scale bars of the panes that lie under a toast. */
const underToast = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll('.toast')].flatMap((toast) => {
      const over = toast.getBoundingClientRect();
      return [...document.querySelectorAll('.overlay text, .overlay .scale')]
        .filter((element) => {
          const box = element.getBoundingClientRect();
          return box.width && box.left < over.right && box.right > over.left && box.top < over.bottom && box.bottom > over.top;
        })
        .map((element) => element.textContent.trim());
    }),
  );

/** Buttons and fields that are smaller than 44 px for a finger, cut by the window, or under another one. */
const smallTargets = (page, places = ['.banner', '.switch', '.toast']) =>
  page.evaluate(
    (within) =>
      [...document.querySelectorAll(within.flatMap((place) => [`${place} button`, `${place} input`]).join())]
        .filter((element) => element.checkVisibility())
        .flatMap((element) => {
          const box = element.getBoundingClientRect();
          const top = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
          const isCut = box.left < 0 || box.right > innerWidth;
          return box.width < 44 || box.height < 44 || isCut || !element.contains(top)
            ? [`${element.getAttribute('aria-label') ?? element.textContent.trim()}: ${box.width} x ${box.height} at ${box.left}`]
            : [];
        }),
    places,
  );

/** Px of the screen per mm, as a picture is shown in its pane. */
async function scaleOf(page, view) {
  const { full_px, pixels_per_mm } = await header(page, view);
  const [width, height] = await paneSize(page, view);
  return pixels_per_mm * Math.min(width / full_px[0], height / full_px[1]);
}

describe('a meeting of three', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let proxy;

  before(async () => {
    world = await startWorld();
    proxy = await startProxy(world.daemon.url);
  });
  after(async () => {
    await proxy?.stop();
    await world?.stop();
  });

  /** The presenter, at another size than the two who follow. */
  const meet = async (options, base, presenterBase) => {
    const room = await world.newRoom();
    const address = `rooms/${room}`;
    const one = await world.newPage(address, { viewport: { width: 1500, height: 700 }, base: presenterBase });
    await says(one, /^Presenting$/);
    const [two, three] = [await world.newPage(address, options), await world.newPage(address, { ...options, base })];
    await says(one, /^Presenting · 2 follow$/);
    await says(two, /^Following Reviewer 1$/);
    await allFull(one, two, three);
    return { room, one, two, three, stop: () => Promise.all([one, two, three].map((page) => page.context().close())) };
  };

  for (const [name, options] of sizes)
    it(`present, follow, leave, return, show everyone at ${name}`, async () => {
      const { room, one, two, three, stop } = await meet(options);
      const before = await matrix(two, 1);
      await drag(one, 1, 150, 0);
      await until(
        'the presenter has turned it',
        (now) => now !== before,
        () => matrix(one, 1),
      );
      for (const page of [two, three]) await shows(page, 1, () => matrix(one, 1));
      assert.equal(await place(two, 2), await place(one, 2));
      await allFull(one, two, three);

      await toPane(two, 2);
      const [pictures, scene, scale] = [[await seen(one), await seen(three)], await world.scene(room), await scaleOf(two, 2)];
      await drag(two, 2, 30, 20);
      await says(two, /^On my own Return F$/);
      await until(
        'the own crosshair has moved',
        async (own) => own !== (await place(one, 3)),
        () => place(two, 3),
      );
      await two.locator('.toast', { hasText: 'On your own' }).waitFor();
      assert.deepEqual(await underToast(two), []);
      await ownSizes(two);
      await allFull(two);
      await until(
        'the scale is kept',
        (now) => Math.abs(now / scale - 1) < 0.01,
        () => scaleOf(two, 2),
      ); // sizes are whole px
      assert.deepEqual([await seen(one), await seen(three)], pictures, "nobody else's picture has changed");
      assert.deepEqual(await world.scene(room), scene, "nor the room's scene");
      await says(one, /^Presenting · 1 follows$/);
      if (options.hasTouch) assert.deepEqual(await smallTargets(two), []);
      await shoot(two, `meeting-own-${name}`);

      await toPane(two, 1);
      await ownSizes(two);
      const own = await matrix(two, 1);
      await drag(one, 1, -60, 30);
      await shows(three, 1, () => matrix(one, 1));
      await until(
        "the presenter's picture is new",
        (now) => now !== own,
        () => matrix(one, 1),
      );
      assert.equal(await matrix(two, 1), own, 'an own view stays');
      if (options.hasTouch) await act(two).tap();
      else await two.keyboard.press('Escape');
      await says(two, /^Following Reviewer 1$/);
      await shows(two, 1, () => matrix(one, 1));
      await until(
        "the crosshair is the room's again",
        async (now) => now === (await place(one, 3)),
        () => place(two, 3),
      );

      if (options.hasTouch) {
        await chip(three).locator('.chip-main').tap();
        await shoot(three, `meeting-members-${name}`);
        await three.locator('.room-members button', { hasText: 'Look for yourself' }).tap();
      } else {
        await three.locator('#picture-1').focus();
        await three.keyboard.press('f');
      }
      await says(three, /^On my own/);
      await drag(one, 1, 0, 40);
      await one.locator('.room-chip:visible .chip-main').click();
      await shoot(one, `meeting-presenter-${name}`);
      await one.locator('.room-members button', { hasText: 'Show everyone' }).click();
      await says(three, /^Following Reviewer 1$/);
      await shows(three, 1, () => matrix(one, 1));
      await one.locator('#picture-1').focus();
      await one.keyboard.press('f');
      await one.locator('.toast', { hasText: 'You are presenting' }).waitFor();
      await says(one, /^Presenting · 2 follow$/);
      await allFull(two);
      assert.deepEqual(await underToast(two), []);
      await shoot(two, `meeting-following-${name}`);
      await stop();
    });

  for (const [name, options] of sizes.filter(([size]) => /1280|touch/.test(size)))
    it(`who came by the link gives a name, and changes it, at ${name}`, async () => {
      const { one, two, stop } = await meet(options);
      /** All words of chip and badges from now on. */
      const record = (page) =>
        page.evaluate(() => {
          globalThis.seenWords = [];
          new MutationObserver(() =>
            globalThis.seenWords.push(...[...document.querySelectorAll('.room-chip, .badge')].map((element) => element.textContent)),
          ).observe(document.body, { subtree: true, childList: true, characterData: true, attributes: true });
        });
      const press = (locator) => (options.hasTouch ? locator.tap() : locator.click());
      const field = two.locator('#room-name');
      const save = () => press(two.locator('.room-members form button'));
      const listed = (page, words) => page.locator('.room-members li', { hasText: words }).waitFor();
      assert.equal(await one.locator('.toast', { hasText: 'You are Reviewer' }).count(), 0, 'nobody was there');
      await press(two.locator('.toast', { hasText: 'You are Reviewer 2 here.' }).locator('.toast-act'));
      await until(
        'the focus is in the field',
        (id) => id === 'room-name',
        () => two.evaluate(() => document.activeElement.id),
      );
      assert.deepEqual(await axe(two), []);
      if (options.hasTouch) assert.deepEqual(await smallTargets(two, ['.room-members']), []);
      await shoot(two, `meeting-name-${name}`);
      assert.equal(await field.getAttribute('maxlength'), '40');
      await two.keyboard.press('Escape');
      await field.waitFor({ state: 'detached' });

      await drag(two, 1, 60, 0); // on their own now, which a new name does not end
      await says(two, /^On my own/);
      await ownSizes(two);
      await until(
        'the own view is at rest',
        async (now) => (await sleep(300), now === (await matrix(two, 1))),
        () => matrix(two, 1),
      );
      const own = await matrix(two, 1);
      await Promise.all([one, two].map(record));
      await press(chip(two).locator('.chip-main'));
      await field.fill('Dr <i>Chen</i>');
      await save();
      await chip(one).locator('.chip-main').click();
      await listed(one, 'Dr <i>Chen</i>');
      await two.locator('.toast', { hasText: 'The others see you as Dr <i>Chen</i>.' }).waitFor();
      await until('the focus is in the chip', Boolean, () => two.evaluate(() => document.activeElement.classList.contains('chip-main')));
      await says(two, /^On my own/);
      await allFull(two);
      assert.equal(await matrix(two, 1), own);
      assert.equal(await two.evaluate(() => localStorage.getItem('beamroom name')), 'Dr <i>Chen</i>');

      const shared = await matrix(one, 1);
      await one.locator('#room-name').fill('Dr Alvarez');
      await one.keyboard.press('Enter');
      await act(two).click();
      await says(two, /^Following Dr Alvarez$/);
      await says(one, /^Presenting · 2 follow$/);
      await allFull(one, two);
      assert.equal(await matrix(one, 1), shared);
      for (const page of [one, two]) {
        const words = await page.evaluate(() => globalThis.seenWords);
        assert.ok(words.some((text) => /Full/.test(text)) && words.some((text) => /Presenting|On my own/.test(text)));
        assert.deepEqual(
          words.filter((text) => /Disconnected|Link|away|No presenter/.test(text)),
          [],
        );
      }

      await two.reload();
      await says(two, /^Following Dr Alvarez$/);
      await press(chip(two).locator('.chip-main'));
      await listed(two, 'Dr <i>Chen</i> (you)');
      assert.equal(await field.inputValue(), 'Dr <i>Chen</i>');
      assert.equal(await two.locator('.toast', { hasText: 'You are' }).count(), 0);
      await stop();
    });

  it('a link that swallows everything shows, what is done meanwhile is kept, and it comes back', async () => {
    const { one, two, three, stop } = await meet(sizes[0][1], proxy.url);
    const before = await place(three, 2);
    proxy.black(true);
    await drag(three, 3, 0, 30); // who follows leaves; this is not heard by the server
    await until(
      'the own crosshair shows',
      (now) => now !== before,
      () => place(three, 2),
    );
    const own = await place(three, 2);
    const badge = three.locator('#badge-all');
    await until(
      'the badge doubts',
      (text) => /^Link\? \d s$/.test(text),
      async () => (await badge.textContent()).trim(),
    );
    assert.equal(await badge.getAttribute('data-badge'), 'link');
    await shoot(three, 'meeting-link');
    await until(
      'the badge knows',
      (state) => state === 'disconnected',
      () => badge.getAttribute('data-badge'),
    );
    await shoot(three, 'meeting-disconnected');
    assert.equal(await place(three, 2), own);
    proxy.black(false);
    await allFull(three);
    assert.equal(await place(three, 2), own, 'what was done meanwhile is kept');
    await says(three, /^On my own/);
    assert.equal(await place(one, 2), before);
    await says(one, /^Presenting · 1 follows$/);
    assert.equal(await place(two, 2), before);
    await act(three).click();
    await says(three, /^Following Reviewer 1$/);
    await until(
      "the crosshair is the room's again",
      (now) => now === before,
      () => place(three, 2),
    );
    await stop();
  });

  it('what the presenter changes while the link is dead is sent when it is back', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`, { base: proxy.url });
    await allFull(page);
    proxy.black(true);
    await page.locator('[data-region="scalp"] .eye').click();
    await drag(page, 1, 150, 0);
    const badge = page.locator('#badge-all');
    await until(
      'the link is lost',
      (state) => state === 'disconnected',
      () => badge.getAttribute('data-badge'),
    );
    await page.locator('[data-region="brain"] .eye').click();
    assert.equal((await world.scene(room)).regions.scalp.visible, true);
    proxy.black(false);
    await until(
      'the scene has it',
      ({ regions }) => !regions.scalp.visible && !regions.brain.visible,
      () => world.scene(room),
    );
    await page.waitForFunction(
      () =>
        document.querySelector('[data-view="1"] [data-letters]').dataset.letters.startsWith('RP') ||
        document.querySelector('[data-view="1"] [data-letters]').dataset.letters.startsWith('PR'),
    );
    await allFull(page);
    await says(page, /^Presenting$/);
    await page.context().close();
  });

  it('a presenter whose machine is gone without a word presents no more after 30 s; others keep what they see and take over', async () => {
    const { one, two, three } = await meet(sizes[0][1], undefined, proxy.url);
    await allFull(one, two, three);
    const gone = performance.now();
    proxy.black(true); // as a laptop that is shut: no end of the connection is ever sent
    await says(two, /^Reviewer 1 is away$/);
    const pictures = [await seen(two), await seen(three)];
    await act(two).waitFor({ timeout: 45000 }); // 30 s, and a busy machine
    assert.ok(performance.now() - gone > 24000, 'pings and pongs come every 5 s at least'); // 30 s since the last sign
    await says(two, /^No presenter Take over$/);
    await shoot(two, 'meeting-no-presenter');
    assert.deepEqual([await seen(two), await seen(three)], pictures);
    await act(two).click();
    await says(two, /^Presenting · 1 follows$/);
    await says(three, /^Following Reviewer 2$/);
    await drag(two, 1, 100, 0);
    await shows(three, 1, () => matrix(two, 1));
    await drag(two, 2, 30, 10);
    await until(
      'the crosshair of the new presenter',
      async (now) => now === (await place(two, 3)),
      () => place(three, 3),
    );
    proxy.black(false); // who comes back finds somebody presenting, and follows
    await says(one, /^Following Reviewer 2$/);
    await shows(one, 1, () => matrix(two, 1));
    await Promise.all([one, two, three].map((page) => page.context().close()));
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
