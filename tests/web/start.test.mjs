// The start page as people use it: rooms, names, thumbnails, folders that are no plans, a full server, a deletion, an address without
// a room; with the keyboard, and without a finding of axe-core in any state.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, demo, openPlan } from '../api/daemon.mjs';
import { Client } from '../api/ws_client.mjs';
import { axe } from './axe.mjs';
import { full, isDue, later, missing, once, shoot, startWorld } from './browser.mjs';
import { cutSegments } from './overlap.mjs';
const sizes = [
  [1280, 720],
  [390, 844],
];

describe('the start page', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;
  const guests = [];

  const enter = async (room, name) => {
    const guest = await Client.open(world.daemon.url, `/api/v1/rooms/${room}/ws`);
    guest.send({ type: 'hello', protocol: 2, name });
    await guest.message('welcome');
    guests.push(guest);
    return guest;
  };
  const newPage = async (address = '', options = {}) => {
    const page = await world.newPage(address, options);
    if (!address) await page.locator('[data-plan]').first().waitFor();
    return page;
  };
  /** areForced: the browser paints in forced colours, which axe-core does not know: it measures the contrast of those in the style sheets. */
  const isClean = async (page, state, areForced = false) =>
    assert.deepEqual(
      (await axe(page)).filter((line) => !areForced || !line.startsWith('color-contrast:')),
      [],
      state,
    );

  /** Pairs of texts, fields and icons of which one lies over the other, as far as each can be seen. */
  const overlaps = (page) =>
    page.evaluate(() => {
      const clipped = (element) => {
        let { left, top, right, bottom } = element.getBoundingClientRect();
        for (let outer = element.parentElement; outer; outer = outer.parentElement) {
          if (getComputedStyle(outer).clipPath !== 'none') return null; // read out, not seen
          if (getComputedStyle(outer).overflowY === 'visible') continue;
          const box = outer.getBoundingClientRect();
          [left, top, right, bottom] = [
            Math.max(left, box.left),
            Math.max(top, box.top),
            Math.min(right, box.right),
            Math.min(bottom, box.bottom),
          ];
        }
        return getComputedStyle(element).clipPath === 'none' && right - left > 1 && bottom - top > 1 ? { left, top, right, bottom } : null;
      };
      const isSticky = (element) => element.closest('.start > .banner'); // lies over what is scrolled under it, by design
      const leaves = [...document.querySelectorAll('.start *')].filter(
        (element) =>
          element.checkVisibility() &&
          element.localName !== 'option' &&
          !element.closest('svg svg, path, dialog') &&
          element.type !== 'file' &&
          ((!element.children.length && element.textContent.trim()) || ['input', 'img', 'svg'].includes(element.localName)) &&
          element.namespaceURI.endsWith(element.localName === 'svg' ? 'svg' : 'xhtml'),
      );
      const boxes = leaves.map((element) => ({ element, box: clipped(element) })).filter(({ box }) => box);
      const found = [];
      for (const [i, a] of boxes.entries())
        for (const b of boxes.slice(i + 1)) {
          if (isSticky(a.element) !== isSticky(b.element) || (a.element.closest('.search') && b.element.closest('.search'))) continue;
          const [width, height] = [
            Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left),
            Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top),
          ];
          if (width > 1 && height > 1)
            found.push([a, b].map(({ element }) => (element.textContent.trim() || element.localName).slice(0, 40)).join(' / '));
        }
      return found;
    });

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-start-'));
    for (const name of ['letters', 'photos']) {
      mkdirSync(join(folder, 'plans', name), { recursive: true });
      writeFileSync(join(folder, 'plans', name, 'a.txt'), 'no plan at all');
    }
    mkdirSync(join(folder, 'plans/broken'), { recursive: true });
    writeFileSync(
      join(folder, 'plans/broken/plan.json'),
      JSON.stringify({ format: 'beamroom-plan', version: 1, name: 'Broken', images: [{ id: 'ct', path: 'ct.nii' }] }),
    );
    world = await startWorld({ plans: [join(folder, 'plans')], args: ['--max-renderers', '2'] });
  });
  after(async () => {
    for (const guest of guests) guest.cut();
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  once('folders that are no plans are a place of their own, and a broken plan is not among them', async () => {
    const page = await newPage();
    assert.equal(await page.locator('.refusal').count(), 1, 'of the broken plan alone');
    assert.equal(await page.locator('[data-place="no-plans"] .n').textContent(), '2');
    await page.locator('[data-place="no-plans"]').press('Enter');
    await page.locator('.no-plans li').nth(1).waitFor();
    assert.deepEqual(await page.locator('.no-plans code').allTextContents(), ['letters', 'photos']);
    assert.equal(await page.locator('[data-plan]').count(), 0);
    await isClean(page, 'folders that are no plans');
    const [own, other] = [`${basename(folder)}/plans`, `${basename(dirname(demo))}/plans`]; // both folders are called "plans"
    const [ownPlace, otherPlace] = [own, other].map((name) => page.locator(`[data-place="folder ${name}"]`));
    await otherPlace.click();
    await page.locator('.list-head', { hasText: `${other}: 1 of 1` }).waitFor();
    await ownPlace.click();
    await page.locator('.list-head', { hasText: `${own}: 1 of 1` }).waitFor();
    assert.deepEqual(await page.locator('[data-plan]').evaluateAll((rows) => rows.map(({ dataset }) => dataset.plan)), ['broken']);
    await page.reload(); // the address keeps the place
    await page.locator('.list-head', { hasText: `${own}: 1 of 1` }).waitFor();
    assert.equal(await ownPlace.getAttribute('aria-current'), 'page');
    await isClean(page, 'a folder');
    await page.goto(`${world.daemon.url}/?place=folder&folder=0123456789abcdef`);
    await page.locator('[data-place="today"][aria-current="page"]').waitFor();
    assert.equal(new URL(page.url()).search, '', 'a folder that is not there gives way to today');
    await page.context().close();
  });

  once('a plan with a room is gone on with; "New room" makes one; a room has a name; "/" finds by it', async () => {
    const page = await newPage();
    const row = page.locator('[data-plan="phantom"]');
    await row.getByRole('button', { name: 'Open Phantom' }).click();
    await full(page);
    const first = page.url().split('/').at(-1);
    await page.locator('.room-chip:visible .chip-main').click();
    await page.getByRole('button', { name: /give this room another name/ }).click();
    await page.getByLabel('Name of this room').fill('Second look');
    await isClean(page, 'naming a room');
    await page.keyboard.press('Enter');
    await page.locator('.room-title', { hasText: 'Second look' }).waitFor();
    assert.equal((await call(`${world.daemon.url}/api/v1/rooms/${first}`)).json.name, 'Second look');
    await page.goto(world.daemon.url);
    await row.locator('.last-room', { hasText: 'Last room: Second look' }).waitFor();
    const isBeside = ([sign, words]) => {
      words.append(' and many more people'.repeat(10));
      const isIt = sign.getBoundingClientRect().right <= words.getBoundingClientRect().left;
      words.lastChild.remove();
      return isIt;
    };
    assert.ok(await row.locator('.last-room .icon, .last-room span:has(> b)').evaluateAll(isBeside), 'the sign stands beside a long text');
    await page.keyboard.press('/');
    await page.keyboard.type('second l');
    await page.locator('.list-head', { hasText: '“second l”: 1 of' }).waitFor();
    await isClean(page, 'a plan with a room');
    await row.getByRole('button', { name: 'Go on with Phantom' }).click();
    await full(page);
    assert.equal(page.url().split('/').at(-1), first, 'the same room');
    await page.goto(world.daemon.url);
    await row.getByRole('button', { name: 'New room on Phantom' }).click();
    await page.waitForURL(/rooms/);
    await full(page);
    const second = page.url().split('/').at(-1);
    assert.notEqual(second, first);
    await page.goto(world.daemon.url); // nobody has changed anything in it
    await row.locator('.last-room', { hasText: 'Second look' }).waitFor();
    assert.equal(await page.locator(`[data-room="${second}"]`).count(), 0, 'it left no trace');
    assert.equal((await call(`${world.daemon.url}/api/v1/rooms/${first}`, 'DELETE')).status, 204);
    await page.context().close();
  });

  later('a plan that is not loaded has no thumbnail and is not loaded for one; a loaded plan has one', async () => {
    const page = await newPage();
    const thumbnail = page.locator('[data-plan="phantom"] .thumb img');
    await page.waitForResponse(/\/api\/v1\/plans\/search$/); // a second list
    assert.equal(await thumbnail.count(), 0);
    assert.equal((await call(`${world.daemon.url}/api/v1/plans/phantom`)).json.state, 'not-loaded');
    await openPlan(world.daemon.url, 'phantom');
    await thumbnail.waitFor();
    assert.deepEqual(
      await thumbnail.evaluate(async (image) => {
        await image.decode();
        return [image.naturalWidth, image.naturalHeight];
      }),
      [192, 116],
    );
    await page.context().close();
  });

  later('a meeting is made, gets cases, is put in order by keys and by drag, loses a case, and is gone into', async () => {
    const page = await newPage();
    await page.getByRole('button', { name: 'New meeting' }).click();
    await page.getByLabel('Name of the meeting').fill('Tumour board');
    await isClean(page, 'making a meeting');
    await page.keyboard.press('Enter');
    const meeting = page.locator('.meeting', { hasText: 'Tumour board' });
    await meeting.waitFor();
    const { meetings } = (await call(`${world.daemon.url}/api/v1/meetings`)).json;
    const at = `${world.daemon.url}/api/v1/meetings/${meetings[0].id}`;
    await page.getByLabel('Find a plan').fill('no such plan'); // what the list shows does not matter for a new case
    await page.locator('.empty', { hasText: 'No plan fits' }).waitFor();
    await meeting.getByRole('button', { name: 'Add a case' }).click();
    const choice = meeting.getByLabel('Plan of the case');
    await choice.locator('option[value="phantom"]').waitFor({ state: 'attached' });
    await meeting.getByLabel('Find its plan').fill('broken');
    await meeting.locator('.note', { hasText: 'No plan fits' }).waitFor(); // it cannot be opened
    assert.equal(await choice.locator('option').count(), 0);
    await meeting.getByLabel('Find its plan').fill('PHANT');
    await choice.locator('option[value="phantom"]').waitFor({ state: 'attached' });
    await isClean(page, 'choosing a case');
    await choice.selectOption('phantom');
    await meeting.getByRole('button', { name: 'Add', exact: true }).click();
    await meeting.locator('.case').waitFor();
    await page.locator('.banner .search input').fill('');
    await meeting.getByRole('button', { name: 'Invite' }).click();
    await meeting.getByLabel('As').selectOption('wall');
    await meeting.getByRole('button', { name: 'Make link' }).click();
    const link = await meeting.getByLabel('The link, told once').inputValue();
    assert.match(link, new RegExp(`^${world.daemon.url}/meetings/${meetings[0].id}#link=[0-9a-f]{32}$`));
    await meeting.locator('.case-links li', { hasText: 'wall' }).waitFor();
    await isClean(page, 'links of a meeting');
    await shoot(page, 'start-meeting-links');
    await meeting.getByRole('button', { name: 'End it: link of wall' }).click();
    await meeting.locator('.case-links li').waitFor({ state: 'detached' });
    assert.deepEqual((await call(`${at}/links`)).json.links, []);
    assert.equal(await meeting.getByRole('link', { name: 'Minutes' }).count(), 0, 'it has not begun');
    const { id: room } = (await call(`${world.daemon.url}/api/v1/rooms`, 'POST', { plan: 'phantom' })).json;
    const added = await call(`${at}/cases`, 'POST', { plan: 'phantom', room });
    assert.equal(added.status, 200, added.text);
    const [one, two] = added.json.cases.map(({ id }) => id);
    const orderIs = (...ids) =>
      page.waitForFunction(
        (wanted) => [...document.querySelectorAll('.case')].map(({ dataset }) => dataset.case).join() === wanted,
        ids.join(),
      );
    await orderIs(one, two);
    await isClean(page, 'an agenda');
    await meeting.locator('.case').first().getByRole('button', { name: /down$/ }).press('Enter');
    await orderIs(two, one);
    await meeting.locator(`[data-case="${one}"]`).dragTo(meeting.locator(`[data-case="${two}"]`));
    await orderIs(one, two);
    assert.deepEqual(
      (await call(at)).json.cases.map(({ id }) => id),
      [one, two],
      'so it is on the server',
    );
    await meeting
      .locator(`[data-case="${two}"]`)
      .getByRole('button', { name: /off the agenda$/ })
      .click();
    await orderIs(one);
    await meeting.getByRole('button', { name: 'Name and time' }).click();
    await meeting.getByLabel('Name of the meeting').fill('Tumour board, Friday');
    await page.keyboard.press('Enter');
    await page.locator('.meeting h2', { hasText: 'Tumour board, Friday' }).waitFor();
    await page.locator('.meeting').getByRole('button', { name: 'Begin' }).click();
    await full(page);
    const running = (await call(at)).json;
    assert.deepEqual([running.state, running.cases[0].state, page.url().split('/').at(-1)], ['running', 'now', running.cases[0].room]);
    await page.goto(world.daemon.url);
    await page.locator('.case[data-state="now"]').waitFor();
    await shoot(page, 'start-meeting');
    assert.equal(
      await page.getByRole('link', { name: 'Minutes of Tumour board, Friday' }).getAttribute('href'),
      `/meetings/${meetings[0].id}/minutes`,
    );
    assert.equal((await call(`${at}/end`, 'POST', {})).status, 200);
    const paper = await world.newPage(`meetings/${meetings[0].id}/minutes`);
    await paper.locator('.sheet h1', { hasText: 'Minutes: Tumour board, Friday' }).waitFor();
    await paper.locator('.sheet', { hasText: 'Phantom: modified Snyder head' }).waitFor();
    await isClean(paper, 'minutes of a meeting');
    await paper.context().close();
    const coming = (await call(`${world.daemon.url}/api/v1/meetings`, 'POST', { name: 'Next week', starts_ms: Date.now() + 7 * 86400000 }))
      .json.id;
    await page.locator('.other-meetings summary').click();
    const row = page.locator(`[data-meeting-row="${coming}"]`);
    await row.getByRole('button', { name: 'Show the agenda of Next week' }).click();
    await page.locator(`[data-meeting="${coming}"]`).getByRole('button', { name: 'Add a case' }).waitFor();
    await isClean(page, 'a meeting of another day');
    await shoot(page, 'start-other-meetings');
    await row.getByRole('button', { name: 'Fold the agenda of Next week' }).click();
    await page.locator(`[data-meeting="${coming}"]`).waitFor({ state: 'detached' });
    assert.equal((await call(`${world.daemon.url}/api/v1/meetings/${coming}`, 'DELETE')).status, 204);
    assert.equal((await call(at, 'DELETE')).status, 204);
    await call(`${world.daemon.url}/api/v1/rooms/${running.cases[0].room}`, 'DELETE');
    await call(`${world.daemon.url}/api/v1/rooms/${room}`, 'DELETE');
    await page.context().close();
  });

  once('name, colours and size are chosen here, asked for once, and go along into a room that is joined with one click', async () => {
    const room = await world.newRoom();
    await enter(room, 'Dr Alvarez');
    const page = await newPage();
    await page.getByLabel('Your name').fill('Maija');
    await page.keyboard.press('Enter');
    await page.locator('.own-name').waitFor({ state: 'detached' });
    const look = page.getByRole('button', { name: 'Size and colours of the page' });
    await look.click();
    await page.getByRole('radio', { name: 'Light' }).click();
    await page.getByRole('radio', { name: '125 %' }).click();
    await isClean(page, 'choosing size and colours');
    assert.deepEqual(await cutSegments(page), []);
    await page.keyboard.press('Escape');
    await page.locator('.look-card').waitFor({ state: 'detached' });
    assert.equal(await look.evaluate((button) => button === document.activeElement), true);
    const open = page.locator('.banner .popover:visible');
    for (const [button, card] of [
      [page.getByRole('button', { name: 'Upload' }), '.upload-card'],
      [look, '.look-card'],
      [page.getByRole('button', { name: 'Join a room' }), '.invite'],
      [page.getByRole('button', { name: 'Maija', exact: true }), '#change-name'],
    ]) {
      await button.click();
      await page.locator(`.banner ${card}:visible`).waitFor();
      assert.equal(await open.count(), 1, `${card} alone is open`);
    }
    await page.locator('main').click({ position: { x: 2, y: 2 } });
    await open.waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Upload' }).click();
    await page.locator('.upload-card:visible').waitFor();
    await page.locator('main').click({ position: { x: 2, y: 2 } });
    await page.locator('.upload-card').waitFor({ state: 'hidden' });
    const row = page.locator(`[data-room="${room}"]`);
    assert.match(await row.textContent(), /Dr Alvarez/);
    await row.getByRole('button').click();
    await full(page);
    assert.deepEqual(
      await page.evaluate(() => [document.documentElement.dataset.colours, document.documentElement.style.getPropertyValue('--page')]),
      ['light', '1.25'],
    );
    await page.evaluate(() => localStorage.removeItem('beamroom look'));
    assert.deepEqual((await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json.members.map(({ name }) => name).sort(), [
      'Dr Alvarez',
      'Maija',
    ]);
    await page.goto(`${world.daemon.url}/#/`);
    await page.locator('[data-plan]').first().waitFor();
    assert.equal(await page.locator('main .own-name').count(), 0, 'asked once');
    await page.getByRole('button', { name: 'Maija', exact: true }).click();
    await isClean(page, 'changing the name');
    await page.getByLabel('Your name').fill('Dr Ojala');
    await page.keyboard.press('Enter');
    await page.getByRole('button', { name: 'Dr Ojala', exact: true }).waitFor();
    await page.context().close();
  });

  later('a full server says so for itself, and the plan is not refused', async () => {
    const page = await newPage();
    const second = await upload(page, 'Second');
    const {
      json: { id: room },
    } = await call(`${world.daemon.url}/api/v1/rooms`, 'POST', { plan: second });
    for (const name of ['Chen', 'Dr B']) await enter(room, name);
    await enter(await world.newRoom(), 'Dr Alvarez'); // on the first plan
    const id = await upload(page, 'Third');
    await page.locator(`[data-plan="${id}"] button`, { hasText: 'Open' }).click(); // people look at the two plans that may be open
    await page.locator('.notice', { hasText: 'The server is full' }).waitFor();
    await shoot(page, 'start-full');
    assert.equal(await page.locator(`[data-plan="${id}"] .refusal`).count(), 0);
    assert.equal(await page.locator(`[data-plan="${id}"] .plan-state`).textContent(), 'Not loaded');
    await isClean(page, 'full');
    await page.locator('.notice button').click();
    await page.locator('.notice').waitFor({ state: 'detached' });
    await page.context().close();
  });

  later('before a plan is deleted, who is looking at it is named; with the keyboard too', async () => {
    const page = await newPage();
    const id = 'second'; // where Chen and Dr B are
    await page.locator(`[data-plan="${id}"] [aria-label^="Delete"]`).focus();
    await page.keyboard.press('Enter');
    const dialog = page.getByRole('alertdialog');
    await dialog.getByText('2 people are looking at it').waitFor();
    assert.match(await dialog.textContent(), /Chen and Dr B/);
    assert.equal(await page.evaluate(() => document.activeElement.textContent), 'Keep', 'the safe answer has the focus');
    await shoot(page, 'start-delete-warning');
    await isClean(page, 'delete dialog');
    await page.keyboard.press('Escape');
    await dialog.waitFor({ state: 'hidden' });
    assert.match(await page.evaluate(() => document.activeElement.getAttribute('aria-label')), /^Delete/, 'the focus is back');
    assert.equal((await call(`${world.daemon.url}/api/v1/plans/${id}`)).status, 200);
    await page.keyboard.press('Enter');
    await dialog.getByText('2 people are looking at it').waitFor();
    await dialog.getByRole('button', { name: 'Delete for good' }).click();
    await page.locator(`[data-plan="${id}"]`).waitFor({ state: 'detached' });
    await page.context().close();
  });

  later('an address without a room says so, and offers its plan in a new room', async () => {
    await enter(await world.newRoom(), 'Dr Alvarez');
    const page = await newPage('#/rooms/nowhere/phantom');
    const card = page.locator('.ended', { hasText: 'There is no room at this address' });
    await card.waitFor();
    assert.equal(await page.locator('.panes').isVisible(), false);
    await card.getByRole('button', { name: 'Join' }).first().waitFor(); // where Dr Alvarez is
    await isClean(page, 'unknown room');
    await shoot(page, 'start-unknown-room');
    await card.getByRole('button', { name: /^Open Phantom.* in a new room$/ }).click();
    await page.waitForURL((url) => /\/rooms\/(?!nowhere)[a-z0-9-]+$/.test(url.href));
    await full(page);
    await page.goto(`${world.daemon.url}/#/rooms/nowhere/letters`);
    await page.locator('.ended', { hasText: 'no longer on this server' }).waitFor();
    await page.locator('.ended a', { hasText: 'All plans' }).click();
    await page.locator('[data-plan]').first().waitFor();
    await page.context().close();
  });

  for (const [width, height] of sizes)
    for (const forcedColors of ['none', 'active'].filter(() => isDue(false)))
      it(`at ${width} x ${height}${forcedColors === 'active' ? ' in forced colours' : ''}, axe-core finds nothing in any state, and nothing is wider than the window`, async () => {
        await openPlan(world.daemon.url, 'phantom'); // a loaded plan has a thumbnail
        const page = await newPage('', { viewport: { width, height }, forcedColors });
        const check = async (state) => {
          await isClean(page, state, forcedColors === 'active');
          const wide = await page.evaluate(() =>
            [...document.querySelectorAll('.start *')]
              .filter(
                (element) =>
                  element.checkVisibility() && !element.closest('.places') && element.getBoundingClientRect().right > innerWidth + 0.5,
              )
              .map((element) => element.outerHTML.slice(0, 80)),
          );
          assert.deepEqual(wide, [], state);
        };
        await page.locator('.thumb img').first().waitFor();
        await check('list');
        await shoot(page, `start-${width}${forcedColors === 'active' ? '-forced' : ''}`);
        await page.locator('button', { hasText: 'Join a room' }).click();
        await check('joining');
        await page.keyboard.press('Escape');
        await page.locator('.banner button', { hasText: 'Upload' }).click();
        await check('choosing files');
        await page.keyboard.press('Escape');
        await page.route('**/api/v1/plans/phantom/open', (route) =>
          route.fulfill({ json: { id: 'j', state: 'running', phase: 'regions', percent: 58 } }),
        );
        await page.route('**/api/v1/jobs/j', (route) =>
          route.fulfill({ json: { id: 'j', state: 'running', phase: 'regions', percent: 58 } }),
        );
        await page.getByRole('button', { name: /^(Open|New room on) Phantom/ }).click();
        await page.getByRole('progressbar').waitFor();
        await check('loading');
        await page
          .locator('[aria-label="Files of a plan"]')
          .setInputFiles([{ name: 'notes.zip', mimeType: 'application/zip', buffer: Buffer.from('no archive at all') }]);
        await page.locator('.upload input[name="name"]').waitFor();
        await check('naming an upload');
        await page.locator('.upload input[name="name"]').press('Enter');
        await page.locator('.upload [role="alert"]').waitFor();
        await check('upload refused');
        await page.getByLabel('Find a plan').fill('no such plan');
        await page.locator('.empty', { hasText: 'No plan fits' }).waitFor();
        await check('nothing found');
        await page.route('**/api/v1/plans/search', (route) => route.abort());
        await page.locator('.notice.bad').waitFor();
        await check('no server');
        await page.context().close();
      });

  for (const [width, height, options] of [
    [1600, 1000, {}],
    [1280, 720, {}],
    [1180, 820, { hasTouch: true, isMobile: true }],
    [390, 844, { hasTouch: true, isMobile: true }],
  ].filter(([size]) => isDue(size === 1280)))
    it(`at ${width} x ${height}, no text lies over another or over a control, and every plan shows its parts and its state`, async () => {
      const page = await newPage('', { viewport: { width, height }, ...options });
      await page.locator('.thumb img').first().waitFor();
      await shoot(page, `start-list-${width}`);
      assert.deepEqual(await overlaps(page), []);
      for (const part of ['.parts .tag', '.plan-state span', '.title code'])
        assert.ok(await page.locator(`[data-plan="phantom"] ${part}`).first().isVisible(), part);
      if (options.hasTouch)
        for (const control of await page.locator('.start button:visible, .start summary:visible').all()) {
          const box = await control.boundingBox();
          assert.ok(box.height >= 24 && box.width >= 24, `${await control.textContent()}: ${box.width} x ${box.height}`);
        }
      await page.context().close();
    });

  once('every control is reached by the keyboard in the order of the page, with a ring around it', async () => {
    await openPlan(world.daemon.url, 'phantom'); // its report has links
    const page = await newPage();
    await page.locator('.load-report .report a').first().waitFor();
    await page.evaluate(() => document.activeElement.blur());
    const seen = [];
    for (let i = 0; i < 80; i++) {
      await page.keyboard.press('Tab');
      const found = await page.evaluate(() => {
        const element = document.activeElement;
        if (element === document.body) return null;
        const { y, x } = element.getBoundingClientRect();
        const region = element.closest('.banner, nav.places, main, aside, footer')?.className || element.closest('main')?.tagName || '';
        return {
          name: element.getAttribute('aria-label') || element.labels?.[0]?.textContent.trim() || element.textContent.trim(),
          region,
          ring: getComputedStyle(element).outlineStyle,
          x,
          y,
        };
      });
      if (!found) break;
      seen.push(found);
    }
    for (const { name, ring } of seen) assert.notEqual(ring, 'none', name);
    const regions = seen.map(({ region }) => region);
    assert.deepEqual([...new Set(regions)], ['banner', 'places', 'MAIN', 'load-report']);
    assert.deepEqual(
      regions,
      [...regions].sort(
        (a, b) => ['banner', 'places', 'MAIN', 'load-report'].indexOf(a) - ['banner', 'places', 'MAIN', 'load-report'].indexOf(b),
      ),
    );
    const names = seen.map(({ name }) => name);
    for (const name of ['Find a plan', 'Join a room', 'Your name, as others in a room see it', 'Upload'])
      assert.ok(names.includes(name), `${name} is among ${names.join(' | ')}`);
    await page.locator('.banner button', { hasText: 'Upload' }).focus();
    await page.keyboard.press('Enter');
    await page.locator('.upload-card').waitFor();
    for (const name of ['Choose files', 'Choose a folder']) {
      await page.keyboard.press('Tab');
      assert.equal(await page.evaluate(() => document.activeElement.textContent.trim()), name);
    }
    await page.keyboard.press('Escape');
    await page.locator('.upload-card').waitFor({ state: 'hidden' });
    assert.equal(await page.evaluate(() => document.activeElement.textContent.trim()), 'Upload');
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));

  /** Sends a copy of a small plan. @returns {Promise<string>} its id */
  async function upload(page, name) {
    const header = Buffer.from(
      'NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 8 8\nspace directions: (10,0,0) (0,10,0) (0,0,10)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n\n',
    );
    const body = Buffer.concat([header, Buffer.alloc(2 * 8 ** 3, 1)]);
    await page
      .locator('[aria-label="Files of a plan"]')
      .setInputFiles([{ name: 'ct.nrrd', mimeType: 'application/octet-stream', buffer: body }]);
    await page.locator('.upload input[name="name"]').fill(name);
    await page.keyboard.press('Enter');
    const id = name.toLowerCase();
    await page.locator(`[data-plan="${id}"]`).waitFor();
    return id;
  }

  it('says in red that it is open to everybody, where it is', async () => {
    const open = await startWorld({ args: ['--open-to-everybody'] });
    try {
      const page = await open.newPage();
      const notice = page.getByRole('note').filter({ hasText: 'Identities are masked here' });
      await notice.waitFor();
      const [red, green, blue] = await notice.locator('b').evaluate((element) => getComputedStyle(element).color.match(/\d+/g).map(Number));
      assert.ok(red > 1.5 * green && red > 1.5 * blue, `rgb ${red} ${green} ${blue}`);
      const above = page.locator('.open-strip', {
        hasText: 'This server is open to everybody who reaches it. Anybody sees every plan here',
      });
      await above.waitFor();
      assert.equal((await above.boundingBox()).height, 36);
      await isClean(page, 'open to everybody');
      await shoot(page, 'start-open');
      const wall = await open.newPage('display/abcd-efgh');
      const strip = wall.getByRole('note').filter({ hasText: 'open to everybody' });
      await strip.waitFor();
      assert.equal((await strip.boundingBox()).height, 36);
      await wall.close();
    } finally {
      await open.stop();
    }
    const page = await newPage();
    assert.equal(await page.getByText(/open to everybody|Identities are masked/i).count(), 0);
    await page.close();
  });
});
