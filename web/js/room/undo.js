// Undo and redo of what this person changed: the scene, and the cameras of the views.
import { batch, effect, signal } from '../../lib/signals-core.js';
import { isObject, mergePatch } from '../wire/merge.js';
import { say } from './words.js';

/** Steps that are kept; the oldest is forgotten first. */
export const maxSteps = 100;
/** Changes of the same fields at most this far apart are one step: wheel, keys held down, typing. */
export const joinMs = 400;

// Fields that only make sense together: one of them is never restored without the others.
const isUnit = (path) => /^(camera|image\.window|image\.looks\.[^.]+)$/.test(path.join('.'));
const ignored = ['size_px', 'pixel_ratio', 'foot_px']; // follows the pane, not the person

/**
 * @typedef {object} Change one field, or one unit of fields, of one document
 * @property {'scene'|number} of the scene, or the number of a view
 * @property {string[]} path @property {unknown} before undefined: not there @property {unknown} after
 */

export class Undo {
  #room;
  #clock;
  #notify;
  #done = []; // steps {changes: Map<string, Change>, gesture, at, place}, oldest first; place: 'room' by the presenter, 'mark' of one's own in the room, 'own' for nobody else
  #undone = [];
  #gesture = 0; // the press that is held down; 0: none
  #nextGesture = 1;
  #isRestoring = false;
  #together = { name: '', at: -Infinity, gesture: 0 }; // the last act on several views

