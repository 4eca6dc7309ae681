// Whether the meeting is being recorded, and, in a room that plays a recording, what it plays and where it stands.
import { computed, signal } from '../../lib/signals-core.js';

const ends = {
  stopped: 'The recording has ended.',
  full: 'The recording is full and has ended: 64 MiB, 500 000 events or 12 hours.',
  empty: 'The recording has ended: nobody was in the room.',
  cut: 'The recording was cut off: the server stops, or the room fell asleep.',
};

export class Recording {
  #room;
  #tell;

  /**
   * @param {import('./room.js').RoomState} room
   * @param {(message: object) => boolean} tell sends a message; false without a connection
   */
  constructor(room, tell) {
    this.#room = room;
    this.#tell = tell;
    /** The message recording of the one that runs; null: none. */
    this.running = signal(null);
    /** The message replay; null: an ordinary room. */
    this.replay = signal(null);
    /** The message replay.at. */
    this.at = signal(null);
    /** Who was in the meeting, while it plays: their ids are none of this room's. */
    this.members = signal([]);
    this.isReplay = computed(() => this.replay.value !== null);
    /** When the recording that plays was made, for people. */
    this.date = computed(() => this.replay.value ? new Date(this.replay.value.started_ms).toLocaleString() : '');
  }

  // ---- messages of the server -------------------------------------------------------------------------------------

  welcome() {
    this.running.value = this.replay.value = this.at.value = null;
    this.members.value = [];
  }

  changed(message) {
    const was = this.running.value;
    if (message.state === 'running') this.running.value = message;
    else if (was?.id === message.id) this.running.value = null;
    if (message.state === 'running') this.#room.notify('ok', `${message.by_name} records the meeting from now on.`);
    else if (was?.id === message.id && ends[message.state]) this.#room.notify('ok', ends[message.state]);
  }

  plays(message) {
    this.replay.value = message;
    if (message.plan_changed) this.#room.notify('warn', 'The plan has changed since the meeting: pictures and numbers may differ.');
  }

  movedTo(message) {
    this.at.value = message;
    if (message.state === 'left') this.replay.value = null;
  }

  // ---- acts of the user -------------------------------------------------------------------------------------------

  start() { this.#tell({ type: 'recording.start' }); }
  stop() { this.#tell({ type: 'recording.stop' }); }
  play(rate) { this.#tell({ type: 'replay.play', rate }); }
  pause() { this.#tell({ type: 'replay.pause' }); }
  seek(t_ms) { this.#tell({ type: 'replay.seek', t_ms }); }
  leave() { this.#tell({ type: 'replay.leave' }); }
}
