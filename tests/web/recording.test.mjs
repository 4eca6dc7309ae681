// A recorded meeting: everybody sees that it is recorded, and its replay says that it is one. Screenshots stay in build/test-artifacts/.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { axe } from './axe.mjs';
import { full, missing, shoot, startWorld } from './browser.mjs';
import { action, enter as enterAs, openRoster as open } from './people.mjs';

describe('a recorded meeting', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld();
  });
  after(async () => {
    await world?.stop();
  });

  it('is said to everybody while it runs, and its replay is no live meeting', async () => {
    const room = await world.newRoom();
    const ann = await enterAs(world, `rooms/${room}`, 'Dr Ann');
    const ben = await enterAs(world, `rooms/${room}`, 'Ben');
    await Promise.all([full(ann), full(ben)]);
    await ben.locator('#picture-1').focus();
    await ben.keyboard.press('p');
    await ben.locator('#picture-1').hover();
    await ann.locator('.person-pointer').first().waitFor({ state: 'attached' });
    await open(ann);
    await action(ann, 'Record meeting').click();
    for (const page of [ann, ben]) await page.locator('.chip-recorded:visible').waitFor();
    await open(ann);
    await action(ann, 'End recording').click();
    await ben.locator('.chip-recorded').first().waitFor({ state: 'detached' });
    await open(ann);
    const play = ann.getByRole('button', { name: /^Play the recording/ }).locator('visible=true');
    await play.waitFor();
    assert.deepEqual(await axe(ann), []);
    await shoot(ann, 'recordings');
    const opened = ann.context().waitForEvent('page');
    await play.click();
    const replay = await opened;
    await replay.locator('.person-pointer .label', { hasText: 'Ben' }).first().waitFor({ state: 'attached' });
    await replay.locator('.room-chip:visible .chip-words', { hasText: /^Replay \d{4}-\d\d-\d\d \d\d:\d\d$/ }).waitFor();
    await full(replay);
    await open(replay);
    await replay.locator('.replay-transport:visible').waitFor();
    await replay.getByText('Replay of a meeting of').locator('visible=true').waitFor();
    const people = replay.getByRole('list', { name: 'In the meeting at this time' }).locator('visible=true');
    await people.locator('li', { hasText: 'Dr Ann' }).getByText('presented').waitFor();
    await people.locator('li', { hasText: 'Ben' }).getByText('was there').waitFor();
    assert.equal(await replay.locator('#saved').textContent(), 'Not kept');
    assert.deepEqual(await axe(replay), []);
    await shoot(replay, 'replay');
  });

  it('is ordered as a film in the list of recordings, made while the page goes on, and saved', async () => {
    const room = await world.newRoom();
    const ann = await enterAs(world, `rooms/${room}`, 'Dr Ann');
    await full(ann);
    await open(ann);
    await action(ann, 'Record meeting').click();
    await ann.locator('.chip-recorded:visible').waitFor();
    await open(ann);
    await action(ann, 'End recording').click();
    await open(ann);
    const film = ann.getByRole('button', { name: /^Film of the recording/ }).locator('visible=true');
    await film.click();
    const dialog = ann.getByRole('dialog', { name: /^Film of the meeting of \d{4}-\d\d-\d\d \d\d:\d\d$/ });
    await dialog.waitFor();
    assert.deepEqual(await axe(ann), []);
    await shoot(ann, 'film-of-meeting');
    await dialog.getByRole('radio', { name: '640 × 480' }).click();
    await dialog.getByRole('radio', { name: '2', exact: true }).click();
    await dialog.getByRole('button', { name: 'Make the film' }).press('Enter');
    const saves = dialog.getByRole('button', { name: 'Save the film' });
    await saves.waitFor({ timeout: 120000 });
    const [download] = await Promise.all([ann.waitForEvent('download'), saves.click()]);
    assert.match(download.suggestedFilename(), /^phantom-meeting-\d{8}T\d{6}Z\.webm$/);
    assert.deepEqual(world.errors, []);
    await ann.context().close();
  });

  it('that cannot be read says so in its replay', async () => {
    const room = await world.newRoom();
    const ann = await enterAs(world, `rooms/${room}`, 'Dr Ann');
    await full(ann);
    await open(ann);
    await action(ann, 'Record meeting').click();
    await ann.locator('.chip-recorded:visible').waitFor();
    await open(ann);
    await action(ann, 'End recording').click();
    const play = ann.getByRole('button', { name: /^Play the recording/ }).locator('visible=true');
    await play.waitFor();
    await ann.locator('#saved', { hasText: /^Saved$/ }).waitFor();
    execFileSync('python3', [
      '-c',
      `import sqlite3, sys
db = sqlite3.connect(sys.argv[1], timeout=30)
db.execute('DELETE FROM recording_batches WHERE room = ?', (sys.argv[2],))
db.commit()`,
      join(world.daemon.data, 'beamroom.db'),
      room,
    ]);
    const opened = ann.context().waitForEvent('page');
    await play.click();
    const replay = await opened;
    await replay.locator('.room-chip:visible .chip-words', { hasText: /, unreadable here$/ }).waitFor();
    await open(replay);
    await replay.getByText('The recording cannot be read here.').locator('visible=true').waitFor();
    assert.deepEqual(await axe(replay), []);
    await shoot(replay, 'replay-unreadable');
  });
});
