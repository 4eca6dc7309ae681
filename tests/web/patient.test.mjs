// Identity of the patient: masked in the banner for everybody, shown to one person who asks, parts of another patient in a section of their own. Made-up DICOM; nobody's data.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { putDose, putPlan, putStructs, putWhole } from '../api/made_dicom.mjs';
import { Client } from '../api/ws_client.mjs';
import { axe } from './axe.mjs';
import { overlaps } from './overlap.mjs';
import { bytesOf, full, missing, shoot, startWorld } from './browser.mjs';

const quirin = { id: '77-30419', name: 'Zweifel^Quirin', birthDate: '19610412' };
const other = { id: '88-50327', name: 'Morgen^Ottilie', birthDate: '19550723', study: '1.2.32', frame: '1.2.42' };

describe('whose plan it is', { skip: missing && `${missing} is not there` }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-patient-'));
  let world;
  let page;
  before(async () => {
    putWhole(join(folder, 'case-1'), quirin, { approval: 'APPROVED' });
    putDose(join(folder, 'case-1'), other, { uid: '1.2.89', file: 'other.dcm' });
    putWhole(join(folder, 'case-2'), quirin, { approval: 'APPROVED' });
    putStructs(join(folder, 'case-2'), quirin, { uid: '1.2.64', file: 'structs2.dcm', left: 2 });
    const second = { uid: '1.2.74', label: 'BNCT-1', file: 'plan2.dcm', beam: 'Back', structs: '1.2.64', approval: 'REJECTED' };
    putPlan(join(folder, 'case-2'), quirin, { ...second, date: '20261012' });
    putDose(join(folder, 'case-2'), quirin, { uid: '1.2.84', plan: '1.2.74', file: 'dose2.dcm' });
    putDose(join(folder, 'case-2'), quirin, { uid: '1.2.85', file: 'dose3.dcm' });
    putWhole(join(folder, 'nameless'), { id: '', name: '', birthDate: '' }, { approval: 'APPROVED' });
    putWhole(join(folder, 'bare'), quirin, { approval: 'APPROVED' });
    putPlan(join(folder, 'bare'), quirin, { uid: '1.2.74', label: 'BNCT-1', file: 'plan2.dcm', beam: 'Back' });
    world = await startWorld({ plans: [folder] });
    page = await world.newPage(`rooms/${await world.newRoom('case-1')}`, { viewport: { width: 1440, height: 900 } });
    await full(page, 2);
  });
  after(async () => {
    await world?.stop();
    rmSync(folder, { recursive: true, force: true });
    assert.deepEqual(world?.errors ?? [], []);
  });
  const shows = (locator, text) =>
    until(
      () => locator.textContent(),
      (now) => now.includes(text),
      30000,
    ).then((now) => assert.ok(now.includes(text), `"${now}" has no "${text}"`));

  it('the banner has the masked patient and the approval; another patient’s dose is named in red and stands in the last section', async () => {
    await shows(page.locator('.banner .patient-button'), 'Q. Z. …419');
    await shows(page.locator('.banner .approval'), 'Approved');
    await shows(page.locator('.fit-bar.err'), 'This folder holds parts of 2 patients. Shown: Q. Z. …419');
    await shows(page.locator('.not-this-patient').last(), 'O. M. …327');
    await page.getByRole('tab', { name: 'Plan', exact: true }).click();
    await shows(page.locator('#tab-panel'), 'Q. Z. …419');
    await shows(page.locator('.fit-table'), 'other');
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'patient-masked');
    const text = await page.evaluate(() => document.documentElement.outerHTML + document.title);
    for (const secret of ['Quirin', 'Zweifel', '77-30419', '1961', 'Ottilie']) assert.ok(!text.includes(secret), secret);
  });

  it('who asks is shown the name, alone, until it is masked again', async () => {
    await page.locator('.patient-button').click();
    await page.getByRole('button', { name: 'Show to me' }).click();
    await shows(page.locator('.patient-button'), 'ZWEIFEL, Quirin');
    await shows(page.locator('.patient-card'), '1961-04-12');
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'patient-shown');
    assert.ok(!(await page.title()).includes('Zweifel'));
    await page.getByRole('button', { name: 'Mask it again' }).click();
    await shows(page.locator('.patient-button'), 'Q. Z. …419');
    assert.ok(!(await page.evaluate(() => document.documentElement.outerHTML)).includes('Quirin'));
  });

  it('a name that is shown is masked after 15 minutes, and where nobody has looked at the page for 5', async () => {
    await page.evaluate(() => {
      const own = { setTimeout: window.setTimeout, clearTimeout: window.clearTimeout },
        late = new Map(); // timers of a minute and more: passes() is their clock
      window.setTimeout = (call, ms = 0, ...rest) => {
        if (ms < 60000) return own.setTimeout.call(window, call, ms, ...rest);
        late.set(-late.size - 1, { call, ms });
        return -late.size;
      };
      window.clearTimeout = (id) => (late.has(id) ? late.set(id, null) : own.clearTimeout.call(window, id));
      window.passes = (minutes) => {
        const due = [...late].filter(([, timer]) => timer?.ms === minutes * 60000);
        for (const [id, { call }] of due) late.set(id, null) && call();
        return due.length;
      };
      window.looksAway = (isHidden) => {
        Object.defineProperty(document, 'hidden', { configurable: true, value: isHidden });
        document.dispatchEvent(new Event('visibilitychange'));
      };
      window.asBefore = () => {
        Object.assign(window, own);
        delete document.hidden;
      };
    });
    const show = async () => {
      if ((await page.locator('.patient-card').count()) === 0) await page.locator('.patient-button').click();
      await page.getByRole('button', { name: 'Show to me' }).click();
      await shows(page.locator('.patient-button'), 'ZWEIFEL, Quirin');
    };
    const after = (minutes) => page.evaluate((n) => window.passes(n), minutes);
    const looksAway = (isHidden) => page.evaluate((is) => window.looksAway(is), isHidden);
    const masked = async () => {
      await shows(page.locator('.patient-button'), 'Q. Z. …419');
      assert.ok(!(await page.evaluate(() => document.documentElement.outerHTML)).includes('Quirin'));
    };
    try {
      await show();
      assert.equal(await after(15), 1);
      await masked();
      await show();
      assert.equal(await after(5), 0); // somebody looks at it
      await looksAway(true);
      await looksAway(false); // and is back in time
      assert.equal(await after(5), 0);
      await shows(page.locator('.patient-button'), 'ZWEIFEL, Quirin');
      await looksAway(true);
      assert.equal(await after(5), 1);
      await masked();
      assert.equal(await after(15), 0); // nothing is left to wait for
      await looksAway(false);
      await masked();
      await looksAway(true); // masked: nobody waits
      assert.equal(await after(5), 0);
    } finally {
      await page.evaluate(() => window.asBefore());
    }
  });

  it('the one person at the server has it shown at once in the next room, and masks it there', async () => {
    const context = page.context();
    if ((await page.locator('.patient-card').count()) === 0) await page.locator('.patient-button').click();
    const box = page.getByRole('checkbox', { name: 'Show at once on this computer' });
    await box.check();
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'patient-at-once');
    await shows(page.locator('.patient-button'), 'Q. Z. …419'); // in the next room
    const next = await context.newPage();
    await next.goto(`${world.daemon.url}/rooms/${await world.newRoom('case-1')}`);
    await shows(next.locator('.patient-button'), 'ZWEIFEL, Quirin');
    await next.locator('.patient-button').click();
    await next.getByRole('button', { name: 'Mask it again' }).click();
    await shows(next.locator('.patient-button'), 'Q. Z. …419');
    await next.close();
    await box.uncheck();
  });

  it('a wall of the room names the patient when that is asked for it, and is masked again by the same button', async () => {
    const room = page.url().split('/').pop();
    const { token: link } = (await call(`${world.daemon.url}/api/v1/rooms/${room}/links`, 'POST', { role: 'wall', expires_s: 600 })).json;
    const display = await world.newPage(`display/${room}#link=${link}`, { viewport: { width: 1280, height: 720 } });
    await shows(display.locator('.wall-patient'), 'Q. Z. …419');
    if ((await page.locator('.patient-card').count()) === 0) await page.locator('.patient-button').click();
    await page.getByRole('button', { name: 'On the wall …' }).click();
    await page.getByRole('button', { name: 'Show the name there' }).click();
    await shows(display.locator('.wall-patient'), 'ZWEIFEL, Quirin');
    assert.equal(await display.getByRole('button', { name: 'Compare identities' }).count(), 0);
    await shoot(display, 'patient-on-wall');
    await page.getByRole('button', { name: 'Mask it there' }).click();
    await shows(display.locator('.wall-patient'), 'Q. Z. …419');
    await display.context().close();
    await page.getByRole('button', { name: 'On the wall …' }).click(); // closed again
    const wall = await Client.enter(world.daemon.url, room, { link });
    const read = () => call(`${world.daemon.url}/api/v1/rooms/${room}/identity`, 'GET', undefined, wall.headers);
    if ((await page.locator('.patient-card').count()) === 0) await page.locator('.patient-button').click();
    await page.getByRole('button', { name: 'On the wall …' }).click();
    await shows(page.locator('.patient-card'), 'Everybody in the room will read the name.');
    assert.deepEqual(await axe(page), []);
    await page.getByRole('button', { name: 'Show the name there' }).click();
    await page.getByRole('button', { name: 'Mask it there' }).waitFor();
    assert.equal((await read()).json.patients[0].name, 'Zweifel^Quirin');
    await shoot(page, 'patient-wall');
    await shows(page.locator('.patient-button'), 'Q. Z. …419'); // the page itself stays masked
    await page.getByRole('button', { name: 'Mask it there' }).click();
    await page.getByRole('button', { name: 'Show the name there' }).waitFor();
    assert.equal((await read()).status, 403);
    wall.cut();
    await shows(page.locator('.patient-card'), 'No wall is in this room');
  });

  it('who may compares the identities of both patients, and masks them again', async () => {
    await page.getByRole('button', { name: 'Compare identities' }).click();
    await shows(page.locator('.identities'), 'ZWEIFEL, Quirin');
    const [shown, other] = await page.locator('.identities tr:has-text("Id") td').allTextContents();
    assert.deepEqual([shown, other], ['77-30419', '88-50327']);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'patient-compared');
    await page.getByRole('button', { name: 'Mask them again' }).click();
    assert.ok(!(await page.evaluate(() => document.documentElement.outerHTML)).match(/Quirin|Ottilie|77-30419/));
  });

  it('who compares them may say that they are one person: their parts are used, and it is withdrawn by the bar', async () => {
    const compare = page.getByRole('button', { name: 'Compare identities' });
    await compare.click();
    await page.getByRole('button', { name: 'They are one person …' }).click();
    await page.getByLabel(/Why they are one person/).fill('The second name is that of her marriage');
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'patient-one-form');
    await page.getByRole('button', { name: 'They are one person', exact: true }).click();
    const bar = page.locator('.fit-bar', { hasText: 'count as of one person' });
    await bar.waitFor();
    assert.match(await bar.textContent(), /The second name is that of her marriage/);
    await until(
      () => compare.count(),
      (n) => n === 0,
    ); // prettier-ignore
    assert.equal(await page.locator('.not-this-patient').count(), 0);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'patient-one');
    await bar.getByRole('button', { name: 'Withdraw the statement' }).click();
    await compare.waitFor();
    await shows(page.locator('.not-this-patient').last(), 'O. M. …327');
    await full(page, 2);
  });

  it('whom the plan is of is stated where the files do not say it, masked like any other, and withdrawn', async () => {
    const own = await world.newPage(`rooms/${await world.newRoom('nameless')}`, { viewport: { width: 1280, height: 720 } });
    await shows(own.locator('.banner .patient'), 'identity unknown');
    await own.getByRole('tab', { name: 'Plan', exact: true }).click();
    await own.getByRole('button', { name: 'State identity …' }).click();
    for (const [label, text] of [
      ['Family name', 'Winterstein'],
      ['Given name', 'Ludmilla'],
      ['Id', '61-20553'],
      ['Born', '1949-02-28'],
    ])
      await own.getByLabel(label, { exact: true }).fill(text);
    assert.deepEqual(await axe(own), []);
    await shoot(own, 'patient-state');
    await own.getByRole('button', { name: 'State it' }).click();
    await shows(own.locator('.banner .patient-button'), 'L. W. …553');
    await shows(own.locator('#tab-panel'), 'stated by');
    assert.ok(!(await own.evaluate(() => document.documentElement.outerHTML)).match(/Ludmilla|Winterstein|61-20553|1949/));
    assert.deepEqual(await axe(own), []);
    await shoot(own, 'patient-stated');
    const { statement } = await (await fetch(`${world.daemon.url}/api/v1/plans/nameless`)).json();
    const stated = `stated by ${statement.by}, ${new Date(statement.time_ms).toLocaleDateString('en-GB', { day: 'numeric', month: 'short' })}`;
    await until(
      () => own.locator('.patient-button [title^="stated by"]').getAttribute('title'),
      (title) => title === stated,
    );
    await own.locator('.patient-button').click();
    await shows(own.locator('.patient-card .patient-stated'), stated);
    await own.getByRole('button', { name: 'Show to me' }).click();
    await shows(own.locator('.patient-button'), 'WINTERSTEIN, Ludmilla');
    await shows(own.locator('.patient-card .patient-stated'), stated);
    await own.getByRole('button', { name: 'Mask it again' }).click();
    await own.keyboard.press('Escape');
    await own.getByRole('button', { name: 'Snapshot', exact: true }).click();
    await own.getByRole('menuitem', { name: /Report to print/ }).click();
    for (const part of ['.facts >> nth=0', '.sheet-foot']) await shows(own.locator(part), `L. W. …553, ${stated}`);
    await own.keyboard.press('Escape');

    const room = own.url().split('/').pop();
    const { token: link } = (await call(`${world.daemon.url}/api/v1/rooms/${room}/links`, 'POST', { role: 'wall', expires_s: 600 })).json;
    const wall = await world.newPage(`display/${room}#link=${link}`, { viewport: { width: 1280, height: 720 } });
    await shows(wall.locator('.wall-whom'), 'L. W. …553');
    await shows(wall.locator('.wall-stated'), stated);
    /** Parts of the head that are cut, or lie over the one before. */
    const pushed = (page, parts) =>
      page.evaluate((list) => {
        const all = list.map((one) => document.querySelector(one));
        const boxes = all.map((one) => one.getBoundingClientRect());
        const cut = list.filter((_, n) => all[n].scrollWidth > all[n].clientWidth + 1 || boxes[n].right > innerWidth);
        return [...cut, ...list.filter((_, n) => n && boxes[n].left < boxes[n - 1].right)];
      }, parts);
    assert.deepEqual(await pushed(wall, ['.wall-whom', '.wall-plan', '.wall-approval']), []);
    const size = await wall
      .locator('.wall-stated')
      .evaluate((one) => (Number.parseFloat(getComputedStyle(one).fontSize) * 1920) / innerWidth);
    assert.ok(size >= 15, `${size} px of a wall of 1920`); // read from 3 m
    assert.deepEqual(await axe(wall), []);
    await shoot(wall, 'patient-stated-wall');

    const start = await world.newPage('', { viewport: { width: 1280, height: 720 } });
    const [row, mine] = [start.locator('.plan[data-plan=nameless]'), start.locator(`.room-row[data-room="${room}"] .title`)];
    for (const width of [1280, 820, 390]) {
      await start.setViewportSize({ width, height: 844 });
      await shows(row.locator('.person'), 'L. W. …553');
      await shows(row.locator('.person'), stated);
      await shows(mine, `L. W. …553, ${stated}`);
      assert.deepEqual(await overlaps(start), [], `at ${width} px`);
      assert.deepEqual(await axe(start), []);
    }
    await shoot(start, 'patient-stated-start-390');
    for (const width of [820, 390]) {
      await own.setViewportSize({ width, height: 844 });
      await own.locator('.patient-button').click();
      await shows(own.locator('.patient-card .patient-stated'), stated);
      const { x, width: wide } = await own.locator('.patient-card').boundingBox();
      assert.ok(x >= 0 && x + wide <= width, `${x} + ${wide} at ${width} px`);
      assert.deepEqual(await pushed(own, ['.patient-button', '.banner .approval']), []);
      assert.deepEqual(await axe(own), []);
      await shoot(own, `patient-stated-${width}`);
      await own.keyboard.press('Escape');
    }
    await own.setViewportSize({ width: 1280, height: 720 });

    await own.getByRole('tab', { name: 'Plan', exact: true }).click();
    await own.getByRole('button', { name: 'Withdraw the statement' }).click();
    await shows(own.locator('.banner .patient'), 'identity unknown');
    await shows(wall.locator('.wall-unknown'), 'identity unknown');
    assert.equal(await wall.locator('.wall-stated').count(), 0);
    await start.reload();
    await shows(row.locator('.person'), 'identity unknown');
    assert.ok(!(await start.locator('body').textContent()).includes('stated by'));
    for (const page of [own, wall, start]) await page.context().close();
  });

  it('the switches for the patient’s identity can be read in the narrowest window', async () => {
    const own = await world.newPage(`rooms/${await world.newRoom('case-1')}`, { viewport: { width: 1000, height: 600 } });
    await own.locator('.patient-button').waitFor();
    await own.setViewportSize({ width: 200, height: 600 });
    const isRead = async (label) => {
      const [box, within] = [await label.boundingBox(), await label.evaluate((one) => one.scrollWidth <= one.clientWidth)];
      assert.ok(within && box.x >= 0 && box.x + box.width <= 200 && box.width >= 120 && box.height <= 60, JSON.stringify(box));
    };
    await own.locator('.patient-button').click();
    await isRead(own.locator('.patient-card label', { hasText: 'Show at once on this computer' }));
    await own.keyboard.press('Escape');
    await own.getByRole('button', { name: 'Snapshot', exact: true }).evaluate((button) => button.click()); // it lies outside
    await isRead(own.locator('.snapshots label', { hasText: 'with the patient’s identity' }));
    await own.getByRole('menuitem', { name: /Film of a turn/ }).click();
    await isRead(own.locator('.film label', { hasText: 'with the patient’s identity' }));
    await shoot(own, 'patient-switch-200');
    await own.context().close();
  });

  it('a snapshot, and a film, has the name only when that is ticked, off each time', async () => {
    const menu = page.getByRole('button', { name: 'Snapshot', exact: true });
    const tick = page.getByRole('checkbox', { name: 'with the patient’s identity' });
    const save = async () => {
      const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('menuitem', { name: /Save/ }).click()]);
      assert.ok(!/Quirin|Zweifel|30419/i.test(download.suggestedFilename()));
      return bytesOf(download);
    };
    await menu.click();
    await tick.check();
    assert.deepEqual(await axe(page), []);
    const named = await save();
    await menu.click();
    assert.equal(await tick.isChecked(), false);
    assert.notDeepEqual(await save(), named);

    const orders = [];
    page.on('request', (one) => one.method() === 'POST' && /\/video$/.test(one.url()) && orders.push(one.postDataJSON().identity));
    for (const isNamed of [true, false]) {
      await menu.click();
      await page.getByRole('menuitem', { name: /Film of a turn/ }).click();
      const dialog = page.getByRole('dialog', { name: 'Film of a turn' });
      const named = dialog.getByRole('checkbox', { name: 'with the patient’s identity' });
      assert.equal(await named.isChecked(), false);
      if (isNamed) await named.check();
      await dialog.getByRole('button', { name: 'Make the film' }).press('Enter');
      await dialog.getByRole('button', { name: 'Cancel', exact: true }).press('Enter');
      await dialog.getByRole('button', { name: 'Make the film' }).waitFor();
      await page.keyboard.press('Escape');
    }
    assert.deepEqual(orders, [true, false]);
  });

  it('of two plans the banner switches dose, beam and structure set together, in one step to undo', async () => {
    const room = await world.newRoom('case-2');
    const two = await world.newPage(`rooms/${room}`, { viewport: { width: 1440, height: 900 } });
    await full(two, 2);
    await shows(two.locator('.banner .plan-name'), 'plan 1 of 2');
    await shows(two.locator('.fit-bar.plain'), '2 plans in this folder. Shown: BNCT-2, approved.');
    const heads = () => two.locator('.row-group').allTextContents();
    assert.deepEqual((await heads()).slice(0, 3), ['Plan BNCT-2 · approved', 'Plan BNCT-1 · rejected', 'No plan stated']);
    const facts = async () => {
      const { dose, beam, regions } = await world.scene(room);
      return [dose.id, beam.id, Object.entries(regions).map(([id, { visible }]) => `${id} ${visible}`)].flat(2);
    };
    const before = await facts();
    const regions = () => two.locator('.row[data-region] .name').allTextContents();
    assert.deepEqual(await regions(), ['Box, structs.dcm', 'Box, structs2.dcm']); // both sets are called Set
    await two.locator('.plan-button').click();
    assert.deepEqual(await axe(two), []);
    await two.getByRole('menuitemradio', { name: /BNCT-1/ }).click();
    await shows(two.locator('.banner .approval'), 'Rejected');
    await shows(two.locator('.fit-bar[role=alert]'), 'This plan was rejected.');
    const document = await (await fetch(`${world.daemon.url}/api/v1/plans/case-2`)).json();
    const of = (list, plan) => list.find((part) => part.plan === document.treatment_plans.findIndex(({ label }) => label === plan)).id;
    const other = await until(facts, (now) => now.join() !== before.join());
    assert.deepEqual(other.slice(0, 2), [of(document.doses, 'BNCT-1'), of(document.beams, 'BNCT-1')]);
    const [first, second] = document.regions;
    assert.deepEqual(other.slice(2).sort(), [`${first.id} false`, `${second.id} true`].sort());
    assert.deepEqual((await heads()).slice(0, 2), ['Plan BNCT-1 · rejected', 'Plan BNCT-2 · approved']);
    await shoot(two, 'patient-plans');
    await two.getByRole('button', { name: /^Undo/ }).first().click();
    await shows(two.locator('.banner .plan-name'), 'plan 1 of 2');
    await until(facts, (now) => now.join() === before.join());
    await two.context().close();
  });

  it('a plan without a dose stands in the switch with the reason, and cannot be chosen', async () => {
    const room = await world.newRoom('bare');
    const own = await world.newPage(`rooms/${room}`, { viewport: { width: 1280, height: 720 } });
    await shows(own.locator('.banner .plan-name'), 'plan 1 of 2');
    const before = await world.scene(room);
    await own.locator('.plan-button').click();
    const [shown, bare] = ['BNCT-2', 'BNCT-1'].map((name) => own.getByRole('menuitemradio', { name: new RegExp(name) }));
    assert.deepEqual([await shown.isEnabled(), await shown.getAttribute('aria-checked')], [true, 'true']);
    await shows(bare, 'no dose in this folder');
    assert.deepEqual([await bare.isEnabled(), await bare.getAttribute('aria-checked')], [false, 'false']);
    await bare.evaluate((button) => button.click()); // nor by a script
    await shows(own.locator('.banner .plan-name'), 'plan 1 of 2');
    assert.deepEqual(await world.scene(room), before);
    assert.deepEqual(await axe(own), []);
    await shoot(own, 'patient-plan-bare');
    await own.context().close();
  });

  it('a plan without DICOM says that it names nobody; the phantom says that it is one', async () => {
    const second = await world.newPage(`rooms/${await world.newRoom('phantom')}`, { viewport: { width: 1440, height: 900 } });
    await shows(second.locator('.banner .patient'), 'PHANTOM');
    await second.context().close();
  });
});
