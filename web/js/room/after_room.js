// Ways on for a person whose room has ended or never existed: a room on the same plan, an existing or a new one.
import { signal } from '../../lib/signals-core.js';

/** The members that are in a room now. */
export const present = (room) => room.members.filter(({ connected }) => connected !== false);

const attempts = 5;
const againMs = 1000;

export class AfterRoom {
  #api;
  #clock;
  #enter;
  #isStopped = false;

  /** @param {object} world {api, clock, enter: (room: string, plan: string) => void} */
  constructor({ api, clock, enter }) {
    this.#api = api;
    this.#clock = clock;
    this.#enter = enter;
    this.plan = signal(null); // of the list of plans; null: not known, or no longer on the server
    this.isPlanGone = signal(false);
    this.rooms = signal([]); // on that plan, with somebody in them
    this.error = signal('');
    this.isBusy = signal(false);
  }

  stop() {
    this.#isStopped = true;
  }

  /** Looks a few times: a server that has just started again does not have its list of plans yet.
   *  @param {string} planId '' when it is not known */
  async look(planId) {
    for (let attempt = 1; planId && !this.plan.value && attempt <= attempts && !this.#isStopped; attempt++) {
      if (attempt > 1)
        await new Promise((resolve) => {
          this.#clock.setTimeout(resolve, againMs);
        });
      await this.#lookOnce(planId);
    }
    this.isPlanGone.value = planId !== '' && !this.plan.value && !this.error.value;
  }

  async #lookOnce(planId) {
    try {
      const [{ plans }, { rooms }] = await Promise.all([this.#api.plans(), this.#api.rooms()]);
      this.plan.value = plans.find(({ id, state }) => id === planId && state !== 'unreadable') ?? null;
      this.rooms.value = rooms.filter((room) => room.plan === planId && present(room).length);
      this.error.value = '';
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
