// The main paths of the page in Debian's Firefox: a room, its pictures under pointer, wheel and keys, the tree, dose, notes, a second member,
// signing in, a display, and what axe-core finds.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { axe } from '../web/axe.mjs';
import { full, missing, says, shoot, startWorld, stats } from './firefox.mjs';

const matrixOf = async (page, view) =>
  Object.values((await stats(page)).headers[view].clip_from_lps_mm)
    .map((value) => value.toFixed(4))
    .join(' ');
const centreOf = async (page, selector) => {
  const { x, y, width, height } = await (await page.waitForSelector(selector)).boundingBox();
  return [x + width / 2, y + height / 2];
};

describe('the page in Firefox', { skip: missing && `${missing} is not there` }, () => {
  let world, room, ann;
  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
  });
  after(async () => {
    await world?.stop();
    assert.deepEqual(world?.errors ?? [], []);
  });

  it('a room opens with four pictures at rest', async () => {
    ann = await world.newPage(`rooms/${room}`);
    await full(ann, [1, 2, 3, 4]);
    await shoot(ann, 'room');
    assert.deepEqual(await axe(ann), []);
  });

  it('a drag turns the 3-D picture, and pictures follow while it lasts', async () => {
    const before = await matrixOf(ann, 1);
    const [x, y] = await centreOf(ann, '#picture-1');
    const { frames } = await stats(ann);
    await ann.evaluate(() => globalThis.beamroom.clear());
    await ann.mouse.move(x - 60, y - 60);
    await ann.mouse.down();
    for (let step = 0; step < 30; step++) {
      await ann.mouse.move(x - 60 + 4 * step, y - 60 + step);
      await new Promise((rest) => setTimeout(rest, 30));
    }
    await ann.mouse.up();
    await full(ann, [1]);
    assert.notEqual(await matrixOf(ann, 1), before);
    const { frames: after_, input_to_paint_ms: times } = await stats(ann);
    assert.ok(after_ - frames >= 5, `${after_ - frames} pictures`);
    const median = times.sort((a, b) => a - b)[Math.floor(times.length / 2)];
    assert.ok(times.length > 0 && median < 2000, `${times.length} inputs painted, median ${median} ms`); // a busy machine; figures: tests/bench
  });

  it('the wheel and the keys go through slices, and the crosshair follows a click', async () => {
    const axial = async () => (await world.scene(room)).image.slices.axial.position_mm;
    const before = await axial();
    await ann.mouse.move(...(await centreOf(ann, '#picture-2')));
    await ann.mouse.wheel({ deltaY: 120 });
    const wheeled = await until(axial, (now) => now !== before);
    await ann.focus('#picture-2');
    await ann.keyboard.press('ArrowUp');
    await until(axial, (now) => now !== wheeled);
    const sagittal = (await world.scene(room)).image.slices.sagittal.position_mm;
    const [x, y] = await centreOf(ann, '#picture-2');
    await ann.mouse.click(x + 40, y + 30);
    await until(
      () => world.scene(room),
      ({ image }) => image.slices.sagittal.position_mm !== sagittal,
    );
    await full(ann, [1, 2, 3, 4]);
  });

  it('a region is hidden in the tree and comes back by undo', async () => {
    const isShown = async () => (await world.scene(room)).regions.scalp.visible;
    await (await ann.waitForSelector('[data-region="scalp"] .eye')).click();
    await until(isShown, (now) => !now);
    await ann.keyboard.down('Control');
    await ann.keyboard.press('z');
    await ann.keyboard.up('Control');
    await until(isShown, (now) => now);
  });

  it('isodose lines are drawn with values, and the legend has their levels', async () => {
    await call(
      `${world.daemon.url}/api/v1/rooms/${room}/scene`,
      'PATCH',
      { dose: { lines: { visible: true }, wash: { visible: true } } },
      { 'If-Match': '*' },
    );
    await until(
      () => ann.$$eval('.legend, [class*="legend"]', (all) => all.map((one) => one.textContent).join(' ')),
      (text) => /90/.test(text) && /50/.test(text),
    );
    await full(ann, [2]);
    await shoot(ann, 'dose');
    assert.deepEqual(await axe(ann), []);
  });

  it('who comes by an address follows, on the same pictures', async () => {
    const ben = await world.newPage(`rooms/${room}`);
    await full(ben, [1, 2]);
    await says(ben, '.room-chip', /Following/);
    const before = await matrixOf(ben, 1);
    await ann.focus('#picture-1');
    await ann.keyboard.press('ArrowLeft');
    await until(
      () => matrixOf(ben, 1),
      (now) => now !== before,
    );
    await full(ann, [1]);
    await until(
      async () => [await matrixOf(ann, 1), await matrixOf(ben, 1)],
      ([one, other]) => one === other,
    );
    await ben.browserContext().close();
  });

  it('every tab of the inspector, the help and the report open, and axe-core finds nothing', async () => {
    for (const name of ['Probe', 'Selection', 'Plan', 'Notes', 'Record']) {
      await (await ann.waitForSelector(`::-p-xpath(//*[@role="tab"][starts-with(normalize-space(.), "${name}")])`)).click();
      await ann.waitForFunction(
        (words) => document.querySelector('[role="tab"][aria-selected="true"]')?.textContent.trim().startsWith(words),
        {},
        name,
      );
      assert.deepEqual(await axe(ann), [], name);
    }
    await ann.focus('#picture-2');
    await ann.keyboard.press('?');
    await ann.waitForSelector('[role="dialog"]');
    await shoot(ann, 'keys');
    await ann.keyboard.press('Escape');
  });

  it('the room comes back after a reload', async () => {
    await ann.reload();
    await full(ann, [1, 2, 3, 4]);
    assert.equal((await world.scene(room)).dose.lines.visible, true);
  });

  it('a wall shows the room', async () => {
    const { json: link } = await call(`${world.daemon.url}/api/v1/rooms/${room}/links`, 'POST', { role: 'wall' });
    const wall = await world.newPage(link.url.replace(/^.*?rooms/, 'display'), {
      width: 1920,
      height: 1080,
    });
    await until(
      () =>
        wall.$$eval('canvas, img', (all) =>
          all.some((one) => one.getBoundingClientRect().width > 400 && (one.naturalWidth ?? one.width) > 16),
        ),
      Boolean,
    );
    await shoot(wall, 'wall');
    await wall.browserContext().close();
  });
});

describe('signing in with Firefox', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld(['--sign-in', 'local']);
  });
  after(async () => {
    await world?.stop();
    assert.deepEqual(world?.errors ?? [], []);
  });

  it('the first administrator is made at the address that the log shows, and stays signed in', async () => {
    const address = await until(
      () => /https?:\/\/\S+first\S*|https?:\/\/\S+#\S+/.exec(world.daemon.log())?.[0] ?? '',
      (found) => found !== '',
    );
    const page = await world.newPage(address.replace(/^https?:\/\/[^/]+\//, ''));
    await page.waitForSelector('input[type="password"]');
    assert.deepEqual(await axe(page), []);
    const fields = await page.$$('form input');
    for (const field of fields) {
      const type = await field.evaluate((one) => `${one.type} ${one.name || one.id}`);
      await field.type(/password/.test(type) ? 'three unlike words' : /name/i.test(type) && !/user/i.test(type) ? 'Ada Lovelace' : 'ada');
    }
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => location.pathname === '/');
    await says(page, 'body', /Signed in as/); // all its modules are there: none is cut off by what follows
    await page.goto(`${world.daemon.url}/`);
    await says(page, 'body', /Signed in as/);
    await shoot(page, 'signed-in');
  });
});
