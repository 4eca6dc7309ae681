// A daemon with the demo plan and a browser for it, for the tests of the page.
import { existsSync, mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { it } from 'node:test';
import { bin, call, demo, openPlan, sleep, startDaemon } from '../api/daemon.mjs';

// Chromium's headless shell opens a page with half of the work of the whole browser.
const headlessShell = '/usr/bin/chromium-headless-shell';
const chromiumPath = process.env.CHROMIUM ?? [headlessShell, '/usr/bin/chromium'].find(existsSync) ?? headlessShell;
const artifacts = 'build/test-artifacts';
const flags = [
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

/** LONG_TESTS: nothing: the short ones, and of what is tested at many sizes of windows, one; 1: all of everything; rest: only what the first leaves out. */
const long = process.env.LONG_TESTS ?? '';
/** Whether a case is to be run now. @param {boolean} isQuick it is one of those without LONG_TESTS */
export const isDue = (isQuick) => long === '1' || isQuick === (long !== 'rest');
/** SLOW_PARTS: ms that every module and style sheet waits in all pages, as behind a slow line; then nothing may be lost that a quick hand does. */
const slowPartsMs = Number(process.env.SLOW_PARTS ?? 0);
/** @param {import('playwright-core').Page} page @param {number} ms */
export const slowParts = (page, ms) =>
  page.route(/\/page\/|\.css$/, async (route) => {
    await sleep(ms);
    await route.continue().catch(() => {}); // the page may be closed by now
  });
/** A test that is run without LONG_TESTS. */
export const once = long === 'rest' ? () => {} : it;
/** A test that is run with LONG_TESTS alone. */
export const later = long ? it : () => {};

/** A file that these tests need and that is not there: they skip then. */
export const missing = [chromiumPath, join(bin, 'beamroomd'), join(demo, 'phantom/plan.json')].find((path) => !existsSync(path));

/** A browser that several test files use one after the other: what BEAMROOM_BROWSER names. @param {string[]} further flags */
export async function startBrowser(further = []) {
  const { chromium } = await import('playwright-core');
  return chromium.launchServer({ executablePath: chromiumPath, headless: true, args: [...flags, ...further] });
}

/** @param {{plans?: string[], args?: string[], data?: string}} how data: a state folder, kept afterwards; folders: programs and page */
export async function startWorld({ plans = [], args = [], data, folders } = {}) {
  mkdirSync(artifacts, { recursive: true });
  const daemon = await startDaemon({ plans: [demo, ...plans], args, data, folders });
  const { chromium } = await import('playwright-core');
  const shared = process.env.BEAMROOM_BROWSER;
  const browser = await (shared
    ? chromium.connect(shared)
    : chromium.launch({ executablePath: chromiumPath, headless: true, args: flags }));
  const errors = [];
  const refused = []; // what the content security policy refused
  return {
    daemon,
    errors,
    refused,
    async newRoom(plan = 'phantom') {
      await openPlan(daemon.url, plan);
      return (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan })).json.id;
    },
    /** @param {string} address behind the daemon's, or behind base @param {object} options of the browser's context */
    async newPage(address = '', { base = daemon.url, ...options } = {}) {
      const context = await browser.newContext({ viewport: { width: 1600, height: 1000 }, ...options });
      context.setDefaultTimeout(60000); // waits for states, however busy the machine
      const page = await context.newPage();
      if (slowPartsMs) await slowParts(page, slowPartsMs);
      page.on('pageerror', (error) => errors.push(error.message));
      page.on('console', (message) => /Content Security Policy/.test(message.text()) && refused.push(message.text()));
      await page.goto(`${base}/${address}`);
      return page;
    },
    async scene(room) {
      const { json } = await call(`${daemon.url}/api/v1/rooms/${room}/scene`);
      return json.scene ?? json;
    },
    async stop() {
      await browser.close(); // of a shared one, the connection and the pages that came by it
      await this.daemon.stop(); // a test may have started another one
    },
  };
}

/** Until the picture of a view is at rest. */
export const full = (page, view = 1) => page.waitForFunction((n) => globalThis.beamroom?.stats().badges[n] === 'full', view);

/** Until the picture shows the scene as it is after this revision. */
export const newer = (page, view, revision) =>
  page.waitForFunction(([n, old]) => globalThis.beamroom.stats().headers[n].scene_revision > old, [view, revision]);

export const header = (page, view) => page.evaluate((n) => globalThis.beamroom.stats().headers[n], view);

/** The downloaded bytes. @param {import('playwright-core').Download} download @returns {Promise<Buffer>} */
export async function bytesOf(download) {
  const parts = [];
  for await (const part of await download.createReadStream()) parts.push(part);
  return Buffer.concat(parts);
}

export const shoot = (page, name) => page.screenshot({ path: `${artifacts}/${name}.png` });
