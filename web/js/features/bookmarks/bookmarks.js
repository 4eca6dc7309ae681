// Bookmarks: what of the page a saved view keeps, and showing one again. What one shows of the plan as it is now, the server says.
import { batch, effect, signal } from '../../../lib/signals-core.js';
import { readDocument } from '../../wire/check.js';
import { isObject } from '../../wire/merge.js';
import { layouts } from '../../room/layout.js';
import { mergedScene } from '../../room/scene_merge.js';
import { say } from './later_words.js';

export const maxName = 80; // characters
const mostPictures = 60; // kept in this tab; never written to the disk of this computer: they show patients

/** The bookmarks of a room in their order. */
export const bookmarksOf = (room) =>
  [...room.items.rows.value.values()]
    .filter(({ kind }) => kind === 'bookmark')
    .sort((a, b) => (a.body.order ?? 0) - (b.body.order ?? 0) || a.created_ms - b.created_ms || (a.id < b.id ? -1 : 1));

const own = ({ members, member }) => members.value.find(({ id }) => id === member.value);
/** Observers look only. */
export const canSave = (room) => room.canChange.value && !['observer', 'wall'].includes(own(room)?.role);
const isOwn = (room, row) => (row.author_user ? row.author_user === own(room)?.user : row.author === room.member.value);
export const canEdit = (room, row) =>
  canSave(room) && (isOwn(room, row) || room.following.isPresenting.value || ['presenter', 'planner'].includes(own(room)?.role));

// ---- saving -------------------------------------------------------------------------------------------------------------

const usual = { phone: 'single', tablet: '1+3', compact: '2x2', wide: '2x2' };

function layoutNow(ui) {
  const layout = ui.panes.layout.value || usual[ui.arrangement.value.size];
  return {
    layout,
    cells: layout === '2x1' ? ui.panes.two.value : ui.panes.four.value,
    maximised: ui.maximised.value,
    active: ui.active.value,
  };
}

/** The document of a view as it is kept: without its size and the own override, which becomes part of the scene. */
function keptDocument({ kind, document }) {
  const { number, plane, camera, beam } = document.value;
  return { kind, ...(number > 1 && { number }), ...(plane && { plane }), ...(camera && { camera }), ...(beam && { beam }) };
}

/** The present state as the body of a bookmark; the server adds the scene. */
export function stateNow({ room, ui }) {
  const override = room.following.override.value;
  return {
    ...(override && { override }),
    scene: null,
    views: ui.visible.value.map((number) => ({ view: number, document: keptDocument(room.view(number)) })),
    layout: layoutNow(ui),
  };
}

const lastOrder = (rows) => rows.reduce((most, { body }) => Math.max(most, body.order ?? 0), 0);

export const freeName = (rows) => {
  for (let n = rows.length + 1; ; n++) {
    const name = say.freeName({ n });
    if (!rows.some(({ body }) => body.name === name)) return name;
  }
};

export function save(world, name) {
  const rows = bookmarksOf(world.room);
  return world.room.items.put('bookmark', { ...stateNow(world), name: name || freeName(rows), order: lastOrder(rows) + 1 });
}

/** The bookmark gets the present state and keeps its name, place and link. */
export const update = (world, row) => world.room.items.put('bookmark', { ...row.body, ...stateNow(world) }, row);
export const rename = ({ room }, row, name) => room.items.put('bookmark', { ...row.body, name: name.slice(0, maxName) }, row);
export const remove = ({ room }, row) => room.items.delete(row);

/** One place earlier (by -1) or later (1): between its new neighbours. */
export async function move({ room }, row, by) {
  const rows = bookmarksOf(room);
  const at = rows.findIndex(({ id }) => id === row.id);
  const to = at + by;
  if (at < 0 || to < 0 || to >= rows.length) return;
  const order = (index) => rows[index]?.body.order ?? 0;
  const beyond = to + by;
  const isEnd = !rows[beyond];
  const place = isEnd ? order(to) + by : (order(to) + order(beyond)) / 2;
  if (place !== order(to) && (isEnd || place !== order(beyond)))
    return void (await room.items.put('bookmark', { ...row.body, order: place }, row));
  const wanted = rows.filter((other) => other !== row); // no number is left between them
  wanted.splice(to, 0, row);
  for (const [index, other] of wanted.entries())
    if (other.body.order !== index + 1) await room.items.put('bookmark', { ...other.body, order: index + 1 }, other);
}

