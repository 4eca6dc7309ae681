// The roster: who is in the room and what they do; control requested, given, taken, locked; links with roles. Screenshots stay
// in build/test-artifacts/.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { until as ask } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, later, missing, shoot, startWorld } from './browser.mjs';
import { action, enter as enterAs, matrix, openRoster as open, row, says, showsAs, toast } from './people.mjs';

const sizes = [
  ['1440x900', { viewport: { width: 1440, height: 900 } }],
  ['390x844-touch', { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }],
];

const words = async (page, name) => (await row(page, name).textContent()).replace(/\s+/g, ' ').trim();

describe('the roster', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
  });

  const enter = (...how) => enterAs(world, ...how);

  it('characters that turn a text round are shown, not obeyed, wherever they come from', async () => {
    const page = await enter(`rooms/${await world.newRoom()}`, 'Ann');
    const shown = await page.evaluate(async () => {
      const line = document.createElement('p');
      line.append('Ann \u202enomiS');
      line.title = 'PTV\u200b';
      document.body.append(line);
      await null;
      const first = [line.textContent, line.title];
      line.firstChild.data = 'Ben \u2066';
      line.title = '\ufeff';
      await null;
      return [...first, line.textContent, line.title];
    });
    assert.deepEqual(shown, ['Ann «RLO»nomiS', 'PTV«ZWSP»', 'Ben «LRI»', '«BOM»']);
    await page.close();
  });

  for (const [size, options] of sizes)
    it(`control goes from one to the other at ${size}`, async () => {
      const room = await world.newRoom();
      const one = await enter(`rooms/${room}`, 'Dr Ann', options);
      const two = await enter(`rooms/${room}`, 'Ben', options);
      await says(one, /^Presenting/);
      await Promise.all([full(one), full(two)]);
      await open(two);
      assert.match(await words(two, 'Dr Ann'), /Dr Ann presenter · presents/);
      assert.match(await words(two, 'Ben'), /Ben \(you\) reviewer · follows Dr Ann/);
      assert.deepEqual(await axe(two), []);
      assert.equal(await action(two, 'Take').count(), 0, 'a reviewer asks');
      await action(two, 'Request control').focus();
      await two.keyboard.press('Enter');
      await toast(two, 'You have asked Dr Ann for control.');

      const line = one.locator('.request-line', { hasText: 'Ben requests control' });
      await line.waitFor();
      assert.deepEqual(await axe(one), []);
      await shoot(one, `roster-request-${size}`);
      await line.getByRole('button', { name: 'Refuse' }).click();
      await toast(two, 'Dr Ann keeps control for now.');
      await line.waitFor({ state: 'detached' });
      await open(two);
      await action(two, 'Request control').click();
      await toast(two, /Ask again in \d+ s/);

      await open(one);
      await shoot(one, `roster-presenter-${size}`);
      await row(one, 'Ben').getByRole('button', { name: 'Give control to Ben' }).click();
      await says(two, /^Presenting/);
      await toast(one, 'Ben presents now. You follow.');
      await open(one);
      await action(one, 'Take control').click(); // the role of presenter takes it back
      await says(one, /^Presenting/);
      await toast(two, 'Dr Ann presents now. You follow.');
      await open(one);
      await action(one, 'Lock control').click();
      await says(one, /^Presenting, locked/);
      await open(two);
      await two.locator('.roster-locked').waitFor();
      await shoot(two, `roster-follower-${size}`);
      assert.deepEqual(world.errors, []);
      await Promise.all([one, two].map((page) => page.context().close()));
    });

  it('a link gives a role; two tabs of a person are told; an observer is offered nothing that is not allowed', async () => {
    const room = await world.newRoom();
    const one = await enter(`rooms/${room}`, 'Dr Ann', sizes[0][1]);
    await one.locator('.invite-button').click();
    await one.locator('#invite-role').selectOption('observer');
    await one.locator('.invite-form button', { hasText: 'Make link' }).click();
    const link = await ask(
      () => one.locator('#invite-made').inputValue(),
      (text) => text !== '',
    );
    assert.match(link, new RegExp(`/rooms/${room}#link=[0-9a-f]{32}$`));
    assert.equal(await one.locator('.invite-form a').getAttribute('href'), `${world.daemon.url}/display/${room}`);
    assert.deepEqual(await axe(one), []);
    await shoot(one, 'roster-invite');
    const two = await enter(link.slice(link.indexOf('rooms/')), 'Cem', sizes[0][1]);
    assert.equal(two.url(), `${world.daemon.url}/rooms/${room}`, 'the address does not keep it');
    await open(two);
    assert.match(await words(two, 'Cem'), /observer · follows Dr Ann/);
    assert.equal(await two.locator('.room-actions button', { hasText: /control|Take/ }).count(), 0);
    await two.reload();
    await says(two, /^Following/);
    await open(two);
    assert.match(await words(two, 'Cem'), /observer/);

    const again = await one.context().newPage();
    await again.goto(`${world.daemon.url}/rooms/${room}`);
    await says(again, /^Following/);
    await open(again);
    await again.locator('.roster-mark', { hasText: 'one of 2 tabs of the same person' }).first().waitFor();
    await shoot(again, 'roster-tabs');

    const late = await world.newPage(`rooms/${room}#link=${'0'.repeat(32)}`);
    await late.locator('.ended', { hasText: 'You cannot enter this room' }).waitFor();
    assert.match(await late.locator('.ended').textContent(), /ask for a new one/);
    assert.deepEqual(world.errors, []);
  });

  later('a phone that is given control presents by touch; the others keep their panes and sizes', async () => {
    const room = await world.newRoom();
    const [wide, phone] = sizes.map(([, options]) => options);
    const one = await enter(`rooms/${room}`, 'Dr Ann', wide);
    await says(one, /^Presenting/);
    const two = await enter(`rooms/${room}`, 'Ben', phone);
    const three = await enter(`rooms/${room}`, 'Cem', wide);
    await Promise.all([one, two, three].map((page) => full(page)));
    const panes = (page) =>
      page.evaluate(() =>
        [...document.querySelectorAll('.pane:not([hidden])')].map((pane) => {
          const { width, height } = pane.getBoundingClientRect();
          return [pane.dataset.view, Math.round(width), Math.round(height)].join();
        }),
      );
    const before = await Promise.all([one, three].map(panes));
    await open(one);
    await row(one, 'Ben').getByRole('button', { name: 'Give control to Ben' }).click();
    await says(two, /^Presenting/);
    await says(three, /^Following Ben/);
    await one.keyboard.press('Escape');

    const shown = await matrix(two, 1);
    const box = await two.locator('#picture-1').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    const session = await two.context().newCDPSession(two);
    const touch = (type, touchPoints) => session.send('Input.dispatchTouchEvent', { type, touchPoints });
    await touch('touchStart', [{ x, y, id: 0 }]);
    for (let step = 1; step <= 6; step++) await touch('touchMove', [{ x: x + 15 * step, y, id: 0 }]);
    await touch('touchEnd', []);
    await ask(
      () => matrix(two, 1),
      (now) => now !== shown,
    );
    for (const page of [one, three]) await showsAs(page, two);
    assert.deepEqual(await Promise.all([one, three].map(panes)), before);
    assert.deepEqual(await axe(two), []);
    await shoot(two, 'roster-phone-presents');
    await open(two);
    const targets = await two
      .locator('.room-members button:visible, .room-actions button:visible')
      .evaluateAll((buttons) =>
        buttons
          .map((button) => [button.textContent.trim(), button.getBoundingClientRect()])
          .filter(([, { width, height }]) => width < 44 || height < 44),
      );
    assert.deepEqual(targets, []);
    await shoot(two, 'roster-phone-roster');
    await open(one);
    await action(one, 'Take control').click(); // the role of presenter takes it back
    await says(one, /^Presenting/);
    await says(two, /^Following Dr Ann/);
    await Promise.all([one, two, three].map((page) => page.context().close()));
  });
});
