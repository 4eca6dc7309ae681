// Where the others point, and the request to look at a point, as the server tells them. What draws them and what sends the own pointer is loaded when
// somebody else is in the room: features/pointers/.
import { batch, computed, signal } from '../../lib/signals-core.js';

const hiddenKey = 'beamroom pointers hidden';

/** @typedef {{member: string, view: number, point: number[], movedAt: number}} Pointer @typedef {{number: number, by: string, point: number[], came: string[]}} Look */

export class Pointers {
  #room;
  #clock;
  #schedule;
  #send;
  #waiting = new Map(); // what came since the last frame: of each member the newest

  /** @param {import('./room.js').RoomState} room @param {{clock, schedule, send: (message: object) => boolean}} world */
  constructor(room, { clock, schedule, send }) {
    this.#room = room;
    this.#clock = clock;
    this.#schedule = schedule;
    this.#send = send;
    /** @type {import('../../lib/signals-core.js').Signal<Map<string, Pointer>>} by member */
    this.all = signal(new Map());
    /** @type {import('../../lib/signals-core.js').Signal<Look|null>} */
    this.look = signal(null);
    this.isPointing = signal(false); // the pointing gesture is on
    this.own = signal(null); // Pointer: what was last sent
    this.isHidden = signal(false);
    const own = computed(() => room.members.value.find(({ id }) => id === room.member.value) ?? null);
    this.mayPoint = computed(() => own.value !== null && own.value.role !== 'observer');
    this.others = computed(() => room.members.value.filter(({ id, connected }) => id !== room.member.value && connected !== false));
    this.shown = computed(() => [...this.others.value, ...room.recording.members.value]); // whose pointers are drawn: in a replay also of who was there
  }

  /** Whether pointers are drawn, as this browser keeps it. */
  keepIn(storage) {
    this.isHidden.value = storage?.getItem(hiddenKey) === 'yes';
    return (isHidden) => {
      this.isHidden.value = isHidden;
      try {
        storage?.setItem(hiddenKey, isHidden ? 'yes' : 'no');
      } catch {
        /* a full storage: kept for this visit */
      }
    };
  }

  nameOf(id) {
    return this.#room.members.value.find((member) => member.id === id)?.name ?? id;
  }

  // ---- acts of the user -------------------------------------------------------------------------------------------

  /** Sends where this person points; null: no more. */
  point(view, point) {
    if (!point && !this.own.peek()) return;
    if (!this.#send(point ? { type: 'pointer', view, point_mm: point } : { type: 'pointer' })) return;
    this.own.value = point ? { member: this.#room.member.peek(), view, point, movedAt: this.#clock.now() } : null;
  }

  /** Asks everybody to look at a point; null: takes the own request back. */
  ask(point) {
    return this.#send({ type: 'look.here', point_mm: point });
  }

  come(number) {
    this.#send({ type: 'look.come', number });
  }

  /** Leaves the pointing gesture. Returns whether it was on. */
  stop() {
    const wasOn = this.isPointing.peek();
    this.isPointing.value = false;
    return wasOn;
  }

  // ---- messages of the server -------------------------------------------------------------------------------------

  /** Shown with the next frame of the screen: several that come before it are drawn once. */
  moved({ member, view, point_mm: point }) {
    if (!this.#waiting.size) this.#schedule(() => this.#show());
    this.#waiting.set(member, point && { member, view, point, movedAt: this.#clock.now() });
  }

  #show() {
    const all = new Map(this.all.peek());
    for (const [member, pointer] of this.#waiting) {
      if (pointer) all.set(member, pointer);
      else all.delete(member);
    }
    this.#waiting.clear();
    this.all.value = all;
  }

  looked({ number, by, point_mm: point, came }) {
    if (point) this.look.value = { number, by, point, came: Array.isArray(came) ? came : [] };
    else if (this.look.peek()?.number === number) this.look.value = null;
  }

  /** The server tells everything anew after a welcome. */
  restart() {
    this.#waiting.clear();
    batch(() => {
      this.all.value = new Map();
      this.look.value = null;
      this.own.value = null;
    });
  }
}
