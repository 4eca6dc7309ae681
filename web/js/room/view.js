// State of one view of a room: its document, the picture on the screen, inputs that wait for an answer.
import { batch, signal } from '../../lib/signals-core.js';
import { Replica } from './replica.js';

const fpsWindowMs = 1000;

export class ViewState {
  #replica = new Replica();
  #paintedAt = [];
  #received = 0; // sequence of the newest picture received; 0: none
  #refusedAt = 0; // #received when the refusal came: a later picture ends it
  #revision = 0; // of the scene, as told last
  #sameSince = 0; // the oldest revision of the scene with the same picture as that
  #unanswered = []; // {input, at, sentAt}; at: time of the input event, 0: not an input in this pane

  /** @param {number} number in messages and frames @param {string} kind of scene.json @param {object} more the document's number; name for people, and within a sentence */
  constructor(number, kind, { number: ofKind = 1, name = kind, nameWithin = name } = {}) {
    this.number = number;
    this.kind = kind;
    this.ofKind = ofKind;
    this.name = name;
    this.nameWithin = nameWithin;
    this.document = signal(ofKind > 1 ? { kind, number: ofKind } : { kind });
    this.isOpen = signal(false);
    this.ownSize = null; // [width, height] in px, as last measured in the page; the shared document has the presenter's
    this.widening = 1; // by how much the extent of the own view was more than that of the shared one when the member left
    this.awaited = []; // follow flags of our acts, oldest first, that the server has not answered with a view message yet
    this.missing = signal({ n: 0, reasons: {} }); // regions missing from the picture because they cannot be drawn: number, and reason by id
    this.refusal = signal(''); // why the view cannot be drawn as it is now; '' when it can
    this.painted = signal(null); // FrameHeader of the picture on the screen
    this.staleSince = signal(0); // time since which an answer is missing; 0: none is
    this.behindSince = signal(0); // time since which the picture has not shown the newest scene, and no newer one came; 0: it does
    this.fps = signal(0);
  }

  queue(patch) {
    this.#replica.queue(patch);
    this.document.value = this.#replica.value;
  }

  get isPending() {
    return this.#replica.isPending;
  }

  take(input) {
    return this.#replica.take(input);
  }

  /** Expects a picture that answers this input. */
  expect(input, at, sentAt) {
    this.#unanswered.push({ input, at, sentAt });
    if (!this.staleSince.value) this.staleSince.value = sentAt;
  }

  /** Expects it no more. Returns what was expected; null: nothing. */
  release(input) {
    const entry = this.#unanswered.find((other) => other.input === input) ?? null;
    if (entry) this.#forget((other) => other === entry);
    return entry;
  }

  refuse(input) {
    this.#replica.refuse(input);
    this.#forget((entry) => entry.input === input);
    this.document.value = this.#replica.value;
  }

  replace(document) {
    this.#replica.replace(document);
    this.document.value = this.#replica.value;
  }

  /** After a lost connection: changes without an answer are queued again. Returns whether there are any. */
  recall() {
    this.#unanswered = [];
    this.staleSince.value = 0;
    this.awaited = [];
    this.#received = this.#refusedAt = 0;
    return this.#replica.recall();
  }

  /** Drops the queued changes. */
  drop() {
    this.#replica.reset(this.#replica.base);
    this.document.value = this.#replica.value;
  }

  /** Starts again from a document without pending changes; the picture stays. */
  restart(document) {
    this.#replica.reset(document);
    this.#unanswered = [];
    this.#refusedAt = 0;
    batch(() => {
      this.document.value = document;
      this.staleSince.value = 0;
      this.missing.value = { n: 0, reasons: {} };
      this.refusal.value = '';
    });
  }

  /** Notes that a picture was received; it may be painted after messages that came later. */
  receive({ sequence }) {
    this.#received = sequence;
  }

  /** Notes that the view cannot be drawn as it is now. The server sends no older picture after that. */
  refuseToDraw(reason) {
    this.#refusedAt = this.#received;
    this.refusal.value = reason;
  }

  /** The scene has this revision now. isSame: this view's picture does not change by it, and no other one comes. */
  sceneChanged(revision, now, isSame = false) {
    this.#revision = revision;
    if (!isSame) this.#sameSince = revision;
    else if (this.painted.value) this.painted.value = this.#asOfNow(this.painted.value);
    if (!this.#isBehind(this.painted.value)) this.behindSince.value = 0;
    else if (!this.behindSince.value) this.behindSince.value = now;
  }

  #isBehind(header) {
    return header !== null && header.scene_revision < this.#revision;
  }

  /** The header with the newest revision that its picture is of. */
  #asOfNow(header) {
    const isNow = header.scene_revision >= this.#sameSince && header.scene_revision < this.#revision;
    return isNow ? { ...header, scene_revision: this.#revision } : header;
  }

  /** Notes that a picture is on the screen. Returns the answered inputs. */
  paint(header, now) {
    this.#paintedAt = [...this.#paintedAt.filter((at) => now - at < fpsWindowMs), now];
    const answered = this.#unanswered.filter((entry) => entry.input <= header.input_id && entry.at);
    this.#replica.settle(header.input_id);
    this.#forget((entry) => entry.input <= header.input_id);
    batch(() => {
      this.document.value = this.#replica.value;
      this.painted.value = this.#asOfNow(header);
      this.behindSince.value = this.#isBehind(this.painted.value) ? now : 0;
      if (header.sequence > this.#refusedAt) this.refusal.value = '';
      this.fps.value = this.#paintedAt.length;
    });
    return answered;
  }

  /** Pictures painted in the last second; 0 when nothing moves. */
  fpsAt(now) {
    return this.#paintedAt.filter((at) => now - at < fpsWindowMs).length;
  }

  #forget(test) {
    this.#unanswered = this.#unanswered.filter((entry) => !test(entry));
    this.staleSince.value = this.#unanswered[0]?.sentAt ?? 0;
  }
}
