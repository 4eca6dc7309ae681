// Control of the room: who requests it, whether it is locked, what this member may do about it. Who presents: following.js.
import { computed, signal } from '../../lib/signals-core.js';
import { roles } from '../../gen/wire.js';
import { say } from './words.js';

const topic = 'following';
const forGuests = ['look', 'point', 'note'];

export class Control {
  #room;
  #tell;

  /**
   * @param {import('./room.js').RoomState} room
   * @param {(message: object) => boolean} tell sends a message; false without a connection
   */
  constructor(room, tell) {
    this.#room = room;
    this.#tell = tell;
    this.isLocked = signal(false);
    this.requested = signal([]); // ids, the oldest request first
    /** The members who request control, the oldest request first. */
    this.requests = computed(() => this.requested.value.map((id) => this.member(id)).filter(Boolean));
    this.me = computed(() => this.member(room.member.value));
    /** observer | reviewer | presenter: what this member may do; '' until the list of members has come. */
    this.role = computed(() => this.me.value?.role ?? '');
    this.isRequesting = computed(() => this.requested.value.includes(room.member.value));
    /** Whether control can be had at once. */
    this.canTake = computed(
      () =>
        this.may('scene') &&
        !room.following.isPresenting.value &&
        (!room.following.presenter.value || (this.may('control') && !this.isLocked.value)),
    );
    this.canRequest = computed(() => this.may('scene') && !this.canTake.value && !room.following.isPresenting.value);
  }

  member(id) {
    return this.#room.members.value.find((member) => member.id === id);
  }

  /** Whether the member, by default this one, may do what needs the right. A guest changes nothing of what the room shows. */
  may(right, member = this.me.value) {
    const isHeld = member?.is_guest && member.role !== 'wall' && !forGuests.includes(right);
    return !isHeld && (roles[member?.role]?.includes(right) ?? false);
  }

  /** A guest takes no files away. */
  get mayExport() {
    return !this.me.value?.is_guest;
  }

  // ---- acts of the user -------------------------------------------------------------------------------------------

  request() {
    const presenter = this.#room.following.presenter.value;
    if (this.#send({ type: 'control.request' }))
      this.#room.notify('ok', presenter ? say.asked(presenter) : say.askedPresenter, topic, {
        word: say.withdraw,
        act: () => this.withdraw(),
      });
  }

  withdraw() {
    this.#send({ type: 'control.request', wanted: false });
  }

  give(member) {
    this.#send({ type: 'control.give', member });
  }

  refuse(member) {
    this.#send({ type: 'control.refuse', member });
  }

  take() {
    if (!this.#room.following.presenter.value) this.#room.following.present();
    else this.#send({ type: 'control.take' });
  }

  lock(locked) {
    this.#send({ type: 'control.lock', locked });
  }

  #send(message) {
    if (this.#tell(message)) return true;
    this.#room.notify('warn', say.notSent, topic);
    return false;
  }

  // ---- messages of the server -------------------------------------------------------------------------------------

  changed({ presenter, locked, requests, act, member }) {
    const own = this.#room.member.value;
    this.isLocked.value = locked;
    if (Array.isArray(requests)) this.requested.value = requests;
    if (presenter === own && ['given', 'taken'].includes(act)) this.#room.following.gotControl();
    if (act === 'refused' && member === own) {
      const presenter = this.#room.following.presenter.value;
      this.#room.notify('warn', presenter ? say.keepsControl(presenter) : say.presenterKeepsControl, topic);
    }
  }

  /** Names in place of the ids in a sentence of the server. */
  named(sentence) {
    return sentence.replace(/\bm\d+\b/g, (id) => this.member(id)?.name ?? id);
  }
}
