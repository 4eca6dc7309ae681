// The page in a language that is made up: each sentence of the tables in ⟦brackets⟧. What a person reads outside of brackets, and neither came from the
// server nor is a unit or a letter, would stay English in every language.
import assert from 'node:assert/strict';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { pathToFileURL } from 'node:url';
import { bin, web } from '../api/daemon.mjs';
import { isRead } from '../page_words.mjs';
import { full, later, missing, startWorld } from './browser.mjs';
import { sizes } from './room_states.mjs';

const language = 'tlh'; // a language that browsers have no words for

/** The tables as their files give them to sentences(). @returns {Promise<Record<string, Record<string, string>>>} by group */
async function tablesOf(folder) {
  const isTable = (path) => /(^|[/_])words\.js$/.test(path) && /\bsentences\(/.test(readFileSync(join(web, 'js', path), 'utf8'));
  const paths = readdirSync(join(web, 'js'), { recursive: true }).filter(isTable);
  const copy = join(folder, 'tables');
  for (const path of paths) cpSync(join(web, 'js', path), join(copy, 'js', path));
  cpSync(join(web, 'gen'), join(copy, 'gen'), { recursive: true });
  mkdirSync(join(copy, 'js/parts'), { recursive: true });
  writeFileSync(join(copy, 'js/parts/sentences.js'), 'export const sentences = (group, english) => ({ group, english });\n');
  writeFileSync(join(copy, 'package.json'), '{"type":"module"}');
  const modules = await Promise.all(paths.map((path) => import(pathToFileURL(join(copy, 'js', path)).href)));
  return Object.fromEntries(modules.flatMap((module) => Object.values(module)).map(({ group, english }) => [group, english]));
}

/** A copy of the page that has the language. */
async function pageWith(folder) {
  const tables = await tablesOf(folder);
  const { about, ...ofServer } = JSON.parse(readFileSync('proto/sentences.json', 'utf8'));
  const rows = Object.values(ofServer).flat(); // "{n %d}": a place, and how the server prints it
  tables.server = Object.fromEntries(rows.map(([code, text]) => [code, text.replace(/\{(\w+) %[^}]*\}/g, '{$1}')]));
  const bracketed = Object.entries(tables).map(([group, english]) => [
    group,
    Object.fromEntries(Object.entries(english).map(([key, text]) => [key, `⟦${text}⟧`])),
  ]);
  const page = join(folder, 'page');
  cpSync(web, page, { recursive: true, filter: (path) => !/\.(br|gz)$/.test(path) });
  cpSync('web/display.html', join(page, 'display.html')); // a wall by its modules, as modules.html is the page
  const languages = join(page, 'js/languages');
  writeFileSync(join(languages, `${language}.js`), `export default ${JSON.stringify(Object.fromEntries(bracketed))};\n`);
  const index = join(languages, 'index.js');
  const text = readFileSync(index, 'utf8');
  const row = `const languages = { ${language}: () => import('./${language}.js') };`;
  const own = text.replace(/const languages = \{[^}]*\};/, row);
  assert.ok(own.includes(row), 'the list of languages has room for a row');
  writeFileSync(index, own);
  return page;
}

