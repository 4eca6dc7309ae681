// Snapshots in the browser: saved, dropped on the page and shown again; the report to print, as PDF.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe } from 'node:test';
import { bin, call } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { bytesOf, full, header, later, missing, newer, once, shoot, startWorld } from './browser.mjs';
import { textOfPages } from './pdf_text.mjs';

describe('snapshots', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-snapshots-'));
    const made = spawnSync(join(bin, 'beamroom'), ['phantom', join(folder, 'other'), '--size', '48x48x32']);
    assert.equal(made.status, 0, String(made.stderr));
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const menu = async (page, name) => {
    await page.getByRole('button', { name: 'Snapshot', exact: true }).click();
    await page.getByRole('menuitem', { name }).click();
  };
  const choose = (page, view) => page.locator(`#picture-${view}`).focus();
  const saved = async (page) => {
    const [download] = await Promise.all([page.waitForEvent('download'), menu(page, 'Save the active pane as PNG')]);
    return { name: download.suggestedFilename(), bytes: await bytesOf(download) };
  };
  const drop = (page, bytes, name = 'picture.png') =>
    page.evaluate(
      ([data, as]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([Uint8Array.from(data)], as));
        document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
      },
      [[...bytes], name],
    );
  const patch = (room, change) => call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', change, { 'If-Match': '*' });
  /** The picture that the server draws of the room's scene with the first view's camera. */
  const drawn = async (room, view) =>
    Buffer.from(
      await (
        await fetch(`${world.daemon.url}/api/v1/rooms/${room}/snapshot?view=${encodeURIComponent(JSON.stringify(view))}`)
      ).arrayBuffer(),
    );

  once('are saved with a caption and, dropped on the page, bring scene and view back', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page, 1);
    const before = await world.scene(room);
    const matrix = (await header(page, 1)).clip_from_lps_mm;
    const { name, bytes } = await saved(page);
    assert.match(name, /^phantom-3d-\d{8}T\d{6}Z\.png$/);
    assert.ok(bytes.readUInt32BE(16) >= 1200, 'wide enough for paper');
    const { scene_revision: revision } = await header(page, 1);
    const plain = await drawn(room, { size_px: [200, 150] });

    await patch(room, {
      regions: { scalp: { visible: false }, brain: { opacity: 0.9, color: '#00ff00' } },
      image: { window: { width: 90 }, slices: { axial: { position_mm: -20 } } },
      surface: { normals: 'face' },
    });
    await newer(page, 1, revision);
    await page.locator('#picture-1').focus();
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('ArrowUp');
    await page.waitForFunction(
      (old) => globalThis.beamroom.stats().headers[1].clip_from_lps_mm.some((value, at) => Math.abs(value - old[at]) > 1e-4),
      Object.values(matrix),
    );
    assert.notDeepEqual(await world.scene(room), before);
    assert.ok(!plain.equals(await drawn(room, { size_px: [200, 150] })));

    await drop(page, bytes);
    await page.getByText('Scene and view are as in the picture').waitFor();
    await page.waitForFunction(
      (old) => globalThis.beamroom.stats().headers[1].clip_from_lps_mm.every((value, at) => Math.abs(value - old[at]) < 1e-5),
      Object.values(matrix),
    );
    await full(page, 1);
    assert.deepEqual(await world.scene(room), before);
    assert.ok(plain.equals(await drawn(room, { size_px: [200, 150] })));
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  later('of another plan are said to be, and open that plan as it was in them', async () => {
    const other = await world.newRoom('other');
    await patch(other, { regions: { scalp: { visible: false } } });
    const page = await world.newPage(`rooms/${other}`);
    await full(page, 2);
    await choose(page, 2);
    const { name, bytes } = await saved(page);
    assert.match(name, /^other-axial-\d{8}T\d{6}Z\.png$/);
    const scene = await world.scene(other);

    await page.goto(`${world.daemon.url}/rooms/${await world.newRoom()}`);
    await full(page, 1);
    await drop(page, bytes);
    const dialog = page.getByRole('dialog', { name: 'Picture of another plan' });
    await dialog.waitFor();
    assert.match(await dialog.innerText(), /other/);
    await shoot(page, 'snapshot-other-plan');
    await dialog.getByRole('button', { name: /Open other/ }).click();
    await page.getByText('Scene and view are as in the picture').waitFor();
    await full(page, 2);
    const room = (await page.evaluate(() => location.pathname)).split('/')[2];
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[2].scene_revision > 1);
    assert.deepEqual(await world.scene(room), scene);

    // the same from the start page
    await page.goto(`${world.daemon.url}/#/`);
    await page.getByRole('button', { name: 'Upload' }).waitFor();
    await drop(page, bytes);
    await page.getByText('Scene and view are as in the picture').waitFor();
    const again = (await page.evaluate(() => location.pathname)).split('/')[2];
    await page.waitForFunction(() => globalThis.beamroom.stats().headers[2]?.scene_revision > 1);
    assert.notEqual(again, room);
    assert.deepEqual(await world.scene(again), scene);
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  later('that say nothing, or nonsense, change nothing and say why', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page, 1);
    const before = await world.scene(room);
    await drop(page, await drawn(room, { size_px: [64, 64] }));
    await page.getByText(/does not say what it shows/).waitFor();
    await drop(page, Buffer.from('no picture at all'), 'notes.txt');
    await page.getByText(/Only a snapshot as PNG can be dropped here/).waitFor();
    const { bytes } = await saved(page);
    bytes[bytes.indexOf('iTXt') + 40] ^= 1;
    await drop(page, bytes);
    await page.getByText('The text in the picture is damaged.').waitFor();
    assert.deepEqual(await world.scene(room), before);
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  later('become a report to print, with captions, figures and the research line on every page', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    for (const view of [1, 2, 3]) {
      await full(page, view);
      await choose(page, view);
      await menu(page, /Add it to the report/);
      await page.getByText(`In the report to print: ${view} picture`).waitFor();
    }
    await menu(page, /Report to print/);
    const dialog = page.getByRole('dialog', { name: 'Report to print' });
    await dialog.waitFor();
    assert.deepEqual(await dialog.locator('img').evaluateAll((images) => images.map(({ alt }) => alt.split(' ')[2])), [
      '3-D',
      'Axial',
      'Sagittal',
    ]);
    await dialog.getByLabel('Caption of Figure 2').fill('Tumour in the slice of its middle');
    await dialog.getByRole('button', { name: 'Figure 2 earlier' }).click();
    await dialog.getByRole('button', { name: 'Remove Figure 3' }).click();
    assert.equal(await dialog.locator('figure').count(), 2);
    await dialog.locator('.printout-bar button.primary:enabled').waitFor();
    await page.waitForFunction(
      () =>
        [...document.querySelectorAll('[aria-label="Figures of the regions"] tbody tr')].length === 5 &&
        !document.querySelector('.numbers-table').innerText.includes('…'),
    );
    await shoot(page, 'printout');

    const pages = textOfPages(await page.pdf({ preferCSSPageSize: true, path: 'build/test-artifacts/printout.pdf' }));
    assert.ok(pages.length >= 2 && pages.length <= 6, `${pages.length} pages`);
    for (const text of pages)
      assert.match(
        text,
        /PHANTOM · Phantom: modified Snyder head · printed \d{4}-\d\d-\d\d \d\d:\d\d UTC[+−]\d+(:\d\d)? · revision 1For research and plan review\. Not a medical device/,
      );
    const whole = pages.join('\n');
    pages.forEach((text, i) => assert.ok(text.startsWith(`Page ${i + 1} of ${pages.length}`), text));
    assert.match(pages[0], /^Page 1 of \dPhantom: modified Snyder headPlan/);
    assert.match(whole, /Figure 1\.\s*Tumour in the slice of its middle/);
    assert.match(whole, /Figure 2\./);
    assert.match(whole, /PatientPHANTOM.*Draftno draft beam stands/s);
    assert.match(
      whole,
      /Basis of the dose.*unitGy\(w\) per minute at 1e10 n\/cm²\/s.*boron in blood\s*\(ppm\)15.*CBE 3\.8.*100 %[\d.]+ Gy/s,
    );
    assert.match(whole, /898\u202f260/, 'no number is broken over two lines');
    const { sagittal, coronal, axial } = (await world.scene(room)).image.slices;
    const [left, posterior, superior] = [sagittal, coronal, axial].map(({ position_mm: mm }) => mm.toFixed(1));
    assert.ok(Math.min(left, posterior, superior) > 0, 'so that the letters are the same: L, P, S');
    assert.match(whole, new RegExp(`Crosshair at L ${left}, P ${posterior}, S ${superior} mm, CT [\\d.]+ HU, in tumour`));
    const { json: plan } = await call(`${world.daemon.url}/api/v1/plans/phantom`);
    const { json: surface } = await call(
      `${world.daemon.url}/api/v1/plans/phantom/regions/tumour/surface?representation=surface&algorithm=smooth`,
    );
    const tumour = plan.regions.find(({ id }) => id === 'tumour');
    assert.ok(
      whole.includes(
        `tumour${tumour.voxels}${tumour.volume_cm3.toFixed(2)}smooth${surface.triangles}${(surface.area_mm2 / 100).toFixed(1)}${(surface.volume_mm3 / 1000).toFixed(2)}`,
      ),
      whole,
    );
    assert.ok(!/Print or save|Remove|Latency/.test(whole), 'no controls on paper');

    for (let i = 0; i < 12; i++) {
      // the focus stays in the report
      await page.keyboard.press('Tab');
      assert.ok(
        await page.evaluate(() => document.activeElement === document.body || Boolean(document.activeElement.closest('.printout'))),
      );
    }
    await page.keyboard.press('Escape');
    await dialog.waitFor({ state: 'detached' });
    assert.equal(await page.evaluate(() => document.activeElement.ariaLabel), 'Snapshot', 'the focus goes back to the camera');
    await page.reload();
    await full(page, 1);
    await menu(page, /Report to print/);
    await dialog.waitFor();
    assert.equal(await dialog.locator('figure').count(), 2);
    assert.equal(await dialog.getByLabel('Caption of Figure 1').inputValue(), 'Tumour in the slice of its middle');
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  /** A film as the browser plays it, and how far each of its pictures at these seconds is from each of the stills, of 255. All in base 64. */
  const played = (page, film, stills, seconds) =>
    page.evaluate(
      async ([video_data, pictures, times]) => {
        const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
        const video = document.createElement('video');
        const loads = (one, name) =>
          new Promise((ok, no) => {
            one.addEventListener(name, ok, { once: true });
            one.addEventListener('error', () => no(new Error(one.error?.message ?? 'not loaded')), { once: true });
          });
        const pixels = (source, w, h) => {
          const canvas = new OffscreenCanvas(w, h);
          const context = canvas.getContext('2d', { willReadFrequently: true });
          context.drawImage(source, 0, 0);
          return context.getImageData(0, 0, w, h).data;
        };
        video.muted = true;
        document.body.append(video);
        let shownS = Number.NaN; // where the frame lies that is on the screen: a seek may end before its frame is
        const presented = (_now, { mediaTime }) => {
          shownS = mediaTime;
          video.requestVideoFrameCallback(presented);
        };
        video.requestVideoFrameCallback(presented);
        video.src = URL.createObjectURL(new Blob([bytes(video_data)], { type: 'video/webm' }));
        await loads(video, 'loadeddata');
        const images = await Promise.all(pictures.map((text) => createImageBitmap(new Blob([bytes(text)], { type: 'image/png' }))));
        const [w, h] = [images[0].width, images[0].height];
        const distance = (one, other) => one.reduce((sum, value, at) => sum + Math.abs(value - other[at]), 0) / one.length;
        const drawn = images.map((image) => pixels(image, w, h));
        const off = [];
        for (const second of times) {
          const seeked = loads(video, 'seeked');
          video.currentTime = second;
          await seeked;
          while (!(shownS <= second && second - shownS < 0.21)) await new Promise((done) => requestAnimationFrame(done));
          const frame = pixels(video, w, h);
          off.push(drawn.map((one) => distance(frame, one)));
        }
        return { width: video.videoWidth, height: video.videoHeight, stillHeight: h, duration: video.duration, off };
      },
      [film, stills, seconds],
    );

  const isJob = /\/api\/v1\/jobs\/[^/]+$/;
  /** Calls to these addresses wait until they are let go. */
  const held = (page, addresses) => {
    let letGo;
    const isFree = new Promise((free) => {
      letGo = free;
    });
    const isSet = page.route(addresses, (route) => isFree.then(() => route.continue()));
    return { isSet, letGo };
  };

  once('a film of a turn is ordered in the menu, made while the page goes on, and shows what the room showed', async () => {
    const room = await world.newRoom();
    await patch(room, { regions: { scalp: { visible: false }, brain: { color: '#00ff00', opacity: 1 } } });
    const page = await world.newPage(`rooms/${room}`);
    await full(page, 1);
    await choose(page, 2); // a slice: the film turns the pane into space
    await menu(page, /Film of a turn/);
    const dialog = page.getByRole('dialog', { name: 'Film of a turn' });
    await dialog.waitFor();
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'film-form');
    await dialog.getByRole('spinbutton', { name: 'Length' }).fill('1');
    await dialog.getByRole('spinbutton', { name: 'Length' }).press('Tab');
    await dialog.getByText('24 pictures of the scene', { exact: false }).waitFor();
    await dialog.getByRole('radio', { name: '12', exact: true }).click();
    const jobs = held(page, isJob); // the page does not learn that it is made before it has been looked at
    await jobs.isSet;
    const ordered = page.waitForResponse((answer) => answer.request().method() === 'POST' && answer.url().endsWith('/video'));
    await dialog.getByRole('button', { name: 'Make the film' }).press('Enter');
    await dialog.getByRole('progressbar', { name: 'Progress of the film' }).waitFor();
    await ordered;
    await patch(room, { regions: { brain: { color: '#ff0000' } } }); // the film is of the scene before
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('Escape');
    await dialog.waitFor({ state: 'detached' });
    jobs.letGo();
    await page.getByText('The film is made', { exact: true }).waitFor({ timeout: 120000 });
    await menu(page, /Film of a turn/);
    const [download] = await Promise.all([page.waitForEvent('download'), dialog.getByRole('button', { name: 'Save the film' }).click()]);
    assert.match(download.suggestedFilename(), /^phantom-turn-\d{8}T\d{6}Z\.webm$/);
    const film = (await bytesOf(download)).toString('base64');
    const view = encodeURIComponent(JSON.stringify({ kind: '3d', size_px: [640, 480] })); // nobody has moved the camera
    const still = async (color) => {
      await patch(room, { regions: { brain: { color } } });
      const answer = await fetch(`${world.daemon.url}/api/v1/rooms/${room}/snapshot?annotations=true&view=${view}`);
      return Buffer.from(await answer.arrayBuffer()).toString('base64');
    };
    const stills = [await still('#00ff00'), await still('#ff0000')];
    const blank = await world.newPage('healthz'); // a room's page plays no films
    const shown = await played(blank, film, stills, [0.01]);
    await blank.context().close();
    assert.deepEqual([shown.width, shown.duration], [640, 1]);
    const [same, other] = shown.off[0];
    assert.ok(same < 4 && other > 2 * same, `${same} off the scene as it was ordered, ${other} off the later one`);
    await dialog.getByRole('button', { name: 'Another film' }).click();
    await dialog.getByRole('radio', { name: 'quarter' }).waitFor();
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  once('a film that is cancelled while it is ordered is not made, and one whose server does not answer for a moment is', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page, 1);
    await menu(page, /Film of a turn/);
    const dialog = page.getByRole('dialog', { name: 'Film of a turn' });
    await dialog.getByRole('spinbutton', { name: 'Length' }).fill('1');
    await dialog.getByRole('spinbutton', { name: 'Length' }).press('Tab');
    await dialog.getByText('24 pictures of the scene', { exact: false }).waitFor();
    const orders = held(page, /\/rooms\/[^/]+\/video$/);
    await orders.isSet;
    const make = dialog.getByRole('button', { name: 'Make the film' });
    await make.press('Enter');
    await dialog.getByRole('button', { name: 'Cancel', exact: true }).press('Enter');
    await make.waitFor();
    const answers = (method, part) => page.waitForResponse((one) => one.request().method() === method && part.test(one.url()));
    const [ended] = await Promise.all([answers('DELETE', isJob), orders.letGo()]);
    assert.equal((await ended.json()).state, 'cancelled');
    assert.equal(await make.count(), 1, 'nothing goes on on the page');

    const ordered = answers('POST', /\/video$/);
    let nUnanswered = 0;
    let isAnswered = false;
    await page.route(isJob, (route) => {
      if (isAnswered || route.request().method() !== 'GET') return route.continue();
      nUnanswered++;
      return nUnanswered % 2 ? route.abort() : route.fulfill({ status: 503, body: '' });
    });
    await make.press('Enter');
    const { id } = await (await ordered).json();
    await dialog.getByRole('alert').getByText('The server does not answer now: it is asked again.').waitFor();
    while (nUnanswered < 3) await page.waitForRequest(isJob);
    assert.deepEqual(await axe(page), []);
    isAnswered = true;
    await dialog.getByRole('button', { name: 'Save the film' }).waitFor({ timeout: 120000 });
    assert.equal(await dialog.getByRole('alert').count(), 0);
    assert.equal((await call(`${world.daemon.url}/api/v1/jobs/${id}`)).json.state, 'done');
    await page.route(/\/jobs\/[^/]+\/video$/, (route) =>
      route.fulfill({ status: 404, json: { status: 404, detail: 'the film of the job is not kept any more' } }),
    );
    await dialog.getByRole('button', { name: 'Save the film' }).press('Enter');
    await dialog.getByRole('alert').getByText('The server does not keep this film any more: have it made again.').waitFor();
    await shoot(page, 'film-gone');
    await dialog.getByRole('button', { name: 'Another film' }).press('Enter');
    await make.waitFor();
    assert.equal(await dialog.getByRole('alert').count(), 0);
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  once('a film of a turn plays in a browser, and its pictures are those that render draws from there', async () => {
    const draw = (...args) => {
      const drawn = spawnSync(join(bin, 'beamroom'), ['render', join(folder, 'other'), '--size', '320x240', '--gl', 'soft', ...args]);
      assert.equal(drawn.status, 0, String(drawn.stderr));
      return readFileSync(args[args.indexOf('-o') + 1]).toString('base64');
    };
    const film = draw('-o', join(folder, 'turn.webm'), '--from', '30,10', '--orbit', '2,5', '--quality', '100', '--annotations');
    // the camera is turned, so it says from where; letters and caption are in the pictures
    const stills = ['30,10', '210,10'].map((from, at) => draw('-o', join(folder, `${at}.png`), '--from', from, '--annotations'));
    const page = await world.newPage('healthz');
    const { width, height, stillHeight, duration, off } = await played(page, film, stills, [0.1, 1.1]);
    const near = [off[0][0], off[1][1]];
    const far = off[0][1];
    assert.deepEqual([width, height, duration], [320, stillHeight + (stillHeight % 2), 2]);
    assert.ok(Math.max(...near) < 2.5 && far > 2 * Math.max(...near), `${near} off, and ${far} from the other side`);
    await page.context().close();
  });
});
