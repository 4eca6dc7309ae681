// Saved views: what a first visit needs of them. The rest is loaded with the first bookmark of the room.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { known, later } from '../../parts/lazy.js';
import { name, treeRow } from '../../parts/tree_row.js';
import { say } from './words.js';

const parts = later(() => import('./bookmark_rows.js'), 'js/features/bookmarks/bookmark.css');

const n = ({ room }) => [...room.items.rows.value.values()].filter(({ kind }) => kind === 'bookmark').length;

const newRow = (world) =>
  treeRow(world, { kind: 'bookmark', id: '', words: [say.save, '…'], title: say.keeps }, html`${icon('plus')}${name(say.saveMore)}`);

const pendingKey = (room) => `saved ${room}`;

/** Remembers that this tab has just made the room from a saved view. */
export const beginWith = (room) => sessionStorage.setItem(pendingKey(room), '1');

/** Arranges the page as the view that this tab has made the room from, and says what of it could not be shown. @returns {() => void} stops */
function resumeBookmark(world) {
  const { room } = world;
  if (!sessionStorage.getItem(pendingKey(room.id))) return () => {};
  let isShown = false;
  return effect(() => {
    if (isShown || !room.canChange.value || !room.plan.value) return;
    isShown = true;
    sessionStorage.removeItem(pendingKey(room.id));
    queueMicrotask(async () => {
      await parts.load();
      await parts.loaded.peek()?.begin(world);
    });
  });
}

/** @type {import('../index.js').Feature} */
export const bookmarks = {
  make: (world) => {
    world.beginPrepared = async () => {
      if (n(world)) (await parts.load(), parts.loaded.peek())?.beginPrepared(world);
    };
  },
  sections: [
    {
      id: 'saved',
      name: say.section,
      icon: 'bookmark',
      place: 9,
      has: (plan, scene) => Boolean(scene), // scene and views can be saved once they are there
      note: (world) => String(n(world) || ''),
      rows: (world) => html`${n(world) ? known(parts)?.bookmarkRows(world) : nothing}${newRow(world)}`,
    },
  ],
  kinds: { bookmark: 'saved' },
  blocks: parts,
  bar: (world) => parts.loaded.value?.playBar(world) ?? nothing,
  start(world) {
    const stop = resumeBookmark(world);
    return () => {
      stop();
      parts.loaded.peek()?.leave(world);
    };
  },
};
