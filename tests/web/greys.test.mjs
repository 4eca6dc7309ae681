// An image whose low values are white: as the image asks, as the scene says, and from one image to the next.
import assert from 'node:assert/strict';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe } from 'node:test';
import { call, demo } from '../api/daemon.mjs';
import { readPng } from '../api/png.mjs';
import { full, header, later, missing, newer, once, shoot, startWorld } from './browser.mjs';

describe('greys on the page', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-greys-'));
    cpSync(join(demo, 'phantom'), join(folder, 'film'), { recursive: true });
    const file = join(folder, 'film/plan.json');
    const plan = JSON.parse(readFileSync(file, 'utf8'));
    plan.images = [
      { ...plan.images[0], id: 'film', inverted: true },
      { ...plan.images[0], id: 'usual' },
    ];
    writeFileSync(file, JSON.stringify(plan));
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  /** The axial slice, as red of every pixel. */
  const slice = async (image) => {
    const answer = await fetch(`${world.daemon.url}/api/v1/plans/film/render`, {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({
        scene: { outline: { on_slices: false }, image },
        view: { kind: 'axial', size_px: [200, 200] },
        format: 'png',
      }),
    });
    assert.equal(answer.status, 200);
    const picture = readPng(await answer.arrayBuffer());
    return Array.from({ length: 200 * 200 }, (_, at) => picture.at(at % 200, Math.floor(at / 200))[0]);
  };

  once('a plan says of each image which it is, and a picture of it is the other way round', async () => {
    await world.newRoom('film');
    const { json } = await call(`${world.daemon.url}/api/v1/plans/film`);
    assert.deepEqual(
      json.images.map((image) => image.is_inverted),
      [true, false],
    );
    const [own, black, usual, white] = await Promise.all([
      slice({ id: 'film' }),
      slice({ id: 'film', low_values: 'black' }),
      slice({ id: 'usual' }),
      slice({ id: 'usual', low_values: 'white' }),
    ]);
    assert.deepEqual(black, usual);
    assert.deepEqual(own, white);
    const darkest = 8; // red of the pane, which no grey is below
    const differ = own.filter((level, at) =>
      black[at] > darkest && level > darkest ? level + black[at] === 255 : level + black[at] >= 255,
    ).length;
    assert.ok(differ > own.length / 3, `${differ} of ${own.length} pixels are the other way round`); /* the rest lies beside the image */
  });

  later('the page shows which it is, switches it, and follows the next image', async () => {
    const room = await world.newRoom('film');
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    /* the panel's choice, and what the three slices say; fails when it does not come to that */
    const shows = (name, nSlices) =>
      page.waitForFunction(
        ([wanted, n]) =>
          document.querySelector('[aria-label="Low values"] [aria-checked="true"]')?.textContent === wanted &&
          [...document.querySelectorAll('text.caption')].filter((caption) => caption.textContent.includes('low white')).length === n,
        [name, nSlices],
      );
    const click = async (what) => {
      const { scene_revision: revision } = await header(page, 1);
      await page.locator(what).click();
      await newer(page, 1, revision);
    };
    const choose = (label, name) => click(`[aria-label="${label}"] >> text="${name}"`);
    await page.locator('.row:has-text("film") button.name').click();
    await shows('White', 3);
    await full(page, 2);
    await shoot(page, 'greys-white');
    await choose('Low values', 'Black');
    await shows('Black', 0);
    assert.equal((await world.scene(room)).image.low_values, 'black');
    await choose('Low values', 'White');
    await click('.row:has-text("usual") button.name');
    await shows('Black', 0);
    assert.equal((await world.scene(room)).image.low_values, 'own');
    await full(page, 2);
    await shoot(page, 'greys-black');
    await choose('Low values', 'White');
    await click('.row:has-text("film") button.name');
    await page.waitForFunction(() => document.querySelector('.row.selected')?.textContent.includes('film'));
    await shows('White', 3);
    assert.equal((await world.scene(room)).image.low_values, 'own');
    assert.deepEqual(world.errors, []);
  });
});
