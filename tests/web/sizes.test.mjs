// A follower in a small window is sent the presenter's picture reduced and sees it letterboxed: the same picture, and the same anatomy under crosshair,
// pointers and picks. Places are computed here, from the matrix of the frame that is painted.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { full, header, missing, shoot, startWorld } from './browser.mjs';
import { axialPoint, boxOf, mark, near, pointAt, project } from './places.mjs';

/** The mean difference of two canvases in grey levels, one the means of divisor x divisor pixels of the other. */
async function difference(whole, reduced, view, divisor) {
  const url = await whole.evaluate((n) => document.querySelector(`[data-view="${n}"] canvas`).toDataURL('image/png'), view);
  return reduced.evaluate(
    async ([n, source, d]) => {
      const own = document.querySelector(`[data-view="${n}"] canvas`);
      const picture = new Image();
      picture.src = source;
      await picture.decode();
      const large = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height }).getContext('2d');
      large.drawImage(picture, 0, 0);
      const pixels = large.getImageData(0, 0, picture.width, picture.height).data;
      const means = own.getContext('2d').getImageData(0, 0, own.width, own.height).data;
      let [sum, count] = [0, 0];
      for (let y = 0; y < Math.floor(picture.height / d); y++)
        for (let x = 0; x < Math.floor(picture.width / d); x++)
          for (let c = 0; c < 3; c++, count++) {
            let mean = 0;
            for (let at = 0; at < d * d; at++) mean += pixels[((y * d + Math.floor(at / d)) * picture.width + x * d + (at % d)) * 4 + c];
            sum += Math.abs(mean / (d * d) - means[(y * own.width + x) * 4 + c]);
          }
      return sum / count;
    },
    [view, url, divisor],
  );
}

