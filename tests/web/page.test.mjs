// The page in a real browser against the real daemon. Screenshots stay in build/test-artifacts/.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, demo, sleep } from '../api/daemon.mjs';
import { bytesOf, full, header, later, missing, once, shoot, startWorld } from './browser.mjs';

/** In the browser: mean and spread of grey over a pane's picture, and a fingerprint of it. */
const look = (page, view) =>
  page.evaluate((n) => {
    const canvas = document.querySelector(`[data-view="${n}"] canvas`);
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0;
    let lit = 0;
    let print = 0;
    for (let at = 0; at < data.length; at += 4) {
      sum += data[at];
      lit += data[at] > 40;
      print = (print * 31 + data[at] * 3 + data[at + 1]) | 0;
    }
    return { mean: sum / (data.length / 4), lit: lit / (data.length / 4), print };
  }, view);

const letters = (page, view) => page.locator(`[data-view="${view}"] [data-letters]`).getAttribute('data-letters');
/** Until the first pane has these letters. */
const turned = (page, expected) =>
  page.waitForFunction((text) => document.querySelector('[data-view="1"] [data-letters]').dataset.letters === text, expected);

/** The daemon's renderer for the one plan that is open. */
function rendererOf({ pid }) {
  const children = readdirSync(`/proc/${pid}/task`).flatMap((task) =>
    readFileSync(`/proc/${pid}/task/${task}/children`, 'utf8').trim().split(' ').filter(Boolean).map(Number),
  );
  return children.find((child) => readFileSync(`/proc/${child}/cmdline`, 'utf8').includes('beamroom-render'));
}

