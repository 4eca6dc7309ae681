// A meeting of three cases in browsers, played whole: a case is prepared with saved views, the presenter goes on by key, who follows goes along, as do a guest
// and a wall, who looks on their own is asked, who may not see the second case waits outside and comes back; it is decided, and the minutes tell of all of it.
// Pictures are grey (--stub): what is looked at is whose they are. Screenshots stay in
// build/test-artifacts/.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { call, demo, until } from '../api/daemon.mjs';
import { axe } from './axe.mjs';
import { full, later, missing, shoot, startWorld } from './browser.mjs';
import { says } from './people.mjs';

const password = 'correct horse';
const names = ['First plan', 'Second plan', 'Third plan'];

describe('a meeting of three cases', { skip: missing && `${missing} is not there` }, () => {
  let world, folder, meeting, cases;
  const who = {};
  const pages = {};
  let wall = null;
  const wallIsAt = async (n, plan) => {
    await wall.locator('.wall-foot', { hasText: `Tumour board · case ${n} of 3` }).waitFor();
    await wall.locator('.wall-plan', { hasText: plan }).waitFor();
  };
  const api = (path, user, method = 'GET', body) => call(`${world.daemon.url}/api/v1${path}`, method, body, { Cookie: who[user] });
  const agenda = async () => (await api(`/meetings/${meeting}`, 'pat')).json;

  /** The guest and the wall, who are there in the long form. */
  const othersAreAt = (n, plan) => Promise.all(wall ? [isIn(pages.guest, n), wallIsAt(n, plan)] : []);

  /** A browser in which this user has signed in. */
  async function browse(user, address, options) {
    const page = await world.newPage('healthz', options); // not yet a page of ours
    const [name, value] = who[user].split('=');
    await page.context().addCookies([{ name, value, url: world.daemon.url }]);
    await page.goto(`${world.daemon.url}/${address}`);
    return page;
  }
  const title = (page) => page.locator('.banner').textContent();
  const chip = (page) => page.locator('.room-chip:visible');
  const isIn = (page, n) =>
    chip(page)
      .locator('b', { hasText: `${n}/3` })
      .waitFor();
  /** Keeps the words of toasts that a page shows from now on: they are gone by themselves, on a slow machine before a test looks. */
  const listen = (page) =>
    page.evaluate(() => {
      globalThis.seenWords = new Set();
      const look = () => {
        for (const { textContent } of document.querySelectorAll('.toast'))
          globalThis.seenWords.add(textContent.replace(/\s+/g, ' ').trim());
      };
      new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true });
    });
  const heard = (page, words) =>
    until(
      () => page.evaluate(() => [...globalThis.seenWords]),
      (seen) => seen.some((text) => words.test(text)),
    );
  /** Marks the panes, so that something of the page before, which must never be seen below the name of the new plan, is found. */
  const mark = (page) =>
    page.evaluate(() => document.querySelectorAll('.pane canvas, .pane').forEach((element) => element.setAttribute('data-before', '')));
  const nBefore = (page) => page.evaluate(() => document.querySelectorAll('[data-before]').length);

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-cases-'));
    for (const [index, name] of ['a/one', 'b/two', 'a/three'].entries()) {
      mkdirSync(join(folder, name), { recursive: true });
      cpSync(join(demo, 'phantom'), join(folder, name), { recursive: true });
      const path = join(folder, name, 'plan.json');
      writeFileSync(path, JSON.stringify({ ...JSON.parse(readFileSync(path, 'utf8')), name: names[index] }));
    }
    const grants = ['* pat planner', `${folder}/a rae reviewer`, '* ola reviewer', '* fay reviewer'];
    world = await startWorld({
      plans: [join(folder, 'a'), join(folder, 'b')],
      args: ['--stub', '--sign-in', 'local', '--guest-links', ...grants.flatMap((line) => ['--grant', line])],
    });
    const token = await until(
      () => /signin\/first#([0-9a-f]{64})/.exec(world.daemon.log())?.[1],
      (found) => found,
    );
    const url = `${world.daemon.url}/api/v1`;
    const signIn = async (user) => {
      const { headers } = await call(`${url}/session`, 'POST', { user, password });
      who[user] = headers.get('set-cookie').split(';')[0];
    };
    await call(`${url}/session/first`, 'POST', { token, user: 'ada', name: 'Ada', password });
    await signIn('ada');
    for (const [user, name] of Object.entries({ pat: 'Pat', rae: 'Rae', ola: 'Ola', fay: 'Fay' })) {
      await api('/users', 'ada', 'POST', { user, name, password, groups: '' });
      await signIn(user);
    }
    const { plans } = (
      await until(
        () => api('/plans', 'pat'),
        ({ json }) => json.plans.length >= 4,
      )
    ).json;
    const made = await api('/meetings', 'pat', 'POST', {
      name: 'Tumour board',
      cases: names.map((name) => ({ plan: plans.find((plan) => plan.name === name).id })),
      people: ['rae', 'ola', 'fay'].map((user) => ({ who: user })),
    });
    assert.equal(made.status, 201, made.text);
    [meeting, cases] = [made.json.id, made.json.cases.map(({ id }) => id)];
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  const scene = async (n) => (await api(`/rooms/${(await agenda()).cases[n - 1].room}/scene`, 'pat')).json;
  const axesAre = (n, isVisible) =>
    until(
      () => scene(n),
      ({ axes }) => axes.visible === isVisible,
    );
  const bar = (page) => page.getByRole('group', { name: 'Saved views as a presentation' });

  it('a case is prepared before from the start page: views are saved in its room', async () => {
    pages.pat = await browse('pat', '');
    const row = pages.pat.locator(`[data-case="${cases[1]}"]`);
    await row.getByRole('button', { name: /^Prepare/ }).waitFor();
    assert.deepEqual(await axe(pages.pat), []);
    await shoot(pages.pat, 'case-prepare');
    await row.getByRole('button', { name: /^Prepare/ }).click();
    await pages.pat.waitForURL(/\/rooms\//);
    await says(pages.pat, /Presenting/);
    await isIn(pages.pat, 2);
    await full(pages.pat);
    const { room } = (await agenda()).cases[1];
    for (const [name, visible] of [
      ['With axes', true],
      ['Without axes', false],
    ]) {
      const patched = await call(
        `${world.daemon.url}/api/v1/rooms/${room}/scene`,
        'PATCH',
        { axes: { visible } },
        { Cookie: who.pat, 'If-Match': '*' },
      );
      assert.equal(patched.status, 200, patched.text);
      await pages.pat.getByRole('treeitem', { name: /^Save this view/ }).click();
      await pages.pat.getByLabel('Name of the view').fill(name);
      await pages.pat.getByRole('button', { name: 'Save', exact: true }).click();
      await pages.pat.locator('.row[data-key^="bookmark:i"]', { hasText: name }).waitFor();
    }
    const draft = { enabled: true, line: { entry_mm: [0, -100, 0], target_mm: [0, 0, 0] } };
    const drafted = await call(
      `${world.daemon.url}/api/v1/rooms/${room}/scene`,
      'PATCH',
      { beam: { draft } },
      { Cookie: who.pat, 'If-Match': '*' },
    );
    assert.equal(drafted.status, 200, drafted.text);
    assert.equal((await agenda()).state, 'planned', 'the meeting has not gone there');
    await pages.pat.context().close();
  });

  it('the address of the meeting waits until it has begun, and then leads into its first case', async () => {
    pages.fay = await browse('fay', `meetings/${meeting}`);
    await pages.fay.locator('h1', { hasText: '“Tumour board” has not begun' }).waitFor();
    assert.deepEqual(await axe(pages.fay), []);
    // who comes first presents: what the waiting page asks is answered once that is Pat
    let presents;
    const isPat = new Promise((done) => {
      presents = done;
    });
    await pages.fay.route(/\/api\/v1\/meetings\//, (route) => isPat.then(() => route.continue()));
    assert.equal((await api(`/meetings/${meeting}/case`, 'pat', 'POST', { case: 'next', from: null })).status, 200);
    const { room } = (await agenda()).cases[0];
    pages.pat = await browse('pat', `rooms/${room}`);
    await isIn(pages.pat, 1);
    await says(pages.pat, /Presenting/);
    presents();
    [pages.rae, pages.ola] = await Promise.all(['rae', 'ola'].map((user) => browse(user, `rooms/${room}`)));
    await Promise.all(['fay', 'rae', 'ola'].map((user) => isIn(pages[user], 1)));
    await Promise.all(['fay', 'rae', 'ola'].map((user) => says(pages[user], /Following Pat/)));
    assert.match(await title(pages.fay), /First plan/);
  });

  later('a guest comes in by the link of the meeting, and is not told the agenda', async () => {
    const link = (await api(`/meetings/${meeting}/links`, 'pat', 'POST', { role: 'observer', guests: true })).json;
    pages.guest = await world.newPage(link.url.slice(1));
    await pages.guest.fill('#guest-name', 'Prof. Lind');
    await pages.guest.keyboard.press('Enter');
    await isIn(pages.guest, 1);
    await chip(pages.guest).locator('.chip-main').click();
    await pages.guest.locator('.meeting-card h2', { hasText: 'Tumour board' }).waitFor();
    assert.equal(await pages.guest.locator('.meeting-card li, .meeting-card a').count(), 0);
    await pages.guest.keyboard.press('Escape');
    assert.match(pages.guest.url(), /\/rooms\//, 'nothing asked them to sign in');
  });

  later('a wall comes in by a link of the meeting', async () => {
    const link = await api(`/meetings/${meeting}/links`, 'pat', 'POST', { role: 'wall', expires_s: 3600, guests: false });
    assert.equal(link.status, 201, link.text);
    wall = await world.newPage(link.json.url.slice(1), { viewport: { width: 1920, height: 1080 } });
    await wallIsAt(1, 'First plan');
  });

  it('the next case takes along who follows, behind a card with the new plan alone; who looks on their own is asked; who may not see it waits', async () => {
    await pages.ola.locator('#picture-1').focus();
    await pages.ola.keyboard.press('ArrowLeft');
    await says(pages.ola, /On my own/);
    for (const page of [pages.pat, pages.fay]) await mark(page);
    await listen(pages.pat);
    const seen = pages.fay.waitForFunction(() => {
      const card = document.querySelector('.case-cover .case-card'); // it stands for 1.5 s
      return card && [card.textContent.replace(/\s+/g, ' '), getComputedStyle(card.parentElement).position];
    });
    const asked = pages.ola.evaluate(
      // goes along as soon as it is asked, for 10 s; the rules of accessibility are held to a question of its kind that stays, below
      () =>
        new Promise((done) => {
          const look = () => {
            const line = document.querySelector('.case-line');
            if (!line) return;
            watch.disconnect();
            done([line.textContent, document.querySelector('.banner').textContent]);
            line.querySelector('button').click();
          };
          const watch = new MutationObserver(look);
          watch.observe(document.body, { subtree: true, childList: true });
        }),
    );
    await pages.pat.keyboard.press('Shift+N');
    const [words, position] = await (await seen).jsonValue();
    assert.match(words, /Case 2 of 3.*PHANTOM.*Second plan.*Pat had the meeting go on/);
    assert.equal(position, 'fixed');
    const [question, shown] = await asked;
    assert.match(question.replace(/\s+/g, ' '), /The meeting went on to case 2 Go along \(\d+ s\)/);
    assert.match(shown, /First plan/, 'nothing changes for who looks on their own');
    await isIn(pages.ola, 2);
    await says(pages.ola, /Following Pat/);
    await pages.rae.locator('h1', { hasText: 'Case 2 is not open to you' }).waitFor();
    assert.doesNotMatch(await pages.rae.locator('body').textContent(), /Second plan/);
    assert.deepEqual(await axe(pages.rae), []);
    await shoot(pages.rae, 'case-closed');
    for (const page of [pages.pat, pages.fay]) {
      await isIn(page, 2);
      await page.locator('.banner', { hasText: 'Second plan' }).waitFor();
      assert.equal(await nBefore(page), 0, 'no picture of the case before');
      await page.locator('.case-card').waitFor({ state: 'detached' });
    }
    await says(pages.pat, /Presenting/);
    await says(pages.fay, /Following Pat/);
    await othersAreAt(2, 'Second plan');
  });

  it('the case begins with its first saved view, said and undone in one step; the others are stepped through by keys', async () => {
    const { pat, fay } = pages;
    await heard(pat, /^“With axes”, the first of 2 views saved for this case, is shown\..*Undo/);
    await bar(pat).getByText('1 of 2').waitFor();
    const isDraft = async () => (await scene(2)).beam.draft.enabled;
    await axesAre(2, true);
    assert.equal(await isDraft(), false, 'a draft that is newer than the view stands aside');
    assert.deepEqual(await axe(pat), []);
    await shoot(pat, 'case-prepared');
    assert.equal(await bar(fay).count(), 0, 'of who presents alone');
    await pat.locator('#picture-1').focus();
    await pat.keyboard.press('Control+z');
    await axesAre(2, false);
    assert.equal(await isDraft(), true, 'and is not lost');
    await pat.keyboard.press('Control+Shift+z');
    await axesAre(2, true);
    assert.equal(await isDraft(), false);
    await pat.keyboard.press('PageDown');
    await bar(pat).getByText('2 of 2').waitFor();
    await axesAre(2, false);
    await pat.keyboard.press('PageUp');
    await bar(pat).getByText('1 of 2').waitFor();
    await axesAre(2, true);
    await bar(pat).getByRole('button', { name: 'End the presentation' }).click();
    await bar(pat).waitFor({ state: 'detached' });
  });

  later('at the next case that is open to them the one who waited is back by themselves, also after a reload', async () => {
    await pages.rae.reload();
    await pages.rae.locator('h1', { hasText: 'Case 2 is not open to you' }).waitFor();
    await pages.pat.getByRole('tab', { name: 'Record' }).click();
    await pages.pat.locator('.record-form select[name="decision"]').selectOption('reject');
    await pages.pat.locator('#picture-1').focus();
    await pages.pat.keyboard.press('Shift+N');
    const writing = pages.pat.locator('.case-line', { hasText: 'A decision is being written here' });
    await writing.waitFor();
    assert.deepEqual(await axe(pages.pat), []);
    await shoot(pages.pat, 'case-asked');
    await writing.locator('button', { hasText: 'Stay here' }).click();
    await writing.waitFor({ state: 'detached' });
    assert.equal((await agenda()).case, 2, 'nothing moves while it is asked');
    await pages.pat.getByLabel('In words').fill('Another field');
    await pages.pat.getByRole('button', { name: 'Write down' }).click();
    await pages.pat.locator('.record-lines').getByText('Another field').waitFor();
    await until(agenda, (told) => told.cases[1].decision === 'reject');
    await chip(pages.pat).locator('.chip-main').click();
    const rows = pages.pat.locator('.meeting-card li');
    await rows.nth(2).waitFor();
    assert.match(await rows.nth(0).textContent(), /left open/);
    assert.match(await rows.nth(1).textContent(), /now/);
    assert.deepEqual(await axe(pages.pat), []);
    await shoot(pages.pat, 'case-agenda');
    await pages.pat.locator('.case-invite summary').click();
    await pages.pat.locator('.case-invite form button').click();
    const made = pages.pat.getByLabel('The link, told once');
    await made.waitFor();
    assert.match(await made.inputValue(), new RegExp(`/meetings/${meeting}#link=[0-9a-f]{32}$`));
    const ofReviewer = pages.pat.getByRole('button', { name: 'End it: link of reviewer' });
    await ofReviewer.click();
    await ofReviewer.waitFor({ state: 'detached' });
    await rows.nth(2).locator('button').click();
    await Promise.all([...Object.values(pages).map((page) => isIn(page, 3)), wallIsAt(3, 'Third plan')]);
    for (const page of Object.values(pages)) await page.locator('.banner', { hasText: 'Third plan' }).waitFor();
    await Promise.all(['fay', 'rae', 'ola'].map((user) => says(pages[user], /Following Pat/)));
    assert.deepEqual(
      (await agenda()).cases.map(({ state }) => state),
      ['left', 'decided', 'now'],
    );
  });

  later('the minutes are a page to print, masked, with the cases and who was there', async () => {
    const page = await browse('rae', `meetings/${meeting}/minutes`);
    await page.locator('.sheet h1', { hasText: 'Minutes: Tumour board' }).waitFor();
    const text = (await page.locator('.sheet').textContent()).replace(/\s+/g, ' ');
    assert.match(text, /First plan.*not open to you.*Third plan/);
    assert.doesNotMatch(text, /Second plan/);
    assert.doesNotMatch(text, /Not accepted/, 'nor what was decided there');
    assert.match(text, /Pat.*Case 1: .*Case 2: .*Case 3: /);
    assert.match(text, /Prof\. Lind \(guest\)/);
    assert.deepEqual(await axe(page), []);
    await shoot(page, 'case-minutes');
    await page.close();
    const ofPat = await browse('pat', `meetings/${meeting}/minutes`);
    const decided = ofPat.locator('.sheet tr', { hasText: 'Second plan' });
    await decided.getByText('Not accepted').waitFor();
    assert.match((await decided.textContent()).replace(/\s+/g, ' '), /Not acceptedPat, \d\d:\d\d/);
    await ofPat.close();
    const { json: record } = await api(`/rooms/${(await agenda()).cases[1].room}/record`, 'pat');
    assert.deepEqual(record.meeting, { id: meeting, name: 'Tumour board', n: 2, of: 3, is_over: false });
  });

  later('a case that is returned to is as it was left: its saved view is not shown again', async () => {
    const [, second, third] = cases;
    const { room } = (await agenda()).cases[1];
    const left = { Cookie: who.pat, 'If-Match': '*' };
    assert.equal((await call(`${world.daemon.url}/api/v1/rooms/${room}/scene`, 'PATCH', { axes: { visible: false } }, left)).status, 200);
    assert.equal((await api(`/meetings/${meeting}/case`, 'pat', 'POST', { case: second, from: third })).status, 200);
    await isIn(pages.pat, 2);
    await pages.pat.locator('.banner', { hasText: 'Second plan' }).waitFor();
    await full(pages.pat);
    assert.equal(await bar(pages.pat).count(), 0);
    assert.equal((await scene(2)).axes.visible, false);
    assert.equal((await api(`/meetings/${meeting}/case`, 'pat', 'POST', { case: third, from: second })).status, 200);
    await Promise.all([isIn(pages.pat, 3), wallIsAt(3, 'Third plan')]);
  });

  later('a wall goes along: the next patient on plain ground, then that case alone, also after a reload', async () => {
    assert.equal(await wall.locator('.wall-next').count(), 0, 'nothing is behind the last case');
    const { room } = (await agenda()).cases[2];
    const walls = (await api(`/rooms/${room}/members`, 'pat')).json.members.filter(({ role }) => role === 'wall');
    assert.equal(walls.length, 1);
    const card = wall.locator('.wall-card'); // it stands for a moment
    const words = wall.waitForFunction(() => document.querySelector('.wall-card')?.textContent.replace(/\s+/g, ' '));
    const [first, , third] = cases;
    assert.equal((await api(`/meetings/${meeting}/case`, 'pat', 'POST', { case: first, from: third })).status, 200);
    assert.match(await (await words).jsonValue(), /Case 1 of 3.*First plan/);
    await card.waitFor({ state: 'detached' });
    await wall.locator('.wall-plan', { hasText: 'First plan' }).waitFor();
    await wall.locator('.wall-next', { hasText: 'next: PHANTOM Second plan' }).waitFor();
    await shoot(wall, 'case-wall');
    await wall.reload(); // it begins at its address, and is told where the meeting is
    await wall.locator('.wall-foot', { hasText: 'case 1 of 3' }).waitFor();
    await wall.context().close();
  });

  later('the keys do nothing for who may not, and the end stays', async () => {
    const [first, , third] = cases;
    assert.equal((await api(`/meetings/${meeting}/case`, 'pat', 'POST', { case: third, from: first })).status, 200);
    await isIn(pages.pat, 3);
    await isIn(pages.fay, 3);
    await pages.fay.keyboard.press('Shift+N');
    await pages.fay.locator('.toast', { hasText: 'Who presents has the meeting go on' }).waitFor();
    await pages.pat.keyboard.press('Shift+N');
    await pages.pat.locator('.toast', { hasText: 'This is the last case' }).waitFor();
    await api(`/meetings/${meeting}/end`, 'pat', 'POST', {});
    await chip(pages.ola).locator('.chip-main').click();
    await pages.ola.locator('.meeting-card', { hasText: 'The meeting is over' }).waitFor();
  });

  it('no script failed on the way, and nothing was refused', () => {
    assert.deepEqual([world.errors, world.refused], [[], []]);
    assert.equal(cases.length, 3);
  });
});
