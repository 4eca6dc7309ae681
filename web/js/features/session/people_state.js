// The state of the people panel beside the members of the room: who may come in without a link, and the links. Its acts.
import { signal } from '../../../lib/signals-core.js';
import { roomPath } from '../../net/address.js';
import { ofMember } from '../../net/api.js';

export const rolesInOrder = ['observer', 'reviewer', 'presenter', 'planner'];

/** Roles that a member with this one may give. */
export const rolesUpTo = (role) => rolesInOrder.slice(0, rolesInOrder.indexOf(role) + 1);

export class PeopleState {
  #world;

  /** @param {object} world {room, api} */
  constructor(world) {
    this.#world = world;
    this.isOpen = signal(false);
    this.people = signal(null); // answer of GET people; null: not known
    this.links = signal([]);
    this.error = signal({}); // by form
    this.asking = signal(''); // what is asked about: "remove:ID", "end:ID"
    this.made = signal({ url: '', isCopied: false });
    this.words = signal(''); // what the last act did
  }

  /** Guests and observers see only who is here. */
  get mayManage() {
    return this.#world.room.control.may('control');
  }

  open() {
    this.isOpen.value = true;
    this.asking.value = '';
    this.words.value = '';
    this.made.value = { url: '', isCopied: false };
    this.error.value = {};
    if (this.mayManage) void this.read();
  }

  close() {
    this.isOpen.value = false;
  }

  #call(method, path, body) {
    const { room, api } = this.#world;
    return api.call(method, `rooms/${room.id}/${path}`, { body, more: ofMember(room.identity) });
  }

  /** Resolves to the answer; undefined when it was refused, and the form says why. */
  async #act(form, act) {
    this.error.value = { ...this.error.peek(), [form]: '' };
    try {
      return (await act()) ?? null;
    } catch (problem) {
      this.error.value = { ...this.error.peek(), [form]: problem.message };
      return undefined;
    }
  }

  async read() {
    await this.#act('people', async () => {
      const [people, { links }] = await Promise.all([this.#call('GET', 'people'), this.#call('GET', 'links')]);
      this.people.value = people;
      this.links.value = links;
    });
  }

  async #change(form, part) {
    const people = await this.#act(form, () => this.#call('PATCH', 'people', part));
    if (people) this.people.value = people;
    return Boolean(people);
  }

  setOpen(isOpen) {
    return this.#change('open', { is_open: isOpen });
  }

  askIn(who, role) {
    const others = this.people.peek().people.filter((one) => one.who !== who);
    return this.#change('ask', { people: [...others, { who, role }] });
  }

  takeOff(who) {
    return this.#change('open', { people: this.people.peek().people.filter((one) => one.who !== who) });
  }

  async remove(member, reason) {
    const query = reason ? `?reason=${encodeURIComponent(reason)}` : '';
    const answer = await this.#act('here', () => this.#call('DELETE', `members/${member.id}${query}`));
    if (answer === undefined) return;
    this.asking.value = '';
    void this.read();
  }

  async makeLink(link) {
    const made = await this.#act('link', () => this.#call('POST', 'links', link));
    if (!made) return false;
    const { id } = this.#world.room;
    const path = link.role === 'wall' ? `/display/${id}#link=${made.token}` : roomPath(id, made.token);
    const url = new URL(path, location.href).href;
    const isCopied = await navigator.clipboard?.writeText(url).then(
      () => true,
      () => false,
    );
    this.made.value = { url, isCopied: Boolean(isCopied) };
    void this.read();
    return true;
  }

  async end(link) {
    const answer = await this.#act('links', () => this.#call('DELETE', `links/${link.id}?members=remove`));
    if (answer === undefined) return;
    this.asking.value = '';
    void this.read();
  }
}