describe('the page', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-page-'));
    mkdirSync(join(folder, 'plans/broken-head'), { recursive: true });
    writeFileSync(
      join(folder, 'plans/broken-head/plan.json'),
      JSON.stringify({ format: 'beamroom-plan', version: 1, name: 'Broken head', images: [{ id: 'ct', path: 'ct.nii' }] }),
    );
    writeFileSync(join(folder, 'plans/broken-head/ct.nii'), 'no image at all');
    world = await startWorld({ plans: [join(folder, 'plans')] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const drag = async (page, view, dx, dy, { release = true } = {}) => {
    const box = await page.locator(`#picture-${view}`).boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let step = 1; step <= 10; step++) {
      await page.mouse.move(x + (dx * step) / 10, y + (dy * step) / 10);
      await sleep(20);
    }
    if (release) await page.mouse.up();
  };

  once('says why a plan is refused and loads nothing of it', async () => {
    const page = await world.newPage();
    const refusal = page.locator('[data-plan="broken-head"] .refusal');
    await refusal.waitFor();
    assert.match(await refusal.textContent(), /ct\.nii/);
    await shoot(page, 'start-refused');
    assert.equal(
      await page.locator('[data-plan="broken-head"] button', { hasText: 'Open' }).count(),
      0,
      'what cannot be read cannot be opened',
    );
    await page.context().close();
  });

  once('opens a plan from the list: four pictures, each with the right letters', async () => {
    const page = await world.newPage();
    await page.locator('[data-plan="phantom"] button', { hasText: 'Open' }).click();
    await page.waitForURL(/\/rooms\/[a-z0-9-]+$/);
    for (const view of [1, 2, 3, 4]) await full(page, view);
    assert.equal(await letters(page, 1), 'RA LP S I', 'from the front and the left, patient right on screen left');
    assert.equal(await letters(page, 2), 'R L A P');
    assert.equal(await letters(page, 3), 'A P S I');
    assert.equal(await letters(page, 4), 'R L S I');
    for (const view of [1, 2, 3, 4]) assert.ok((await look(page, view)).lit > 0.1, `pane ${view} shows the head`);
    assert.ok(await page.locator('.tag.phantom').isVisible(), 'a phantom is labelled as one');
    await shoot(page, 'room');
    await page.setViewportSize({ width: 1180, height: 820 });
    await full(page);
    await shoot(page, 'room-1180x820');
    await page.context().close();
  });

  once('turns by dragging, and ends with a full picture and turned letters', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`);
    await full(page);
    const before = await look(page, 1);
    await drag(page, 1, 225, 0); // 90 degrees at 0.4 degrees a pixel: the front turns to screen right, the eye from 30 degrees left to 60 right
    await turned(page, 'PR AL S I');
    await full(page);
    assert.ok((await page.evaluate(() => globalThis.beamroom.stats().input_to_paint_ms.length)) > 0);
    assert.notEqual((await look(page, 1)).print, before.print);
    assert.equal((await header(page, 1)).scale_percent, 100);
    await page.locator('#picture-1').focus();
    await page.keyboard.press('r');
    await turned(page, 'RA LP S I');
    await page.context().close();
  });

  it('back and forward go between start page and rooms; the token of a link leaves the address', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}#link=${'0'.repeat(32)}`);
    await page.locator('.ended').waitFor(); // a link that lets nobody in
    assert.equal(page.url(), `${world.daemon.url}/rooms/${room}`);
    await page.locator('.ended a', { hasText: 'All plans' }).click();
    await page.locator('.start [data-plan]').first().waitFor();
    assert.equal(page.url(), `${world.daemon.url}/`);
    await page.goBack();
    await page.locator('.room').waitFor();
    assert.equal(page.url(), `${world.daemon.url}/rooms/${room}`);
    await page.goForward();
    await page.locator('.start').waitFor();
    await page.goto(`${world.daemon.url}/#/rooms/not-there/phantom`); // an address of the time when rooms were fragments
    await page.locator('.ended', { hasText: 'There is no room at this address' }).waitFor();
    assert.equal(page.url(), `${world.daemon.url}/rooms/not-there`);
    await page.context().close();
  });

  once('hides a region through the tree and changes the window by a key', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    const before = await look(page, 1);
    await page.locator('[data-region="scalp"] .eye').click();
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[1].scene_revision > 1);
    await full(page);
    assert.notEqual((await look(page, 1)).print, before.print);
    const scene = (await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`)).json;
    assert.equal((scene.scene ?? scene).regions.scalp.visible, false);
    const slice = await look(page, 2);
    await page.locator('#picture-2').focus();
    await page.keyboard.press('4'); // bone: centre 480, so soft tissue gets darker
    await page.waitForFunction(() => document.querySelector('[data-view="2"] .overlay:not(.clip-lines)').textContent.includes('C 480'));
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[2].scene_revision > 2);
    await full(page, 2);
    assert.ok((await look(page, 2)).mean < slice.mean - 3);
    await page.context().close();
  });

  once('takes a plan that is dropped or chosen, shows it, and deletes it after a second question', async () => {
    const page = await world.newPage();
    await page.locator('[aria-label="Folder of a plan"]').setInputFiles(join(demo, 'phantom'));
    const naming = page.locator('.upload form');
    await naming.waitFor();
    assert.match(await naming.textContent(), /phantom.*no patient's name/s);
    await shoot(page, 'start-upload-naming');
    await naming.locator('input').fill('Phantom 2');
    await naming.locator('button', { hasText: 'Send' }).click();
    const row = page.locator('[data-plan="phantom-2"]');
    await row.waitFor({ timeout: 60000 });
    await shoot(page, 'start-uploaded');
    assert.match(await row.textContent(), /Phantom: modified Snyder head/);
    const id = await row.getAttribute('data-plan');
    await row.locator('button', { hasText: 'Open' }).click();
    await full(page);
    assert.ok((await look(page, 1)).lit > 0.02);
    await page.goto(`${world.daemon.url}/#/`);
    await page.locator(`[data-plan="${id}"] [aria-label^="Delete"]`).click();
    await page.locator('button', { hasText: 'Keep' }).click();
    await page.locator(`[data-plan="${id}"] [aria-label^="Delete"]`).click();
    await shoot(page, 'start-delete');
    await page.locator('button', { hasText: 'Delete for good' }).click();
    await page.locator(`[data-plan="${id}"]`).waitFor({ state: 'detached' });
    assert.equal((await call(`${world.daemon.url}/api/v1/plans/${id}`)).status, 404);
    await page.context().close();
  });

  once('says why an archive was refused, and keeps nothing of it', async () => {
    const page = await world.newPage();
    await page
      .locator('[aria-label="Files of a plan"]')
      .setInputFiles([{ name: 'notes.zip', mimeType: 'application/zip', buffer: Buffer.from('no archive at all') }]);
    await page.locator('.upload input[name="name"]').press('Enter');
    const refusal = page.locator('.upload [role="alert"]');
    await refusal.waitFor();
    assert.match(await refusal.textContent(), /Nothing was kept/);
    await shoot(page, 'start-upload-refused');
    await page.locator('.upload button', { hasText: 'Dismiss' }).click();
    await page.locator('.upload').waitFor({ state: 'detached' });
    await page.context().close();
  });

  later("shows the box of a dose's grid", async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    const before = await look(page, 1);
    await page.locator('[data-dose="goorley"] button.name').click();
    await page.getByRole('button', { name: 'Box of the grid' }).click();
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[1].scene_revision > 1);
    await full(page);
    assert.notEqual((await look(page, 1)).print, before.print);
    const { json } = await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`);
    assert.deepEqual([(json.scene ?? json).dose.id, (json.scene ?? json).dose.grid], ['goorley', true]);
    await page.context().close();
  });

  once('downloads the surface of the chosen region in three formats', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`);
    await full(page);
    await page.locator('[data-region="tumour"] button.name').click();
    const links = page.locator('[aria-label="Download the surface"] a');
    await links.first().waitFor();
    assert.deepEqual(await links.allTextContents().then((words) => words.map((word) => word.trim())), ['STL', 'PLY', 'GLB']);
    await shoot(page, 'downloads');
    for (const [at, ending, magic] of [
      [0, 'stl', 'Beamroom mm LPS tumour'],
      [1, 'ply', 'ply\n'],
      [2, 'glb', 'glTF'],
    ]) {
      const [download] = await Promise.all([page.waitForEvent('download'), links.nth(at).click()]);
      assert.equal(download.suggestedFilename(), `phantom-tumour.${ending}`);
      assert.equal((await bytesOf(download)).subarray(0, magic.length).toString(), magic);
    }
    await page.context().close();
  });

  later('draws the surfaces by the algorithm chosen below a region', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    const before = await look(page, 1);
    await page.locator('[data-region="tumour"] button.name').click();
    await page.locator('[aria-label="Surface"] >> text=8-cell').click();
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[1].scene_revision > 1);
    await full(page);
    assert.notEqual((await look(page, 1)).print, before.print);
    const scene = (await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`)).json;
    assert.equal((scene.scene ?? scene).surface.algorithm, 'eight-cell');
    await shoot(page, 'room-eight-cell');
    await page.context().close();
  });

  later('shows a region in every way there is, each picture new and soon, with its figures', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    await page.locator('[data-region="tumour"] button.name').click();
    const { scene_revision: before } = await header(page, 1);
    await page.locator('button', { hasText: 'Solo' }).click();
    await page.waitForFunction((old) => globalThis.beamroom.stats().headers[1].scene_revision > old, before); // or its picture counts as the first of the others
    await full(page);
    const prints = new Set();
    const figures = page.locator('dl.figures');
    for (const [name, made] of [
      ['Univels', /triangles/],
      ['Outlines', /outlines/],
      ['Points', /points/],
      ['Solid', /points/],
      ['NURBS', /triangles/],
      ['Fan', /triangles/],
      ['Surface', /triangles/],
    ]) {
      const revision = (await header(page, 1)).scene_revision;
      await page.locator(`[aria-label="Shown as"] >> text="${name}"`).click();
      await page.waitForFunction((old) => globalThis.beamroom.stats().headers[1].scene_revision > old, revision);
      await full(page);
      prints.add((await look(page, 1)).print);
      await page.waitForFunction((words) => new RegExp(words).test(document.querySelector('dl.figures')?.textContent ?? ''), made.source);
      assert.match(await figures.textContent(), /Made in/);
      await shoot(page, `room-${name.toLowerCase()}`);
    }
    assert.equal(prints.size, 7, 'seven different pictures');
    await page.context().close();
  });

  later('compares the methods on one region, and gives the table as CSV', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`);
    await full(page);
    await page.locator('[data-region="tumour"] button.name').click();
    await page.locator('button', { hasText: 'Compare methods' }).click();
    const dialog = page.locator('[aria-label="Methods compared"]');
    await dialog.locator('button:not([disabled])', { hasText: 'CSV' }).waitFor({ timeout: 60000 });
    const rows = await dialog.locator('tbody tr').allTextContents();
    assert.equal(rows.length, 14);
    assert.match(
      rows.find((row) => /Univels/.test(row)),
      /0\.00 %/,
      'univels enclose exactly themselves',
    );
    await shoot(page, 'compare');
    const [download] = await Promise.all([page.waitForEvent('download'), dialog.locator('button', { hasText: 'CSV' }).click()]);
    assert.equal((await bytesOf(download)).toString().trim().split('\n').length, 15);
    await page.keyboard.press('Escape');
    await dialog.waitFor({ state: 'detached' });
    await page.context().close();
  });

  later('lives through the death of the renderer in the middle of a drag', async () => {
    const page = await world.newPage(`rooms/${await world.newRoom()}`);
    await full(page);
    await drag(page, 1, 100, 0, { release: false });
    process.kill(rendererOf(world.daemon.child), 'SIGKILL');
    await page.locator('.toast >> text=Renderer restarting').waitFor({ timeout: 60000 });
    await shoot(page, 'room-restarting');
    await page.mouse.up();
    await page.locator('.toast >> text=Picture restored').waitFor({ timeout: 60000 });
    await full(page);
    assert.ok((await look(page, 1)).lit > 0.05);
    await drag(page, 1, 125, 0);
    await turned(page, 'PR AL S I');
    await page.context().close();
  });

  it('has had no error and nothing against the content security policy', () => assert.deepEqual([world.errors, world.refused], [[], []]));
});
