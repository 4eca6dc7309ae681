// Effects of the pointer on pictures: clicks select, rests show facts, double clicks move nothing; mouse and finger in the browser.
import assert from 'node:assert/strict';
import { after, before, describe } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { full, header, later, missing, once, shoot, startWorld } from './browser.mjs';

const tablet = { viewport: { width: 1180, height: 820 }, hasTouch: true, isMobile: true };

describe('the pointer on the pictures', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let page;

  before(async () => {
    world = await startWorld();
    await open();
    for (const view of [3, 4]) await full(page, view);
  });
  after(async () => {
    await world?.stop();
  });

  /** A page in a room of its own. */
  const open = async (options) => {
    await page?.context().close();
    room = await world.newRoom();
    const slices = { axial: { visible: false } }; // in 3-D it would hide parts of the regions
    await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { image: { slices } }, { 'If-Match': '*' });
    page = await world.newPage(`rooms/${room}`, options);
    for (const view of [1, 2]) await full(page, view);
  };
  const crosshairOf = async () => {
    const { sagittal, coronal, axial } = (await world.scene(room)).image.slices;
    return [sagittal.position_mm, coronal.position_mm, axial.position_mm];
  };
  const planOf = async () => (await call(`${world.daemon.url}/api/v1/plans/phantom`)).json;
  /** Place in the window of a patient point in a picture. */
  const placeOf = async (view, point) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    const m = Object.values((await header(page, view)).clip_from_lps_mm);
    const row = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
    return [box.x + ((row(0) / row(3) + 1) / 2) * box.width, box.y + ((1 - row(1) / row(3)) / 2) * box.height];
  };
  const regionAt = (name) =>
    page.waitForFunction((wanted) => document.querySelector('.inspector')?.textContent.includes(`Region ${wanted}`), name);
  const card = (view) => page.locator(`[data-view="${view}"] .read-out`);
  const isNear = (a, b, mm) => a.every((value, at) => Math.abs(value - b[at]) <= mm);

  once('a click in 3-D selects the region that is seen through those before it, and moves no crosshair', async () => {
    const before = await crosshairOf();
    const { regions } = await planOf();
    const tumour = regions.find(({ name }) => name === 'tumour');
    await page.mouse.click(...(await placeOf(1, tumour.center_mm)));
    await regionAt('tumour');
    await page.waitForTimeout(300);
    assert.deepEqual(await crosshairOf(), before);
  });

  once('a click in a slice moves the crosshair and selects; a double click maximises and moves nothing', async () => {
    const before = await crosshairOf();
    const [x, y] = await placeOf(2, before);
    await page.mouse.dblclick(x + 40, y + 30);
    await page.waitForFunction(() => document.querySelectorAll('.pane:not([hidden])').length === 1);
    await page.waitForTimeout(600);
    assert.deepEqual(await crosshairOf(), before);
    await full(page, 2);
    const [u, v] = await placeOf(2, before);
    await page.mouse.dblclick(u + 40, v + 30);
    await page.waitForFunction(() => document.querySelectorAll('.pane:not([hidden])').length === 4);
    for (const view of [1, 2, 3, 4]) await full(page, view);
    await page.waitForTimeout(600);
    assert.deepEqual(await crosshairOf(), before);
    const target = [before[0] + 20, before[1] - 15, before[2]];
    await page.mouse.click(...(await placeOf(2, target)));
    const found = await until(crosshairOf, (now) => isNear(now, target, 2), 60000);
    assert.ok(isNear(found, target, 2), `${found}, expected ${target}`);
  });

  once('at rest over a slice the pointer shows region, value with unit and position; none while dragging', async () => {
    const point = await crosshairOf();
    const [x, y] = await placeOf(2, [point[0] - 15, point[1] + 10, point[2]]);
    await page.mouse.move(x - 30, y);
    await page.mouse.move(x, y, { steps: 3 });
    await card(2).waitFor();
    const text = await card(2).textContent();
    assert.match(text, /brain|skull|scalp|tumour/);
    assert.match(text, /CT\s+\S*\d\s*HU/);
    assert.match(text, /L .+P .+S .+ mm/);
    await shoot(page, 'pointed-slice');
    assert.equal(await card(2).evaluate((element) => getComputedStyle(element.parentElement).pointerEvents), 'none');
    await page.mouse.down();
    await page.mouse.move(x + 20, y + 10, { steps: 4 });
    assert.equal(await card(2).count(), 0);
    await page.waitForTimeout(400);
    assert.equal(await card(2).count(), 0);
    await page.mouse.up();
    await page.mouse.move(x + 30, y + 20, { steps: 3 });
    await card(2).waitFor();
    await page.keyboard.press('Escape');
    await card(2).waitFor({ state: 'detached' });
    await page.mouse.move(x + 20, y + 20, { steps: 3 });
    await card(2).waitFor();
    await page.mouse.move(5, 5);
    await card(2).waitFor({ state: 'detached' });
  });

  once('over 3-D it shows what is seen there, and nothing beside the patient', async () => {
    const { regions } = await planOf();
    const [x, y] = await placeOf(1, regions.find(({ name }) => name === 'tumour').center_mm);
    await page.mouse.move(x + 5, y);
    await page.mouse.move(x, y);
    await card(1).waitFor();
    assert.match(await card(1).textContent(), /^\s*tumour/);
    await shoot(page, 'pointed-3d');
    for (const view of [1, 2]) {
      // in a slice that is beside the image, of which the first picture shows the body alone
      if (view === 2) {
        await page.locator('#picture-2').focus();
        for (let n = 0; n < 4; n++) await page.keyboard.press('-');
        await full(page, 2);
      }
      const box = await page.locator(`#picture-${view}`).boundingBox();
      await page.mouse.move(box.x + 20, box.y + 60);
      await card(view).waitFor({ state: 'detached' });
      await page.waitForTimeout(500);
      assert.equal(await card(view).count(), 0);
    }
    await page.locator('#picture-2').focus();
    await page.keyboard.press('r');
    await full(page, 2);
  });

  once('goes with the picture it is about, and comes back for the next', async () => {
    const point = await crosshairOf();
    const [x, y] = await placeOf(2, point);
    await page.mouse.move(x + 30, y);
    await page.mouse.move(x + 25, y);
    await card(2).waitFor();
    const before = await card(2).textContent();
    await page.mouse.wheel(0, -300);
    await page.waitForFunction((old) => {
      const now = document.querySelector('[data-view="2"] .read-out');
      return now && now.textContent !== old;
    }, before);
  });

  once('Shift and the pointer move the crosshair, in 3-D to what is seen', async () => {
    const before = await crosshairOf();
    const target = [before[0] - 12, before[1] + 9, before[2]];
    const [x, y] = await placeOf(2, target);
    await page.keyboard.down('Shift');
    await page.mouse.move(x - 10, y);
    await page.mouse.move(x, y, { steps: 3 });
    assert.ok(isNear(await until(crosshairOf, (now) => isNear(now, target, 2), 60000), target, 2));
    const { regions } = await planOf();
    const tumour = regions.find(({ name }) => name === 'tumour');
    const place = await placeOf(1, tumour.center_mm);
    await page.locator('[data-region="tumour"] .name').click(); // not what the last click in a slice has selected
    await page.mouse.move(place[0] - 6, place[1]);
    await page.mouse.move(...place, { steps: 3 });
    await page.keyboard.up('Shift');
    // on the tumour's front, along the line of sight to its middle: its radius from there
    const found = await until(crosshairOf, (now) => isNear(now, tumour.center_mm, 40) && !isNear(now, target, 2), 60000);
    assert.ok(isNear(found, tumour.center_mm, 40), `${found} at ${tumour.center_mm}`);
  });

  once('Ctrl and arrows move the picture', async () => {
    await page.locator('#picture-1').focus();
    const before = Object.values((await header(page, 1)).clip_from_lps_mm);
    const letters = () => page.locator('[data-view="1"] [data-letters]').getAttribute('data-letters');
    const looking = await letters();
    await page.keyboard.press('Control+ArrowRight');
    const after = await until(
      async () => Object.values((await header(page, 1)).clip_from_lps_mm),
      (m) => m[12] > before[12] + 1e-3,
      60000,
    );
    assert.ok(after[12] > before[12], 'to the right');
    assert.equal(await letters(), looking, 'not turned');
  });

  once('says without a pointer what lies at the crosshair of the pane with the focus', async () => {
    await page.locator('#picture-2').focus();
    await page.waitForFunction(() =>
      /^Axial, S \S+ mm, (tumour|target|brain|cranium|scalp), CT \S+ HU(, \S+ Gy\(w\))?$/.test(
        document.querySelector('#caption-2').textContent,
      ),
    );
    await page.waitForFunction(() => /^Sagittal, L \S+ mm$/.test(document.querySelector('#caption-3').textContent));
  });

  later('a long press shows the values beside the finger, away from letters', async () => {
    await open(tablet);
    const devtools = await page.context().newCDPSession(page);
    const touch = (type, points) =>
      devtools.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    for (const view of [2, 1]) {
      const { regions } = await planOf();
      const { center_mm: middle } = regions.find(({ name }) => name === 'tumour');
      const point = view === 1 ? middle : [middle[0] - 40, middle[1] - 30, (await crosshairOf())[2]];
      const place = await placeOf(view, point);
      await touch('touchStart', [place]);
      await card(view).waitFor();
      await touch('touchEnd', []);
      await full(page, view);
      await shoot(page, `held-${view}`);
      assert.equal(await card(view).getAttribute('data-held'), '');
      assert.equal(await card(view).getAttribute('role'), 'status');
      const clash = await page.evaluate((n) => {
        const pane = document.querySelector(`[data-view="${n}"]`);
        const a = pane.querySelector('.read-out').getBoundingClientRect();
        return [...pane.querySelectorAll('.overlay text')]
          .filter((text) => {
            const b = text.getBoundingClientRect();
            return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
          })
          .map((text) => text.textContent);
      }, view);
      assert.deepEqual(clash, []);
      const found = await crosshairOf();
      assert.ok(isNear(found, point, view === 1 ? 20 : 2), `the crosshair is there: ${found}`);
    }
    assert.equal(await card(2).count(), 0, 'one at a time');
    assert.deepEqual(world.errors, []);
  });
});