/** Run in the page: what is outside of brackets in texts and in attributes that are read. @returns {{said: [string, string][], bracketed: number}} text, and where */
function readPage() {
  const attributes = ['title', 'aria-label', 'aria-description', 'aria-valuetext', 'placeholder', 'alt'];
  const wholes = 'button, p, td, th, dt, dd, option, label, h1, h2, h3, text, li, summary, legend'; // a text in them may be cut into several elements
  const said = [];
  let [depth, bracketed] = [0, 0];
  const outside = (text) => {
    let rest = '';
    for (const c of text) {
      if (c === '⟦') [depth, bracketed, rest] = [depth + 1, bracketed + 1, `${rest} `];
      else if (c === '⟧') depth--;
      else if (depth === 0) rest += c;
    }
    return rest;
  };
  const add = (text, where) => text.trim() && said.push([text.trim().replace(/\s+/g, ' '), where]);
  const nameOf = ({ localName, className }) => [localName, ...(className?.baseVal ?? className ?? '').split(' ')].filter(Boolean).join('.');
  for (const element of document.body.querySelectorAll('*'))
    for (const name of attributes) {
      add(outside(element.getAttribute(name) ?? ''), `${nameOf(element)} ${name}`);
      if (depth) add('a bracket that is not closed', `${nameOf(element)} ${name}`);
      depth = 0;
    }
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let [whole, text] = [null, ''];
  while (walker.nextNode()) {
    const { data, parentElement } = walker.currentNode;
    if (parentElement.closest('script, style, noscript, code')) continue;
    const own = parentElement.closest(wholes) ?? parentElement;
    if (own !== whole) {
      if (whole) add(text, nameOf(whole));
      [whole, text] = [own, ''];
    }
    text += `${parentElement.closest('.clip') ? '' : ' '}${outside(data)}`; // a name that is cut in two is one
  }
  if (whole) add(text, nameOf(whole));
  depth = 0;
  add(outside(document.title), 'title of the document');
  return { said, bracketed };
}

/** Under these names a message or an answer has names of things, words of files, and paths. */
const nameKeys = [
  'name',
  'label',
  'id',
  'masked',
  'modality',
  'unit',
  'per',
  'where',
  'code',
  'author_name',
  'source',
  'group',
  'format',
  'gl',
  'note',
  'tissue',
  'assumed',
];
const sentenceKeys = ['sentence', 'detail', 'title', 'phase', 'reason', 'parts', 'basis']; // not all of them have a code
const escaped = (text) => text.replace(/[\\^$.*+?()[\]{}|]/g, '\\$&');

/** Remembers names that the server sent, and its sentences. */
function hear(page, heard) {
  const keep = (value, key) => {
    if (typeof value === 'string' && ([...nameKeys, ...sentenceKeys].includes(key) || /^\S{20}/.test(value))) heard.add(value);
    if (value && typeof value === 'object') for (const [inner, one] of Object.entries(value)) keep(one, Array.isArray(value) ? key : inner);
  };
  const parse = (text) => {
    try {
      keep(JSON.parse(text));
    } catch {
      // not JSON
    }
  };
  keep(JSON.parse(readFileSync('proto/dose_presets.json', 'utf8'))); // names of published sets
  page.on('response', (answer) => /json/.test(answer.headers()['content-type'] ?? '') && answer.text().then(parse, () => {}));
  page.on('websocket', (socket) => socket.on('framereceived', ({ payload }) => typeof payload === 'string' && parse(payload)));
}

