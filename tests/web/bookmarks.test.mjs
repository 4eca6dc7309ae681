// Saved views in the browser: saved, renamed, shown, presented; their links in a second browser.
import assert from 'node:assert/strict';
import { after, before, describe } from 'node:test';
import { call, until } from '../api/daemon.mjs';
import { axe as findings } from './axe.mjs';
import { full, later, missing, shoot, startWorld } from './browser.mjs';

describe('saved views', { skip: missing && `${missing} is not there` }, () => {
  let world;
  before(async () => {
    world = await startWorld();
  });
  after(() => world?.stop());

  const bookmarks = async (room) => (await call(`${world.daemon.url}/api/v1/rooms/${room}/bookmarks`)).json.bookmarks;
  const named = (page, name) => page.getByRole('treeitem', { name: new RegExp(`^${name}`) });
  const names = (page) => page.locator('.row[data-key^="bookmark:i"] .name').evaluateAll((found) => found.map(({ title }) => title));
  const listed = (page, wanted) =>
    until(
      () => names(page),
      (found) => found.join() === wanted.join(),
    );
  const patch = (room, change) => call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', change, { 'If-Match': '*' });
  /** Where the camera looks and how far it is: the row of w, which the shape of the pane does not change. */
  const cameraOf = (page, view = 1) =>
    page
      .evaluate((n) => globalThis.beamroom.stats().headers[n].clip_from_lps_mm, view)
      .then((matrix) => [3, 7, 11, 15].map((at) => matrix[at]));
  const isNear = (a, b) => a.every((value, at) => Math.abs(value - b[at]) < 1e-3);

  async function save(page, name) {
    await named(page, 'Save this view').click();
    const field = page.getByLabel('Name of the view');
    await field.waitFor();
    if (name) await field.fill(name);
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await page.getByLabel('Name of the saved view').waitFor();
  }

  async function turn(page) {
    const before = await cameraOf(page);
    await page.locator('#picture-1').focus();
    await page.keyboard.press('ArrowLeft');
    await until(
      () => cameraOf(page),
      (now) => !isNear(now, before),
    );
    await full(page);
    return cameraOf(page);
  }

  later('are saved, shown, renamed, moved, updated and deleted; a link opens a room of its own in another browser', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`);
    await full(page);
    const home = await cameraOf(page);
    const plain = await world.scene(room);
    await save(page, '');
    await listed(page, ['View 1']);

    await patch(room, {
      regions: { scalp: { visible: false } },
      measures: { m1: { kind: 'distance', points: [{ at_mm: [0, 0, 0] }, { at_mm: [20, 0, 0] }] } },
    });
    const turned = await turn(page);
    const thin = await world.scene(room);
    await save(page, 'Without the scalp');
    await listed(page, ['View 1', 'Without the scalp']);
    await page.locator('.bookmark-block img').waitFor();
    assert.deepEqual(await findings(page), []);
    await shoot(page, 'bookmarks');

    // shown: scene and camera are those that were saved; the measure made since stays
    const kept = { ...plain, measures: thin.measures };
    await named(page, 'View 1').getByRole('button', { name: 'Show View 1' }).click();
    await until(
      () => cameraOf(page),
      (now) => isNear(now, home),
    );
    await until(
      () => world.scene(room),
      (scene) => JSON.stringify(scene) === JSON.stringify(kept),
    );
    await named(page, 'Without the scalp').click();
    await page.getByRole('button', { name: 'Show to everybody' }).click();
    await until(
      () => cameraOf(page),
      (now) => isNear(now, turned),
    );
    await until(
      () => world.scene(room),
      (scene) => JSON.stringify(scene) === JSON.stringify(thin),
    );

    // one step to undo
    await page.locator('#picture-1').focus();
    await page.keyboard.press('Control+z');
    await until(
      () => cameraOf(page),
      (now) => isNear(now, home),
    );
    await until(
      () => world.scene(room),
      (scene) => JSON.stringify(scene) === JSON.stringify(kept),
    );

    await page.getByLabel('Name of the saved view').fill('Bare skull');
    await page.getByLabel('Name of the saved view').press('Enter');
    await listed(page, ['View 1', 'Bare skull']);
    await page.getByRole('button', { name: 'Earlier in the list' }).click();
    await listed(page, ['Bare skull', 'View 1']);
    const [{ body: before }] = (await bookmarks(room)).filter(({ body }) => body.name === 'Bare skull');

    // the link, in another browser
    const link = await page.getByLabel('Link to it').inputValue();
    assert.equal(link, `${world.daemon.url}/#/p/${before.token}`);
    const { revision } = (await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json;
    const other = await world.newPage(link.slice(world.daemon.url.length + 1));
    await full(other);
    await other.getByText('“Bare skull” in a new room of its own.').waitFor();
    const own = (await other.evaluate(() => location.pathname)).split('/')[2];
    assert.notEqual(own, room);
    assert.deepEqual(await world.scene(own), thin);
    assert.ok(isNear(await cameraOf(other), turned));
    await patch(own, { regions: { brain: { visible: false } } });
    assert.equal((await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json.revision, revision);
    await other.context().close();

    // updated, it keeps its link; deleted, the link opens nothing
    await page.getByRole('button', { name: 'Update to what is shown' }).click();
    await until(
      async () => (await bookmarks(room)).find(({ body }) => body.name === 'Bare skull').body,
      (body) => Object.keys(body.scene).join() === 'measures' && body.token === before.token,
    );
    await page.getByRole('button', { name: 'Delete the saved view' }).click();
    await listed(page, ['View 1']);
    const late = await world.newPage(link.slice(world.daemon.url.length + 1));
    await late.getByRole('heading', { name: 'Nothing is saved under this link' }).waitFor();
    assert.deepEqual(await findings(late), []);
    await shoot(late, 'bookmark-gone');
    await late.getByRole('link', { name: 'All plans' }).click();
    await late.getByRole('button', { name: 'Upload' }).waitFor();
    await late.context().close();
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });

  later('are shown to the room by the presenter, to themselves by others, and presented by Page down and Page up', async () => {
    const room = await world.newRoom();
    const ann = await world.newPage(`rooms/${room}`);
    await full(ann);
    const cameras = [await cameraOf(ann)];
    await save(ann, 'First');
    cameras.push(await turn(ann));
    await save(ann, 'Second');
    await patch(room, { axes: { visible: true } });
    cameras.push(await turn(ann));
    await save(ann, 'Third');
    const ben = await world.newPage(`rooms/${room}`);
    await full(ben);
    await listed(ben, ['First', 'Second', 'Third']);

    await named(ann, 'First').click();
    await ann.getByRole('button', { name: 'Present from here' }).click();
    const bar = ann.getByRole('group', { name: 'Saved views as a presentation' });
    await bar.getByText('1 of 3').waitFor();
    for (const page of [ann, ben])
      await until(
        () => cameraOf(page),
        (now) => isNear(now, cameras[0]),
      );
    assert.equal((await world.scene(room)).axes.visible, false);
    await ann.locator('#picture-2').focus(); // where Page down would be ten slices
    await ann.keyboard.press('PageDown');
    await bar.getByText('2 of 3').waitFor();
    await ann.keyboard.press('PageDown');
    await bar.getByText('3 of 3').waitFor();
    for (const page of [ann, ben])
      await until(
        () => cameraOf(page),
        (now) => isNear(now, cameras[2]),
      );
    assert.equal((await world.scene(room)).axes.visible, true);
    assert.ok(await bar.getByRole('button', { name: 'Next view' }).isDisabled());
    await ann.getByText('3 of 3').nth(1).waitFor(); // Selection goes along
    await shoot(ann, 'bookmark-presentation');
    assert.deepEqual(await findings(ann), []);
    await ann.keyboard.press('PageUp');
    await bar.getByText('2 of 3').waitFor();
    await until(
      () => cameraOf(ben),
      (now) => isNear(now, cameras[1]),
    );
    const { position_mm: slice } = (await world.scene(room)).image.slices.axial;
    await bar.getByRole('button', { name: 'End the presentation' }).click();
    await bar.waitFor({ state: 'detached' });
    await ann.locator('#picture-2').focus();
    await ann.keyboard.press('PageDown');
    await until(
      () => world.scene(room),
      (scene) => scene.image.slices.axial.position_mm !== slice,
    );

    // a follower shows one to himself alone, and cannot change hers
    const { revision } = (await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json;
    await named(ben, 'First').click();
    assert.ok(await ben.getByRole('button', { name: 'Delete the saved view' }).isDisabled());
    await ben.getByRole('button', { name: 'Show to me' }).click();
    await until(
      () => cameraOf(ben),
      (now) => !isNear(now, cameras[1]),
    );
    await ben.waitForFunction(() => document.querySelector('[data-standing="own"]'));
    assert.equal((await call(`${world.daemon.url}/api/v1/rooms/${room}`)).json.revision, revision);
    await until(
      () => cameraOf(ann),
      (now) => isNear(now, cameras[1]),
    );
    assert.deepEqual(world.errors, []);
    await ann.context().close();
    await ben.context().close();
  });

  later('are within reach on a telephone', async () => {
    const room = await world.newRoom();
    const page = await world.newPage(`rooms/${room}`, { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    await full(page);
    await page.getByRole('button', { name: 'Parts' }).click();
    await page.getByRole('tab', { name: 'Saved views' }).click();
    await save(page, 'On the way');
    await page.locator('.bookmark-block img').waitFor();
    assert.deepEqual(await findings(page), []);
    await shoot(page, 'bookmark-phone');
    await page.getByRole('button', { name: 'Parts' }).click();
    await listed(page, ['On the way']);
    await shoot(page, 'bookmarks-phone');
    assert.deepEqual(world.errors, []);
    await page.context().close();
  });
});
