// Checks of the sign-in behind a proxy, or at it: who is nobody, who is ann, and what happens when her sign-in ends.
import assert from 'node:assert/strict';
import { it } from 'node:test';
import { until } from '../api/daemon.mjs';
import { Client } from '../api/ws_client.mjs';
import { full } from '../web/browser.mjs';
import { people } from './people.mjs';
import { PASSWORD } from './site.mjs';
import { Caller, openSecurely } from './world.mjs';

const session = async (caller, headers) => (await caller.call('/api/v1/session', { headers })).json;
const seats = async (site) => (await site.caller.call(`/api/v1/rooms/${site.room}`)).json.members.map(({ id }) => id);

/** @param {import('./site.mjs').Site} site */
export function provesSignIn(site) {
  it('nobody gets the page, and nothing else: neither calls nor rooms', async () => {
    const stranger = new Caller(site.port);
    assert.match((await stranger.call('/')).text, /<!doctype html>/i);
    assert.equal((await session(stranger)).identity, null);
    const refused = await stranger.call('/api/v1/plans');
    assert.deepEqual([refused.status, refused.json.type], [401, '/problems/sign-in']);
    const note = { body: { text: 'from a stranger' } };
    assert.equal((await stranger.call(`/api/v1/rooms/${site.room}/notes`, { method: 'POST', body: note })).status, 401);
    stranger.end();
    const socket = await openSecurely(site.port, { ALPNProtocols: ['http/1.1'] });
    const client = await Client.open(`https://${site.host}`, `/api/v1/rooms/${site.room}/ws`, { Host: site.host }, socket);
    // a guest might come by a link, which hello would bring: who brings none is shown nothing of the room
    if (client.status === 101) {
      client.send({ type: 'hello', protocol: 2, name: 'Stranger' });
      await client.until(() => client.closeCode, 'the end');
      assert.deepEqual(
        client.messages.map(({ type }) => type),
        ['bye'],
      );
    } else assert.equal(client.status, 401);
    client.cut();
  });

  it('who has signed in is told to the daemon, and no header of a client changes it', async () => {
    const { identity, sign_in } = await session(site.caller);
    assert.deepEqual([sign_in, identity.user], [[site.signsIn ? 'proxy' : 'local'], 'ann']);
    const { groups } = identity;
    if (site.signsIn) assert.deepEqual(groups, people.ann.groups);
    if (site.signsIn !== 'proxy') {
      assert.equal(identity.name, people.ann.name);
      assert.ok(Math.abs(identity.proved_ms - Date.now()) < 600000, 'when she signed in');
    }
    const stranger = new Caller(site.port);
    for (const name of ['X-Beamroom-User', 'x-beamroom-user']) {
      const claim = { [name]: 'eve', 'X-Beamroom-Groups': 'beamroom-admins', 'X-Beamroom-Name': 'Eve', 'X-Beamroom-Auth-Time': '1' };
      assert.deepEqual((await session(site.caller, claim)).identity.groups, groups);
      assert.equal((await session(site.caller, claim)).identity.user, 'ann');
      assert.equal((await session(stranger, claim)).identity, null);
    }
    const dropped = await session(site.caller, { Connection: 'close, X-Beamroom-User, X-Beamroom-Groups' });
    assert.ok([undefined, 'ann'].includes(dropped.identity?.user));
    stranger.end();
    const direct = await fetch(`${site.daemon.url}/api/v1/version`, { headers: { 'X-Beamroom-User': 'ann' } });
    assert.equal(direct.status, 400);
  });

  it('a room that somebody was sent opens behind the sign-in; its end in the meeting keeps the seat', async () => {
    const context = await site.newContext();
    const { page } = await site.visit(`/rooms/${site.room}`, { context });
    await page.waitForURL(`https://${site.host}/signin?return=*`);
    if (site.signsIn) await page.click('button.hospital');
    await site.passProvider(page);
    await page.waitForURL(`https://${site.host}/rooms/${site.room}**`);
    await full(page);
    const before = await seats(site);
    await context.clearCookies(); // as at the end of its time
    await page.keyboard.press('Escape'); // input, of which the page tells the server
    const card = page.locator('.card.again');
    if (site.signsIn) {
      const opened = context.waitForEvent('page');
      await card.locator('button.primary').click();
      if (site.signsIn === 'oidc') await site.passProvider(await opened);
    } else {
      await card.locator('#again-password').fill(PASSWORD);
      await card.locator('.again-pair button').click();
    }
    await card.waitFor({ state: 'detached' });
    await full(page);
    assert.deepEqual(await seats(site), before);
    await context.close();
  });
  it('signing out leaves nothing behind in the browser', async () => {
    const context = await site.newContext();
    const { page } = await site.visit(site.signsIn ? '/signin/proxy?return=/' : '/signin?return=/', { context });
    await site.passProvider(page);
    await page.waitForURL(`https://${site.host}/`);
    const who = () => page.evaluate(async () => (await (await fetch('/api/v1/session')).json()).identity?.user);
    assert.equal(await who(), 'ann');
    assert.equal(await page.evaluate(async () => (await fetch('/api/v1/session', { method: 'DELETE' })).status), 204);
    // clearing closes the browser's connections, under a call at that moment too
    assert.equal(
      await until(
        () => who().catch((error) => error),
        (said) => !(said instanceof Error),
      ),
      undefined,
    );
    assert.equal((await context.cookies(`https://${site.host}/`)).length, 0);
    await context.close();
  });
}

/** A signature needs a fresh password, which who knows the people asks for. @param {import('./site.mjs').Site} site */
export function provesFreshSignIn(site) {
  it('who signs out and in again, later than 5 minutes after the password, gives it again and can sign', async () => {
    const context = await site.newContext();
    const { page } = await site.visit('/signin/proxy?return=/', { context });
    await site.passProvider(page);
    await page.waitForURL(`https://${site.host}/`);
    const provedMs = () => page.evaluate(async () => (await (await fetch('/api/v1/session')).json()).identity?.proved_ms);
    const first = await provedMs();
    site.people.wait(301);
    assert.equal(await page.evaluate(async () => (await fetch('/api/v1/session', { method: 'DELETE' })).status), 204);
    await page.goto(`https://${site.host}/signin/proxy?return=/`);
    await page.fill('input[name=login]', 'ann');
    await page.fill('input[name=password]', 'any');
    await page.click('button[type=submit]');
    await page.waitForURL(`https://${site.host}/`);
    const again = await provedMs();
    assert.ok(again >= first && Date.now() - again < 60000, `${again} after ${first}`);
    await context.close();
  });
}
