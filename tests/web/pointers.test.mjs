// Pointers between two pages: the same anatomy in other layouts, slices and cameras, hidden, gone; "look here". Places are computed here, from the matrix of
// the frame that is painted, not by the page's own functions.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { call, sleep, until as untilTold } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, missing, shoot, startWorld } from './browser.mjs';
import { axialPoint, boxOf, mark, near, pointAt, project } from './places.mjs';

/** Until this holds; fails with the last value after 60 s. Between the tries `meanwhile` runs. */
async function until(what, ask, holds, meanwhile = async () => {}) {
  let last;
  for (const end = Date.now() + 60000; Date.now() < end; await sleep(50)) {
    last = await ask();
    if (holds(last)) return last;
    await meanwhile();
  }
  throw new assert.AssertionError({ message: `${what}: ${JSON.stringify(last)}` });
}

describe('pointers between two pages', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let ann;
  let ben;
  const allFull = () => Promise.all([ann, ben].flatMap((page) => [1, 2, 3, 4].map((view) => full(page, view))));
  /** A pointer at rest fades: moved a little now and then it does not. */
  const keptMoving = (view, place) => {
    let [last, side] = [Date.now(), 0];
    return async () => {
      if (Date.now() - last < 2500) return;
      last = Date.now();
      side = 1 - side;
      await pointAt(ann, view, [place[0] + side * 0.004, place[1]]);
    };
  };

  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    ann = await world.newPage(`rooms/${room}`);
    await full(ann, 1);
    ben = await world.newPage(`rooms/${room}`, { viewport: { width: 1280, height: 720 } });
    await allFull();
    await ann.locator('.point-tools').waitFor();
  });
  after(() => world?.stop());

  it('is on the same anatomy in another size, layout and slice', async () => {
    await ben.locator('#picture-2').focus();
    await ben.keyboard.press('PageUp'); // on his own, ten slices on
    await ben.locator('.room-chip.in-strip[data-standing="own"]').waitFor();
    await ben.keyboard.press('Shift+Digit1'); // a row of three
    await ben.keyboard.press('+');
    await until(
      'Ben has his own pictures',
      () => ben.evaluate(() => ['full', 'full'].every((_, n) => globalThis.beamroom.stats().badges[n + 1] === 'full')),
      Boolean,
    );
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('p');
    await ann.locator('.point-tools [aria-pressed="true"]').waitFor();
    const s = (await world.scene(room)).image.slices.axial.position_mm;
    const place = [0.46, 0.37];
    const point = await axialPoint(ann, 2, await pointAt(ann, 2, place), s);
    const own = await ben.evaluate(() => globalThis.beamroom.stats().documents[2].override.image.slices);
    const off = { 2: Math.abs(point[2] - own.axial.position_mm), 3: Math.abs(point[0] - own.sagittal.position_mm) };
    assert.ok(off[2] > 5, 'the slices differ');
    for (const view of [2, 3]) {
      const at = await until(
        `the mark in view ${view}`,
        () => mark(ben, view),
        (now) => now !== null,
        keptMoving(2, place),
      );
      const expected = await project(ben, view, point);
      assert.ok(near(at, expected, 2.5), `view ${view}: ${JSON.stringify(at)}, expected ${expected}`); // keptMoving moves by up to 2 px
      assert.ok(Math.abs(Number.parseFloat(at.words) - off[view]) <= 1.1, `view ${view}: ${at.words}, ${off[view]} mm away`);
      assert.match(at.words, /^[\d.]+ mm$/);
      assert.ok(at.strength < 0.9);
    }
    await shoot(ben, 'pointers-other-slice');
    assert.deepEqual(
      await ben.evaluate(() =>
        [...document.querySelectorAll('.person-pointer .label')]
          .filter((label) => {
            const [rect, text] = ['rect', 'text'].map((name) => label.querySelector(name).getBBox());
            return text.width > rect.width - 4 || !text.width;
          })
          .map((label) => label.textContent),
      ),
      [],
      'labels fit into their boxes',
    );
    assert.equal(await mark(ann, 2), null, 'her own pointer is her cursor');
  });

  it('stays on the anatomy while the picture below it moves', async () => {
    const s = (await world.scene(room)).image.slices.axial.position_mm;
    const place = [0.5, 0.45];
    const point = await axialPoint(ann, 2, await pointAt(ann, 2, place), s);
    await until(
      'the mark',
      () => mark(ben, 2),
      (now) => now !== null,
      keptMoving(2, place),
    );
    const before = await header(ben, 2);
    await ben.locator('#picture-2').focus();
    await ben.keyboard.press('-');
    await ben.keyboard.press('Control+ArrowRight');
    await until(
      'Ben has another picture',
      () => header(ben, 2),
      ({ clip_from_lps_mm: m }) => String(Object.values(m)) !== String(Object.values(before.clip_from_lps_mm)),
    );
    await until(
      'the mark is where the new matrix has it',
      async () => near(await mark(ben, 2), await project(ben, 2, point), 2.5),
      Boolean,
      keptMoving(2, place),
    );
  });

  it('in 3-D is what is seen there, and is said to be behind for who looks from the other side', async () => {
    await ben.keyboard.press('Shift+Digit2'); // four panes
    await ben.keyboard.press('f');
    await until(
      'Ben follows again',
      () => ben.evaluate(() => document.querySelector('.room-chip').dataset.standing),
      (word) => word === 'following',
    );
    await allFull();
    const place = [0.48, 0.6]; // below the slice that is drawn in space: a surface, which the head hides from behind
    const [px, py] = await pointAt(ann, 1, place);
    const box = await boxOf(ann, 1);
    const document = await ann.evaluate(() => globalThis.beamroom.stats().documents[1]);
    const query = new URLSearchParams({
      room,
      view: JSON.stringify(document),
      px: ((px - box.x) / box.width) * document.size_px[0],
      py: ((py - box.y) / box.height) * document.size_px[1],
    });
    const { json } = await call(`${world.daemon.url}/api/v1/plans/phantom/pick?${query}`);
    const point = json.hits.find(({ seen }) => seen).point_lps_mm;
    await until(
      'the mark is on what is seen',
      async () => near(await mark(ben, 1), await project(ben, 1, point), 4),
      Boolean,
      keptMoving(1, place),
    );
    const front = await until(
      'it is in front',
      () => mark(ben, 1),
      (at) => at?.words === '',
      keptMoving(1, place),
    );
    assert.equal(front.strength, 1);

    await ben.locator('#picture-1').focus();
    await ben.keyboard.press('Shift+Numpad1'); // from posterior, on his own
    await full(ben, 1);
    const back = await until(
      'it is behind',
      () => mark(ben, 1),
      (at) => at?.words === 'behind',
      keptMoving(1, place),
    );
    assert.ok(back.strength < 0.6);
    await until('on the same point', async () => near(await mark(ben, 1), await project(ben, 1, point), 4), Boolean, keptMoving(1, place));
    await shoot(ben, 'pointers-behind');
  });

  it('can be hidden, and this browser keeps that', async () => {
    const place = [0.5, 0.5];
    await pointAt(ann, 2, place);
    await until(
      'a mark',
      () => mark(ben, 2),
      (at) => at !== null,
      keptMoving(2, place),
    );
    const toggle = async () => {
      await ben.locator('.point-more').click();
      if (await mark(ben, 2)) assert.deepEqual(await axe(ben), []);
      await ben.getByLabel('Pointers of the others').click();
      await ben.keyboard.press('Escape');
    };
    await toggle();
    await until(
      'no mark',
      () => ben.locator('.person-pointer').count(),
      (n) => n === 0,
    );
    assert.equal(await ben.evaluate(() => localStorage.getItem('beamroom pointers hidden')), 'yes');
    await toggle();
    await until(
      'a mark again',
      () => mark(ben, 2),
      (at) => at !== null,
      keptMoving(2, place),
    );
  });

  it('look here: who follows sees the mark and stays, who is on their own comes, and the asker sees who came', async () => {
    await ann.keyboard.press('Escape'); // no pointing: the crosshair is meant
    await until(
      'no pointer',
      () => ben.locator('.person-pointer').count(),
      (n) => n === 0,
    );
    const cem = await world.newPage(`rooms/${room}`, { viewport: { width: 1200, height: 800 } });
    await full(cem, 2);
    await ben.locator('#picture-2').focus();
    await ben.keyboard.press('PageDown');
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('Shift+P');
    const asked = ben.getByText('Reviewer 1 asks you to look here');
    await Promise.all([asked.waitFor(), ann.getByText('0 of 2 came').waitFor()]);
    const { axial, coronal, sagittal } = (await world.scene(room)).image.slices;
    await ben.getByRole('button', { name: 'Come', exact: true }).click();
    await ann.getByText('1 of 2 came').waitFor();
    await asked.waitFor({ state: 'detached' });
    const slices = await until(
      'Ben is there',
      () => ben.evaluate(() => globalThis.beamroom.stats().documents[2].override.image.slices),
      (own) => Math.abs(own.axial.position_mm - axial.position_mm) < 1e-3,
    );
    assert.ok(
      Math.abs(slices.coronal.position_mm - coronal.position_mm) < 1e-3 &&
        Math.abs(slices.sagittal.position_mm - sagittal.position_mm) < 1e-3,
    );
    await cem.getByRole('button', { name: 'Come', exact: true }).click();
    await ann.getByText('2 of 2 came').waitFor();
    assert.equal(await cem.evaluate(() => document.querySelector('.room-chip').dataset.standing), 'following');
    const at = await mark(cem, 2, 'look-1');
    assert.ok(near(at, await project(cem, 2, [sagittal.position_mm, coronal.position_mm, axial.position_mm])), JSON.stringify(at));
    await shoot(cem, 'pointers-look-here');
    await ann.getByRole('button', { name: 'End', exact: true }).click();
    await until(
      'it is over',
      () => cem.locator('.person-pointer').count(),
      (n) => n === 0,
    );
    await cem.close();
  });

  it('ends with the gesture and with who leaves', async () => {
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('p');
    const place = [0.5, 0.52];
    await pointAt(ann, 2, place);
    await until(
      'a mark',
      () => mark(ben, 2),
      (at) => at !== null,
      keptMoving(2, place),
    );
    await ann.keyboard.press('p');
    await until(
      'no mark',
      () => mark(ben, 2),
      (at) => at === null,
    );
    await ann.keyboard.press('p');
    await pointAt(ann, 2, [0.5, 0.5]);
    await until(
      'a mark again',
      () => mark(ben, 2),
      (at) => at !== null,
      keptMoving(2, place),
    );
    await ann.close();
    await until(
      'no mark of who has gone',
      () => mark(ben, 2),
      (at) => at === null,
    );
    await untilTold(
      () => ben.locator('.point-tools').count(),
      (n) => n === 0,
    );
    assert.deepEqual(world.errors, []);
  });
});
