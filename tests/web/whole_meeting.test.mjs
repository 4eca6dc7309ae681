// A meeting from the first link to the last view: three people in three browsers, through the crash of a renderer and the death of the
// daemon. Screenshots stay in build/test-artifacts/.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, renderersOf, startDaemon, until } from '../api/daemon.mjs';
import { onDisk } from '../api/on_disk.mjs';
import { bytesOf, full, missing, newer, shoot, startWorld } from './browser.mjs';
import { action, enter, matrix, openRoster, row, says, showsAs, toast, turn } from './people.mjs';
import { axialPoint, mark, near, pointAt, project } from './places.mjs';

const wide = { viewport: { width: 1440, height: 900 } },
  small = { viewport: { width: 1100, height: 760 } };
const comesBackMs = 2000; // after the server, as net/connection.js promises
const slack = 10; // where other tests run beside this one

describe('a whole meeting', { skip: missing && `${missing} is not there` }, () => {
  let world, data, room, ann, ben, cem, permalink, recorded;
  const all = () => [ann, ben, cem];
  const meeting = () => call(`${world.daemon.url}/api/v1/rooms/${room}`).then(({ json }) => json);
  const items = (kind) => call(`${world.daemon.url}/api/v1/rooms/${room}/${kind}`).then(({ json }) => json[kind]);
  const note = (page, text) => page.locator('.notes > li').filter({ hasText: text });
  const openNote = async (page, text) => {
    if (page === cem) await page.getByRole('button', { name: 'Show the inspector' }).click(); // a narrow window
    await page.getByRole('tab', { name: /^Notes/ }).click();
    const head = note(page, text).locator('.note-head');
    if ((await head.getAttribute('aria-expanded')) !== 'true') await head.click();
  };
  const presses = async (page, keys) => {
    await page.locator('#picture-1').focus();
    await page.keyboard.press(keys);
  };
  const hides = async (page, region) => {
    const { revision } = await meeting();
    await page.locator(`[data-region="${region}"] .eye`).click();
    await until(
      () => world.scene(room),
      ({ regions }) => !regions[region].visible,
    );
    await newer(page, 1, revision);
  };

  before(async () => {
    data = mkdtempSync(join(tmpdir(), 'beamroom-meeting-'));
    world = await startWorld({ data });
    room = await world.newRoom();
  });
  after(async () => {
    await world?.stop();
    rmSync(data, { recursive: true, force: true });
  });

  it('they join by links with roles', async () => {
    ann = await enter(world, `rooms/${room}`, 'Dr Ann', wide);
    await says(ann, /^Presenting/);
    await full(ann);
    const made = ann.locator('#invite-made');
    const linkFor = async (role, before = '') => {
      await ann.locator('#invite-role').selectOption(role);
      await ann.locator('.invite-form button', { hasText: 'Make link' }).click();
      const link = await until(
        () => made.inputValue(),
        (text) => text !== before,
      );
      return link.slice(link.indexOf('rooms/'));
    };
    await ann.locator('.invite-button').click();
    const reviewer = await linkFor('reviewer');
    ben = await enter(world, reviewer, 'Ben', wide);
    const observer = await linkFor('observer', await made.inputValue());
    cem = await enter(world, observer, 'Cem', small);
    await full(cem);
    await ann.keyboard.press('Escape');
    await says(ann, /^Presenting · 2 follow$/);
    const { members } = await meeting();
    assert.deepEqual(
      members.map(({ name, role }) => [name, role]),
      [
        ['Dr Ann', 'presenter'],
        ['Ben', 'reviewer'],
        ['Cem', 'observer'],
      ],
    );
    await Promise.all(all().map((page) => full(page)));
  });

  it('who follows sees what the presenter shows; who leaves moves nobody, and returns', async () => {
    await turn(ann);
    await Promise.all([ben, cem].map((page) => showsAs(page, ann)));
    await hides(ann, 'scalp');
    await Promise.all(all().map((page) => full(page)));
    const before = await matrix(cem, 1);
    await turn(ben);
    await says(ben, /^On my own/);
    const own = await matrix(ben, 1);
    assert.equal(await matrix(cem, 1), before);
    await turn(ann);
    await showsAs(cem, ann);
    assert.equal(await matrix(ben, 1), own);
    await presses(ben, 'f');
    await says(ben, /^Following Dr Ann$/);
    await showsAs(ben, ann);
    await shoot(ben, 'whole-1-following');
  });

  it('what one points at, the others see on the same anatomy', async () => {
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('p');
    await ann.locator('.point-tools [aria-pressed="true"]').waitFor();
    const { position_mm: s } = (await world.scene(room)).image.slices.axial;
    for (const page of [ben, cem]) {
      let side = 0,
        point,
        movedAt = 0;
      await until(async () => {
        if (performance.now() - movedAt > 2500) {
          // a pointer at rest is taken away
          side = 1 - side;
          point = await axialPoint(ann, 2, await pointAt(ann, 2, [0.46 + 0.004 * side, 0.4]), s);
          movedAt = performance.now();
        }
        return near(await mark(page, 2), await project(page, 2, point));
      }, Boolean);
    }
    await shoot(cem, 'whole-2-pointer');
    await ann.keyboard.press('Escape');
    await until(
      () => ben.locator('.person-pointer').count(),
      (n) => n === 0,
    );
    await ann.keyboard.press('Shift+P');
    for (const page of [ben, cem]) await page.getByRole('button', { name: 'Come', exact: true }).click();
    await ann.getByText('2 of 2 came').waitFor();
    await ann.getByRole('button', { name: 'End', exact: true }).click();
  });

  it('a note names a member, who is told and answers', async () => {
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('n');
    await ann.locator('#note-field-new:focus').waitFor();
    await ann.keyboard.type('Is the margin enough? @Be');
    await ann.locator('.note-names li').first().waitFor();
    await ann.keyboard.press('Enter');
    await ann.keyboard.press('Control+Enter');
    await note(ann, 'Is the margin').waitFor();
    const ben_id = (await meeting()).members.find(({ name }) => name === 'Ben').id;
    assert.deepEqual((await items('notes'))[0].body.mentions, [{ member: ben_id, name: 'Ben' }]);
    await toast(ben, 'Dr Ann mentions you in a note');
    await openNote(ben, 'Is the margin');
    await ben.getByLabel('Reply', { exact: true }).fill('5 mm more, please');
    await ben.getByRole('button', { name: 'Reply', exact: true }).click();
    await ann.locator('.note-replies', { hasText: '5 mm more' }).waitFor();
    await openNote(cem, 'Is the margin');
    await cem.locator('.note-replies', { hasText: '5 mm more' }).waitFor();
    assert.equal(await cem.getByLabel('Reply', { exact: true }).count(), 0, 'an observer reads');
    await shoot(cem, 'whole-3-note-observer');
  });

  it('who follows measures for everybody, under their name, and takes it back', async () => {
    const drawn = (page, id) => page.locator(`[data-view="2"] [data-measure="${id}"]`);
    const measures = async () => Object.entries((await world.scene(room)).measures).map(([id, { author }]) => [id, author]);
    await ben.locator('#picture-2').focus();
    await ben.keyboard.press('m');
    await pointAt(ben, 2, [0.45, 0.4]);
    await ben.mouse.down();
    await pointAt(ben, 2, [0.55, 0.4]);
    await ben.mouse.up();
    for (const page of all()) await drawn(page, 'm1-m2').waitFor();
    assert.deepEqual(await measures(), [['m1-m2', 'Ben']]);
    await says(ben, /^Following Dr Ann$/);
    await shoot(ann, 'whole-3-measure');
    await ben.keyboard.press('Escape');
    await presses(ben, 'Control+z');
    for (const page of all()) await drawn(page, 'm1-m2').waitFor({ state: 'detached' });
    await presses(ben, 'Control+y');
    for (const page of all()) await drawn(page, 'm1-m2').waitFor();
    assert.deepEqual(await measures(), [['m1-m2', 'Ben']]);
  });

  it('control is requested, refused, given, taken and locked; each takes back what is theirs', async () => {
    const asks = async () => {
      await openRoster(ben);
      await action(ben, 'Request control').click();
      const line = ann.locator('.request-line', { hasText: 'Ben requests control' });
      await line.waitFor();
      return line;
    };
    await (await asks()).getByRole('button', { name: 'Refuse' }).click();
    await toast(ben, 'Dr Ann keeps control for now.');
    await openRoster(ann);
    await row(ann, 'Ben').getByRole('button', { name: 'Give control to Ben' }).click();
    await says(ben, /^Presenting/);
    await toast(ann, 'Ben presents now. You follow.');
    await hides(ben, 'brain');
    await openRoster(ann);
    await action(ann, 'Take control').click();
    await says(ann, /^Presenting/);
    const turned = await matrix(ann, 1);
    await presses(ann, 'Control+z'); // her own: the camera, then the scalp; never Ben's brain
    await until(
      () => matrix(ann, 1),
      (now) => now !== turned,
    );
    await presses(ann, 'Control+z');
    const { regions } = await until(
      () => world.scene(room),
      (scene) => scene.regions.scalp.visible,
    );
    assert.equal(regions.brain.visible, false);
    await openRoster(ann);
    await action(ann, 'Lock control').click();
    await says(ann, /^Presenting, locked/);
    await openRoster(ben);
    await ben.locator('.roster-locked').waitFor();
    await shoot(ben, 'whole-4-locked');
    await ben.keyboard.press('Escape');
    await openRoster(ann);
    await action(ann, 'Unlock').click();
    await says(ann, /^Presenting · 2 follow$/);
  });

  it('a view is saved; its link opens a room of its own and leaves the meeting as it is', async () => {
    await ann.getByRole('treeitem', { name: /^Save this view/ }).click();
    await ann.getByLabel('Name of the view').fill('Margin');
    await ann.getByRole('button', { name: 'Save', exact: true }).click();
    permalink = await ann.getByLabel('Link to it').inputValue();
    const before = await meeting();
    const own = await world.newPage(permalink.slice(world.daemon.url.length + 1), small);
    await full(own);
    await own.getByText('“Margin” in a new room of its own.').waitFor();
    assert.equal((await world.scene((await own.evaluate(() => location.pathname)).split('/')[2])).regions.brain.visible, false);
    await own.context().close();
    const later = await meeting();
    assert.deepEqual([later.revision, later.members.length], [before.revision, 3]);
  });

  it('the crash of the renderer costs a moment: the last picture stays, then it goes on', async () => {
    await Promise.all(all().map((page) => full(page)));
    const { revision } = await meeting();
    const [old] = renderersOf(world.daemon.child.pid);
    process.kill(old, 'SIGKILL');
    await Promise.all(
      all().flatMap((page) => ['Renderer restarting. The last picture stays', 'Picture restored'].map((words) => toast(page, words))),
    );
    assert.notDeepEqual(renderersOf(world.daemon.child.pid), [old]);
    assert.equal((await meeting()).revision, revision, 'the scene is the same');
    await turn(ann);
    await Promise.all([ben, cem].map((page) => showsAs(page, ann)));
  });

  it('the death of the daemon costs seconds: room, people, scene, views, notes and saved views come back', async (t) => {
    const [before, scene, notes, saved, shown] = [
      await meeting(),
      await world.scene(room),
      await items('notes'),
      await items('bookmarks'),
      await matrix(ann, 1),
    ];
    await until(
      () => onDisk(room, data),
      (kept) => kept?.revision === before.revision && JSON.stringify(kept.views).includes('camera'),
    );
    const host = new URL(world.daemon.url).host,
      ended = new Promise((done) => world.daemon.child.on('exit', done));
    world.daemon.child.kill('SIGKILL');
    await ended;
    await Promise.all(all().map((page) => page.waitForFunction(() => globalThis.beamroom.stats().badges[1] === 'disconnected')));
    await shoot(cem, 'whole-6-disconnected');
    const nFrames = await Promise.all(all().map((page) => page.evaluate(() => globalThis.beamroom.stats().frames_of[1])));
    world.daemon = await startDaemon({ data, args: ['--listen', host] });
    const up = performance.now();
    await Promise.all(all().map((page) => page.waitForFunction(() => globalThis.beamroom.stats().badges[1] !== 'disconnected')));
    const connectedMs = performance.now() - up;
    await Promise.all(all().map((page, at) => page.waitForFunction((n) => globalThis.beamroom.stats().frames_of[1] > n, nFrames[at])));
    await Promise.all(all().map((page) => full(page)));
    const ms = performance.now() - up;
    t.diagnostic(`all are connected ${Math.round(connectedMs)} ms, and have their pictures ${Math.round(ms)} ms after the daemon is up`);
    assert.ok(connectedMs < slack * comesBackMs, `connected ${connectedMs} ms after the daemon was up`);
    const later = await meeting();
    assert.equal(later.revision, before.revision);
    assert.deepEqual(
      later.members.map(({ id, name, role, connected }) => [id, name, role, connected]),
      before.members.map(({ id, name, role }) => [id, name, role, true]),
    );
    assert.deepEqual(await world.scene(room), scene);
    assert.deepEqual([await items('notes'), await items('bookmarks')], [notes, saved]);
    await says(ann, /^Presenting · 2 follow$/);
    for (const page of all()) assert.equal(await matrix(page, 1), shown);
    await shoot(ann, 'whole-7-back');
  });

  it('a part of it is recorded, decided, signed and exported; the record has all of it', async () => {
    recorded = [await matrix(ann, 1)];
    await openRoster(ann);
    await action(ann, 'Record meeting').click();
    for (const page of all()) await page.locator('.chip-recorded:visible').waitFor();
    await ann.keyboard.press('Escape');
    await turn(ann);
    recorded.push(await matrix(ann, 1));
    await Promise.all([ben, cem].map((page) => showsAs(page, ann)));
    for (const page of [ann, ben]) {
      await page.getByRole('tab', { name: 'Record' }).click();
      await page.getByRole('heading', { name: 'Checklist' }).waitFor();
    }
    await ann.getByRole('combobox', { name: 'Decision' }).selectOption('accept');
    await ann.getByLabel('In words').fill('As shown');
    await ann.getByRole('button', { name: 'Write down' }).click();
    await ben.locator('.record-lines').getByText('As shown').waitFor();
    await ben.getByRole('textbox', { name: 'Name' }).fill('B. Example');
    await ben.getByRole('button', { name: 'Sign' }).click();
    await ann.locator('.record-lines').getByText('B. Example').waitFor();
    const [download] = await Promise.all([ann.waitForEvent('download'), ann.getByRole('button', { name: 'JSON' }).click()]);
    const { decisions, signatures, notes, saved_views, present } = JSON.parse((await bytesOf(download)).toString());
    assert.deepEqual(
      [decisions.map(({ decision, text }) => [decision, text]), signatures.map(({ name }) => name)],
      [[['accept', 'As shown']], ['B. Example']],
    );
    assert.deepEqual([notes.length, saved_views.length], [(await items('notes')).length, 1]);
    for (const name of ['Dr Ann', 'Ben', 'Cem'])
      assert.ok(
        present.some((stay) => stay.name === name),
        `${name} was present`,
      );
    await shoot(ann, 'whole-8-record');
    await openRoster(ann);
    await action(ann, 'End recording').click();
    for (const page of all()) await page.locator('.chip-recorded').first().waitFor({ state: 'detached' });
  });

  it('its replay shows at its beginning and at its end what was shown then, and leaves the meeting as it is', async () => {
    const before = await meeting();
    await openRoster(ann);
    const opened = ann.context().waitForEvent('page');
    await ann
      .getByRole('button', { name: /^Play the recording/ })
      .locator('visible=true')
      .click();
    const replay = await opened;
    await full(replay);
    await openRoster(replay);
    const slider = replay.locator('.replay-transport:visible input');
    const seek = (toEnd) =>
      slider.evaluate((range, isEnd) => {
        range.value = isEnd ? range.max : range.min;
        range.dispatchEvent(new Event('change', { bubbles: true }));
      }, toEnd);
    for (const isEnd of [true, false, true]) {
      await seek(isEnd);
      await until(
        () => matrix(replay, 1),
        (shown) => shown === recorded[Number(isEnd)],
      );
    }
    await shoot(replay, 'whole-9-replay');
    const later = await meeting();
    assert.deepEqual([later.revision, later.members.length], [before.revision, before.members.length]);
    assert.equal(await matrix(ann, 1), recorded[1]);
  });

  it('it has had no error', () => assert.deepEqual(world.errors, []));
});
