// Saved views: rows of the tree, Selection, the bar while they are presented.
import { bookmarkBlock } from './bookmark_block.js';
import { html, nothing } from '../../../lib/lit-html.js';
import { repeat } from '../../../lib/directives/repeat.js';
import { Bookmarks, bookmarksOf } from './bookmarks.js';
import { toldOfMerge } from '../../room/scene_merge.js';
import { icon } from '../../parts/icons.js';
import { name, treeRow } from '../../parts/tree_row.js';
import { say } from './later_words.js';

export const blocks = { bookmark: bookmarkBlock };

const known = new WeakMap();

/** The bookmarks of this page's room; their keys work from the first call on. @returns {Bookmarks} */
export function bookmarksIn(world) {
  if (!known.has(world)) known.set(world, new Bookmarks(world));
  return known.get(world);
}

/** Runs what talks to the server, and says why it failed. */
export async function attempt({ ui }, run, done = '') {
  try {
    const result = await run();
    if (done) ui.notify('ok', done, 'saved');
    return result;
  } catch (error) {
    ui.notify('err', error.message ?? error.detail ?? say.refused, 'saved'); // an Error, or a problem of the server
    return null;
  }
}

/** A sentence about the parts of a saved view that could not be shown; '' when it is whole. */
const lost = ({ report, n_report: all }) => (all ? (all > 1 ? say.lost : say.oneLost)({ n: all, detail: report[0].detail }) : '');

/** A sentence about what of a saved view is not as it was saved; '' when it is. */
const whyNot = (opened) => [lost(opened), toldOfMerge(opened.merge)].filter(Boolean).join(' ');

function told(world, opened, isQuiet = false) {
  if (!opened) return;
  const isReported = opened.n_report > 0;
  const why = whyNot(opened);
  if (why)
    world.ui.notify(
      'warn',
      say.openedBut({ name: opened.name, why }),
      'saved',
      isReported ? { word: say.all, act: () => world.ui.choose('bookmark', bookmarksIn(world).shown.value) } : null,
    );
  else if (!world.room.following.isPresenting.value && !isQuiet)
    world.ui.notify('ok', say.openedOwn({ name: opened.name }), 'saved', {
      word: say.return,
      keys: (hotkeys) => hotkeys.orEscape('follow'),
      act: () => world.room.following.return(),
    });
}

/** Shows a saved view: the presenter to everybody, anybody else to themselves. */
export const show = async (world, row) => told(world, await attempt(world, () => bookmarksIn(world).show(row)));

/** An image of a saved view; a frame with its sign until it is drawn. */
export function pictureOf(world, row) {
  const url = bookmarksIn(world).picture(row);
  return html`<span class="bookmark-picture">${url ? html`<img src=${url} alt="">` : icon('bookmark')}</span>`;
}

export function bookmarkRows(world) {
  const { room } = world;
  const { shown } = bookmarksIn(world);
  return repeat(
    bookmarksOf(room),
    ({ id }) => id,
    (row) => {
      const { name: words } = row.body;
      const isShown = shown.value === row.id;
      const toggle = () => void show(world, row);
      const about = room.following.isPresenting.value ? say.showAll : say.showOwn;
      return treeRow(
        world,
        {
          kind: 'bookmark',
          id: row.id,
          words: [words],
          more: [...(isShown ? [say.shownLast] : [])],
          title: say.savedBy({ name: words, author: row.author_name }),
          toggle,
        },
        html`
      ${pictureOf(world, row)}${name(words)}<button class="eye bookmark-show" tabindex="-1"
        aria-label=${say.show({ name: words })} title=${about} ?disabled=${!room.canChange.value}
        @click=${(event) => {
          event.stopPropagation();
          toggle();
        }}>${icon('eye')}</button>`,
      );
    },
  );
}

// ---- presenting ---------------------------------------------------------------------------------------------------------

let playing = null; // the world whose saved views the keys go through

function onKey(event) {
  const by = { PageDown: 1, PageUp: -1 }[event.key];
  if (!by || event.target.matches?.('input:not([type=range]):not([type=checkbox]), textarea, select')) return;
  event.preventDefault();
  event.stopPropagation(); // a pane would go ten slices on
  void step(playing, by);
}

async function playFrom(world, row) {
  endPlaying();
  playing = world;
  addEventListener('keydown', onKey, true);
  return attempt(world, () => bookmarksIn(world).play(row));
}

export const play = async (world, row = null) => told(world, await playFrom(world, row), true);

/** A meeting has come to the case of this room: the first saved view is shown to everybody, several are a presentation that begins with it. */
export async function beginPrepared(world) {
  const rows = bookmarksOf(world.room);
  const opened = rows.length > 1 ? await playFrom(world, rows[0]) : await attempt(world, () => bookmarksIn(world).show(rows[0]));
  if (!opened) return;
  const words = (rows.length > 1 ? say.preparedFirst : say.prepared)({ name: opened.name, n: rows.length });
  const why = whyNot(opened);
  world.ui.notify(why ? 'warn' : 'ok', [words, why].filter(Boolean).join(' '), 'saved', { word: say.undo, act: () => world.undo.undo() });
}

function endPlaying() {
  removeEventListener('keydown', onKey, true);
  if (playing) bookmarksIn(playing).end();
  playing = null;
}

/** The page leaves the room. */
export function leave(world) {
  if (playing === world) endPlaying();
  bookmarksIn(world).stop();
}

const step = async (world, by) => told(world, await attempt(world, () => bookmarksIn(world).step(by)), true);

export function playBar(world) {
  const bookmarks = bookmarksIn(world);
  if (!bookmarks.isPlaying.value) return nothing;
  const { room } = world;
  const rows = bookmarksOf(room);
  const at = bookmarks.position(rows);
  const who = room.following.isPresenting.value ? say.allSee : say.ownSees;
  return html`<div class="bookmark-bar" role="group" aria-label=${say.presentation}>
    <button class="icon-button" aria-label=${say.before} title=${say.pageUp} ?disabled=${at <= 0}
      @click=${() => void step(world, -1)}>${icon('chevronLeft')}</button>
    <p role="status"><b>${at < 0 ? say.noneOf({ all: rows.length }) : say.place({ n: at + 1, all: rows.length })}</b>
      <span class="clipped">${rows[at]?.body.name ?? ''}</span> <span class="dim">${who}</span></p>
    <button class="icon-button" aria-label=${say.next} title=${say.pageDown} ?disabled=${at >= rows.length - 1}
      @click=${() => void step(world, 1)}>${icon('chevronRight')}</button>
    <button class="icon-button" aria-label=${say.endPresentation} title=${say.end} @click=${endPlaying}>${icon('close')}</button></div>`;
}

// ---- a room that was made from one --------------------------------------------------------------------------------------

/** The server has given the room its scene and cameras; panes are this page's own. */
export async function begin(world) {
  const { room, api } = world;
  const { saved } = (await attempt(world, () => api.room(room.id))) ?? {};
  if (!saved) return;
  const why = saved.n_report ? lost(saved) : '';
  bookmarksIn(world).begin(saved);
  world.ui.notify(
    why ? 'warn' : 'ok',
    (why ? say.begunBut : say.begun)({ name: saved.name, why }),
    'saved',
    why ? { word: say.all, act: () => world.ui.choose('bookmark', 'begun') } : null,
  );
}
