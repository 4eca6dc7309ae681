// The page of a wall: what a room shows, at the wall's own pixels, on the screen of a meeting room.
import { after, before, describe, it } from 'node:test';
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { call, renderersOf, startDaemon, until } from '../api/daemon.mjs';
import { onDisk } from '../api/on_disk.mjs';
import { axe } from './axe.mjs';
import { full, later, missing, shoot, startWorld } from './browser.mjs';

const wallSize = { width: 1920, height: 1080 };
const names = ['3-D', 'Axial', 'Sagittal', 'Coronal'];
const framedMs = 1000; // after a wheel, where nothing else runs
const slack = 10; // where other tests run beside this one

/** Until the pictures of these views stand still on the wall, drawn for the newest scene. */
const drawn = (wall, views = [1, 2, 3, 4]) =>
  wall.waitForFunction((numbers) => {
    const { room } = globalThis.wall ?? {};
    return numbers.every((n) => {
      const { painted, behindSince } = room?.view(n) ?? {};
      return painted?.value?.is_still && !behindSince.value;
    });
  }, views);
const workedIn = (wall) => wall.evaluate(() => Number(document.querySelector('.wall-pane.worked-in')?.dataset.view ?? 0));
const shown = (wall) =>
  wall.evaluate(() =>
    [...document.querySelectorAll('.wall-pane')]
      .filter((pane) => !pane.hidden)
      .sort((a, b) => a.style.order - b.style.order)
      .map(({ dataset }) => Number(dataset.view)),
  );
const live = (wall, state) => wall.waitForFunction((is) => document.querySelector('.wall-live')?.dataset.state === is, state);
const text = (wall, selector) => wall.locator(selector).innerText();

/** Each picture: its pixels, those that it takes on the screen, those of the pane, those that the server drew. */
const pictures = (wall) =>
  wall.evaluate(() =>
    [...document.querySelectorAll('.wall-pane')]
      .filter((pane) => !pane.hidden)
      .map((pane) => {
        const [canvas, picture] = [pane.querySelector('canvas'), pane.querySelector('.wall-picture')];
        const box = canvas.getBoundingClientRect();
        const { width_px: width, height_px: height } = globalThis.wall.room.view(Number(pane.dataset.view)).painted.value;
        return [
          [canvas.width, canvas.height],
          [box.width, box.height],
          [picture.clientWidth, picture.clientHeight],
          [width, height],
        ];
      }),
  );

/** Every text that is seen, with the px that its letters have on the screen. */
const letterSizes = (wall) =>
  wall.evaluate(() => {
    const walker = document.createTreeWalker(document.querySelector('.wall'), NodeFilter.SHOW_TEXT);
    const list = [];
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      const box = element.getBoundingClientRect();
      if (!walker.currentNode.data.trim() || !box.width || !box.height || getComputedStyle(element).visibility === 'hidden') continue;
      const scaled = element.closest('.picture');
      const scale = scaled ? scaled.getBoundingClientRect().width / scaled.offsetWidth : 1;
      list.push({ words: walker.currentNode.data.trim(), px: Number.parseFloat(getComputedStyle(element).fontSize) * scale });
    }
    return list;
  });

/** Turns the wheel over a pane of the presenter. */
async function wheel(page, view, steps = 1) {
  const box = await page.locator(`#picture-${view}`).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 3);
  for (let step = 0; step < steps; step++) await page.mouse.wheel(0, 100);
}

