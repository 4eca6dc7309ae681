// Plots of dose: drawer, table twins, files, limits, print. Numbers come from doses with a closed form (dose_stub.mjs).
import assert from 'node:assert/strict';
import { after, before, describe } from 'node:test';
import { call } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { bytesOf, full, later, missing, once, shoot, startWorld } from './browser.mjs';
import { evenly, stubDose } from './dose_stub.mjs';
import { overlaps } from './overlap.mjs';
import { sizes } from './room_states.mjs';

describe('plots of dose', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
    assert.deepEqual(world?.errors ?? [], []);
  });

  /** A room whose questions about dose are answered by the stub. @returns {Promise<{page, room: string, asked: object[]}>} */
  async function open(options = sizes.wide, how = {}) {
    const page = await world.newPage('healthz', options);
    const asked = await stubDose(page, how);
    const room = await world.newRoom();
    await page.goto(`${world.daemon.url}/rooms/${room}`);
    await full(page);
    return { page, room, asked };
  }

  const plots = '[aria-label="Plots of dose"].tool';
  const cells = (page, name) =>
    page
      .locator(`[aria-label="${name}"] tbody tr`)
      .evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent.trim())));
  const saved = async (page, click) => {
    const [download] = await Promise.all([page.waitForEvent('download'), click()]);
    return { name: download.suggestedFilename(), text: (await bytesOf(download)).toString() };
  };

  once('the code of the plots is loaded when they are first opened, by key V, and the drawer takes 220 px of the panes alone', async () => {
    const { page } = await open();
    const loaded = () =>
      page.evaluate(
        () =>
          performance
            .getEntriesByType('resource')
            .map(({ name }) => name)
            .filter((name) => /charts-/.test(name)).length,
      );
    assert.equal(await loaded(), 0);
    await page.locator('#picture-2').focus();
    await page.keyboard.press('v');
    await page.locator('.chart-dvh canvas').waitFor();
    assert.equal(await loaded(), 1);
    const box = (selector) => page.locator(selector).boundingBox();
    const [drawer, main, tree] = [await box('.chart-drawer'), await box('main'), await box('.tree')];
    assert.equal(drawer.height, 220);
    assert.deepEqual([drawer.x, drawer.width], [main.x, main.width]);
    assert.equal(tree.y + tree.height, drawer.y + drawer.height, 'the tree keeps its height');
    await page.locator('.chart-profile .chart-foot').waitFor();
    await page.locator('.chart-here b').waitFor();
    for (const width of [1440, 1280]) {
      await page.setViewportSize({ width, height: 900 });
      const cut = await page.evaluate(() =>
        [...document.querySelectorAll('.chart-foot > span, .chart-here')]
          .filter((element) => {
            const range = document.createRange();
            range.selectNodeContents(element);
            const part = element.closest('.chart-part').getBoundingClientRect();
            const isOut = [...range.getClientRects()].some(
              ({ left, right, bottom }) => left < part.left || right > part.right || bottom > part.bottom,
            );
            return isOut || element.scrollWidth > element.clientWidth + (element.clientWidth ? 0 : element.scrollWidth);
          })
          .map(({ textContent }) => textContent.trim()),
      );
      assert.deepEqual(cut, [], `words of the axes and the value at the crosshair at ${width}`);
    }
    await page.keyboard.press('v');
    assert.equal(await page.locator('.chart-drawer').isVisible(), false);
    await page.context().close();
  });

  once('without a visible region the drawer says so, from the first', async () => {
    const page = await world.newPage('healthz', sizes.wide);
    const room = await world.newRoom();
    const { regions } = await world.scene(room);
    await call(
      `${world.daemon.url}/api/v1/rooms/${room}/scene`,
      'PATCH',
      { regions: Object.fromEntries(Object.keys(regions).map((id) => [id, { visible: false }])) },
      { 'If-Match': '*' },
    );
    await page.goto(`${world.daemon.url}/rooms/${room}`);
    await full(page);
    await page.locator(plots).click();
    await page.locator('.chart-dvh').getByText('No region is shown.').waitFor();
    await shoot(page, 'charts-no-region');
    await page.context().close();
  });

  once('the tables have the figures, the read-out the share and volume under the pointer, and a region goes with its chip', async () => {
    const { page, asked } = await open();
    await page.locator(plots).click();
    await page.locator('[aria-label="Histogram as a table"]').click();
    await page.locator('[aria-label="Figures of the histograms"] tbody tr').nth(4).waitFor();
    const rows = await cells(page, 'Figures of the histograms');
    assert.deepEqual(
      rows.map(([name]) => name),
      Object.keys(evenly),
    );
    assert.deepEqual(rows[4].slice(1, 9), ['5.51', '5510', '30.0', '40.0', '50.0', '30.4', '40.0', '49.6']);
    await page.locator('[aria-label^="V: dose in"]').fill('35');
    await page.keyboard.press('Enter');
    assert.deepEqual(
      (await cells(page, 'Figures of the histograms')).map((row) => row.at(-1)),
      ['0.0 %', '0.0 %', '0.0 %', '25.0 %', '75.0 %'],
    );
    await page.locator('[aria-label="Histogram as a table"]').click();

    const over = page.locator('.chart-dvh .u-over');
    const { width } = await over.boundingBox();
    await over.hover({ position: { x: width / 2, y: 30 } });
    const [, dose] = /at least ([\d.]+) Gy\(w\)/.exec(await page.locator('.chart-dvh .chart-card').textContent());
    const tumour = (await page.locator('.chart-dvh .chart-card tr', { hasText: 'tumour' }).textContent()).trim();
    const percent = Math.min(100, (50 - Number(dose)) * 5);
    assert.ok(Math.abs(Number(/([\d.]+) %/.exec(tumour)[1]) - percent) < 1, `${tumour} at ${dose}`);

    await page.locator('[aria-label="Choices of the histogram"]').click();
    await page.locator('.chart-chip', { hasText: 'brain' }).click();
    await page.keyboard.press('Escape');
    assert.ok(!(await page.locator('.chart-dvh .chart-plot').getAttribute('aria-label')).includes('brain'));
    assert.equal(asked.filter(({ question }) => question === 'dvh').length, 1, 'the answer has all regions');

    await page.locator('[aria-label="Profile as a table"]').click();
    const depths = await cells(page, 'Doses along the line');
    assert.deepEqual(depths.find(([, place]) => place.startsWith('peak')).slice(0, 4), ['30.0', 'peak, brain', '40.0', '25.0']);
    await page.context().close();
  });

  later(
    'beside the panes two of 420 px and more stay; files say what their numbers depend on; clicks move the crosshair and the coverage',
    async () => {
      const { page, room } = await open({ viewport: { width: 1400, height: 900 } });
      await page.locator(plots).click();
      await page.locator('[aria-label="Plots beside the panes"]').click();
      const boxes = await Promise.all([1, 2].map((n) => page.locator(`.pane[data-view="${n}"]`).boundingBox()));
      for (const { width } of boxes) assert.ok(width >= 419.5, `${width} px`);
      assert.equal(boxes[0].x, boxes[1].x);
      const file = (part, name) => saved(page, () => page.locator(`.chart-${part} .chart-files button`, { hasText: name }).click());
      await page.locator('.chart-dvh canvas').waitFor();
      const { name, text } = await file('dvh', 'CSV');
      assert.equal(name, 'phantom-dvh.csv');
      assert.match(text, /^plan,Phantom: modified Snyder head,phantom\r\n/);
      assert.match(text, /boron in blood \(ppm\),\d/);
      assert.match(text, /\r\ntumour,5\.51,5510,0,30,40,50,/);
      const json = JSON.parse((await file('dvh', 'JSON')).text);
      assert.deepEqual(
        json.histograms.map(({ region, volume }) => [region, volume]),
        Object.entries(evenly).map(([region, [, , cm3]]) => [region, cm3]),
      );
      assert.match((await file('profile', 'CSV')).text, /\r\n30,40,25,8,4,3,12,10000000000,brain\r\n/);
      assert.equal(JSON.parse((await file('profile', 'JSON')).text).peak.depth, 30);

      await page
        .locator('[aria-label="Reference curves beside the profile"]')
        .selectOption({ label: 'water phantom: gamma, fast neutron, Gy' });
      assert.match(await page.locator('.chart-profile .warn').last().textContent(), /not this patient's dose\. Right axis: Gy/);
      assert.deepEqual((await page.locator('.chart-key li').allTextContents()).slice(-2), ['phantom: gamma', 'phantom: fast neutron']);
      await shoot(page, 'charts-reference');
      const before = (await world.scene(room)).image.slices;
      await page.locator('.chart-profile .u-over').click({ position: { x: 200, y: 60 } });
      await page.locator('.chart-dvh .u-over').click({ position: { x: 200, y: 60 } });
      await page.locator('.toast', { hasText: 'Highlighted' }).waitFor();
      await page.waitForFunction(() => document.querySelector('.chart-profile .chart-here'));
      const scene = await world.scene(room);
      assert.notDeepEqual(scene.image.slices, before);
      assert.equal(scene.dose.coverage.visible, true);
      assert.equal(scene.dose.coverage.unit, 'dose');
      await page.context().close();
    },
  );

  later('the pointer over a histogram highlights in the own views alone, and leaves nothing behind', async () => {
    const { page, room } = await open();
    await page.locator(plots).click();
    await page.locator('.chart-dvh canvas').waitFor();
    const override = () => page.evaluate(() => globalThis.beamroom.stats().documents[2].override?.dose?.coverage ?? null);
    await page.locator('.chart-dvh .u-over').hover({ position: { x: 150, y: 40 } });
    await page.waitForFunction(() => globalThis.beamroom.stats().documents[2].override?.dose?.coverage?.visible);
    assert.equal((await override()).unit, 'dose');
    assert.equal((await world.scene(room)).dose.coverage.visible, false, 'the scene is as it was');
    await page.mouse.move(5, 5);
    await page.waitForFunction(() => !globalThis.beamroom.stats().documents[2].override?.dose);
    assert.equal(await page.locator('[aria-label^="Undo"]').isDisabled(), true);
    await page.context().close();
  });

  later('another weight asks again, and hidden plots ask nothing', async () => {
    const { page, room, asked } = await open();
    const n = (question) => asked.filter((one) => one.question === question).length;
    const patch = (blood_ppm) =>
      call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { dose: { blood_ppm } }, { 'If-Match': '*' });
    await patch(16);
    assert.equal(n('dvh'), 0);
    await page.locator(plots).click();
    await page.locator('.chart-dvh canvas').waitFor();
    assert.deepEqual([n('dvh'), n('profile')], [1, 1]);
    await Promise.all([page.waitForRequest(/\/dvh\?/), page.waitForRequest(/\/profile\?/), patch(17)]);
    await page.locator('.chart-dvh:not(.old)').waitFor();
    await Promise.all([page.waitForRequest(/\/dvh\?/), page.locator('[data-region="scalp"] .eye').click()]);
    await page.waitForFunction(() => !document.querySelector('.chart-dvh .chart-plot').getAttribute('aria-label').includes('scalp'));
    assert.deepEqual([n('dvh'), n('profile')], [3, 2], 'the profile does not depend on which regions are shown');
    assert.equal(asked.findLast(({ question }) => question === 'dvh').regions, 'cranium,brain,target,tumour');
    await page.context().close();
  });

  later('limits: added, edited, imported, exported, removed, each with its value, an icon and a word', async () => {
    const constraints = {};
    const { page, room } = await open(sizes.wide, { constraints });
    const known = async () => {
      for (const [id, one] of Object.entries((await world.scene(room)).constraints)) constraints[id] = one;
    };
    await page.getByRole('tab', { name: 'Plan', exact: true }).click();
    await page.getByRole('button', { name: 'Add a limit' }).click();
    await page.locator('#limit-region').selectOption('brain');
    await page.locator('#limit-quantity').selectOption('weighted');
    await page.locator('#limit-metric').fill('D95');
    await page.locator('#limit-limit').fill('10');
    await page.locator('#limit-side').selectOption('at-most');
    await page.getByRole('button', { name: 'Add it' }).click();
    assert.match(await page.locator('.chart-form .refusal').textContent(), /“D95” is no figure/);
    await page.locator('#limit-metric').fill('max');
    constraints['limit-1'] = { region: 'brain', quantity: 'weighted', metric: 'max', side: 'at-most', limit: 10 };
    await page.getByRole('button', { name: 'Add it' }).click();
    await page.locator('[data-limit="limit-1"] .chart-verdict.ok', { hasText: 'met' }).waitFor();
    assert.match(await page.locator('[data-limit="limit-1"]').textContent(), /brain[\s\S]*max ≤ 10\.0 Gy\(w\)[\s\S]*8\.00 Gy\(w\)/);

    const lines = (...rows) => ({
      name: 'limits.csv',
      mimeType: 'text/csv',
      buffer: Buffer.from(['region,quantity,metric,side,limit', ...rows].join('\n')),
    });
    await page.locator('.chart-limits input[type=file]').setInputFiles(lines('liver,weighted,max,at-most,1'));
    assert.match(
      await page.locator('.chart-limits > .refusal').textContent(),
      /limits\.csv was not read\. Line 2: The plan has no region “liver”/,
    );
    constraints['limit-2'] = { region: 'tumour', quantity: 'weighted', metric: 'min', side: 'at-least', limit: 31 };
    constraints['limit-3'] = { region: 'tumour', quantity: 'boron', metric: 'mean', side: 'at-least', limit: 3 };
    await page
      .locator('.chart-limits input[type=file]')
      .setInputFiles(lines('brain,weighted,max,at-most,10', 'tumour,weighted,min,at-least,31', 'tumour,boron,mean,at-least,3'));
    await page.locator('[data-limit="limit-2"] .chart-verdict.err', { hasText: 'not met' }).waitFor();
    await page.locator('[data-limit="limit-3"] .chart-verdict.warn', { hasText: 'not known' }).waitFor();
    assert.match(await page.locator('[data-limit="limit-3"]').textContent(), /The dose has no mean of boron/);
    assert.equal(Object.keys((await world.scene(room)).constraints).length, 3, 'one was there already');
    await shoot(page, 'charts-limits');
    assert.deepEqual(await axe(page), []);
    const { text } = await saved(page, () => page.locator('.chart-limits button', { hasText: /^\s*CSV$/ }).click());
    assert.match(text, /\r\ntumour,weighted,min,at-least,31,30,Gy\(w\),no,,tumour,,,\r\n/);

    await page.locator('[data-limit="limit-2"] [aria-label^="Edit"]').click();
    await page.locator('#limit-limit').fill('29');
    constraints['limit-2'] = { ...constraints['limit-2'], limit: 29 };
    await page.getByRole('button', { name: 'Change it' }).click();
    await page.locator('[data-limit="limit-2"] .chart-verdict.ok').waitFor();
    await page.locator('[data-limit="limit-1"] [aria-label^="Remove"]').click();
    await page.locator('[data-limit="limit-1"]').waitFor({ state: 'detached' });
    await known();
    assert.deepEqual(Object.keys(constraints).length, 3);
    await page.context().close();
  });

  later('the report to print has plots and tables, a band and bounds where a part has no dose, and says whose weights count', async () => {
    const { page } = await open(sizes.wide, { partial: 'brain', constraints: {} });
    await page.locator('[aria-label="Snapshot"]').click();
    await page.getByRole('menuitem', { name: /Report to print/ }).click();
    await page.locator('.chart-paper').nth(1).waitFor();
    assert.deepEqual(
      await page
        .locator('.chart-paper')
        .evaluateAll((plots) => plots.map((plot) => plot.querySelectorAll('path:not(.chart-paper-band)').length)),
      [5, 5],
    );
    assert.equal(await page.locator('.chart-paper-band').count(), 1);
    assert.match(await page.locator('.chart-paper-key').first().textContent(), /brain: in the band, 50 % has no dose/);
    const brain = (await cells(page, 'Figures of the histograms')).find(([name]) => name === 'brain');
    assert.deepEqual([brain[2], ...brain.slice(4, 7)], ['719', '≤\u00a00.500', '≥\u00a02.13', '≥\u00a08.00']); // half of it, at 4.25 on average
    assert.match(
      await page
        .locator('.chart-paper')
        .first()
        .evaluate((plot) => plot.previousElementSibling.textContent),
      /weights: each region's own weights.*own univels, without regions inside/,
    );
    assert.ok((await cells(page, 'Figures of the histograms')).length === 5);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'charts-print');
    await page.context().close();
  });

  once(
    'of the daemon: volumes are those of the plan, a limit is held to the maximum that the histogram has, and files are of the scene',
    async () => {
      const room = await world.newRoom();
      const page = await world.newPage(`rooms/${room}`);
      await full(page);
      await page.locator(plots).click();
      await page.locator('[aria-label="Histogram as a table"]').click();
      const { json: plan } = await call(`${world.daemon.url}/api/v1/plans/phantom`);
      await page
        .locator('[aria-label="Figures of the histograms"] tbody tr')
        .nth(plan.regions.length - 1)
        .waitFor();
      const rows = new Map(
        (await cells(page, 'Figures of the histograms')).map(([name, cm3, univels, , , max]) => [
          name.replace(/ [\d.]+ cm³ without dose$/, ''),
          { cm3: Number(cm3), univels: Number(univels.replace(/\D/g, '')), max: Number(max) },
        ]),
      );
      for (const { name, volume_cm3: cm3, voxels } of plan.regions) {
        assert.ok(Math.abs(rows.get(name).cm3 - cm3) < 0.006, name);
        assert.equal(rows.get(name).univels, voxels, name);
      }
      const scene = async () => (await world.scene(room)).dose;
      await page.locator('[aria-label="Univels of a region"]').selectOption({ label: 'whole region' });
      await page.waitForFunction(
        ([n]) =>
          [...document.querySelectorAll('[aria-label="Figures of the histograms"] tbody tr')].some(
            (row) => /^brain/.test(row.textContent.trim()) && Number(row.children[2].textContent.replace(/\D/g, '')) > n,
          ),
        [rows.get('brain').univels],
      );
      assert.equal((await scene()).population, 'whole');
      await page.locator('[aria-label="Univels of a region"]').selectOption({ label: 'own univels, without regions inside' });
      const { max } = rows.get('brain');
      await call(
        `${world.daemon.url}/api/v1/rooms/${room}/scene`,
        'PATCH',
        {
          constraints: {
            a: { region: 'brain', quantity: 'weighted', metric: 'max', side: 'at-most', limit: max * 1.02 },
            b: { region: 'brain', quantity: 'weighted', metric: 'max', side: 'at-most', limit: max * 0.98 },
            c: { region: 'brain', quantity: 'isoeffective', metric: 'max', side: 'at-most', limit: 1 },
          },
        },
        { 'If-Match': '*' },
      );
      await page.getByRole('tab', { name: 'Plan', exact: true }).click();
      for (const [id, word] of [
        ['a', 'met'],
        ['b', 'not met'],
        ['c', 'not known'],
      ])
        await page.locator(`[data-limit="${id}"] .chart-verdict`, { hasText: new RegExp(`^\\s*${word}$`) }).waitFor();
      assert.ok((await page.locator('[data-limit="a"] .chart-value').textContent()).startsWith(max.toPrecision(3)));
      // 0.98 of the maximum, as the table rounds it, is reached after 0.98 of the unit that the dose is per
      const ends = page.locator('.chart-ends', { hasText: /0\.9(79|80|81) min at 1e10 n\/cm²\/s/ });
      await ends.waitFor();
      assert.match(await ends.textContent(), /brain max ≤ [\d.]+ Gy\(w\) is reached first.*A limit that is not known may come before it/s);
      assert.match(await page.locator('[data-until="c"]').textContent(), /not known: no tissue has parameters of the isoeffective dose/);
      await page.locator('.chart-irradiation').getByLabel('Boron in blood, measured', { exact: true }).fill('30');
      await page.keyboard.press('Tab');
      await page.locator('.chart-irradiation', { hasText: 'boron 30.0 ppm in blood, measured' }).waitFor();
      assert.equal((await world.scene(room)).irradiation.blood_ppm, 30);
      assert.equal((await scene()).blood_ppm, 15, 'what is drawn keeps its boron');
      const [minutes] = /[\d.]+(?= min at)/.exec(await page.locator('.chart-ends').textContent());
      assert.ok(Number(minutes) < 0.98, 'more boron, less time');
      await page.keyboard.press('Control+z');
      await page.locator('.chart-irradiation', { hasText: 'boron 15.0 ppm in blood, as shown' }).waitFor();
      await page.context().close();
    },
  );
  for (const [size, options] of Object.entries(sizes))
    later(`${size}: plots, choices and tables have no overlaps, and axe-core finds nothing`, async () => {
      const { page } = await open(options);
      if (size === 'phone') {
        await page.locator('.dock button', { hasText: 'Probe' }).click();
        await page.getByRole('tab', { name: 'DVH', exact: true }).click();
      } else if (size === 'tablet') await page.locator('.dock button', { hasText: 'DVH' }).click();
      else await page.locator(plots).click();
      await page.locator('.chart-profile canvas').waitFor();
      const steps = [
        ['plots', async () => {}],
        ['choices of the histogram', () => page.locator('[aria-label="Choices of the histogram"]').click()],
        ['nothing open', () => page.keyboard.press('Escape')],
        [
          'tables',
          async () => {
            for (const name of ['Histogram as a table', 'Profile as a table']) await page.locator(`[aria-label="${name}"]`).click();
          },
        ],
        ...(size === 'wide' ? [['beside the panes', () => page.locator('[aria-label="Plots beside the panes"]').click()]] : []),
      ];
      for (const [name, act] of steps) {
        await act();
        assert.deepEqual(await overlaps(page), [], name);
        if (name !== 'nothing open') assert.deepEqual(await axe(page), [], name);
        await shoot(page, `charts-${size}-${name.replaceAll(' ', '-')}`);
      }
      await page.context().close();
    });
});