  /**
   * @param {import('./room.js').RoomState} room
   * @param {{clock: {now: () => number}, notify: (kind: string, text: string, topic?: string) => void}} world
   */
  constructor(room, { clock, notify }) {
    this.#room = room;
    this.#clock = clock;
    this.#notify = notify;
    this.next = signal(null); // the changes that undo would take back, Change[]; null: none
    this.nextAgain = signal(null); // the same of redo
    room.recorder = (of, patch, document, isMark = false) => this.#record(of, patch, document, isMark);
    room.together = (name, run) => this.#runTogether(name, run);
    room.returned = () => this.#dropOwn();
    effect(() => this.#tell());
  }

  /** All changes until release() are one step: a drag, or one movement of a slider. */
  press() {
    this.#gesture = this.#nextGesture++;
  }

  release() {
    this.#gesture = 0;
  }

  /** Makes the changes of run one step, joined with the same act just before it: wheel and keys held down. */
  #runTogether(name, run) {
    if (this.#gesture) return void run();
    const now = this.#clock.now();
    const { name: lastName, at: lastAt, gesture } = this.#together;
    this.#gesture = name === lastName && now - lastAt <= joinMs ? gesture : this.#nextGesture++;
    this.#together = { name, at: now, gesture: this.#gesture };
    run();
    this.#gesture = 0;
  }

  /** Notes an act of the presenter that no patch makes, such as an item. @param {{name: string, undo: () => Promise<unknown>, redo: () => Promise<unknown>}} act */
  noteAct(act) {
    const step = { changes: new Map(), act, gesture: 0, at: -Infinity, place: 'room' };
    this.#done = [...this.#done, step].slice(-maxSteps);
    this.#undone = [];
    this.#tell();
  }

  /** Steps that a reload keeps: those of the room and of one's marks. Own views begin anew, and acts are functions. */
  get kept() {
    const of = (steps) =>
      steps.filter(({ act, place }) => !act && place !== 'own').map(({ changes, place }) => ({ place, changes: [...changes.values()] }));
    return { done: of(this.#done), undone: of(this.#undone) };
  }

  /** Gives back what was kept, below what was changed since. */
  restore({ done, undone }) {
    const of = (steps) =>
      steps.map(({ place, changes }) => ({
        changes: new Map(changes.map((change) => [keyOf(change), change])),
        gesture: 0,
        at: -Infinity,
        place,
      }));
    const isNew = !this.#done.length;
    this.#done = [...of(done), ...this.#done].slice(-maxSteps);
    if (isNew) this.#undone = of(undone);
    this.#tell();
  }

  undo() {
    this.#move(this.#done, this.#undone, 'before', 'after', [say.partlyUndone, say.notUndone]);
  }

  redo() {
    this.#move(this.#undone, this.#done, 'after', 'before', [say.partlyRedone, say.notRedone]);
  }

  /** Notes a change before it is applied. */
  #record(of, patch, document, isMark) {
    if (this.#isRestoring) return;
    const changes = leaves(patch, document)
      .filter(([path]) => !ignored.includes(path[0]))
      .map(([path, value]) => {
        const before = at(document, path);
        return { of, path, before, after: after(before, value) };
      })
      .filter(({ before, after: value }) => !isSame(before, value));
    if (!changes.length) return;
    const now = this.#clock.now();
    const step = this.#stepFor(changes, now, isMark ? 'mark' : this.#isOnOwn ? 'own' : 'room');
    step.at = now;
    for (const change of changes) {
      const key = keyOf(change);
      const outer = [...step.changes.values()].find((other) => isWithin(change, other));
      if (outer) {
        outer.after = mergePatch(outer.after, put({}, change.path.slice(outer.path.length), change.after ?? null));
        continue;
      }
      const known = step.changes.get(key);
      step.changes.set(key, known ? { ...known, after: change.after } : change);
    }
    this.#undone = this.#undone.filter((undone) => !this.#reaches(undone));
    this.#tell();
  }

  /** The step that these changes belong to: the last one, or a new one. */
  #stepFor(changes, now, place) {
    const last = this.#done.at(-1);
    const isSamePress = last?.place === place && this.#gesture !== 0 && last.gesture === this.#gesture;
    const isSameFields =
      last?.place === place &&
      !this.#reaches(this.#undone.at(-1)) &&
      now - last.at <= joinMs &&
      changes.length === last.changes.size &&
      changes.every((change) => last.changes.has(keyOf(change)));
    if (isSamePress || isSameFields) return last;
    const step = { changes: new Map(), gesture: this.#gesture, at: now, place };
    this.#done = [...this.#done, step].slice(-maxSteps);
    return step;
  }

  /** Restores the fields of the newest step that still differ; a field that somebody else has changed since is left. */
  #move(from, to, wanted, left, [inPart, not]) {
    if (!this.#room.canChange.value) return;
    let step = null;
    let open = [];
    if (from.at(-1)?.act && this.#reaches(from.at(-1))) return this.#moveAct(from, to, wanted);
    while (!open.length && !from.at(-1)?.act && this.#reaches(from.at(-1))) {
      // a step that was refused, or already is as wanted, is passed over
      step = from.pop();
      open = [...step.changes.values()].filter((change) => !isSame(this.#now(change), change[wanted]));
    }
    const mine = open.filter((change) => isSame(this.#now(change), change[left]));
    if (mine.length) this.#restore(mine, wanted, step.place === 'mark');
    if (mine.length)
      to.push({ changes: new Map(mine.map((change) => [keyOf(change), change])), gesture: 0, at: -Infinity, place: step.place });
    if (mine.length < open.length) this.#notify('warn', mine.length ? inPart : not, 'undo');
    this.#tell();
  }

  /** An act that the server refuses, as one that was taken back since, is no step any more. */
  #moveAct(from, to, wanted) {
    const step = from.pop();
    const act = wanted === 'before' ? step.act.undo : step.act.redo;
    act().then(
      () => {
        to.push(step);
        this.#tell();
      },
      (problem) => this.#notify('warn', problem?.detail || say.refused, 'undo'),
    );
    this.#tell();
  }

  #restore(changes, wanted, isBack) {
    const patches = new Map();
    for (const change of changes) {
      const value = change[wanted] === undefined ? null : patchTo(this.#now(change), change[wanted]);
      patches.set(change.of, put(patches.get(change.of) ?? {}, change.path, value));
    }
    this.#isRestoring = true;
    batch(() => {
      for (const [of, patch] of patches) {
        if (of === 'scene') this.#room.patchScene(patch, { isBack });
        else this.#room.patchView(of, patch);
      }
    });
    this.#isRestoring = false;
  }

  #now({ of, path }) {
    return at(of === 'scene' ? this.#room.scene.value : this.#room.view(of).document.value, path);
  }

  get #isOnOwn() {
    return !this.#room.following.isPresenting.value;
  }

  /** The room's steps are the presenter's: to take one back, anybody else would have to leave. Marks are taken back by whose they are. */
  #reaches(step) {
    const isOnOwn = this.#isOnOwn; // read also without a step: next and nextAgain are told anew when it changes
    return step !== undefined && (step.place !== 'room' || !isOnOwn) && (step.place !== 'mark' || !isOnOwn || this.#isOfMarksOf(step));
  }

  /** Whether this member may change these marks without presenting: not those that were made by who presented then. */
  #isOfMarksOf({ changes }) {
    return [...changes.values()].every(({ path }) => path[1]?.endsWith(`-${this.#room.member.value}`));
  }

  /** After returning to the presenter's views: what was changed on one's own is gone already. */
  #dropOwn() {
    this.#done = this.#done.filter(({ place }) => place !== 'own');
    this.#undone = this.#undone.filter(({ place }) => place !== 'own');
    this.#tell();
  }

  #tell() {
    const changes = (step) =>
      this.#reaches(step) ? (step.act ? [{ of: 'act', path: [step.act.name] }] : [...step.changes.values()]) : null;
    batch(() => {
      this.next.value = changes(this.#done.at(-1));
      this.nextAgain.value = changes(this.#undone.at(-1));
    });
  }
}

/** Makes every press of a pointer one step. @param {EventTarget} target the window @param {Undo} undo @returns {() => void} stops it */
export function listenUndo(target, undo) {
  const abort = new AbortController();
  const on = (type, listener, capture) => target.addEventListener(type, listener, { signal: abort.signal, capture });
  on('pointerdown', () => undo.press(), true);
  on('pointerup', () => undo.release()); // after the listeners of what was pressed, whose last change belongs to the drag
  on('pointercancel', () => undo.release());
  return () => abort.abort();
}

const keyOf = ({ of, path }) => JSON.stringify([of, ...path]);

/** True for a field inside one that the same step has made. */
const isWithin = (change, other) =>
  change.of === other.of && change.path.length > other.path.length && other.path.every((name, index) => name === change.path[index]);

/** The fields that a patch sets, a unit as one field, and so what the document does not have yet: undo takes that away whole. [path, value][]. */
function leaves(patch, document, path = []) {
  if (path.length && (!isObject(patch) || isUnit(path) || at(document, path) === undefined)) return [[path, patch]];
  return Object.entries(patch).flatMap(([name, value]) => leaves(value, document, [...path, name]));
}

/** The value of a field once a patch has set it; null takes it away. */
const after = (before, patch) =>
  patch === null
    ? undefined
    : isObject(patch)
      ? Object.fromEntries(Object.entries({ ...before, ...patch }).filter(([, value]) => value !== null))
      : patch;

/** The patch that sets a field to a value, also to one with fewer fields inside than now. */
const patchTo = (now, wanted) =>
  isObject(wanted) && isObject(now) ? { ...Object.fromEntries(Object.keys(now).map((name) => [name, null])), ...wanted } : wanted;

const at = (document, path) =>
  path.reduce((value, name) => (isObject(value) && Object.hasOwn(value, name) ? value[name] : undefined), document) ?? undefined;

function put(patch, [name, ...rest], value) {
  patch[name] = rest.length ? put(patch[name] ?? {}, rest, value) : value;
  return patch;
}

/** Equal values; numbers that have been through the server as text may differ in their last digits. */
function isSame(a, b) {
  if (typeof a === 'number' && typeof b === 'number') return a === b || Math.abs(a - b) <= 1e-9 * Math.max(Math.abs(a), Math.abs(b));
  if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((value, index) => isSame(value, b[index]));
  if (!isObject(a) || !isObject(b)) return (a ?? null) === (b ?? null);
  return [...new Set([...Object.keys(a), ...Object.keys(b)])].every((name) => isSame(a[name], b[name]));
}
