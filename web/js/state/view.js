// One picture of a room as the page knows it: its document, what was painted, what still waits for an answer.
import { batch, signal } from '../../lib/signals-core.js';
import { Replica } from './replica.js';

const fpsWindowMs = 1000;

export class ViewState {
  #replica = new Replica();
  #paintedAt = [];
  #hasChanged = false; // since refusal was told; messages overtake frames
  #unanswered = []; // {input, at, sentAt}: at is when the person did it

  /** @param {number} number as on the wire @param {'3d'|'axial'|'coronal'|'sagittal'} kind */
  constructor(number, kind) {
    this.number = number;
    this.kind = kind;
    this.document = signal({ kind });
    this.isOpen = signal(false);
    this.isFollowing = signal(true);
    this.movedBy = signal(''); // the other member whose change is shown, '' for our own
    this.leftAt = signal(0); // when following ended
    this.leftFrom = signal('');
    this.missing = signal({ n: 0, reasons: {} }); // regions the picture leaves out because they cannot be drawn: how many, why by id
    this.refusal = signal(''); // why there is no picture of the view as it is now, '' when there is
    this.painted = signal(null); // FrameHeader of the picture on the screen
    this.staleSince = signal(0); // since when an answer is missing; 0: none is
    this.fps = signal(0);
  }

  queue(patch) {
    this.change();
    this.#replica.queue(patch);
    batch(() => {
      if ('camera' in patch) this.movedBy.value = ''; // a new size alone is nobody's movement
      this.document.value = this.#replica.value;
    });
  }

  take(input) {
    return this.#replica.take(input);
  }

  /** From now on a picture with this input is expected. */
  expect(input, at, sentAt) {
    this.#unanswered.push({ input, at, sentAt });
    if (!this.staleSince.value) this.staleSince.value = sentAt;
  }

  refuse(input) {
    this.#replica.refuse(input);
    this.#forget((entry) => entry.input === input);
    this.document.value = this.#replica.value;
  }

  replace(document) {
    this.change();
    this.#replica.replace(document);
    this.document.value = this.#replica.value;
  }

  /** After a lost connection: what was under way is lost, what is shown stays. */
  restart(document) {
    this.#replica.reset(document);
    this.#unanswered = [];
    batch(() => {
      this.document.value = document;
      this.staleSince.value = 0;
      this.missing.value = { n: 0, reasons: {} };
      this.refusal.value = '';
    });
  }

  /** The view as it is now cannot be drawn. Frames that are still on their way show what it was. */
  refuseToDraw(reason) {
    this.#hasChanged = false;
    this.refusal.value = reason;
  }

  /** The view or its scene is no longer as it was: it may be drawn again. */
  change() {
    this.#hasChanged = true;
  }

  /** A picture is on the screen. Returns the answered inputs. */
  paint(header, now) {
    this.#paintedAt = [...this.#paintedAt.filter((at) => now - at < fpsWindowMs), now];
    const answered = this.#unanswered.filter((entry) => entry.input <= header.input_id);
    this.#replica.settle(header.input_id);
    this.#forget((entry) => entry.input <= header.input_id);
    batch(() => {
      this.document.value = this.#replica.value;
      this.painted.value = header;
      if (this.#hasChanged) this.refusal.value = '';
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
