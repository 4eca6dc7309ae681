// Whether what was said in the room is on the server's disk. Nothing is called saved before the server has said so.
import { computed, signal } from '../../lib/signals-core.js';
import { say } from './words.js';

const problems = {
  full: say.diskFull,
  write: say.diskWrite,
};

export class Saved {
  #told = signal({ state: '', problem: null }); // the server's newest word
  #isOlder = signal(false); // than a change that this page has heard of

  /** @param {import('./room.js').RoomState} room */
  constructor(room) {
    /** '' before the server has told anything | unkept | saving | saved | failing */
    this.state = computed(() => {
      const { state } = this.#told.value;
      return state === 'saved' && (this.#isOlder.value || room.isScenePending.value) ? 'saving' : state;
    });
    /** Why nothing is kept now; '': it is. */
    this.problem = computed(() =>
      this.#told.value.state === 'failing' ? (problems[this.#told.value.problem?.code] ?? problems.write) : '',
    );
  }

  /** The server tells it after each welcome. */
  restart() {
    this.#told.value = { state: '', problem: null };
  }

  /** A change of the scene or of an item was heard of. */
  changed() {
    this.#isOlder.value = true;
  }

  told({ state, problem }) {
    this.#told.value = { state, problem };
    this.#isOlder.value = false;
  }
}