describe('a follower in a small window', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let room;
  let ann;
  let ben;
  const divisorOf = async (page, view) => {
    const { full_px, width_px } = await header(page, view);
    return Math.round(full_px[0] / width_px);
  };
  const crosshairOf = ({ image: { slices } }) => [slices.sagittal, slices.coronal, slices.axial].map(({ position_mm: mm }) => mm);
  const inMm = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
  /** Ann's pane fills her window, Ben has all four in his. Until both show it at rest, his as one of this divisor. */
  const maximise = async (view, divisor) => {
    await ann.locator(`#picture-${view}`).focus();
    await ann.keyboard.press('Enter');
    await full(ann, view);
    await until(
      async () => [(await header(ann, view)).full_px, (await header(ben, view)).full_px, await divisorOf(ben, view)],
      ([own, his, by]) => by === divisor && Math.abs(own[0] - his[0]) < divisor && own[0] > 900,
    );
    await full(ben, view);
  };
  const restore = async (view) => {
    await ann.locator(`#picture-${view}`).focus();
    await ann.keyboard.press('Enter');
    await full(ann, 1);
  };

  before(async () => {
    world = await startWorld();
    room = await world.newRoom();
    ann = await world.newPage(`rooms/${room}`, { viewport: { width: 1603, height: 1001 } });
    await full(ann, 1);
    ben = await world.newPage(`rooms/${room}`, { viewport: { width: 1100, height: 700 } });
    await Promise.all([ann, ben].flatMap((page) => [1, 2, 3, 4].map((view) => full(page, view))));
    await ann.locator('.point-tools').waitFor();
  });
  after(() => world?.stop());

  it('is sent the same picture in fewer pixels', async () => {
    await maximise(2, 2);
    const [own, his] = [await header(ann, 2), await header(ben, 2)];
    assert.deepEqual(
      [his.width_px, his.height_px],
      [own.width_px, own.height_px].map((side) => Math.ceil(side / 2)),
    );
    assert.equal(his.scene_revision, own.scene_revision);
    assert.equal(his.render_us, own.render_us, 'drawn once');
    assert.ok((await boxOf(ben, 2)).width <= his.width_px + 1, 'each pixel of his screen has one of its own');
    const grey = await difference(ann, ben, 2, 2);
    assert.ok(grey < 2, `${grey} grey levels apart`); // both are JPEGs of quality 92
    assert.equal(await ben.evaluate(() => globalThis.beamroom.stats().badges[2]), 'full');
    await shoot(ben, 'sizes-half');
  });

  it('has crosshair, scale bar and pointer of the presenter on the same anatomy', async () => {
    const { x, y, width, height } = await ann.locator('#picture-2').boundingBox();
    const s = (await world.scene(room)).image.slices.axial.position_mm;
    const before = crosshairOf(await world.scene(room));
    const place = [Math.round(width * 0.61), Math.round(height * 0.27)];
    await ann.mouse.click(x + place[0], y + place[1]);
    const point = await axialPoint(ann, 2, place, s);
    const set = await until(
      async () => crosshairOf(await world.scene(room)),
      (now) => inMm(now, before) > 1,
    );
    assert.ok(inMm(set, point) < 0.6, `${set}, clicked at ${point}`);
    const cross = () =>
      ben.evaluate(() => {
        const ends = [...document.querySelectorAll('[data-view="2"] .overlay .crosshair line')].map((line) =>
          ['x1', 'y1', 'x2', 'y2'].map((name) => Number(line.getAttribute(name))),
        );
        return { x: ends.find(([x1, , x2]) => x1 === x2)?.[0] ?? -1, y: ends.find(([, y1, , y2]) => y1 === y2)?.[1] ?? -1 };
      });
    const [at] = await until(
      async () => [await cross(), await project(ben, 2, set)],
      ([now, expected]) => near(now, expected, 0.5),
    );
    assert.ok(inMm(await axialPoint(ben, 2, [at.x, at.y], s), set) < 0.5);

    const [left, right] = [await project(ben, 2, [0, 0, s]), await project(ben, 2, [100, 0, s])];
    const bar = await ben.evaluate(() => {
      const group = document.querySelector('[data-view="2"] .overlay .scale');
      return (
        group && {
          px: group.querySelector('line, path, rect').getBBox().width,
          mm: Number.parseFloat(group.textContent) * (group.textContent.includes('cm') ? 10 : 1),
        }
      );
    });
    assert.ok(bar && Math.abs(bar.px / bar.mm - Math.hypot(left[0] - right[0], left[1] - right[1]) / 100) < 0.01, JSON.stringify(bar));

    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('p');
    await ann.locator('.point-tools [aria-pressed="true"]').waitFor();
    const shown = await axialPoint(ann, 2, await pointAt(ann, 2, [0.37, 0.58]), s);
    const there = await until(
      async () => {
        await pointAt(ann, 2, [0.37, 0.58]);
        return mark(ben, 2);
      },
      (now) => now !== null,
    );
    assert.ok(inMm(await axialPoint(ben, 2, [there.x, there.y], s), shown) < 0.5, 'his mark is on her point');
    await ann.keyboard.press('Escape');
    await restore(2);
  });

  it('picks in 3-D what the presenter has under the same place', async () => {
    await ben.setViewportSize({ width: 1100, height: 500 });
    await maximise(1, 4);
    const box = await boxOf(ben, 1);
    await ben.locator('#picture-1').focus();
    await ben.keyboard.press('p');
    await ben.locator('.point-tools [aria-pressed="true"]').waitFor();
    const [px, py] = await pointAt(ben, 1, [0.52, 0.62]);
    // the place in pixels of the whole picture: each of his is 4 x 4 of hers
    const { width_px: across } = await header(ben, 1);
    const [wholeX, wholeY] = [px - box.x, py - box.y].map((part) => (part / box.width) * across * 4);
    const hers = await boxOf(ann, 1);
    const { width_px: whole } = await header(ann, 1);
    const expected = [hers.x + (wholeX * hers.width) / whole, hers.y + (wholeY * hers.width) / whole];
    const at = await until(
      async () => {
        await pointAt(ben, 1, [0.52, 0.62]);
        return mark(ann, 1, 'm2');
      },
      (now) => now !== null,
    );
    assert.ok(near(at, expected, 0.5), `${JSON.stringify(at)}, expected ${expected}`);
    await ben.keyboard.press('Escape');
  });

  it('is sent more pixels when the window grows, and drawn is nothing for that', async () => {
    const drawn = (await header(ben, 1)).render_us;
    await ben.setViewportSize({ width: 1603, height: 1001 });
    await ben.locator('#picture-1').focus();
    await ben.keyboard.press('Enter');
    const whole = await until(
      () => header(ben, 1),
      ({ full_px, width_px }) => full_px[0] === width_px,
    );
    assert.equal(whole.render_us, drawn);
    assert.deepEqual(world.errors, []);
  });
});