/** The token of a saved view stands behind "#": no server writes it into a log. */
export const linkOf = (row, href = location.href) => new URL(`/#/p/${row.body.token}`, href).href;

// ---- showing ------------------------------------------------------------------------------------------------------------

const isEqual = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/**
 * The patch that makes wanted of now. isOwn: for the override of own views, which cannot take an entry of the room's scene away: it hides it.
 */
export function patchTo(now, wanted, isOwn = false) {
  const patch = {};
  const set = (name, value) => Object.defineProperty(patch, name, { value, enumerable: true, configurable: true, writable: true });
  for (const [name, value] of Object.entries(wanted)) {
    const before = Object.hasOwn(now, name) ? now[name] : undefined;
    if (isEqual(before, value)) continue;
    const inner = isObject(before) && isObject(value) ? patchTo(before, value, isOwn) : value;
    if (!isObject(inner) || Object.keys(inner).length || !isObject(before)) set(name, inner);
  }
  for (const [name, value] of Object.entries(now)) {
    if (Object.hasOwn(wanted, name) || value === null) continue;
    if (!isOwn) set(name, null);
    else if (isObject(value) && 'visible' in value) set(name, { visible: false });
  }
  return patch;
}

const isCells = (cells, n) =>
  Array.isArray(cells) &&
  cells.length === n &&
  new Set(cells).size === n &&
  cells.every((view) => Number.isInteger(view) && view >= 1 && view <= 8);
const isView = (number) => Number.isInteger(number) && number >= 1 && number <= 8;

/** Arranges the panes of this page as they were saved. */
export function arrangeAs(ui, { layout, cells, maximised, active } = {}) {
  batch(() => {
    if (layouts.some((other) => other.layout === layout)) ui.panes.layout.value = layout;
    if (layout === '2x1' && isCells(cells, 2)) ui.panes.two.value = cells;
    else if (layout !== '2x1' && isCells(cells, 4)) ui.panes.four.value = cells;
    if (isView(active)) ui.active.value = active;
    ui.maximised.value = isView(maximised) ? maximised : 0;
  });
  if (!ui.visible.value.includes(ui.active.value)) ui.active.value = ui.visible.value[0];
}

/** Everything that a view keeps: the server leaves out what is null. */
function viewPatch(document) {
  const { kind, camera, plane, beam } = readDocument('view', document);
  return { camera, ...(kind === 'oblique' && { plane }), ...(kind.startsWith('beam') && { beam }) };
}

/** Gives views their saved documents; one that no pane shows yet gets it when it is opened. @returns {() => void} stops waiting */
export function showViews(room, views) {
  const stops = [];
  const known = views.filter(({ view, document }) => room.view(view)?.kind === document.kind);
  const [open, closed] = [
    known.filter(({ view }) => room.view(view).isOpen.value),
    known.filter(({ view }) => !room.view(view).isOpen.value),
  ];
  room.patchViews(open.map(({ view, document }) => [view, viewPatch(document)]));
  for (const { view, document } of closed) {
    let isDone = false;
    const stop = effect(() => {
      if (isDone || !room.view(view).isOpen.value) return;
      isDone = true;
      queueMicrotask(() => {
        stop();
        room.patchView(view, viewPatch(document));
      });
    });
    stops.push(stop);
  }
  return () => stops.forEach((stop) => stop());
}

/** In this tab's room: its pictures, and the bookmarks as a presentation. */
export class Bookmarks {
  #world;
  #stopViews = () => {};
  #urls = new Map(); // by id and version, in order of their making
  #asked = new Set();
  #isRunning = false;

  /** @param {object} world {room, ui, undo, api} @param {{createObjectURL: Function, revokeObjectURL: Function}} urls */
  constructor(world, urls = URL) {
    this.#world = world;
    this.makeUrl = (blob) => urls.createObjectURL(blob);
    this.dropUrl = (url) => urls.revokeObjectURL(url);
    this.urls = signal({});
    this.shown = signal(''); // the bookmark that was shown last
    this.isPlaying = signal(false);
    this.report = signal({ id: '', name: '', lines: [], n: 0 }); // what of the one shown last could not be shown
  }

