// Pointing in a meeting: from the mouse event in one browser to the paint of the pointer in another one, both on the demo plan.
import { existsSync } from 'node:fs';
import { call, openPlan, sleep, startDaemon, until } from '../api/daemon.mjs';

const chromiumPath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const seconds = 10;
const [slicePx, spacePx] = [0.6, 2.5]; // how far a mark may lie from the place of its event: what is seen in 3-D lies in the middle of a pixel

const tell = (name, value, unit, note) => console.log(JSON.stringify({ name, value: Number(value.toFixed(2)), unit, note }));
const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];

if (!existsSync(chromiumPath)) {
  console.log('no Chromium: nothing measured in a page');
  process.exit(77);
}
const { chromium } = await import('playwright-core');
const daemon = await startDaemon();
const browser = await chromium.launch({
  executablePath: chromiumPath,
  headless: true,
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
  const open = async () => {
    const page = await (await browser.newContext({ viewport: { width: 1500, height: 1000 } })).newPage();
    await page.goto(`${daemon.url}/rooms/${room.id}`);
    await until(
      () => page.evaluate(() => globalThis.beamroom?.stats().badges ?? {}),
      (badges) => [1, 2, 3, 4].every((view) => badges[view] === 'full'),
    );
    return page;
  };
  const [sender, receiver] = [await open(), await open()];
  await sender.locator('.point-tools').waitFor();
  await sender.evaluate(() => {
    globalThis.sent = [];
    addEventListener(
      'pointermove',
      (event) => {
        const picture = event.target.closest?.('.picture')?.getBoundingClientRect();
        if (picture)
          globalThis.sent.push({
            x: event.clientX - picture.left,
            y: event.clientY - picture.top,
            at: performance.timeOrigin + event.timeStamp,
          });
      },
      true,
    );
  });
  await receiver.evaluate(() => {
    globalThis.painted = [];
    const look = () => {
      for (const mark of document.querySelectorAll('.person-pointer')) {
        const one = { view: Number(mark.closest('.pane').dataset.view), x: Number(mark.dataset.x), y: Number(mark.dataset.y), at: 0 };
        const { port1, port2 } = new MessageChannel();
        port1.onmessage = () => {
          one.at = performance.timeOrigin + performance.now();
          port1.close();
        };
        requestAnimationFrame(() => port2.postMessage(0)); // the marks are drawn in a frame's callbacks: this one is of that frame or the next
        globalThis.painted.push(one);
      }
    };
    for (const layer of document.querySelectorAll('.pointers'))
      new MutationObserver(look).observe(layer, {
        subtree: true,
        childList: true,
        attributes: true,
        attributeFilter: ['data-x', 'data-y'],
      });
  });

  /** Times from each event whose place was painted in the receiver's pane of the same size to that paint. */
  const measure = async (view, within, key) => {
    await sender.locator(`#picture-${view}`).focus();
    if (key) await sender.keyboard.press(key);
    const box = await sender.locator(`#picture-${view}`).boundingBox();
    await Promise.all(
      [sender, receiver].map((page) =>
        page.evaluate(() => {
          globalThis.sent = [];
          globalThis.painted = [];
        }),
      ),
    );
    const began = performance.now();
    for (let step = 0; performance.now() - began < seconds * 1000; step++) {
      await sender.mouse.move(
        box.x + box.width / 2 + Math.round(60 * Math.sin(step / 37) + 30 * Math.sin(step / 7.3)),
        box.y + box.height / 2 + Math.round(60 * Math.cos(step / 31)),
      );
      await sleep(8);
    }
    await sleep(500);
    const [sent, painted] = [await sender.evaluate(() => globalThis.sent), await receiver.evaluate(() => globalThis.painted)];
    const known = new Set();
    return painted
      .filter(({ view: of, at }) => of === view && at)
      .flatMap(({ x, y, at }) => {
        const event = sent.filter((other) => other.at < at && Math.hypot(other.x - x, other.y - y) <= within).at(-1);
        if (!event || known.has(event)) return [];
        known.add(event);
        return [at - event.at];
      });
  };
  const slice = await measure(2, slicePx, 'p');
  if (slice.length < seconds * 5) throw new Error(`only ${slice.length} places were painted`);
  const note = `${slice.length} places painted in ${seconds} s, both browsers on this machine`;
  tell('pointer in a slice: mouse event to paint in another browser, p50', quantile(slice, 0.5), 'ms', note);
  tell('pointer in a slice: mouse event to paint in another browser, p95', quantile(slice, 0.95), 'ms', 'at most 50 asked for');
  const space = await measure(1, spacePx, '');
  if (space.length) {
    tell(
      'pointer in 3-D: mouse event to paint in another browser, p50',
      quantile(space, 0.5),
      'ms',
      `${space.length} places; each asks the server what is seen there`,
    );
    tell('pointer in 3-D: mouse event to paint in another browser, p95', quantile(space, 0.95), 'ms', 'no bound');
  }
} finally {
  await browser.close();
  await daemon.stop();
}
