// Facts of a room's record that the server alone knows: the revision of the plan's files, who was present, the audit's newest row.
import { signal } from '../../../lib/signals-core.js';
import { fetchRecord } from '../../net/record.js';

export class Record {
  #room;
  #clock;
  #asked = ''; // for which members and plan it was asked
  #timer = null;

  /** @param {object} room @param {{setTimeout: Function, clearTimeout: Function}} clock */
  constructor(room, clock) {
    this.#room = room;
    this.#clock = clock;
    this.facts = signal(null); // the answer of GET /rooms/{room}/record
    this.error = signal('');
  }

  /** Has it asked for, when somebody has come, gone or signed since. */
  keep(key) {
    if (key === this.#asked) return;
    this.#asked = key;
    this.#load(key);
  }

  async #load(key) {
    this.#clock.clearTimeout(this.#timer);
    try {
      const facts = await fetchRecord(this.#room.id, this.#room.identity);
      if (key !== this.#asked) return;
      this.facts.value = facts;
      this.error.value = '';
    } catch (problem) {
      if (key !== this.#asked) return;
      const isSoon = problem.type === '/problems/busy';
      this.error.value = isSoon ? '' : problem.message;
      this.#timer = this.#clock.setTimeout(() => this.#load(key), isSoon ? 500 : 5000);
    }
  }
}
