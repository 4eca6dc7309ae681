// Plans that go up by being dropped on the page, while others look at the list, and go again.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, demo, until } from '../api/daemon.mjs';
import { bytesOf, full, later, missing, once, shoot, startWorld } from './browser.mjs';

describe('dropping plans', { skip: missing && `${missing} is not there` }, () => {
  let world;
  let folder;

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-drop-'));
    cpSync(join(demo, 'phantom'), join(folder, 'Kopf 1'), { recursive: true });
    mkdirSync(join(folder, 'letters'));
    writeFileSync(join(folder, 'letters/letter.txt'), 'no plan at all');
    writeFileSync(join(folder, 'large.bin'), Buffer.alloc(8 << 20));
    for (let n = 1; n <= 12; n++) {
      // a list longer than the window
      mkdirSync(join(folder, `plans/refused-${n}`), { recursive: true });
      writeFileSync(
        join(folder, `plans/refused-${n}/plan.json`),
        JSON.stringify({ format: 'beamroom-plan', version: 1, images: [{ id: 'ct', path: 'ct.nii' }] }),
      );
    }
    world = await startWorld({ plans: [join(folder, 'plans')] });
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const isInView = (locator) =>
    locator.evaluate((element) => {
      const box = element.getBoundingClientRect();
      const outer = element.closest('main').getBoundingClientRect();
      return box.top >= outer.top - 1 && box.bottom <= outer.bottom + 1;
    });

  /** Drops files like the browser's own window: folders come as entries to be walked. */
  const drop = async (page, ...files) => {
    const devtools = await page.context().newCDPSession(page);
    const drag = (type) =>
      devtools.send('Input.dispatchDragEvent', { type, x: 500, y: 300, data: { items: [], files, dragOperationsMask: 1 } });
    await drag('dragEnter');
    await drag('dragOver');
    await page.locator('.drop-zone.over').waitFor();
    await drag('drop');
    const field = page.locator('.upload input[name="name"]');
    await field.waitFor();
    await page.waitForFunction(() => document.activeElement?.name === 'name'); // the keyboard goes on where it is asked
    assert.ok(await until(() => isInView(field), Boolean, 60000), 'what is asked can be seen');
    return devtools;
  };
  const uploaded = async () =>
    (await call(`${world.daemon.url}/api/v1/plans`)).json.plans.filter((plan) => plan.uploaded).map((plan) => plan.id);

  later('a dropped folder is a plan for everybody, shown where it can be seen; deleted, those who look at it are told', async () => {
    const one = await world.newPage('', { viewport: { width: 1280, height: 720 } });
    const two = await world.newPage();
    await two.locator('[data-plan]').first().waitFor();
    await one.locator('[data-plan]').first().waitFor();
    await drop(one, join(folder, 'Kopf 1'));
    await one.keyboard.type('Kopf 1');
    await one.keyboard.press('Enter');
    await one.locator('[data-plan="kopf-1"].chosen').waitFor();
    assert.ok(await until(() => isInView(one.locator('[data-plan="kopf-1"]')), Boolean, 60000), 'the new plan can be seen');
    await two.locator('[data-plan="kopf-1"]').waitFor(); // its list finds it by itself
    await two.locator('[data-plan="kopf-1"] button', { hasText: 'Open' }).click();
    await full(two);
    await two.locator('#picture-2').focus();
    await two.keyboard.press('n');
    await two.locator('#note-field-new').fill('Look at the rim again');
    await two.keyboard.press('Control+Enter');
    await two.locator('.notes > li', { hasText: 'Look at the rim' }).waitFor();
    await one.locator('[data-plan="kopf-1"] [aria-label^="Delete"]').click();
    await one.locator('dialog', { hasText: '1 person is looking at it' }).waitFor();
    await shoot(one, 'drop-delete');
    await one.locator('button', { hasText: 'Delete for good' }).click();
    await one.locator('[data-plan="kopf-1"]').waitFor({ state: 'detached' });
    const note = two.locator('.ended[role="alert"]');
    await note.waitFor();
    await note.locator('text=no longer on this server').waitFor();
    await shoot(two, 'drop-ended');
    const [file] = await Promise.all([
      two.waitForEvent('download'),
      note.getByRole('button', { name: 'Save its notes as a file' }).click(),
    ]);
    assert.match((await bytesOf(file)).toString(), /^Notes of the room \S+ on .*\n\n1\. Reviewer 1, .*\n {3}Look at the rim again\n$/);
    await note.locator('a', { hasText: 'All plans' }).click();
    await two.locator('.plans').waitFor();
    assert.deepEqual(await uploaded(), []);
    await Promise.all([one.context().close(), two.context().close()]);
  });

  once('a refused drop says why where one looks, though the list was scrolled down', async () => {
    const page = await world.newPage('', { viewport: { width: 1280, height: 720 } });
    await page.locator('[data-plan="refused-9"]').scrollIntoViewIfNeeded();
    await drop(page, join(folder, 'letters'));
    await page.keyboard.press('Enter');
    const refusal = page.locator('.upload [role="alert"]');
    await refusal.waitFor();
    assert.match(await refusal.textContent(), /no file in the folder is an image/);
    assert.ok(await until(() => isInView(refusal), Boolean, 60000), 'in view');
    await shoot(page, 'drop-refused');
    await page.context().close();
  });

  once('cancelled on a slow link, nothing of it is kept', async () => {
    const page = await world.newPage();
    await page.locator('[data-plan]').first().waitFor();
    const devtools = await page.context().newCDPSession(page);
    await devtools.send('Network.emulateNetworkConditions', {
      offline: false,
      latency: 100,
      downloadThroughput: 1e6,
      uploadThroughput: 4e5,
    });
    await drop(page, join(folder, 'large.bin'));
    await page.keyboard.press('Enter');
    const progress = page.locator('.upload [role="progressbar"]');
    await page.waitForFunction(() => Number(document.querySelector('.upload [role="progressbar"]')?.getAttribute('aria-valuenow')) > 0);
    assert.match(await progress.textContent(), /%\s+Sending/);
    await page.locator('.upload button', { hasText: 'Cancel' }).click();
    await page.locator('.upload').waitFor({ state: 'detached' });
    assert.deepEqual(await until(uploaded, (ids) => ids.length === 0, 60000), []);
    await page.context().close();
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
