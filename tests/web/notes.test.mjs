// Notes of two people: written at the crosshair and on a region, answered by both at once, found, jumped to, resolved, and there after a reload.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, missing, shoot, startWorld } from './browser.mjs';
import { enter as enterAs } from './people.mjs';

let world;
let room;
const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

before(async () => {
  if (missing) return;
  world = await startWorld();
  room = await world.newRoom();
});
after(() => world?.stop());

const enter = async (name, options) => {
  const page = await enterAs(world, `rooms/${room}`, name, options);
  await full(page, 1);
  return page;
};
const notes = async () => (await call(`${world.daemon.url}/api/v1/rooms/${room}/notes`)).json.notes;
const note = (page, text) => page.locator('.notes > li').filter({ hasText: text });
const openTab = (page) => page.getByRole('tab', { name: /^Notes/ }).click();

test('two people write notes, answer at once, find, jump, resolve, and find all of it after a reload', { skip: missing }, async () => {
  const [ann, ben] = [await enter('Ann'), await enter('Ben')];
  const scene = await world.scene(room);

  // Ann, by keyboard alone: a note at the crosshair that names the other
  await ann.locator('#picture-2').focus();
  await ann.keyboard.press('n');
  await ann.locator('#note-field-new:focus').waitFor();
  const others = (await call(`${world.daemon.url}/api/v1/rooms/${room}/members`)).json.members.filter(({ presenting }) => !presenting);
  await ann.keyboard.type(`Is <b>this</b> the edge? @${others[0].name.slice(0, 2)}`);
  await ann.locator('.note-names li').first().waitFor();
  assert.deepEqual(await axe(ann), []);
  await ann.keyboard.press('Enter');
  await ann.keyboard.press('Control+Enter');
  await note(ann, 'Is <b>this</b> the edge?').waitFor();
  const [made] = await notes();
  assert.deepEqual(made.body.mentions, [{ member: others[0].id, name: others[0].name }]);
  assert.ok(Math.abs(made.body.anchor.point_mm[2] - scene.image.slices.axial.position_mm) < 0.01);

  // Ben is told, and both answer at the same moment
  await ben.locator('.note-pin').first().waitFor();
  await openTab(ben);
  await note(ben, 'the edge?').locator('.note-head').click();
  await ann.getByLabel('Reply', { exact: true }).fill('Ann says yes');
  await ben.getByLabel('Reply', { exact: true }).fill('Ben says no');
  await Promise.all([ann, ben].map((page) => page.getByRole('button', { name: 'Reply', exact: true }).click()));
  for (const page of [ann, ben]) {
    await page.locator('.note-replies > li').nth(1).waitFor();
    assert.deepEqual((await page.locator('.note-replies .note-words').allTextContents()).sort(), ['Ann says yes', 'Ben says no']);
    assert.equal(
      await page.locator('.note-thread .note-buttons button').filter({ hasText: 'Resolve' }).count(),
      page === ann ? 1 : 0,
      'only the author and a presenter resolve',
    );
  }
  assert.equal(
    await ben
      .locator('.notes b b, .notes li b')
      .filter({ hasText: /^this$/ })
      .count(),
    0,
    'no HTML of a person is interpreted',
  );
  await shoot(ann, 'notes');

  // Ben, on a region; the filter finds it, and only it
  await ben.locator('.tree .row').filter({ hasText: 'brain' }).locator('.name').click();
  await openTab(ben);
  await ben.getByRole('button', { name: 'On brain' }).click();
  await ben.locator('#note-field-new').fill('Swelling here');
  await ben.getByRole('button', { name: 'Add note' }).click();
  await note(ann, 'Swelling').waitFor();
  await ann.getByLabel('Text in notes').fill('swell');
  await ann.locator('.notes > li').filter({ hasNotText: 'edge' }).first().waitFor();
  await ann.getByLabel('Text in notes').fill('');
  await ann.getByLabel('Whose notes').selectOption('mine');
  await note(ann, 'Swelling').waitFor({ state: 'detached' });
  await ann.getByLabel('Whose notes').selectOption('all');

  // Ben's jump is Ben's own; Ann, who presents, moves the room
  await ben.locator('.status').waitFor();
  await note(ben, 'Swelling').waitFor();
  const before = await world.scene(room);
  await ben.getByRole('button', { name: 'Jump, in my view' }).click();
  await ben.locator('[data-standing="own"]:visible').waitFor();
  assert.deepEqual((await world.scene(room)).image.slices, before.image.slices);
  await note(ann, 'Swelling').locator('.note-head').click();
  await ann.getByRole('button', { name: 'Jump, for everybody' }).click();
  const { regions } = (await call(`${world.daemon.url}/api/v1/plans/phantom`)).json;
  const center = regions.find(({ id }) => id === 'brain').center_mm;
  await until(
    () => world.scene(room),
    (now) => Math.abs(now.image.slices.axial.position_mm - center[2]) < 0.1,
  );

  // resolved: gone from the list and the pictures, until it is asked for
  await note(ann, 'the edge?').locator('.note-head').click();
  await ann.getByRole('button', { name: 'Resolve' }).click();
  await until(notes, (all) => all[0].body.resolved);
  await note(ben, 'the edge?').waitFor({ state: 'detached' });
  await ben.getByLabel('Resolved').check();
  await note(ben, 'the edge?').waitFor();

  // a change of somebody else meanwhile is refused, and what was written stays
  await note(ben, 'Swelling').locator('.note-head').waitFor();
  if ((await note(ben, 'Swelling').locator('.note-head').getAttribute('aria-expanded')) !== 'true')
    await note(ben, 'Swelling').locator('.note-head').click();
  await note(ben, 'Swelling').getByRole('button', { name: 'Edit' }).click();
  await ben.getByLabel('Change the text').fill('Swelling, seen on T2');
  await note(ann, 'Swelling').locator('.note-head').click();
  await note(ann, 'Swelling').getByRole('button', { name: 'Resolve' }).click();
  await until(notes, (all) => all.find(({ body }) => body.text === 'Swelling here')?.body.resolved);
  await ben.locator('.note-error').waitFor();
  await ben.getByRole('button', { name: 'Save', exact: true }).click();
  await ben.getByRole('alert').filter({ hasText: 'save again' }).waitFor();
  assert.equal(await ben.getByLabel('Change the text').inputValue(), 'Swelling, seen on T2');
  await ben.getByRole('button', { name: 'Save', exact: true }).click();
  await until(notes, (all) => all.some(({ body }) => body.text === 'Swelling, seen on T2' && body.resolved));

  await ann.reload();
  await full(ann, 1);
  await openTab(ann);
  await ann.getByLabel('Resolved').check();
  await note(ann, 'Swelling, seen on T2').waitFor();
  await note(ann, 'the edge?').locator('.note-head').click();
  await ann.locator('.note-replies > li').nth(1).waitFor();
  await openTab(ben);
  if ((await note(ben, 'the edge?').locator('.note-head').getAttribute('aria-expanded')) !== 'true')
    await note(ben, 'the edge?').locator('.note-head').click();
  await ben.getByLabel('Reply', { exact: true }).fill('Half a thought');
  await note(ann, 'the edge?').getByRole('button', { name: 'Delete' }).first().click();
  await ann.getByRole('button', { name: 'Delete with 2 replies?' }).click();
  await note(ben, 'the edge?').waitFor({ state: 'detached' });
  assert.equal((await notes()).length, 1);
  await ben.getByRole('status').filter({ hasText: 'Half a thought' }).waitFor(); // what was written for it is not lost
  await ben.getByRole('button', { name: 'As a new note' }).click();
  await ben.getByRole('button', { name: 'Add note' }).click();
  await note(ann, 'Half a thought').waitFor();
  assert.deepEqual(world.errors, []);
});

test('on a phone notes are in the sheet, with targets for fingers', { skip: missing }, async () => {
  const page = await enter('Cem', phone);
  await page.getByRole('button', { name: 'Probe' }).tap();
  await page.getByRole('tab', { name: /^Notes/ }).tap();
  await page.getByRole('button', { name: 'Note at the crosshair' }).tap();
  await page.locator('#note-field-new').fill('From the phone');
  await page.getByRole('button', { name: 'Add note' }).tap();
  await note(page, 'From the phone').waitFor();
  await page.getByRole('button', { name: /^Jump/ }).waitFor();
  assert.deepEqual(await axe(page), []);
  const low = await page
    .locator('.inspector button:visible')
    .evaluateAll((buttons) => buttons.filter((button) => button.getBoundingClientRect().height < 43.5).map((button) => button.textContent));
  assert.deepEqual(low, []);
  await shoot(page, 'notes-phone');
  assert.deepEqual(world.errors, []);
});
