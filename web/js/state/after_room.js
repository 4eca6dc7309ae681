// What a person can do whose room has ended or never existed: go on in a room on the same plan, an existing or a new one.
import { signal } from '../../lib/signals-core.js';
import { present } from './plans.js';

export class AfterRoom {
  #api;
  #enter;

  /** @param {object} world {api, enter: (room: string, plan: string) => void} */
  constructor({ api, enter }) {
    this.#api = api;
    this.#enter = enter;
    this.plan = signal(null); // of the list of plans; null: not known, or no longer on the server
    this.isPlanGone = signal(false);
    this.rooms = signal([]); // on that plan, with somebody in them
    this.error = signal('');
    this.isBusy = signal(false);
  }

  /** @param {string} planId '' when it is not known */
  async look(planId) {
    if (!planId) return;
    try {
      const [{ plans }, { rooms }] = await Promise.all([this.#api.plans(), this.#api.rooms()]);
      this.plan.value = plans.find(({ id, state }) => id === planId && state !== 'unreadable') ?? null;
      this.isPlanGone.value = !this.plan.value;
      this.rooms.value = rooms.filter((room) => room.plan === planId && present(room).length);
    } catch (error) {
      this.error.value = error.message;
    }
  }

  /** Opens the plan in a new room. */
  async reopen() {
    this.error.value = '';
    this.isBusy.value = true;
    try {
      const { id } = this.plan.value;
      const room = await this.#api.makeRoom(id);
      this.#enter(room.id, id);
    } catch (error) {
      this.error.value = error.message;
    } finally {
      this.isBusy.value = false;
    }
  }

  join(room) {
    this.#enter(room.id, room.plan);
  }
}