describe('the page of a wall', { skip: missing && `${missing} is missing` }, () => {
  let world, data, room, presenter, wall;
  const patch = (scene) => call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', scene, { 'If-Match': '*' });
  before(async () => {
    data = mkdtempSync(join(tmpdir(), 'beamroom-wall-'));
    world = await startWorld({ data });
    room = await world.newRoom();
    presenter = await world.newPage(`rooms/${room}`, { viewport: { width: 1440, height: 900 } });
    await full(presenter);
    wall = await world.newPage(`display/${room}`, { viewport: wallSize });
    await drawn(wall);
  });
  after(async () => {
    if (world) world.daemon.child.kill('SIGCONT');
    await world?.stop();
    if (data) rmSync(data, { recursive: true, force: true });
  });

  it('shows four panes, each drawn at its own pixels, and nothing of it changes the presenter', async () => {
    const all = await pictures(wall);
    assert.equal(all.length, 4);
    for (const [own, ...others] of all) {
      for (const other of others) assert.deepEqual(other, own);
      assert.ok(own[0] > 800 && own[1] > 400, `${own}`);
    }
    assert.deepEqual(await shown(wall), [1, 2, 3, 4]);
    assert.deepEqual(await wall.locator('.wall-pane:not([hidden]) h2').allInnerTexts(), names);
    await live(wall, 'live');
    const ratios = await wall.evaluate(() => globalThis.wall.room.views.slice(0, 4).map(({ document }) => document.value.pixel_ratio));
    assert.deepEqual(ratios, [1.4, 1.4, 1.4, 1.4], 'lines are 1.4 times as wide');
    const size = await presenter.evaluate(() => globalThis.beamroom.stats().headers[2].full_px);
    const [width, height] = await presenter.evaluate(() => {
      const { width: w, height: h } = document.querySelector('[data-view="2"] canvas').getBoundingClientRect();
      return [Math.round(w), Math.round(h)];
    });
    assert.deepEqual(size, [width, height]);
    assert.deepEqual(await axe(wall), []);
  });

  it('loads few files: its modules are joined, as those of a room are', async () => {
    const loaded = await wall.evaluate(() =>
      performance
        .getEntriesByType('resource')
        .map(({ name }) => new URL(name).pathname)
        .filter((path) => /\.(js|css)$/.test(path)),
    );
    const joined = loaded.filter((path) => /^\/page\/wall-[0-9A-Z]{8}\.(js|css)$/.test(path));
    assert.deepEqual([...new Set(joined.map((path) => path.split('.').at(-1)))].sort(), ['css', 'js'], `${loaded}`);
    assert.ok(new Set(loaded).size <= 12, `${loaded}`);
    assert.deepEqual(
      loaded.filter((path) => path.startsWith('/js/') && path.endsWith('.js') && !path.endsWith('worker.js')),
      [],
    );
  });

  it('is named in the foot as the room is: by its plan and its day, then by the name that it is given', async () => {
    await wall.locator('.wall-foot', { hasText: /Phantom.*, \d+ \w+/ }).waitFor();
    const at = `${world.daemon.url}/api/v1/rooms/${room}`;
    assert.ok((await call(at, 'PATCH', { name: 'Second look' })).status < 300);
    await wall.locator('.wall-foot .wall-shrinks', { hasText: 'Second look' }).waitFor();
    await presenter.locator('.in-strip .chip-main[title^="Second look: "]').waitFor();
    await presenter.waitForFunction(() => document.title.startsWith('Second look – '));
    const long = 'Second look at both fields, with the dose of the first visit and of the second';
    assert.ok((await call(at, 'PATCH', { name: long })).status < 300);
    await wall.locator('.wall-foot .wall-shrinks', { hasText: long }).waitFor();
    const right = await wall.evaluate(() => document.querySelector('.wall-foot b').getBoundingClientRect().right);
    assert.ok(right <= wallSize.width, `a long name pushes nothing off the wall: ${right}`);
    await shoot(wall, 'wall-long-name');
    assert.ok((await call(at, 'PATCH', { name: null })).status < 300);
  });

  it('shows what the presenter sees, from the same side', async () => {
    await presenter.getByRole('button', { name: 'Look from anterior' }).first().click();
    await until(
      () => wall.locator('[data-view="1"] [data-letters]').getAttribute('data-letters'),
      (letters) => letters === 'R L S I',
    );
    assert.equal(await workedIn(wall), 1);
    await wheel(presenter, 2);
    const slice = (page) =>
      page.evaluate(() => (globalThis.wall?.room ?? globalThis.beamroom.room()).scene.value.image.slices.axial.position_mm);
    await drawn(wall);
    const shownAt = await text(wall, '[data-view="2"] .wall-where');
    assert.equal(shownAt, await presenter.locator('[data-view="2"] .where').innerText());
    assert.ok(Number.isFinite(await slice(wall)));
  });

  it('frames the pane that a wheel turns, and the foot names it; the quickest of four is framed within a second, or ten on a busy machine', async () => {
    const times = [];
    for (const view of [3, 2, 4, 1]) {
      const begun = performance.now();
      await wheel(presenter, view);
      await wall.waitForFunction((n) => document.querySelector('.wall-pane.worked-in')?.dataset.view === String(n), view, { polling: 20 });
      times.push(Math.round(performance.now() - begun));
      const name = names[view - 1];
      await until(
        () => text(wall, '.wall-foot'),
        (words) => words.includes(`four panes; Reviewer 1 works in ${name}`),
      );
    }
    assert.ok(Math.min(...times) < slack * framedMs, `${times} ms`);
    assert.equal(
      await wall.evaluate(() => {
        const { borderTopWidth, borderTopStyle } = getComputedStyle(document.querySelector('.worked-in'), '::after');
        return `${borderTopWidth} ${borderTopStyle}`;
      }),
      '2px solid',
    );
  });

  it('has bars, legend, values, pointers with names and measures, and no letter under 15 px', async () => {
    await patch({
      dose: { lines: { visible: true }, wash: { visible: true } },
      beam: { draft: { enabled: true, line: { entry_mm: [0, -120, 0], target_mm: [0, 0, 0] } } },
      measures: { mine: { kind: 'distance', points: [{ at_mm: [-30, 20, 32.8] }, { at_mm: [10, 40, 32.8] }] } },
      clip: { axial_high: { enabled: true, position_mm: 60 } },
      check: { visible: true },
    });
    const ben = await world.newPage(`rooms/${room}`, { viewport: { width: 1280, height: 720 } });
    await full(ben, 2);
    await ben.locator('#picture-2').focus();
    await ben.keyboard.press('p');
    const box = await ben.locator('#picture-2').boundingBox();
    await ben.mouse.move(box.x + box.width * 0.4, box.y + box.height * 0.4);
    await ben.mouse.move(box.x + box.width * 0.42, box.y + box.height * 0.42, { steps: 3 });
    const label = wall.locator('[data-view="2"] .person-pointer text');
    await label.waitFor();
    assert.equal(await label.textContent(), 'Reviewer 2');
    const places = await wall.evaluate(() => {
      const pane = document.querySelector('[data-view="2"]');
      const middle = (selector) => {
        const { left, right } = pane.querySelector(selector).getBoundingClientRect();
        return (left + right) / 2;
      };
      return [middle('.person-pointer .label rect'), middle('.person-pointer circle'), middle('.crosshair')];
    });
    assert.ok(places[0] < places[1], `the name stands left, the crosshair right: ${places}`);
    await wall.locator('.wall-bar.draft').waitFor();
    assert.match(await text(wall, '.wall-bar.draft'), /^Draft beam: the dose shown belongs to the planned beam\./);
    await wall.locator('.wall-levels li').first().waitFor();
    await wall.locator('.wall-check').waitFor();
    const labelPx = await wall.evaluate(() => {
      const label = document.createElementNS('http://www.w3.org/2000/svg', 'text'); // of an isodose line: those of this plan run along the target, where none stands
      label.setAttribute('class', 'halo dose-line-label');
      document.querySelector('[data-view="2"] .overlay').append(label);
      const px = Number.parseFloat(getComputedStyle(label).fontSize) * 1.4;
      label.remove();
      return px;
    });
    assert.ok(labelPx >= 15, `${labelPx}`);
    await wall.locator('.wall-column .wall-region', { hasText: /^tumour$/ }).waitFor(); // the innermost region at the crosshair
    const column = await text(wall, '.wall-column');
    for (const words of [
      'Weighted total',
      'Gy(w)',
      '100 % =',
      'surface beyond univels',
      'Regions',
      'tumour',
      'At the crosshair',
      'Here',
      'Reviewer 1',
      'Reviewer 2',
    ])
      assert.ok(column.includes(words), `${words} in ${column}`);
    const { slices } = (await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`)).json.image;
    const inferior = { ...slices, axial: { ...slices.axial, position_mm: -12 } };
    await patch({ image: { slices: inferior } });
    await until(
      () => text(wall, '.wall-column'),
      (words) => words.includes('S −12.0 mm'), // as the page says it, and headers of panes
    );
    await patch({ image: { slices } });
    await ben.mouse.move(box.x + box.width * 0.41, box.y + box.height * 0.41); // who rests for long points no more
    await until(
      () => text(wall, '.wall-top'),
      (words) => /^PHANTOM.*Reviewer 2 points.*Reviewer 1 presents.*Live.*\d\d:\d\d:\d\d$/s.test(words),
    );
    assert.match(await text(wall, '.wall-foot'), /patient right on screen left.*Research use/s);
    assert.equal(await wall.locator('.clip-line').count(), 2, 'the clip plane in two slices');
    assert.equal(await wall.locator('.clip-handle, input, a').count(), 0, 'nothing to be pressed');
    await drawn(wall);
    const small = (await letterSizes(wall)).filter(({ px }) => px < 14.99);
    assert.deepEqual(small, []);
    assert.deepEqual(await axe(wall), []);
    await shoot(wall, 'wall');
    await wall.setViewportSize({ width: 3840, height: 2160 });
    await wall.waitForFunction(
      () => globalThis.wall.room.view(2).painted.value?.full_px[0] > 1600 && globalThis.wall.room.view(2).painted.value.is_still,
    );
    assert.deepEqual(
      (await letterSizes(wall)).filter(({ px }) => px < 29.9),
      [],
      'twice as large at 4K',
    );
    for (const [own, ...others] of await pictures(wall)) for (const other of others) assert.deepEqual(other, own);
    await shoot(wall, 'wall-4k');
    await wall.setViewportSize(wallSize);
    await ben.context().close();
    await patch({ beam: { draft: { enabled: false } }, clip: { axial_high: { enabled: false } } });
    await wall.locator('.wall-bar.draft').waitFor({ state: 'detached' });
  });

  later('shows the pane worked in alone, or the presenter’s panes, as the presenter’s chip says; a reload changes nothing', async () => {
    await presenter.locator('.in-strip .chip-main').click();
    await presenter.getByRole('button', { name: 'the pane worked in' }).click();
    await until(
      () => shown(wall),
      (views) => views.length === 1,
    );
    await presenter.keyboard.press('Escape');
    await wheel(presenter, 3);
    const begun = performance.now();
    await until(
      () => shown(wall),
      (views) => views.join() === '3',
    );
    assert.ok(performance.now() - begun > 300, 'it goes over after 0.6 s');
    await drawn(wall, [3]);
    const [[own, ...others]] = await pictures(wall);
    for (const other of others) assert.deepEqual(other, own);
    assert.ok(own[0] > 1600, 'over the whole wall');
    await wall.reload();
    await drawn(wall, [3]);
    assert.deepEqual(await shown(wall), [3]);

    await presenter.locator('.in-strip .chip-main').click();
    await presenter.getByRole('button', { name: 'as the presenter' }).click();
    await presenter.keyboard.press('Escape');
    await until(
      () => shown(wall),
      (views) => views.join() === '1,2,3,4',
    );
    await presenter.locator('[aria-label="Maximise Coronal"]').click();
    await until(
      () => shown(wall),
      (views) => views.join() === '4',
    );
    await presenter.locator('[aria-label="Restore Coronal"]').click();
    await presenter.locator('.in-strip .chip-main').click();
    await presenter.locator('.roster-wall button', { hasText: 'four panes' }).click();
    await presenter.keyboard.press('Escape');
    await until(
      () => shown(wall),
      (views) => views.join() === '1,2,3,4',
    );
    await drawn(wall);
  });

  later('greys its pictures when the connection is lost, and goes on when it is back', async () => {
    world.daemon.child.kill('SIGSTOP');
    await live(wall, 'link');
    await live(wall, 'disconnected');
    assert.equal(await text(wall, '.wall-live'), 'Disconnected');
    assert.match(await wall.evaluate(() => getComputedStyle(document.querySelector('.wall-pane canvas')).filter), /grayscale/);
    assert.deepEqual(await axe(wall), []);
    world.daemon.child.kill('SIGCONT');
    await live(wall, 'live');
    await drawn(wall);
  });

  later('comes back by itself after its renderer was killed', async () => {
    const renderers = () => renderersOf(world.daemon.child.pid);
    const before = renderers();
    const told = wall.evaluate(
      () =>
        new Promise((done) => {
          const take = ({ detail }) => detail.type === 'renderer' && detail.state !== 'ready' && done(detail.state);
          globalThis.wall.world.connection.addEventListener('message', take);
        }),
    );
    for (const pid of before) process.kill(pid, 'SIGKILL');
    assert.notEqual(await told, 'ready');
    await wall.waitForFunction(() => globalThis.wall.room.renderer.value.state === 'ready');
    assert.equal(
      renderers().some((pid) => before.includes(pid)),
      false,
    );
    await wheel(presenter, 2, 2); // what is drawn from now on is of the new one
    await drawn(wall);
    await live(wall, 'live');
  });

  later('goes on by itself after the daemon was killed and started again', async () => {
    const host = new URL(world.daemon.url).host;
    const { revision } = (await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json;
    await until(
      () => onDisk(room, data),
      (kept) => kept?.revision >= revision,
    );
    const ended = new Promise((done) => world.daemon.child.on('exit', done));
    world.daemon.child.kill('SIGKILL');
    await ended;
    await live(wall, 'disconnected');
    assert.match(await wall.evaluate(() => getComputedStyle(document.querySelector('.wall-pane canvas')).filter), /grayscale/);
    world.daemon = await startDaemon({ args: ['--listen', host], data });
    await live(wall, 'live');
    await drawn(wall);
    assert.deepEqual(await shown(wall), [1, 2, 3, 4]);
    await full(presenter);
  });

  it('is ended from the roster by who presents, also where nobody signs in, and stays dark', async () => {
    await presenter.locator('.in-strip .chip-main').click();
    const row = presenter.locator('.room-members li', { hasText: 'wall' });
    await row.getByRole('button', { name: /^End it: Wall/ }).click();
    const sure = row.getByRole('button', { name: /^End it now: Wall/ });
    await sure.waitFor();
    assert.deepEqual(
      (await axe(presenter)).filter((line) => !line.includes('.avatar')), // that of who is away is pale
      [],
    );
    assert.equal(await wall.locator('.wall-said').count(), 0, 'pressed once, it is asked');
    await shoot(presenter, 'roster-end-wall');
    // it is asked for 5 s, and a busy machine may have looked for longer: pressed until it was pressed twice
    await until(
      async () => {
        await row
          .getByRole('button', { name: /^End it/ })
          .click({ timeout: 3000 })
          .catch(() => {});
        return wall.locator('.wall-said', { hasText: 'This wall has ended' }).count();
      },
      (n) => n > 0,
    );
    await row.waitFor({ state: 'detached' });
    await presenter.keyboard.press('Escape');
    const sides = await wall.evaluate(() => [...document.querySelectorAll('canvas')].map(({ width }) => width));
    assert.ok(
      sides.every((side) => side <= 16),
      `no picture stays: ${sides}`,
    );
  });

  it('names what it cannot show', async () => {
    const nowhere = await world.newPage('display/aaaa-aaaa');
    await nowhere.locator('.wall-said').waitFor();
    assert.match(await text(nowhere, '.wall-said'), /^This wall has ended: /);
    const odd = await world.newPage('display/');
    await until(
      () => odd.locator('body').innerText(),
      (words) => words.length > 0,
    );
    assert.deepEqual([world.errors, world.refused], [[], []]);
  });
});
