// Delays that a person feels: Chromium shows the demo plan's five surfaces in a 1024 x 768 picture, a mouse orbits it for some seconds.
// Input to paint: from the pointer event to the paint of the first picture that shows it, measured by the page itself (js/hooks.js).
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { call, openPlan, sleep, startDaemon, until } from '../api/daemon.mjs';

const chromiumPath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const wanted = { width: 1024, height: 768 };
const dragSeconds = 6;
const releases = 7;

const tell = (name, value, unit, note) => console.log(JSON.stringify({ name, value: Number(value.toFixed(2)), unit, note }));
const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];

if (!existsSync(chromiumPath)) {
  console.log('no Chromium: nothing measured in a page');
  process.exit(77);
}
const { chromium } = await import('playwright-core');
const profile = mkdtempSync(join(tmpdir(), 'beamroom-bench-'));
const daemon = await startDaemon();
const browser = await chromium.launchPersistentContext(profile, {
  executablePath: chromiumPath,
  headless: true,
  viewport: { width: 1500, height: 1000 },
  args: [
    '--no-sandbox',
    '--disable-gpu',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
  ],
});
try {
  await openPlan(daemon.url, 'phantom');
  const room = (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json;
  const page = await browser.newPage();
  const began = performance.now();
  await page.goto(`${daemon.url}/rooms/${room.id}`);
  const stats = () => page.evaluate(() => globalThis.beamroom?.stats() ?? null);
  const isFull = (s) => Boolean(s?.headers[1]) && s.badges[1] === 'full';
  await page.waitForFunction(() => globalThis.beamroom?.stats().headers[1], null, { polling: 5 });
  tell(
    'page opened to first picture, open plan',
    performance.now() - began,
    'ms',
    'room address typed to paint; at most 300 asked for, without the page itself',
  );

  // one pane, its picture exactly 1024 x 768
  await page.locator('#picture-1').focus();
  await page.keyboard.press('Enter');
  await sleep(200);
  for (let turn = 0; turn < 3; turn++) {
    const box = await page.locator('#picture-1').boundingBox();
    const view = page.viewportSize();
    await page.setViewportSize({
      width: Math.round(view.width + wanted.width - box.width),
      height: Math.round(view.height + wanted.height - box.height),
    });
    await sleep(300);
  }
  const box = await page.locator('#picture-1').boundingBox();
  if (Math.abs(box.width - wanted.width) > 2 || Math.abs(box.height - wanted.height) > 2)
    throw new Error(`the picture is ${box.width} x ${box.height}`);
  await until(stats, isFull);

  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let step = 0; step < 60; step++) {
    await page.mouse.move(x + 2 * step, y + 10 * Math.sin(step / 9));
    await sleep(16);
  } // the pace settles
  await page.evaluate(() => globalThis.beamroom.clear());
  const frames = (await stats()).frames;
  const start = performance.now();
  for (let step = 0; performance.now() - start < dragSeconds * 1000; step++) {
    await page.mouse.move(x + 250 * Math.sin(step / 40), y + 60 * Math.sin(step / 23));
    await sleep(12);
  }
  const seconds = (performance.now() - start) / 1000;
  const moved = await stats();
  const header = moved.headers[1];
  await page.mouse.up();
  const size = `${header.width_px} x ${header.height_px}, JPEG ${header.quality}`;
  tell(
    'input to paint while orbiting, p50',
    quantile(moved.input_to_paint_ms, 0.5),
    'ms',
    `${moved.input_to_paint_ms.length} inputs, pictures of ${size}; at most 60 asked for`,
  );
  tell('input to paint while orbiting, p95', quantile(moved.input_to_paint_ms, 0.95), 'ms', 'at most 100 asked for');
  tell('pictures a second while orbiting', (moved.frames - frames) / seconds, '1/s', size);
  tell('drawing one of them', header.render_us / 1000, 'ms', 'the last one');

  // from letting go to the full picture on the screen
  const stills = [];
  for (let turn = 0; turn < releases; turn++) {
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let step = 0; step < 20; step++) {
      await page.mouse.move(x + 5 * step, y);
      await sleep(16);
    }
    await page.mouse.up();
    const released = performance.now();
    await page.waitForFunction(() => globalThis.beamroom.stats().badges[1] === 'full', null, { polling: 4 });
    stills.push(performance.now() - released);
    await sleep(100);
  }
  tell('release to full picture, 1024 x 768', quantile(stills, 0.5), 'ms', `median of ${releases}; at most 400 asked for`);

  // four panes: the crosshair dragged in the coronal one moves two slices, and 3-D shows one of them
  await page.keyboard.press('Enter');
  await until(stats, (s) => [1, 2, 3, 4].every((view) => s.badges[view] === 'full'));
  const pane = await page.locator('#picture-4').boundingBox();
  const [middleX, middleY] = [pane.x + pane.width / 2, pane.y + pane.height / 2];
  await page.mouse.move(middleX, middleY);
  await page.mouse.down();
  const dragAbout = async (ms) => {
    const began = performance.now();
    for (let step = 0; performance.now() - began < ms; step++) {
      await page.mouse.move(middleX + 60 * Math.sin(step / 19), middleY + 60 * Math.sin(step / 23));
      await sleep(12);
    }
    return (performance.now() - began) / 1000;
  };
  await dragAbout(1500); // the pace settles
  await page.evaluate(() => globalThis.beamroom.clear());
  const from = (await stats()).frames_of;
  const took = await dragAbout(dragSeconds * 1000);
  const { frames_of: to, input_to_paint_ms: times } = await stats();
  await page.mouse.up();
  const rate = (view) => (to[view] - from[view]) / took;
  const panes = `four panes of ${Math.round(pane.width)} x ${Math.round(pane.height)}`;
  tell(
    'pictures a second of each pane while dragging the crosshair',
    Math.min(rate(2), rate(3)),
    '1/s',
    `${panes}: axial ${rate(2).toFixed(1)}, sagittal ${rate(3).toFixed(1)}, 3-D with the slice ${rate(1).toFixed(1)}; at least 30 asked for`,
  );
  tell('pictures of the pane that does not change', to[4] - from[4], '', 'none asked for');
  tell('input to paint while dragging the crosshair, p50', quantile(times, 0.5), 'ms', `${times.length} inputs; at most 50 asked for`);
  tell('input to paint while dragging the crosshair, p95', quantile(times, 0.95), 'ms', 'at most 90 asked for');

  // the same with the beam's eye in place of 3-D: regions transparent, tracks and a beam slice in it, and the beam's target is dragged
  await page.getByRole('button', { name: 'Panes', exact: true }).click();
  await page.locator('.beam-presets button', { hasText: "Beam's eye" }).click();
  const more = { tracks: { visible: true }, beam: { slice: { visible: true, along_mm: 60 }, looks: { 'beam-1': { visible: true } } } };
  if ((await call(`${daemon.url}/api/v1/rooms/${room.id}/scene`, 'PATCH', more, { 'If-Match': '*' })).status !== 200)
    throw new Error('no tracks');
  await page.getByRole('button', { name: 'Move beam' }).click();
  await until(stats, (s) => [7, 2, 3, 4].every((view) => s.badges[view] === 'full'));
  const eye = await page.locator('#picture-7').boundingBox();
  const [eyeX, eyeY] = [eye.x + eye.width / 2, eye.y + eye.height / 2];
  await page.mouse.move(eyeX, eyeY);
  await page.mouse.down();
  const dragBeam = async (ms) => {
    for (let step = 0, began = performance.now(); performance.now() - began < ms; step++) {
      await page.mouse.move(eyeX + 60 * Math.sin(step / 19), eyeY + 60 * Math.sin(step / 23));
      await sleep(12);
    }
  };
  await dragBeam(1500); // the pace settles
  await page.evaluate(() => globalThis.beamroom.clear());
  const eyeFrom = (await stats()).frames_of[7];
  const dragged = performance.now();
  await dragBeam(dragSeconds * 1000);
  const eyeSeconds = (performance.now() - dragged) / 1000;
  const {
    input_to_paint_ms: eyeTimes,
    frames_of: { 7: eyeTo },
    headers: { 7: eyeHeader },
  } = await stats();
  await page.mouse.up();
  const { beam } = (await call(`${daemon.url}/api/v1/rooms/${room.id}/scene`)).json;
  if (!beam.draft.enabled) throw new Error('the beam was not moved');
  const eyeNote = `four panes, the beam's eye ${Math.round(eye.width)} x ${Math.round(eye.height)} with ${eyeHeader.width_px} x ${eyeHeader.height_px}`;
  tell(
    "input to paint while dragging the beam in its beam's-eye view, p50",
    quantile(eyeTimes, 0.5),
    'ms',
    `${eyeTimes.length} inputs, ${eyeNote}, 1000 tracks, a beam slice; at most 50 asked for`,
  );
  tell("input to paint while dragging the beam in its beam's-eye view, p95", quantile(eyeTimes, 0.95), 'ms', 'at most 90 asked for');
  tell(
    "pictures a second of the beam's-eye view while dragging the beam",
    (eyeTo - eyeFrom) / eyeSeconds,
    '1/s',
    `drawing one takes ${(eyeHeader.render_us / 1000).toFixed(1)} ms`,
  );

  const renders = async () => Number(/^beamroom_renders_total (\d+)/m.exec((await call(`${daemon.url}/metrics`)).text)[1]);
  await sleep(1000);
  const before = await renders();
  await sleep(3000);
  tell('pictures drawn in an idle room', (await renders()) - before, '', 'over 3 s with a browser in it; none asked for');
} finally {
  await browser.close();
  await daemon.stop();
  rmSync(profile, { recursive: true, force: true });
}
