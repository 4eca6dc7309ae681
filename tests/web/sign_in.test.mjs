// Signing in on the page, against the daemon: first administrator, address kept, the end of a sign-in in a room, guests, a display, a signature.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, later, missing, shoot, startWorld } from './browser.mjs';

const wide = { viewport: { width: 1440, height: 900 } };
const password = 'correct horse 7';

/** Ends the sign-in of a page behind its back, as somebody who disables the user does. */
async function endSession(page, url) {
  const cookies = await page.context().cookies(url);
  const headers = { Cookie: cookies.map(({ name, value }) => `${name}=${value}`).join('; '), Origin: url };
  const { status } = await fetch(`${url}/api/v1/session`, { method: 'DELETE', headers });
  assert.equal(status, 204);
}

const badges = (page) => page.evaluate(() => Object.values(globalThis.beamroom.stats().badges).join());

describe('signing in', { skip: missing && `${missing} is missing` }, () => {
  let world, page, room;
  const urls = []; // of all requests of all pages
  const visit = async (address) => {
    const made = await world.newPage(address, wide);
    made.on('request', (request) => urls.push(request.url()));
    return made;
  };
  const signIn = async (on, secret = password) => {
    await on.fill('#sign-in-user', 'ann.keller');
    await on.fill('#sign-in-password', secret);
    await on.keyboard.press('Enter');
  };
  before(async () => {
    world = await startWorld({ args: ['--sign-in', 'local', '--guest-links'] });
  });
  after(() => world?.stop());

  it('makes the first administrator at the address that the log shows, and shows who is signed in', async () => {
    const [, address] = await until(
      async () => /(signin\/first#\w+)/.exec(world.daemon.log()),
      (found) => found,
    );
    page = await visit(address);
    await page.locator('#first-user').waitFor();
    assert.equal(page.url(), `${world.daemon.url}/signin/first`, 'the token is not in the address any more');
    await page.fill('#first-user', 'ann.keller');
    await page.fill('#first-name', 'Dr Ann Keller');
    await page.fill('#first-password', password);
    await page.fill('#first-again', password);
    assert.deepEqual(await axe(page), []);
    await page.keyboard.press('Enter');
    await page.locator('.start [data-plan]').first().waitFor();
    await page.goto(`${world.daemon.url}/signin`); // who is signed in goes on
    await page.locator('.start [data-plan]').first().waitFor();
    await page.getByRole('button', { name: 'Signed in as Dr Ann Keller' }).click();
    await page.getByText('ann.keller, account of this server').waitFor();
    assert.deepEqual(await axe(page), []);
  });

  it('signs out, and clears what the browser kept', async () => {
    await page.evaluate(() => localStorage.setItem('beamroom name', 'X'));
    await page.getByRole('button', { name: 'Sign out' }).click();
    await page.locator('#sign-in-user').waitFor();
    assert.deepEqual(await page.evaluate(() => [...Object.keys(localStorage), ...Object.keys(sessionStorage)]), []);
    await page.goto(world.daemon.url);
    await page.waitForURL(/\/signin\?return=%2F$/);
  });

  it('says how many tries a wrong password leaves, and opens the room whose address was asked for', async () => {
    await page.goto(`${world.daemon.url}/rooms/not-there`);
    await page.waitForURL(/\/signin\?return=%2Frooms%2Fnot-there$/);
    await page.locator('#sign-in-user').waitFor();
    await signIn(page, 'wrong');
    await page.getByText('User and password do not match. 4 tries are left, then a pause of 1 minute.').waitFor();
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'sign-in');
    await signIn(page);
    await page.locator('.ended', { hasText: /You cannot enter this room.*people who were asked in/s }).waitFor(); // as of one that is closed to them
    assert.equal(page.url(), `${world.daemon.url}/rooms/not-there`);
    await page.locator('.ended a', { hasText: 'All plans' }).click();
    await page.locator('[data-plan] button', { hasText: 'Open' }).first().click();
    await full(page);
    room = /rooms\/([\w-]+)$/.exec(page.url())[1];
    await page.locator('.you', { hasText: 'Dr Ann Keller (you)' }).waitFor();
  });

  it('stands still when the sign-in ends in a room, and comes back to the same seat', async () => {
    const seat = () => page.evaluate((id) => JSON.parse(sessionStorage.getItem(`room ${id}`)), room);
    const before = await seat();
    assert.equal(before.user, 'ann.keller', 'it is kept whose seat it is');
    await endSession(page, world.daemon.url);
    const card = page.getByRole('dialog', { name: 'Sign in again' });
    await card.waitFor();
    assert.match(await badges(page), /^(paused|,)+$/);
    assert.equal(await page.evaluate(() => document.querySelector('#page').inert), true);
    await page.waitForFunction(() => document.activeElement.id === 'again-password');
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'sign-in-again');
    await page.fill('#again-password', 'wrong');
    await page.keyboard.press('Enter');
    await card.getByText(/User and password do not match/).waitFor();
    await page.fill('#again-password', password);
    await page.keyboard.press('Enter');
    await card.waitFor({ state: 'detached' });
    await full(page);
    assert.equal((await seat()).member, before.member);
  });

  it('a guest comes in by a link that admits guests, under a name, and is marked', async () => {
    await page.locator('.people-button').click();
    await page.fill('.people-link input[name=name]', 'Umeå');
    await page.locator('.people-link input[name=guests]').check();
    await page.getByRole('button', { name: 'Make and copy' }).click();
    const link = await until(
      () => page.locator('.people-made input').inputValue(),
      (text) => text !== '',
    );
    const token = /^http:\/\/[^/]+\/rooms\/[\w-]+#link=(\w+)$/.exec(link)[1];
    const guest = await visit(link.slice(world.daemon.url.length + 1));
    await guest.fill('#guest-name', 'Prof. Lind');
    assert.deepEqual(await axe(guest), []);
    await guest.keyboard.press('Enter');
    await full(guest);
    assert.equal(guest.url(), `${world.daemon.url}/rooms/${room}`);
    const camera = (on) => on.getByRole('button', { name: 'Snapshot', exact: true }).count();
    assert.deepEqual([await camera(page), await camera(guest)], [1, 0], 'a guest takes no files away');
    const row = page.locator('.people-here li', { hasText: 'Prof. Lind' });
    await row.locator('.tag', { hasText: 'guest' }).waitFor();
    await page.locator('.people-links tr', { hasText: 'Umeå' }).waitFor();
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'people');
    await row.getByRole('button', { name: /^Remove/ }).click();
    await page.getByRole('button', { name: 'Remove', exact: true }).click();
    await guest.locator('.ended', { hasText: 'Dr Ann Keller removed you from this room' }).waitFor();
    assert.deepEqual(
      urls.filter((url) => url.includes(token) || url.includes(password)),
      [],
    );
    await page.keyboard.press('Escape');
    await guest.context().close();
  });

  later('a guest by a link for one person has a second tab; another browser is told in words', async () => {
    const link = await page.evaluate(async (id) => {
      const body = JSON.stringify({ role: 'observer', expires_s: 3600, one_use: true, guests: true });
      const answer = await fetch(`/api/v1/rooms/${id}/links`, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body });
      return (await answer.json()).token;
    }, room);
    const address = `rooms/${room}#link=${link}`;
    const comeIn = async (on) => {
      await on.fill('#guest-name', 'Prof. Lind');
      await on.keyboard.press('Enter');
    };
    const first = await visit(address);
    await comeIn(first);
    await full(first);
    const second = await first.context().newPage();
    await second.goto(`${world.daemon.url}/${address}`);
    await comeIn(second);
    await full(second);
    assert.equal(await first.locator('.ended').count(), 0, 'the first tab stays');
    const other = await visit(address);
    await comeIn(other);
    await other.locator('.ended', { hasText: 'the link was for one person and has been used: ask for one of your own' }).waitFor();
    assert.deepEqual(await axe(other), []);
    await shoot(other, 'sign-in-link-used');
    await Promise.all([first, other].map((one) => one.context().close()));
  });

  it('a display comes in by a link of the role wall, without signing in', async () => {
    const made = () => page.locator('.people-made input');
    await page.locator('.people-button').click();
    await page.locator('.people-link select[name=role]').selectOption('wall');
    await page.getByRole('button', { name: 'Make and copy' }).click();
    const link = await made().inputValue();
    const wall = await visit(link.slice(world.daemon.url.length + 1));
    await wall.locator('.wall-live[data-state="live"]').waitFor();
    await wall.waitForFunction(() => globalThis.wall.room.views.slice(0, 4).every(({ painted }) => painted.value));
    await wall.locator('.wall-column', { hasText: 'At the crosshair' }).waitFor();
    await wall.locator('.wall-column .wall-value', { hasText: /\d.* Gy/ }).waitFor();
    assert.equal(wall.url(), `${world.daemon.url}/display/${room}`);
    await page.locator('.people-here li', { hasText: 'wall' }).waitFor();
    await page
      .locator('.people-links tr', { hasText: 'wall' })
      .getByRole('button', { name: /^End it/ })
      .click();
    await wall.locator('.wall-said', { hasText: 'This wall has ended' }).waitFor();
    const sides = await wall.evaluate(() => [...document.querySelectorAll('canvas')].map(({ width }) => width));
    assert.ok(
      sides.every((side) => side <= 16),
      `no picture of a patient stays: ${sides}`,
    );
    assert.equal(await wall.locator('.wall-column').innerText(), '');
    await page.keyboard.press('Escape');
    await wall.context().close();
    const without = await visit(`display/${room}`);
    await without.getByText('This wall needs a link').waitFor();
    await without.context().close();
  });

  it('signs as the person signed in, with the password once more', async () => {
    await page.locator('#tab-record').click();
    await page.fill('#sign-password', password);
    await page.locator('.signing button', { hasText: 'Sign' }).click();
    await page.locator('.record-lines li', { hasText: 'Dr Ann Keller' }).waitFor();
    assert.equal(await page.locator('.record-form input[name=name]').count(), 0, 'no field for a name');
    assert.deepEqual([world.errors, world.refused], [[], []]);
  });
});
