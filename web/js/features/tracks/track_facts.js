// The server's numbers about particle tracks: how many are shown, energies, files, lost particles.
import { signal } from '../../../lib/signals-core.js';
import { Answer } from '../../parts/answer.js';
import { TrackPlay } from './track_play.js';

const perRoom = new WeakMap();

class TrackFacts {
  #room;
  #answer;
  #wanted = signal('');
  #result = null; // of the last answer, which stays when the next question fails

  constructor(room, api, clock) {
    this.#room = room;
    this.play = new TrackPlay(room, clock);
    const ask = async (of) => {
      // with the tracks of this page's scene, which the server may not have yet
      const view = { override: { ...room.following.override.peek(), tracks: JSON.parse(of) } };
      this.#result = await api.ofScene(room.planId.peek(), 'tracks', room.id, view, {});
      return this.#result;
    };
    this.#answer = new Answer({ key: () => this.#wanted.value, ask, clock });
    this.#answer.start();
  }

  /** Asks about the scene as it is, unless it has been asked already; not while the tracks are played. To be read while drawing. @returns {{result, error}} */
  want() {
    const { classes, first, count = null, energy_low_mev: low = null, energy_high_mev: high = null } = this.#room.scene.value.tracks;
    const of = JSON.stringify({ classes, first, count, energy_low_mev: low, energy_high_mev: high });
    if (of !== this.#wanted.peek() && !this.play.isOn.value && this.#room.renderer.value.state === 'ready') this.#wanted.value = of;
    const { error } = this.#answer.state.value;
    return { result: this.#result, error };
  }

  /** True if the answer is about the scene as it is. */
  get isNew() {
    return this.#answer.of === this.#wanted.peek() && !this.play.isOn.value;
  }
}

/** Those of a room. @param {{room, api, clock}} world @returns {TrackFacts} */
export function trackFacts({ room, api, clock }) {
  if (!perRoom.has(room)) perRoom.set(room, new TrackFacts(room, api, clock));
  return perRoom.get(room);
}
