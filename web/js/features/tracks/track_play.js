// Plays particle tracks in the order of the files: the number of segments that is drawn grows, at most ten times a second.
import { signal } from '../../../lib/signals-core.js';
import { countPatch, rangeOf } from './tracks.js';

const stepMs = 100;
/** Seconds that all segments take. */
export const durations = [10, 30, 120];

export class TrackPlay {
  #room;
  #clock;
  #timer = 0;
  #at = 0; // segments drawn, with the part of the next one
  #since = 0;

  /** @param {import('../../room/room.js').RoomState} room @param {{now: () => number, setTimeout: Function, clearTimeout: Function}} clock */
  constructor(room, clock) {
    this.#room = room;
    this.#clock = clock;
    this.isOn = signal(false);
    this.seconds = signal(durations[0]);
  }

  /** Starts where it stands; at the beginning when all are drawn. */
  start() {
    const { plan, scene, canChange } = this.#room;
    if (this.isOn.peek() || !canChange.peek()) return;
    const { count, most } = rangeOf(plan.peek(), scene.peek());
    this.#at = count === most ? 0 : count;
    this.#since = this.#clock.now();
    this.isOn.value = true;
    this.#room.patchScene({ tracks: { ...countPatch(plan.peek(), scene.peek(), this.#at).tracks, visible: true } });
    this.#wait();
  }

  pause() {
    this.#clock.clearTimeout(this.#timer);
    this.isOn.value = false;
  }

  #wait() {
    this.#timer = this.#clock.setTimeout(() => this.#step(), stepMs);
  }

  /** A change that the server has not taken yet is waited for, so that a slow one is not flooded. */
  #step() {
    const { plan, scene, canChange, isScenePending } = this.#room;
    const now = this.#clock.now();
    if (!canChange.peek() || !scene.peek().tracks.visible) return void this.pause();
    if (isScenePending.peek()) return void this.#wait();
    const { most } = rangeOf(plan.peek(), scene.peek());
    this.#at += ((now - this.#since) / 1000 / this.seconds.peek()) * most;
    this.#since = now;
    this.#room.patchScene(countPatch(plan.peek(), scene.peek(), this.#at));
    if (this.#at >= most) this.pause();
    else this.#wait();
  }
}
