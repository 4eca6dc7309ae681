// Particle tracks on the page: rows and check-boxes, Selection, playing, limits of energy, lost particles and the camera that flies there, a track that is clicked.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe } from 'node:test';
import { call, demo, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, header, later, missing, newer, once, shoot, startWorld } from './browser.mjs';
import { sizes } from './room_states.mjs';

describe('particle tracks', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  let room;
  let page;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-tracks-'));
    const plan = join(folder, 'energies');
    mkdirSync(plan);
    for (const name of ['labels.nii.gz', 'labels.json']) cpSync(join(demo, 'phantom', name), join(plan, name));
    writeFileSync(
      join(plan, 'plan.json'),
      JSON.stringify({
        format: 'beamroom-plan',
        version: 1,
        regions: [{ path: 'labels.nii.gz', names: 'labels.json' }],
        tracks: [{ path: 't.csv' }],
      }),
    );
    writeFileSync(
      join(plan, 't.csv'),
      'x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm,class,energy_mev\n-90,-150,0,90,-150,0,neutron-high,2\n-90,-150,40,90,-150,40,gamma-high,0.478\n0,0,300,0,0,310,lost,\n24,24,34,30,24,42,lost,0.01\n',
    );
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    rmSync(folder, { recursive: true, force: true });
  });

  const scene = () => world.scene(room);
  const comes = async (pick, suits, words) => {
    const value = await until(async () => pick(await scene()), suits, 30000);
    assert.ok(suits(value), `${words}: ${JSON.stringify(value)}`);
    return value;
  };
  const open = async (plan = 'phantom', options = sizes.wide) => {
    room = await world.newRoom(plan);
    page = await world.newPage(`rooms/${room}`, options);
    await full(page, 1);
  };
  const row = (id) => page.locator(`[data-key="tracks:${id}"]`);
  const pixelOf = async (view, point) => {
    const { x, y, width, height } = await page.locator(`#picture-${view}`).boundingBox();
    const m = Object.values((await header(page, view)).clip_from_lps_mm);
    const at = (r) => m[r] * point[0] + m[4 + r] * point[1] + m[8 + r] * point[2] + m[12 + r];
    return [x + ((at(0) / at(3) + 1) / 2) * width, y + ((1 - at(1) / at(3)) / 2) * height];
  };

  once('key T shows them, and the rows have the counts of the plan and a check-box for each class', async () => {
    await open();
    await page.locator('#picture-1').focus();
    const revision = (await header(page, 1)).scene_revision;
    await page.keyboard.press('t');
    await comes(
      (now) => now.tracks.visible,
      (on) => on === true,
      'visible',
    );
    await newer(page, 1, revision);
    await full(page, 1);
    const {
      json: {
        tracks: { segments, classes },
      },
    } = await call(`${world.daemon.url}/api/v1/plans/phantom`);
    assert.equal(await row('').locator('.tail').innerText(), String(segments));
    for (const [id, n] of Object.entries(classes)) assert.equal(await row(id).locator('.tail').innerText(), String(n), id);
    await row('gamma-high').locator('input').uncheck();
    await comes(
      (now) => now.tracks.classes.gamma_high,
      (on) => on === false,
      'the class that was unchecked',
    );
    await row('').click();
    await page.locator('#track-shown', { hasText: `${segments - classes['gamma-high']} shown` }).waitFor();
    const text = await page.locator('.track-counts').innerText();
    assert.match(text, new RegExp(`Gamma high\\s+${classes['gamma-high']}\\s`));
    // keys act from the tree, too
    for (const isOn of [false, true]) {
      await page.keyboard.press('t');
      await comes(
        (now) => now.tracks.visible,
        (on) => on === isOn,
        'by T in the tree',
      );
    }
  });

  once('by keyboard alone a class is found and hidden, and shown again', async () => {
    const tree = page.locator('.tree [role="tree"]');
    await tree.focus();
    for (let i = 0; i < 60 && !(await row('lost').evaluate((item) => item.classList.contains('current'))); i++)
      await page.keyboard.press('ArrowDown');
    await page.keyboard.press(' ');
    await comes(
      (now) => now.tracks.classes.lost,
      (on) => on === false,
      'hidden',
    );
    await page.keyboard.press(' ');
    await comes(
      (now) => now.tracks.classes.lost,
      (on) => on === true,
      'shown',
    );
  });

  once('playing draws more and more segments in the order of the file, and pauses where it is', async () => {
    await page.getByLabel('Time for all segments').selectOption('120'); // longer than the test
    await page.getByRole('button', { name: 'Play', exact: true }).click();
    await comes(
      (now) => now.tracks.count,
      (n) => n > 20,
      'while playing',
    );
    await page.getByRole('button', { name: 'Pause', exact: true }).click();
    await page.getByRole('button', { name: 'Play', exact: true }).waitFor();
    const value = await page.getByLabel('Number of segments drawn').inputValue();
    await comes(
      (now) => now.tracks.count,
      (n) => n === Number(value),
      `paused at ${value}`,
    );
    await page.getByLabel('Number of segments drawn').fill('1000');
    await page.keyboard.press('Enter');
    await comes(
      (now) => now.tracks.count,
      (n) => n === null,
      'all',
    );
  });

  once('width, depth cue and clipping are those of the scene', async () => {
    await page.getByLabel('Width of the lines in pixels').fill('3');
    await page.keyboard.press('Enter');
    await page.getByLabel('Darker far away').uncheck();
    await page.getByLabel('Cut by clip planes').uncheck();
    await comes(
      (now) => [now.tracks.width_px, now.tracks.depth_cue, now.tracks.clipped].join(),
      (all) => all === '3,false,false',
      'drawing',
    );
  });

  once('a click on the beam line alone picks it, with its data and a mark in the picture', async () => {
    for (const id of ['neutron-high', 'neutron-medium', 'neutron-low', 'gamma-medium', 'gamma-low', 'lost'])
      await row(id).locator('input').uncheck();
    await comes(
      (now) => Object.values(now.tracks.classes).filter(Boolean).length,
      (n) => n === 1,
      'only the beam line',
    );
    await full(page, 1);
    await page.mouse.click(...(await pixelOf(1, [0, 0, 118])));
    await page.getByRole('heading', { name: /^Track 0 Beam line/ }).waitFor();
    const text = await page.locator('.track-one').innerText();
    assert.match(text, /Length\s+140\.0 mm/); // of the phantom: from S 150 mm to the brain's middle at S 10 mm
    assert.match(text, /From\s+L 0\.0\s+P 0\.0\s+S 150\.0 mm\s+outside all regions\s+To\s+L 0\.0\s+P 0\.0\s+S 10\.0 mm\s+brain/);
    assert.equal(await page.locator('[data-view="1"] .track-chosen').count(), 1);
    assert.equal(await page.locator('[data-view="2"] .track-chosen').count(), 0);
    await shoot(page, 'tracks-picked');
    await page.close();
  });

  later('lost particles are listed with their region, and "Fly to" centres 3-D there, in the same direction', async () => {
    await open('energies');
    await row('lost').locator('button.name').click();
    const list = page.locator('.track-lost li');
    await list.nth(1).waitFor();
    assert.match(await list.nth(0).innerText(), /outside all regions\s+L 0\.0\s+P 0\.0\s+S 300\.0 mm/);
    assert.match(await list.nth(1).innerText(), /tumour\s+L 24\.0\s+P 24\.0\s+S 34\.0 mm/);
    const forward = ({ clip_from_lps_mm: m }) => [3, 7, 11].map((i) => m[i]); // the row of w grows along the line of sight
    const before = await header(page, 1);
    const unit = (v) => v.map((x) => x / Math.hypot(...v));
    await page.getByRole('button', { name: 'Fly to the particle lost in segment 3' }).click();
    await comes(
      ({ image: { slices } }) => [slices.sagittal, slices.coronal, slices.axial].map(({ position_mm: mm }) => mm).join(),
      (mm) => mm === '24,24,34',
      'the crosshair',
    );
    const { x, y, width, height } = await page.locator('#picture-1').boundingBox();
    const isCentred = ([px, py]) => Math.hypot(px - x - width / 2, py - y - height / 2) < 2;
    const at = await until(() => pixelOf(1, [24, 24, 34]), isCentred, 30000);
    assert.ok(isCentred(at), `${at} in the middle of ${[x, y, width, height]}`);
    const [a, b] = [unit(forward(before)), unit(forward(await header(page, 1)))];
    assert.ok(Math.hypot(...a.map((value, i) => value - b[i])) < 1e-5, `${a} and ${b}`);
  });

  later('limits of energy are there for a file that has energies, and count with those that have none', async () => {
    await page.getByLabel('Lowest energy in MeV').fill('0.1');
    await page.keyboard.press('Enter');
    await comes(
      (now) => now.tracks.energy_low_mev,
      (mev) => mev === 0.1,
      'lowest',
    );
    await row('lost').locator('input').check();
    await page.locator('#track-shown', { hasText: '3 shown' }).waitFor(); // without the one of 0.01 MeV
    await page.getByLabel('Lowest energy in MeV').fill('');
    await page.keyboard.press('Enter');
    await comes(
      (now) => now.tracks.energy_low_mev,
      (mev) => mev === null,
      'no limit',
    );
    await page.locator('#track-shown', { hasText: 'all shown' }).waitFor();
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'tracks-energies');
    await page.close();
  });

  later('on a tablet rows and Selection are in sheets, with targets for fingers inside the window', async () => {
    await open('phantom', sizes.tablet);
    await page.getByRole('button', { name: 'Parts' }).tap();
    await page.getByRole('tab', { name: 'Tracks' }).tap();
    await row('').locator('.eye').tap();
    await comes(
      (now) => now.tracks.visible,
      (on) => on === true,
      'visible',
    );
    await row('neutron-high').locator('input').tap();
    await comes(
      (now) => now.tracks.classes.neutron_high,
      (on) => on === false,
      'the class that was tapped',
    );
    await row('neutron-high').locator('button.name').tap();
    const play = page.getByRole('button', { name: 'Play', exact: true });
    await play.waitFor();
    const { width, height } = sizes.tablet.viewport;
    const box = await play.boundingBox();
    assert.ok(box.width >= 44 && box.height >= 44, JSON.stringify(box));
    for (const name of ['.track-counts', '.track-play']) {
      const { x, y, width: w, height: h } = await page.locator(name).boundingBox();
      assert.ok(x >= 0 && y >= 0 && x + w <= width && y + h <= height, name);
    }
    await full(page, 1);
    await shoot(page, 'tracks-tablet');
    assert.deepEqual(world.errors, []);
    await page.close();
  });
});