  stop() {
    this.#stopViews();
    for (const url of this.#urls.values()) this.dropUrl(url);
    this.#urls.clear();
  }

  // ---- showing --------------------------------------------------------------------------------------------------------

  /** The presenter shows it to the room, anybody else to themselves. */
  async show(row) {
    const { room, api } = this.#world;
    const opened = await api.bookmark(room.id, row.id);
    if (!room.canChange.value) throw new Error(say.noAnswer);
    return { ...opened, merge: this.showOpened(opened, row.id) };
  }

  /** @param {object} opened as GET .../bookmarks/{bookmark} answers @returns what of the room's scene it hid or left: mergedScene */
  showOpened(opened, id = '') {
    const { room, ui, undo } = this.#world;
    this.#stopViews();
    undo?.press();
    const merge = mergedScene(room.scene.value, opened.scene);
    const patch = patchTo(room.scene.value, merge.scene, !room.following.isPresenting.value);
    if (Object.keys(patch).length) room.patchScene(patch, { view: ui.active.value });
    arrangeAs(ui, opened.layout);
    this.#stopViews = showViews(room, opened.views);
    undo?.release();
    this.shown.value = id;
    if (id && this.isPlaying.value && ui.selection.value.kind === 'bookmark') ui.select('bookmark', id, false);
    this.report.value = { id, name: opened.name, lines: opened.report, n: opened.n_report };
    return merge;
  }

  /** The page of a room that was made from a saved view: the server has given the room its scene and cameras. @param {object} saved of the room's document */
  begin({ name, layout, views = [], report = [], n_report: n = 0 }) {
    const { room, ui } = this.#world;
    arrangeAs(ui, layout);
    if (room.following.isPresenting.value) this.#stopViews = showViews(room, views); // an oblique pane is told its plane
    this.report.value = { id: 'begun', name, lines: report, n };
  }

  // ---- as a presentation ----------------------------------------------------------------------------------------------

  /** Index of the one shown last; -1: none of the list. */
  position(rows = bookmarksOf(this.#world.room)) {
    return rows.findIndex(({ id }) => id === this.shown.value);
  }

  async play(row = null) {
    const rows = bookmarksOf(this.#world.room);
    if (!rows.length) return null;
    this.isPlaying.value = true;
    return this.show(row ?? rows[Math.max(this.position(rows), 0)]);
  }

  /** The next (1) or the one before (-1); at either end it stays. */
  async step(by) {
    const rows = bookmarksOf(this.#world.room);
    const to = Math.min(Math.max(this.position(rows) + by, 0), rows.length - 1);
    return rows[to] && rows[to].id !== this.shown.value ? this.show(rows[to]) : null;
  }

  end() {
    this.isPlaying.value = false;
  }

  // ---- pictures -------------------------------------------------------------------------------------------------------

  /** @returns {string} '' while there is none */
  picture(row) {
    const key = `${row.id} ${row.version}`;
    if (!this.#asked.has(key) && this.#world.room.renderer.value.state === 'ready') {
      this.#asked.add(key);
      queueMicrotask(() => this.#makePictures());
    }
    return this.urls.value[key] ?? '';
  }

  async #makePictures() {
    if (this.#isRunning) return;
    this.#isRunning = true;
    const { room, api } = this.#world;
    for (let key; (key = [...this.#asked].find((other) => !this.#urls.has(other))); ) {
      const [id] = key.split(' ');
      this.#urls.set(key, ''); // a refused one is not asked for again before the bookmark changes
      const blob = await api.bookmarkPicture(room.id, id).catch(() => null);
      if (blob) this.#urls.set(key, this.makeUrl(blob));
      for (const [old, url] of this.#urls) {
        if (this.#urls.size <= mostPictures) break;
        this.#urls.delete(old);
        this.#asked.delete(old);
        if (url) this.dropUrl(url);
      }
      this.urls.value = Object.fromEntries(this.#urls);
    }
    this.#isRunning = false;
  }
}
