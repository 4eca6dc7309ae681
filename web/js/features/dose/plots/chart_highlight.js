// While the pointer rests on a histogram, the univels it is about are highlighted in the own pictures. Nothing of that is a change of the
// scene or a step of undo. Members who follow see what the presenter's views show; their own pointer highlights nothing.

const highlightMs = 60;

export class Highlight {
  #room;
  #timer = 0;
  #wanted = null;
  #isOn = false;
  #before = null; // coverage of the own views before; null: none of their own

  /** @param {import('../../../room/room.js').RoomState} room */
  constructor(room) {
    this.#room = room;
  }

  /** @param {{region: string, low: number, high: number|null, quantity: string, tissue: string}} part of the region, in the quantity and with the weights of its histogram */
  show(part) {
    if (!this.#room.canShowOwn) return;
    this.#wanted = {
      visible: true,
      region: part.region,
      low: part.low,
      ...(part.high === null ? {} : { high: part.high }),
      unit: 'dose',
      quantity: part.quantity,
      tissue: part.tissue,
    };
    if (!this.#timer) this.#timer = setTimeout(() => this.#send(), highlightMs);
  }

  end() {
    clearTimeout(this.#timer);
    this.#timer = 0;
    this.#wanted = null;
    if (!this.#isOn) return;
    this.#isOn = false;
    const own = this.#room.views.find((view) => view.isOpen.value)?.document.value.override?.dose ?? {};
    this.#room.showOwn({ dose: Object.keys(own).some((name) => name !== 'coverage') ? { coverage: null } : null });
    if (this.#before) this.#room.showOwn({ dose: { coverage: this.#before } });
  }

  #send() {
    this.#timer = 0;
    if (!this.#wanted) return;
    if (!this.#isOn) this.#before = this.#room.following.override.value?.dose?.coverage ?? null;
    this.#isOn = true;
    this.#room.showOwn({ dose: { coverage: this.#wanted } });
  }
}
