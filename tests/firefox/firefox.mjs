// A daemon with the demo plan and Debian's Firefox, driven by WebDriver BiDi.
import { existsSync, mkdirSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { bin, call, demo, openPlan, startDaemon, until } from '../api/daemon.mjs';

const firefoxPath = process.env.FIREFOX ?? '/usr/bin/firefox-esr';
const driver = resolve('build/firefox/node_modules/puppeteer-core/lib/esm/puppeteer/puppeteer-core.js');
const artifacts = 'build/test-artifacts';

/** A file that these tests need and that is not there: they skip then. */
export const missing = [firefoxPath, driver, join(bin, 'beamroomd'), join(demo, 'phantom/plan.json')].find((path) => !existsSync(path));

/** @param {string[]} args of the daemon */
export async function startWorld(args = []) {
  mkdirSync(artifacts, { recursive: true });
  const { default: puppeteer } = await import(pathToFileURL(driver));
  const daemon = await startDaemon({ plans: [demo], args });
  const browser = await puppeteer.launch({ browser: 'firefox', executablePath: firefoxPath, headless: true });
  const errors = [];
  return {
    daemon,
    errors,
    async newRoom() {
      await openPlan(daemon.url, 'phantom');
      return (await call(`${daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json.id;
    },
    /** A browser of its own. @param {string} address behind the daemon's */
    async newPage(address, { width = 1440, height = 900 } = {}) {
      const context = await browser.createBrowserContext();
      const page = await context.newPage();
      page.setDefaultTimeout(60000); // waits for states, however busy the machine
      await page.setViewport({ width, height });
      page.on('pageerror', (error) => errors.push(error.message));
      page.on('console', (message) => /Content-Security-Policy/.test(message.text()) && errors.push(message.text()));
      await page.goto(`${daemon.url}/${address}`);
      return page;
    },
    async scene(room) {
      const { json } = await call(`${daemon.url}/api/v1/rooms/${room}/scene`);
      return json.scene ?? json;
    },
    async stop() {
      await browser.close();
      await daemon.stop();
    },
  };
}

export const stats = (page) => page.evaluate(() => JSON.parse(JSON.stringify(globalThis.beamroom.stats())));
/** Until the pictures of these views are at rest. */
export const full = (page, views = [1]) =>
  page.waitForFunction((all) => all.every((view) => globalThis.beamroom?.stats().badges[view] === 'full'), {}, views);
/** Until what a page says of itself is so. */
export const says = (page, selector, words) =>
  until(
    () => page.$$eval(selector, (all) => all.map((one) => one.textContent.replace(/\s+/g, ' ').trim()).join(' ')),
    (text) => words.test(text),
  );
export const shoot = (page, name) => page.screenshot({ path: `${artifacts}/firefox-${name}.png` });