describe('the page in another language', { skip: missing && `${missing} is not there` }, () => {
  let folder;
  let world;
  let room;
  const heard = new Set();
  /** Without what the server sent, the longest first. */
  const own = (text) => {
    const names = [...heard].filter((name) => isRead(name) && text.includes(name)).sort((a, b) => b.length - a.length);
    return names.reduce((rest, name) => rest.replace(new RegExp(`(?<!\\p{L})${escaped(name)}(?!\\p{L})`, 'gu'), ' '), text);
  };
  const found = new Map(); // text: where it was first
  let bracketed = 0;
  const look = async (page, state) => {
    let seen = '';
    for (let n = 0; n < 20; n++) {
      const now = await page.evaluate(readPage);
      if (JSON.stringify(now) === seen) break;
      seen = JSON.stringify(now);
      await page.waitForTimeout(80);
    }
    const { said, bracketed: count } = JSON.parse(seen);
    bracketed = Math.max(bracketed, count);
    for (const [text, where] of said) if (!found.has(text)) found.set(text, `${state}, ${where}`);
  };
  const open = async (address, options) => {
    const page = await world.newPage('', { locale: language, ...options });
    hear(page, heard);
    await page.goto('about:blank');
    await page.goto(`${world.daemon.url}/${address}`);
    return page;
  };
  /** Whatever opens a popover here. */
  const popovers = async (page, state) => {
    const openers = page.locator(':is([aria-haspopup], .anchor > button, [aria-expanded="false"]:not([role]):not(.fold)):visible:enabled');
    for (let n = 0; n < (await openers.count()); n++) {
      const opener = openers.nth(n);
      const name = await opener.getAttribute('class');
      await opener.click({ timeout: 2000 }).catch(() => {});
      await look(page, `${state}, popover ${n} ${name}`);
      await page.keyboard.press('Escape');
    }
  };
  const blocks = async (page, more = () => {}) => {
    const kinds = await page.locator('[role="treeitem"][data-key]').evaluateAll((rows) => {
      const first = new Map(rows.map((row) => [row.dataset.key.split(':')[0], row.dataset.key]).reverse());
      return [...first.values()];
    });
    for (const key of kinds.filter((one) => !one.startsWith('section:'))) {
      const name = page.locator(`[data-key="${key}"] button.name`).first();
      if (!(await name.count())) continue;
      await name.click();
      await look(page, `Selection of ${key}`);
      await more(`Selection of ${key}`);
    }
  };
  const tabs = async (page) => {
    for (const id of await page.locator('.inspector [role="tab"]').evaluateAll((all) => all.map((one) => one.id))) {
      await page.locator(`#${id}`).click();
      await look(page, id);
    }
  };

  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'beamroom-language-'));
    world = await startWorld({ folders: { bin, web: await pageWith(folder) } });
    room = await world.newRoom();
  });
  after(async () => {
    await world?.stop();
    if (folder) rmSync(folder, { recursive: true, force: true });
  });

  it('opens a room and its help', async () => {
    const page = await open(`modules.html#/rooms/${room}`);
    await full(page);
    await look(page, 'a room');
    await page.keyboard.press('?');
    await page.locator('.help-keys li').first().waitFor();
    await look(page, 'help');
    await page.context().close();
  });

  later('goes through a room', async () => {
    const page = await open(`modules.html#/rooms/${room}`);
    await full(page);
    const folded = page.locator('.section-head[aria-expanded="false"]');
    while (await folded.count()) await folded.first().click();
    await blocks(page);
    await tabs(page);
    await popovers(page, 'a room');
    await page.locator('#picture-1').focus();
    for (const key of ['v', 'm', 'b']) {
      await page.keyboard.press(key);
      await look(page, `key ${key}`);
    }
    await page.context().close();
  });

  it('goes through start page, a room that is not there and a display', async () => {
    for (const address of ['modules.html', 'modules.html#/rooms/not-there', `display/${room}`]) {
      const page = await open(address);
      await page.waitForFunction(() => document.body.innerText.trim().length > 40);
      await look(page, address);
      if (address === 'modules.html') await popovers(page, 'the start page');
      await page.context().close();
    }
  });

  later('goes through signing in, and what people who signed in have', async () => {
    const ours = await world.newRoom(); // whose first member may do everything
    const person = { user: 'a.k', name: 'A 1', groups: [], source: 'password', proved_ms: 1 };
    let identity = null;
    const session = () => {
      const ends = identity && Date.now() + 240000; // soon: the page says so
      return { sign_in: ['local', 'proxy'], open_to_everybody: false, identity, idle_ends_ms: ends, ends_ms: ends, guest_links: true };
    };
    const page = await world.newPage('', { locale: language });
    const answers = {
      session: () => session(),
      'session/input': () => session(),
      'rooms/*/people': () => ({
        owner: 'a.k',
        is_open: false,
        people: [{ who: '@g', role: 'reviewer' }],
        removed: [{ user: 'b', name: 'A 1' }],
      }),
      'rooms/*/links': () => ({
        links: [{ id: 'a', role: 'wall', expires_s: 60, one_use: true, used: false, guests: true, name: '', by: 'a.k', came: 1 }],
      }),
    };
    for (const [path, answer] of Object.entries(answers))
      await page.route(`**/api/v1/${path}`, (route) => route.fulfill({ json: answer() }));
    hear(page, heard);
    await page.goto('about:blank');
    await page.goto(`${world.daemon.url}/modules.html#/rooms/${ours}?link=${'0'.repeat(32)}`);
    await page.locator('#guest-name').waitFor();
    await look(page, 'signing in');
    identity = person;
    await page.goto('about:blank');
    await page.goto(`${world.daemon.url}/modules.html`);
    await page.evaluate(() => sessionStorage.clear());
    await page.goto('about:blank');
    await page.goto(`${world.daemon.url}/modules.html#/rooms/${ours}`);
    await full(page);
    await page.locator('.people-button').click();
    await page.locator('.people-links button').first().click();
    await look(page, 'people');
    await page.keyboard.press('Escape');
    await page.locator('#tab-record').click();
    await page.locator('.signing').waitFor();
    await look(page, 'signing');
    await page.locator('.session-person').click();
    await look(page, 'who is signed in');
    await page.keyboard.press('Escape');
    identity = null;
    await page.route('**/api/v1/rooms/*/record*', (route) => route.fulfill({ status: 401, json: { title: '' } }));
    await page.route('**/api/v1/plans/**', (route) => route.fulfill({ status: 401, json: { title: '' } }));
    await page.locator('#tab-probe').click();
    await page.locator('#picture-2').click({ position: { x: 80, y: 80 } });
    await page.locator('.again').waitFor();
    await look(page, 'sign in again');
    await page.context().close();
  });

  later('presses each button of each panel', async () => {
    const page = await open(`modules.html#/rooms/${room}`, { acceptDownloads: true });
    page.on('dialog', (dialog) => dialog.dismiss());
    await full(page);
    const folded = page.locator('.section-head[aria-expanded="false"]');
    while (await folded.count()) await folded.first().click();
    const press = async (state) => {
      const buttons = page.locator('#tab-panel button:visible:enabled');
      for (let n = 0; n < Math.min(await buttons.count(), 40); n++) {
        const text = await buttons.nth(n).innerText();
        await buttons
          .nth(n)
          .click({ timeout: 2000 })
          .catch(() => {});
        await look(page, `${state}, button ${n} ${text}`);
        await page.keyboard.press('Escape');
      }
    };
    await blocks(page, press);
    for (const id of ['tab-probe', 'tab-plan', 'tab-notes', 'tab-record']) {
      await page.locator(`#${id}`).click();
      await press(id);
    }
    await page.context().close();
  });

  later('goes through a room at each size', async () => {
    for (const [size, options] of Object.entries(sizes).slice(1)) {
      const page = await open(`modules.html#/rooms/${room}`, options);
      await full(page);
      await look(page, size);
      await popovers(page, size);
      await page.context().close();
    }
  });

  it('finds what is planted', async () => {
    const page = await open('modules.html');
    await page.waitForFunction(() => document.body.innerText.trim().length > 40);
    await page.evaluate(() => document.body.insertAdjacentHTML('beforeend', '<p title="Planted title">⟦a⟧ planted ⟦b <b>c</b>⟧</p>'));
    const { said } = await page.evaluate(readPage);
    assert.deepEqual(
      said.filter(([text]) => /planted/i.test(text)).map(([text]) => text),
      ['Planted title', 'planted'],
    );
    await page.context().close();
  });

  it('has nothing that a person reads outside of the tables', () => {
    assert.ok(bracketed > 200, `${bracketed} sentences of the language were on the page`);
    const outside = [...found]
      .map(([text, where]) => [own(text), where, text])
      .filter(([text]) => isRead(text))
      .map(([rest, where, text]) => `${rest}   (${where}: ${text.slice(0, 90)})`);
    assert.deepEqual(outside.sort(), []);
  });

  it('has had no error', () => assert.deepEqual(world.errors, []));
});
