// The server's numbers about particle tracks: how many are shown, energies, files, lost particles.
import { signal } from '../../../lib/signals-core.js';
import { Asker } from '../../parts/asker.js';
import { TrackPlay } from './track_play.js';

const perRoom = new WeakMap();

class TrackFacts {
  #room;
  #asker;
  #wanted = '';

  constructor(room, api, clock) {
    this.#room = room;
    /** {result, error, of: what it was asked for} of the question tracks */
    this.answer = signal({ result: null, error: '', of: '' });
    this.play = new TrackPlay(room, clock);
    this.#asker = new Asker(async () => {
      const of = this.#wanted;
      const tell = (facts) => {
        this.answer.value = { ...this.answer.peek(), error: '', of, ...facts };
      };
      // with the tracks of this page's scene, which the server may not have yet
      const view = { override: { ...room.following.override.peek(), tracks: JSON.parse(of) } };
      await api.ofScene(room.planId.peek(), 'tracks', room.id, view, {}).then(
        (result) => tell({ result }),
        (error) => tell({ error: error.message }),
      );
    }, clock);
  }

  /** Asks about the scene as it is, unless it has been asked already; not while the tracks are played. To be read while drawing. */
  want() {
    const { classes, first, count = null, energy_low_mev: low = null, energy_high_mev: high = null } = this.#room.scene.value.tracks;
    const of = JSON.stringify({ classes, first, count, energy_low_mev: low, energy_high_mev: high });
    if (of !== this.#wanted && !this.play.isOn.value && this.#room.renderer.value.state === 'ready') {
      this.#wanted = of;
      this.#asker.want();
    }
    return this.answer.value;
  }

  /** True if the answer is about the scene as it is. */
  get isNew() {
    return this.answer.value.of === this.#wanted && !this.play.isOn.value;
  }
}

/** Those of a room. @param {{room, api, clock}} world @returns {TrackFacts} */
export function trackFacts({ room, api, clock }) {
  if (!perRoom.has(room)) perRoom.set(room, new TrackFacts(room, api, clock));
  return perRoom.get(room);
}
