// The user's guide (docs/guide) against the page: each of its tasks is done as the guide's pictures are made, every word that the guide has in bold
// type was seen on the way, every picture it shows is one of these, and its list of keys is the page's.
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { missing, startWorld } from './browser.mjs';
import { guidePlans, walk } from './guide_tours.mjs';
import { codesOn } from './plain_words.mjs';

const folder = new URL('../../docs/guide/', import.meta.url).pathname;
const pages = readdirSync(folder)
  .filter((name) => name.endsWith('.md'))
  .map((name) => ({ name, text: readFileSync(join(folder, name), 'utf8') }));
const plain = (text) => text.replace(/[\s\u00a0]+/g, ' ').toLowerCase();

describe("the user's guide", { skip: missing && `${missing} is not there` }, () => {
  let world;
  let parent;
  before(async () => {
    parent = mkdtempSync(join(tmpdir(), 'beamroom-guide-'));
    const plans = join(parent, 'plans'); // the page shows this name; the parent's random letters may look like a program's
    mkdirSync(plans);
    guidePlans(plans);
    world = await startWorld({ plans: [plans] });
  });
  after(async () => {
    await world?.stop();
    rmSync(parent, { recursive: true, force: true });
  });

  it('can be followed, and says what the page says', async () => {
    const pictures = [];
    const codes = new Set();
    let keys = [];
    const seen = plain(
      await walk(world, {
        shot: async (target, name) => {
          pictures.push(`${name}.jpg`);
          for (const code of await codesOn(target.page?.() ?? target)) codes.add(code);
        },
        keys: (rows) => {
          keys = rows;
        },
      }),
    );
    assert.deepEqual([...codes], [], 'words of programs on the page');
    const unseen = pages.flatMap(({ name, text }) =>
      [...text.matchAll(/\*\*(.+?)\*\*/gs)]
        .map(([, words]) => words)
        .filter((words) => !seen.includes(plain(words)))
        .map((words) => `${name}: ${words}`),
    );
    assert.deepEqual(unseen, [], 'words in bold type that were not seen on the page');
    const shown = pages.flatMap(({ text }) => [...text.matchAll(/!\[.*?\]\((.+?)\)/g)].map(([, file]) => file));
    assert.deepEqual(shown.sort(), pictures.sort());
    const listed = pages.find(({ name }) => name === 'keys.md').text;
    for (const [key, what] of keys) assert.ok(listed.includes(`| ${key} | ${what} |`), `keys.md lacks ${key}: make guide-pictures`);
    assert.deepEqual(world.errors, []);
  });
});
