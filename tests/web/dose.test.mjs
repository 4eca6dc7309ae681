// Dose on the page: every control changes the scene on the server, by pointer and by keys; numbers on the page are those of the API; acceptance; pins.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe } from 'node:test';
import { call, sleep, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { bytesOf, full, later, missing, once, shoot, startWorld } from './browser.mjs';
import { overlaps } from './overlap.mjs';
import { sizes } from './room_states.mjs';
import { writeStrayDose } from './stray_dose.mjs';
const presets = JSON.parse(readFileSync('proto/dose_presets.json', 'utf8'));

describe('dose on the page', { skip: missing && `${missing} is not there` }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'beamroom-dose-'));
  let world;
  let room;
  let page;

  before(async () => {
    writeStrayDose(folder);
    world = await startWorld({ plans: [folder] });
  });
  after(async () => {
    await world?.stop();
    rmSync(folder, { recursive: true });
  });

  const open = async (plan, options = sizes.wide) => {
    room = await world.newRoom(plan);
    page = await world.newPage(`rooms/${room}`, options);
    await full(page);
    await page.locator('[data-key^="dose:"], [data-section="doses"], .dock').first().waitFor();
  };
  const dose = async () => (await world.scene(room)).dose;
  const comes = async (pick, expected, words = '') => {
    const value = await until(
      async () => pick(await dose()),
      (now) => JSON.stringify(now) === JSON.stringify(expected),
      30000,
    );
    assert.deepEqual(value, expected, words);
  };
  const ask = async (question, plan = 'phantom') =>
    (await call(`${world.daemon.url}/api/v1/plans/${plan}/${question}${question.includes('?') ? '&' : '?'}room=${room}`)).json;
  const field = (label) => page.locator(`#tab-panel [aria-label="${label}"]`);
  const fill = async (label, value) => {
    await field(label).fill(String(value));
    await field(label).press('Enter');
  };
  const select = (label, value) => field(label).selectOption(value);
  const shows = (locator, text) =>
    until(
      () => locator.textContent(),
      (now) => now.includes(text),
      30000,
    ).then((now) => assert.ok(now.includes(text), `"${now}" has no "${text}"`));

  once('the eye of a dose shows lines and wash with a legend; keys D and I switch them', async () => {
    await open('phantom');
    assert.equal(await page.locator('.dose-legend').count(), 0, 'dose is off at first');
    const top = async () => (await page.locator('.panes').boundingBox()).y;
    const free = await top();
    await page.locator('[data-dose="goorley"] .eye').click();
    await comes(({ lines, wash, surfaces }) => [lines.visible, wash.visible, surfaces.visible], [true, true, false]);
    const { reference, unit } = await ask('dose');
    assert.equal(unit, 'Gy(w)');
    const legend = page.locator('.dose-legend.in-strip');
    await shows(legend, `95${(0.95 * reference.value).toPrecision(3)}`);
    await shows(legend, `100 % = ${reference.value.toPrecision(3)} Gy(w), body max`);
    assert.equal((await legend.boundingBox()).height, 28);
    assert.equal((await top()) - free, 28);
    await page.locator('#picture-2').focus();
    await page.keyboard.press('d');
    await comes(({ wash }) => wash.visible, false);
    await page.keyboard.press('i');
    await comes(({ lines }) => lines.visible, false);
    await legend.waitFor({ state: 'detached' });
    assert.equal(await top(), free, 'with all off the panes have its room');
    await page.keyboard.press('i');
    await comes(({ lines }) => lines.visible, true);
    const { x, y, width, height } = await page.locator('#picture-2').boundingBox();
    await page.mouse.move(x + width * 0.52, y + height * 0.55);
    await shows(page.locator('[data-view="2"] .read-out'), 'Gy(w), ');
  });

  once('by keys alone a level is hidden, moved, chosen, edited, removed and added', async () => {
    const tree = page.locator('[role="tree"]');
    await tree.focus();
    const at = () => page.evaluate(() => document.activeElement.getAttribute('aria-activedescendant'));
    await page.keyboard.press('Home');
    for (let n = 0; n < 60 && (await at()) !== 'row-level:level-2'; n++) await page.keyboard.press('ArrowDown');
    assert.equal(await at(), 'row-level:level-2');
    await page.keyboard.press(' ');
    await comes(({ levels }) => levels['level-2'].visible, false);
    await page.keyboard.press('Shift+ArrowRight');
    await comes(({ levels }) => levels['level-2'].value, 91);
    await page.keyboard.press('Enter');
    const { reference } = await ask('dose');
    await page.getByRole('radiogroup', { name: 'Unit of the level' }).locator('button[aria-checked="true"]').focus();
    await page.keyboard.press('ArrowRight');
    await comes(({ levels }) => levels['level-2'].unit, 'dose');
    assert.ok(Math.abs((await dose()).levels['level-2'].value / (0.91 * reference.value) - 1) < 1e-4, 'the same dose in the other unit');
    await fill('Value of the level', 2.5);
    await comes(({ levels }) => levels['level-2'].value, 2.5);
    for (const [name, part] of [
      ['Shown', 'visible'],
      ['Line', 'line'],
      ['Wash', 'wash'],
      ['Surface in 3-D', 'surface'],
    ]) {
      const before = (await dose()).levels['level-2'][part];
      await page.locator('#tab-panel').getByLabel(name, { exact: true }).press(' ');
      await comes(({ levels }) => levels['level-2'][part], !before, name);
    }
    await fill('Opacity in per cent', 70);
    await comes(({ levels }) => levels['level-2'].opacity, 0.7);
    await page.locator('#tab-panel').getByRole('button', { name: 'Remove' }).press('Enter');
    await comes(({ levels }) => 'level-2' in levels, false);
    await page.locator('[data-key="dosing:levels"] button').first().click();
    await comes(({ levels }) => levels['level-2'].value, 40, 'below the lowest, 50 %');
  });

  once('in the rows: value, colour, line, wash and surface of a level, and the wash', async () => {
    const row = page.locator('[data-key="level:level-1"]');
    await row.locator('.dose-value input').fill('93');
    await row.locator('.dose-value input').press('Enter');
    await comes(({ levels }) => levels['level-1'].value, 93);
    await row.locator('input[type="color"]').fill('#123456');
    await comes(({ levels }) => levels['level-1'].color, '#123456');
    for (const [n, part, to] of [
      [0, 'line', false],
      [1, 'wash', false],
      [2, 'surface', true],
    ]) {
      await row.locator('.dose-toggle').nth(n).click();
      await comes(({ levels }) => levels['level-1'][part], to);
    }
    for (const toggle of await row.locator('button').all()) assert.ok((await toggle.boundingBox()).height >= 24);
    await page.locator('[aria-label="Style of the wash"]').selectOption('smooth');
    await comes(({ wash }) => wash.style, 'smooth');
    await page.locator('.dose-from input').fill('25');
    await page.locator('.dose-from input').press('Enter');
    await comes(({ wash }) => wash.below_percent, 25);
    await page.locator('[data-key="dosing:surfaces"] .eye').click();
    await comes(({ surfaces }) => surfaces.visible, true);
  });

  once('in Selection: quantity, reference, tissue, table of levels', async () => {
    await page.locator('[data-dose="goorley"] button.name').click();
    await select('Table of levels', 'BNCT, 10 to 100');
    await comes(
      ({ levels }) =>
        Object.values(levels)
          .map(({ value }) => value)
          .sort((a, b) => b - a),
      [100, 90, 80, 70, 60, 50, 40, 30, 20, 10],
    );
    await select('Quantity', 'gamma');
    await comes(({ quantity }) => quantity, 'gamma');
    await select('Quantity', 'weighted');
    await select('Reference: what 100 % is', 'region-max tumour');
    await comes(({ reference }) => [reference.kind, reference.region], ['region-max', 'tumour']);
    await shows(page.locator('.dose-legend'), ', tumour max');
    await select('Reference: what 100 % is', 'value');
    await fill('Prescribed dose', 12);
    await comes(({ reference }) => [reference.kind, reference.value], ['value', 12]);
    await shows(page.locator('.dose-legend'), '100 % = 12.0 Gy(w), prescription');
    await select('Weights of', 'brain');
    await comes(({ tissue }) => tissue, 'brain');
    await shows(page.locator('.dose-basis.aside'), 'isodose as brain');
    await select('Weights of', '');
    await select('Reference: what 100 % is', 'body');
    await comes(({ reference }) => reference.kind, 'body');
  });

  once('weights come from a preset, an edited number is marked and can be reset; the plan is not changed', async () => {
    const preset = presets.weights[1];
    await select('Set of weights', preset.name);
    await comes(({ weights_name: name }) => name, preset.name);
    const { tissues } = preset;
    const of = (kind) => tissues.find(({ tissue }) => tissue === kind);
    const { weights } = await dose();
    for (const [region, kind] of [
      ['tumour', 'tumour'],
      ['brain', 'brain'],
      ['scalp', 'scalp'],
      ['cranium', 'skull, sinus, ventricles'],
    ])
      assert.deepEqual(
        ['boron_ratio', 'cbe', 'nitrogen', 'fast', 'gamma'].map((name) => weights[region][name]),
        ['boron_ratio', 'cbe', 'nitrogen', 'fast', 'gamma'].map((name) => of(kind)[name]),
        region,
      );
    await fill('tumour: CBE, the weight of boron', 4);
    await comes(({ weights: now, weights_name: name }) => [now.tumour.cbe, name], [4, `${preset.name}, edited`]);
    assert.equal(await page.locator('.dose-edited').count(), 1);
    await shows(page.locator('.dose-basis.aside'), 'edited');
    await page.locator('[aria-label="Reset the weights"]').click();
    await comes(({ weights: now }) => now.tumour.cbe, of('tumour').cbe);
    assert.ok((await page.locator('#tab-panel').textContent()).includes('Example values, not a prescription. The plan is not changed.'));
    assert.ok((await page.locator('#tab-panel').textContent()).includes(preset.source));
  });

  once('boron in blood moves by keys, and the Probe has the number that follows from it', async () => {
    const point = (scene) => scene.image.slices;
    const slices = point(await world.scene(room));
    const where = `x=${slices.sagittal.position_mm}&y=${slices.coronal.position_mm}&z=${slices.axial.position_mm}`;
    const before = await ask(`dose/probe?${where}`);
    await field('Boron in blood, ppm').focus();
    await page.keyboard.press('ArrowRight');
    await comes(({ blood_ppm: ppm }) => ppm, 15.5);
    await fill('Boron in blood', 30);
    await comes(({ blood_ppm: ppm }) => ppm, 30);
    const boron = ({ components }) => components.find(({ quantity }) => quantity === 'boron').value;
    const now = await ask(`dose/probe?${where}`);
    assert.ok(Math.abs(boron(now) / boron(before) - 2) < 1e-5, 'boron is per ppm');
    await page.getByRole('tab', { name: 'Probe', exact: true }).click();
    await shows(page.locator('.dose-table'), boron(now).toPrecision(3));
    await shows(page.locator('.dose-value-list'), `${now.value.toPrecision(3)} Gy(w)`);
    await shows(page.locator('.status .place-name'), `${now.value.toPrecision(3)} Gy(w)`);
    assert.deepEqual(
      (await page.locator('.dose-table tbody tr').first().locator('td').allTextContents()).filter(Boolean),
      ['Weighted total', now.value.toPrecision(3)],
      'the weighted total is on top',
    );
    assert.deepEqual(await page.locator('.dose-table th').allTextContents(), ['Component', 'Gy', 'weight', 'Gy(w)']);
  });

  once('what is drawn, the factor, and coverage with its volume and share', async () => {
    await page.locator('[data-dose="goorley"] button.name').click();
    const panel = page.locator('#tab-panel');
    for (const [name, pick] of [
      ['Wash on the volume', ({ wash }) => wash.volume],
      ['Clip planes cut surfaces', ({ surfaces }) => surfaces.clipped],
      ['Statistical error as wash', ({ error }) => error],
    ]) {
      const was = pick(await dose());
      await panel.getByLabel(name).press(' ');
      await comes(pick, !was, name);
    }
    await panel.getByLabel('Statistical error as wash').press(' ');
    await fill('Opacity of the wash in per cent', 60);
    await comes(({ wash }) => wash.opacity, 0.6);
    await fill('Width of isodose lines', 2);
    await comes(({ lines }) => lines.width_px, 2);
    await fill('Factor of goorley', 30);
    await comes(({ factor }) => factor, 30);
    await shows(page.locator('.dose-basis.aside'), 'for 30 ×');
    await fill('Factor of goorley', 1);
    await comes(({ factor }) => factor, 1);
    await panel.getByLabel('Highlight the part').press(' ');
    await select('Region of the coverage', 'tumour');
    await fill('Level of the coverage', 90);
    await comes(
      ({ coverage }) => [coverage.visible, coverage.region, coverage.low, coverage.high, coverage.unit],
      [true, 'tumour', null, 90, 'percent'],
    );
    const { share, volume_cm3: volume } = await ask('coverage');
    assert.ok(share > 0 && share <= 1);
    await shows(panel.locator('.dose-result'), `${(share * 100).toFixed(1)} %`);
    assert.ok(volume > 0);
    await page.getByRole('radiogroup', { name: 'Side of the coverage' }).getByRole('radio', { name: 'at least' }).click();
    await comes(({ coverage }) => [coverage.low, coverage.high], [90, null]);
    await panel.getByLabel('Highlight the part').press(' ');
    await comes(({ coverage }) => coverage.visible, false);
  });

  once('values at the crosshair are pinned by a key and by a button, listed, marked, saved and removed', async () => {
    await page.getByRole('tab', { name: 'Probe', exact: true }).click();
    await page.locator('#picture-2').focus();
    await page.keyboard.press('q');
    const probes = async () => Object.values((await world.scene(room)).probes).map(({ at_mm: at }) => at);
    const first = await until(probes, (now) => now.length === 1, 30000);
    const { image } = await world.scene(room);
    ['sagittal', 'coronal', 'axial'].forEach((axis, at) => assert.ok(Math.abs(first[0][at] - image.slices[axis].position_mm) < 1e-3));
    await page.keyboard.press('PageUp');
    await page.getByRole('button', { name: 'Pin these values' }).click();
    await until(probes, (now) => now.length === 2, 30000);
    await page.locator('[data-view="2"] [data-pin="pin-2"]').waitFor();
    assert.equal(await page.locator('[data-view="2"] [data-pin="pin-1"]').count(), 0, 'it lies ten slices away');
    assert.equal(await page.locator('[data-view="1"] .dose-pin').count(), 2);
    const answer = await ask(`dose/probe?${['x', 'y', 'z'].map((name, at) => `${name}=${first[0][at]}`).join('&')}`);
    const row = page.locator('.dose-pins tbody tr').first();
    await shows(row, answer.value.toPrecision(3));
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('.dose-head button', { hasText: 'CSV' }).click()]);
    const lines = (await bytesOf(download)).toString().split('\r\n');
    assert.equal(lines.length, 4);
    assert.ok(lines[0].startsWith('pin,L_mm,P_mm,S_mm,region'));
    assert.ok(lines[1].includes(String(Number(answer.value.toPrecision(7)))), `${lines[1]} has no ${answer.value}`);
    await shoot(page, 'dose-wide');
    await row.getByRole('button', { name: 'Remove pin 1' }).click();
    await until(probes, (now) => now.length === 1, 30000);
    await page.context().close();
  });

  once('a dose that does not fit is not used before a person has it used, is marked then everywhere, and is withdrawn', async () => {
    await open('stray-dose');
    await page.locator('[data-dose="far"] .eye').click();
    await comes(({ id, quantity, wash }) => [id, quantity, wash.visible], ['far', 'total', true]);
    const { fit_reason: reason, drawn } = await ask('dose', 'stray-dose');
    assert.equal(drawn, false);
    const bar = page.locator('.fit-bar');
    await shows(bar, reason);
    await shows(page.locator('[data-dose="far"]'), 'not used');
    assert.equal(await page.locator('.dose-legend').count(), 0);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'fit-bar');
    await bar.getByRole('button', { name: 'Use it all the same …' }).press('Enter');
    const form = page.locator('.fit-block');
    await shows(form, 'does not fit');
    await form.getByLabel('Look first: drawn for me alone').check();
    await form.locator('.fit-looked img').waitFor();
    assert.equal(await page.locator('.dose-legend').count(), 0); // the room's panes show nothing of it
    const use = form.getByRole('button', { name: 'Use it in this room' });
    await form.getByLabel('Why it may be used').selectOption('compared-on-anatomy');
    await form.getByLabel('In your words, at least 10 letters').fill('too short');
    assert.equal(await use.isDisabled(), true);
    await form.getByLabel('In your words, at least 10 letters').fill('a metre away, to see that it is');
    await until(
      () => use.isDisabled(),
      (isOff) => !isOff,
    );
    await sleep(300); // its colours change over a while
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'fit-form');
    await use.click();
    await bar.waitFor({ state: 'detached' });
    assert.equal(await page.locator('.fit-looked').count(), 0);
    for (const view of [1, 2, 3, 4]) await shows(page.locator(`[data-view="${view}"] .pane-head .fit-mark`), 'lies apart');
    await shows(page.locator('.dose-legend'), 'lies apart');
    await shows(page.locator('.dose-basis.aside'), 'lies apart');
    await shows(page.locator('[data-dose="far"]'), 'lies apart');
    await shows(page.locator('#tab-panel'), 'a metre away, to see that it is');
    await shoot(page, 'fit-used');
    await page.getByRole('tab', { name: 'Probe', exact: true }).click();
    await shows(page.locator('#tab-panel'), 'Used though it does not fit');
    await shows(page.locator('#tab-panel'), 'outside the dose grid');
    await page.getByRole('tab', { name: 'Plan', exact: true }).click();
    await shows(page.locator('.fit-table'), 'apart');
    await shows(page.locator('#tab-panel'), 'no patient identity in these files');
    await page.locator('[data-dose="far"] button.name').click();
    await page.locator('#tab-panel').getByRole('button', { name: 'Withdraw' }).click();
    await bar.waitFor();
    assert.equal(await page.locator('.pane-head .fit-mark').count(), 0);
    await page.keyboard.press('Control+z'); // the withdrawal is undone
    await bar.waitFor({ state: 'detached' });
    await page.keyboard.press('Control+Shift+z');
    await bar.waitFor();
  });

  once('a second dose is added or compared, and a total says what it lacks', async () => {
    await page.locator('[data-dose="own"] .eye').click();
    await comes(({ id, quantity }) => [id, quantity], ['own', 'total']);
    await page.locator('[data-dose="own"] button.name').click();
    await select('Quantity', 'weighted');
    await shows(page.locator('.dose-basis.aside'), 'without nitrogen');
    await shows(page.locator('.dose-legend'), 'without nitrogen');
    const panel = page.locator('#tab-panel');
    assert.equal(await panel.getByLabel('+ far').isDisabled(), true);
    await shows(panel, 'does not fit');
    await panel.getByLabel('+ near').press(' ');
    await fill('Factor of near', 2);
    await comes(({ sum }) => sum, { near: { factor: 2 } });
    await panel.getByLabel('+ near').press(' ');
    await comes(({ sum }) => sum, {});
    for (const [name, mode] of [
      ['Lines', 'lines'],
      ['Difference', 'difference'],
      ['Gamma', 'gamma'],
    ]) {
      await page.getByRole('radiogroup', { name: 'Comparison' }).getByRole('radio', { name }).click();
      await comes(({ compare }) => [compare.id, compare.mode], ['near', mode]);
    }
    await fill('Dose difference', 2);
    await fill('Distance to agreement', 3);
    await fill('Leave out below', 20);
    await comes(({ compare }) => [compare.dose_percent, compare.distance_mm, compare.threshold_percent], [2, 3, 20]);
    await shows(page.locator('#tab-panel'), (await ask('gamma', 'stray-dose')).comparison_reason ?? 'Pass rate');
    await page.getByRole('radiogroup', { name: 'Normalization of gamma' }).getByRole('radio', { name: 'point' }).click();
    await comes(({ compare }) => compare.normalization, 'local');
    await page.getByRole('radiogroup', { name: 'Comparison' }).getByRole('radio', { name: 'Off' }).click();
    await comes(({ compare }) => compare.mode, 'none');
    await page.context().close();
  });

  for (const [size, options] of Object.entries(sizes))
    later(`${size}: nothing overlaps while dose is shown, and axe-core finds nothing`, async () => {
      await open('phantom', options);
      if (size === 'compact') await page.locator('[data-section="doses"]').click();
      if (options.hasTouch) {
        await page.locator('.dock button', { hasText: 'Parts' }).click();
        await page.getByRole('tab', { name: 'Doses', exact: true }).click();
      }
      await page.locator('[data-dose="goorley"] .eye').click();
      if (size === 'compact') await page.locator('[aria-label="Pin"]').click();
      await comes(({ wash }) => wash.visible, true);
      await page.locator('.dose-legend').first().waitFor();
      const check = async (words) => {
        assert.deepEqual(await overlaps(page), [], words);
        assert.deepEqual(await axe(page), [], words);
        await shoot(page, `dose-${size}-${words}`);
      };
      await check('section');
      await page.locator('[data-dose="goorley"] button.name').click();
      await page.locator('.dose-weights').waitFor();
      await check('selection');
      await page
        .locator(options.hasTouch ? '.dock button' : '[role="tab"]', { hasText: 'Probe' })
        .first()
        .click();
      await page.locator('.dose-table').waitFor();
      await check('probe');
      await page.context().close();
      assert.deepEqual(world.errors, []);
    });
});
