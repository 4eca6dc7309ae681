// Saved views: what a first visit needs of them. The rest is loaded with the first bookmark of the room.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { known, Lazy, styled } from '../../parts/lazy.js';
import { name, treeRow } from '../../parts/tree_row.js';

const parts = new Lazy(async () => (await Promise.all([import('./bookmark_rows.js'), styled('js/features/bookmarks/bookmark.css')]))[0]);

/** Scene and views can be saved once they are there. */
export const hasBookmarks = (plan, scene) => Boolean(scene);

const n = ({ room }) => [...room.items.rows.value.values()].filter(({ kind }) => kind === 'bookmark').length;

export const bookmarkNote = (world) => String(n(world) || '');

const newRow = (world) =>
  treeRow(
    world,
    { kind: 'bookmark', id: '', words: ['Save this view', '…'], title: 'Keeps scene, cameras and panes as they are now' },
    html`${icon('plus')}${name('Save this view …')}`,
  );

export const bookmarkRows = (world) => html`${n(world) ? known(parts)?.bookmarkRows(world) : nothing}${newRow(world)}`;

/** Draws parts of bookmark_rows.js in Selection. */
export const drawBookmark = (use) => parts.draw(use);

/** Above the panes while saved views are presented. */
export const playBar = (world) => parts.loaded.value?.playBar(world) ?? nothing;

/** The page leaves the room. */
export const leaveBookmarks = (world) => parts.loaded.peek()?.leave(world);

const pendingKey = (room) => `saved ${room}`;

/** Remembers that this tab has just made the room from a saved view. */
export const beginWith = (room) => sessionStorage.setItem(pendingKey(room), '1');

/** Arranges the page as the view that this tab has made the room from, and says what of it could not be shown. @returns {() => void} stops */
export function resumeBookmark(world) {
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
