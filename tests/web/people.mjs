// The people of a room in their browsers: entering under a name, what the room chip says, following and cameras.
import { until } from '../api/daemon.mjs';
import { full, header } from './browser.mjs';

export const chip = (page) => page.locator('.room-chip:visible');
/** Until the room chip says this. @param {RegExp} words */
export const says = (page, words) =>
  until(
    async () => (await chip(page).textContent()).replace(/\s+/g, ' ').trim(),
    (text) => words.test(text),
  );
export const toast = (page, text) => page.locator('.toast', { hasText: text }).waitFor();
/** A button of the chip's popover. */
export const action = (page, word) => page.locator('.room-actions button', { hasText: word });
export const row = (page, name) => page.locator('.room-members li', { has: page.locator('.roster-who > .clipped', { hasText: name }) });
/** Opens the list of members. */
export async function openRoster(page) {
  if (await page.locator('.room-members .own-name').count()) return;
  await chip(page).locator('.chip-main').click();
  await page.locator('.room-members .own-name').waitFor();
}

/** A browser of its own, under this name, at an address behind the daemon's: "rooms/ID". */
export async function enter(world, address, name, options = {}) {
  const page = await world.newPage('#/', options);
  await page.evaluate((text) => localStorage.setItem('beamroom name', text), name);
  await page.goto('about:blank'); // the name is read when the page starts
  await page.goto(`${options.base ?? world.daemon.url}/${address}`);
  await says(page, /Presenting|Following|No presenter/);
  return page;
}

/** The matrix of what a pane shows, to compare. */
export const matrix = async (page, view) =>
  Object.values((await header(page, view)).clip_from_lps_mm)
    .map((value) => value.toFixed(4))
    .join(' ');
/** Until a pane shows what the other page's shows, at rest in both. */
export async function showsAs(page, other, view = 1) {
  await until(
    async () => [await matrix(page, view), await matrix(other, view)],
    ([own, shown]) => own === shown,
  );
  await Promise.all([page, other].map((each) => full(each, view)));
}
/** Turns the 3-D view until its picture is another one, at rest. */
export async function turn(page) {
  const before = await matrix(page, 1);
  await page.locator('#picture-1').focus();
  await page.keyboard.press('ArrowLeft');
  await until(
    () => matrix(page, 1),
    (now) => now !== before,
  );
  await full(page, 1);
}
