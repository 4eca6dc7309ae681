// Measures: drawn by mouse, keys and fingers, kept with the scene, edited by number, undone, one's own while on one's own, printed.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, later, missing, once, shoot, slowParts, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';
import { sizes } from './room_states.mjs';

const brain = { hounsfield: 38, noise: 5 }; // of the demo head, as core/phantom/head.c makes it

describe('measures on the page', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
  });

  const open = async (options = sizes.wide, room = null, slowMs = 0) => {
    const id = room ?? (await world.newRoom());
    const page = await world.newPage('', options);
    if (slowMs) await slowParts(page, slowMs);
    await page.goto(`${world.daemon.url}/rooms/${id}`);
    for (const view of options === sizes.phone ? [1] : [1, 2, 3, 4]) await full(page, view);
    const measures = async () => (await world.scene(id)).measures;
    const comes = async (test, words) => {
      const found = await until(measures, test, 20000);
      assert.ok(test(found), `${words}: ${JSON.stringify(found)}`);
      return found;
    };
    return { room: id, page, measures, comes };
  };
  const crosshairOf = ({ image: { slices } }) => [slices.sagittal, slices.coronal, slices.axial].map(({ position_mm: mm }) => mm);
  /** Place in the window of a patient point in a picture. */
  const placeOf = async (page, view, point) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    const m = Object.values((await header(page, view)).clip_from_lps_mm);
    const row = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
    return [box.x + ((row(0) / row(3) + 1) / 2) * box.width, box.y + ((1 - row(1) / row(3)) / 2) * box.height];
  };
  const drag = async (page, view, from, to) => {
    await page.mouse.move(...(await placeOf(page, view, from)));
    await page.mouse.down();
    await page.mouse.move(...(await placeOf(page, view, to)), { steps: 4 });
    await page.mouse.up();
  };
  const click = async (page, view, point) => page.mouse.click(...(await placeOf(page, view, point)));
  const kind = (page, name) => page.getByRole('radiogroup', { name: 'What is measured' }).getByRole('radio', { name }).click();
  const away = (a, b) => Math.hypot(...a.map((value, axis) => value - b[axis]));
  const places = ({ points }) => points.map(({ at_mm: at }) => at);
  const areAt = (measure, expected) =>
    places(measure).length === expected.length && places(measure).every((at, index) => away(at, expected[index]) < 0.1);
  const drawn = (page, view, id) => page.locator(`[data-view="${view}"] [data-measure="${id}"]`);

  once('every kind is drawn by mouse and says what geometry says, within 0.1 mm; in the panes of its plane and in 3-D', async () => {
    const { page, room, comes } = await open();
    const [L, P, S] = crosshairOf(await world.scene(room));
    await page.locator('[aria-label="Measure"]').click();

    await drag(page, 2, [-60, 10, S], [30, -30, S]); // 90 and 40: 98.5 mm
    const { m1 } = await comes(
      ({ m1: made }) =>
        made &&
        areAt(made, [
          [-60, 10, S],
          [30, -30, S],
        ]),
      'distance',
    );
    assert.ok(Math.abs(away(...places(m1)) - Math.hypot(90, 40)) < 0.1);
    assert.deepEqual({ ...m1, points: [] }, { kind: 'distance', name: '', author: 'Reviewer 1', visible: true, image: 'ct', points: [] });
    assert.match(await drawn(page, 2, 'm1').textContent(), /98\.5 mm/);
    assert.deepEqual(
      await Promise.all([1, 3, 4].map((view) => drawn(page, view, 'm1').count())),
      [1, 0, 0],
      'faintly in 3-D, not in planes that it crosses',
    );

    await kind(page, 'Angle');
    for (const point of [
      [-40, P, 0],
      [0, P, 0],
      [30, P, 30],
    ])
      await click(page, 4, point); // 180 - 45 degrees
    await comes(
      ({ m2 }) =>
        m2 &&
        areAt(m2, [
          [-40, P, 0],
          [0, P, 0],
          [30, P, 30],
        ]),
      'angle',
    );
    assert.match(await drawn(page, 4, 'm2').textContent(), /13[45]\.\d°/);

    await kind(page, 'Polyline');
    for (const point of [
      [-50, P, -30],
      [-50, P, 0],
    ])
      await click(page, 4, point);
    await page.mouse.dblclick(...(await placeOf(page, 4, [-10, P, -30]))); // 30 and 50
    await comes(
      ({ m3 }) =>
        m3 &&
        areAt(m3, [
          [-50, P, -30],
          [-50, P, 0],
          [-10, P, -30],
        ]),
      'polyline',
    );
    assert.match(await drawn(page, 4, 'm3').textContent(), /(80\.[01]|79\.9) mm/);

    await kind(page, 'Ellipse');
    await drag(page, 3, [L, 0, 0], [L, 20, 0]); // a circle: pi 20 20 mm2
    await comes(
      ({ m4 }) =>
        m4 &&
        areAt(
          m4,
          [
            [L, 0, 0],
            [L, 20, 0],
            [L, 0, 20],
          ].map((at, index) => (index === 2 ? places(m4)[2] : at)),
        ) &&
        Math.abs(away(...places(m4).filter((_, index) => index !== 1)) - 20) < 0.1,
      'ellipse',
    );
    await page.locator('[data-view="3"] [data-measure="m4"]', { hasText: 'HU' }).waitFor();
    const [, mean, sd] = /([\d.]+) ± ([\d.]+) HU/.exec(await drawn(page, 3, 'm4').textContent()).map(Number);
    assert.ok(Math.abs(mean - brain.hounsfield) < 1, `${mean} HU in the brain`); // of over 1000 voxels: 5 / 30
    assert.ok(sd > 1 && sd < brain.noise * 1.1, `${sd} HU: between voxels noise is averaged`);
    assert.match(await drawn(page, 3, 'm4').textContent(), /12\.(5\d|6\d) cm²/);

    await page.keyboard.press('Escape'); // the tool
    await page.locator('#picture-2').focus();
    await page.keyboard.press('ArrowUp');
    await drawn(page, 2, 'm1').waitFor({ state: 'detached' });
    await page.getByLabel('Crosshair to Distance 1').click();
    await drawn(page, 2, 'm1').waitFor();
    assert.equal(await page.locator('[role="tree"] [data-key^="measure:"]').count(), 4);
    await shoot(page, 'measure-wide');

    await page.context().close();
  });

  later('a point is dragged later, in one step to undo; by keys and numbers everything can be done too', async () => {
    const { page, room, comes, measures } = await open();
    const [L, P, S] = crosshairOf(await world.scene(room));
    await page.locator('#picture-2').focus();
    await page.keyboard.press('m');
    await page.keyboard.press('Enter'); // at the crosshair
    const moved = async (keys, axis, view) => {
      await page.locator(`#picture-${view}`).focus();
      for (const key of keys) await page.keyboard.press(key);
      await until(
        async () => crosshairOf(await world.scene(room))[axis],
        (now) => now !== [L, P, S][axis],
        20000,
      );
    };
    await moved(['PageUp', 'PageUp'], 0, 3); // the sagittal pane moves the crosshair along L, 20 voxels of 1 mm
    await page.locator('#picture-2').focus();
    await page.keyboard.press('Enter');
    await comes(
      ({ m1 }) =>
        m1 &&
        areAt(m1, [
          [L, P, S],
          [L + 20, P, S],
        ]),
      'by keys',
    );

    await page.keyboard.press('Escape');
    assert.equal(await page.locator('[aria-label="Crosshair"]').getAttribute('aria-pressed'), 'true');
    await drag(page, 2, [L + 20, P, S], [L - 30, P + 40, S]); // the chosen one's point, without the tool
    await comes(
      ({ m1 }) =>
        areAt(m1, [
          [L, P, S],
          [L - 30, P + 40, S],
        ]),
      'dragged',
    );
    assert.match(await drawn(page, 2, 'm1').textContent(), /(50\.[01]|49\.9) mm/);
    await page.getByRole('button', { name: /^Undo: points of a measure/ }).click();
    await comes(
      ({ m1 }) =>
        areAt(m1, [
          [L, P, S],
          [L + 20, P, S],
        ]),
      'undone',
    );

    const enter = async (label, value) => {
      await page.getByLabel(label, { exact: true }).fill(String(value));
      await page.getByLabel(label, { exact: true }).press('Enter');
    };
    await enter('Point 2, L in mm', L + 3);
    await enter('Point 2, P in mm', P + 4);
    await enter('Name of the measure', 'Midline shift');
    await comes(
      ({ m1 }) =>
        m1.name === 'Midline shift' &&
        areAt(m1, [
          [L, P, S],
          [L + 3, P + 4, S],
        ]),
      'by number',
    );
    await page.locator('.image-measured', { hasText: '5.0 mm' }).waitFor();
    await page.getByRole('button', { name: 'Show Midline shift in the pictures' }).click();
    await drawn(page, 2, 'm1').waitFor({ state: 'detached' });
    await comes(({ m1 }) => m1.visible === false, 'hidden');
    const kept = (await measures()).m1;
    await page.getByRole('button', { name: 'Delete Midline shift' }).click();
    await comes((now) => !now.m1, 'deleted');
    await page.getByRole('button', { name: /^Undo: measure/ }).click();
    await comes(({ m1 }) => JSON.stringify(m1) === JSON.stringify(kept), 'back as it was');

    await kind(page, 'Ellipse');
    await page.getByRole('button', { name: 'Add at the crosshair' }).click();
    await comes(({ m2 }) => m2?.kind === 'ellipse' && m2.points.length === 3, 'added by a button');
    await page.locator('#picture-2').focus();
    await page.keyboard.press('m');
    await page.keyboard.press('Enter');
    await page.keyboard.press('Escape'); // what is being drawn, not the tool
    assert.equal(await page.locator('[aria-label="Measure"]').getAttribute('aria-pressed'), 'true');
    assert.equal(await page.locator('[data-measure="draft"]').count(), 0);
    await page.locator('.help, [aria-label="Help"]').first().click();
    assert.match(await page.locator('.help-keys').textContent(), /Measure in a slice/);
    await page.context().close();
  });

  later("who follows measures for the room, who is on their own for themselves; the report to print lists the room's", async () => {
    const { page, room, comes, measures } = await open();
    const [, , S] = crosshairOf(await world.scene(room));
    const other = (await open(sizes.wide, room)).page;
    await page.keyboard.press('Escape');
    await page.locator('[aria-label="Measure"]').click();
    await drag(page, 2, [0, 0, S], [50, 0, S]);
    await comes(
      ({ m1 }) =>
        m1 &&
        areAt(m1, [
          [0, 0, S],
          [50, 0, S],
        ]),
      "the presenter's",
    );
    await drawn(other, 2, 'm1').waitFor();
    await other.locator('[aria-label="Measure"]').click();
    await drag(other, 2, [10, 20, S], [10, 30, S]);
    await drawn(page, 2, 'm2-m2').waitFor();
    assert.equal(await other.locator('.room-chip:visible').getAttribute('data-standing'), 'following');
    await page.locator('.image-list', { hasText: /Distance 2.*by Reviewer 2/s }).waitFor();
    await shoot(page, 'measures-of-two');
    await other.keyboard.press('f');
    await drag(other, 2, [0, 20, S], [0, 50, S]);
    await drawn(other, 2, 'own1').waitFor();
    assert.match(await drawn(other, 2, 'own1').textContent(), /30\.0 mm/);
    assert.deepEqual(Object.keys(await measures()), ['m1', 'm2-m2']);
    assert.equal(await drawn(page, 2, 'own1').count(), 0);
    await other.getByRole('button', { name: 'Delete Distance 1' }).first().click(); // the presenter's: hidden for oneself only
    await drawn(other, 2, 'm1').waitFor({ state: 'detached' });
    assert.equal(await drawn(page, 2, 'm1').count(), 1);
    await other.context().close();
    await page.getByRole('button', { name: 'Snapshot', exact: true }).click();
    await page.getByRole('menuitem', { name: /^Report to print/ }).click();
    const table = page.locator('.printout [aria-label="Measures"] table');
    await table.waitFor();
    assert.match(await table.textContent(), /Distance 1.*50\.0 mm.*\(0\.0, 0\.0/s);
    await page.context().close();
  });

  for (const [size, options] of Object.entries(sizes))
    later(
      `${size}: axe-core finds nothing and no text lies over another while something is measured${options.hasTouch ? ', with fingers' : ''}`,
      async () => {
        const { page, room, comes } = await open(options, null, 500); // a quick hand draws before the tool's code is there
        const [, , S] = crosshairOf(await world.scene(room));
        /** Until the picture has the size of its pane. */
        const sized = (view) =>
          page.waitForFunction((n) => {
            const [painted, box] = [
              globalThis.beamroom.stats().headers[n],
              document.querySelector(`#picture-${n}`).getBoundingClientRect(),
            ];
            return (
              painted &&
              Math.abs(painted.width_px / devicePixelRatio - box.width) <= 1 &&
              Math.abs(painted.height_px / devicePixelRatio - box.height) <= 1
            );
          }, view);
        const settled = () =>
          page.waitForFunction(() =>
            [...document.querySelectorAll('.pane:not([hidden])')].every(
              (pane) => globalThis.beamroom.stats().badges[pane.dataset.view] === 'full',
            ),
          );
        const tool = page.locator('[aria-label="Measure"]').first();
        if (options.hasTouch) {
          if (size === 'phone') await page.locator('[aria-label="Pane"] button', { hasText: 'Axial' }).click();
          await tool.click();
          await page.locator('[aria-label="Close the sheet"]').click();
          await sized(2);
          await settled();
          const devtools = await page.context().newCDPSession(page);
          const touch = (type, points) =>
            devtools.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
          const [from, to] = [await placeOf(page, 2, [-30, 0, S]), await placeOf(page, 2, [30, 10, S])];
          await touch('touchStart', [from]);
          for (const part of [0.3, 0.6, 1])
            await touch('touchMove', [[from[0] + (to[0] - from[0]) * part, from[1] + (to[1] - from[1]) * part]]);
          await touch('touchEnd', []);
          await comes(
            ({ m1 }) =>
              m1 &&
              areAt(m1, [
                [-30, 0, S],
                [30, 10, S],
              ]),
            'drawn by a finger',
          );
          await page.locator('.dock button', { hasText: 'Selection' }).click();
        } else {
          await tool.click();
          await drag(page, 2, [-30, 0, S], [30, 10, S]);
          await comes(({ m1 }) => Boolean(m1), 'drawn');
          await kind(page, 'Ellipse');
          await page.getByRole('button', { name: 'Add at the crosshair' }).click();
          await comes(({ m2 }) => Boolean(m2), 'added');
        }
        await page.locator('.image-measured').waitFor();
        await settled();
        assert.deepEqual(await overlaps(page), []);
        assert.deepEqual(await axe(page), []);
        if (options.hasTouch)
          assert.deepEqual(
            await page
              .locator('#tab-panel :is(button, select, .field input)')
              .evaluateAll((all) =>
                all
                  .filter((one) => one.checkVisibility() && one.getBoundingClientRect().height < 43.5)
                  .map((one) => one.getAttribute('aria-label') ?? one.textContent),
              ),
            [],
            'for fingers',
          );
        await shoot(page, `measure-${size}`);
        await page.context().close();
      },
    );

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
