// The items of a room, which are notes, replies and bookmarks: the server's rows, and the own commands that it has not answered.
import { computed, signal } from '../../lib/signals-core.js';
import { say } from './words.js';

const mostUntold = 20;

/** @typedef {{id: string, kind: 'note'|'bookmark'|'check'|'decision'|'signature', version: number, author: string, author_name: string, author_color: string, changed_name: string, created_ms: number, changed_ms: number, body: object}} Item */

export class Items {
  #send;
  #told; // of new items of other members
  #untold = []; // as long as nobody listens
  #own = []; // commands without an answer: {message, input: 0 while it waits for a connection, before: ids there when it was given, done, failed}

  /** @param {(message: object) => number} send gives the input number; 0 without a connection */
  constructor(send) {
    this.#send = send;
    this.rows = signal(new Map()); // by id, oldest first
    this.nPending = signal(0);
    this.notes = computed(() => [...this.rows.value.values()].filter(({ kind }) => kind === 'note'));
    this.nOpen = computed(() => this.notes.value.filter(({ body }) => !body.parent && !body.resolved).length);
    this.#told = (item) => {
      this.#untold = [...this.#untold.slice(1 - mostUntold), item];
    };
  }

  /** Tells of new items of other members, first of those that came before. @param {(item: Item) => void} told @returns {() => void} stops */
  listen(told) {
    this.#told = told;
    this.#untold.forEach(told);
    this.#untold = [];
    return () => {
      this.#told = () => {};
    };
  }

  /** Writes a new item, or another body of one. Resolves with the row once the server has it; rejects with its problem. @param {Item['kind']} kind @param {object} body @param {{id: string, version: number}|null} of what is changed, in the version that was seen */
  put(kind, body, of = null) {
    return this.#give({ type: 'item.put', item: of?.id ?? '', version: of?.version ?? 0, kind, body });
  }

  /** Deletes an item, and of a note its replies. @param {{id: string, version: number}} of in the version that was seen */
  delete(of) {
    return this.#give({ type: 'item.delete', item: of.id, version: of.version });
  }

  /** Hides a note from everybody, or shows it again. @param {{id: string}} of @param {boolean} hidden */
  hide(of, hidden) {
    return this.#give({ type: 'item.hide', item: of.id, hidden });
  }

  #give(message) {
    return new Promise((done, failed) => {
      const command = { message, input: this.#send(message), before: new Set(this.rows.peek().keys()), done, failed };
      this.#keep([...this.#own, command]);
    });
  }

  #keep(commands) {
    this.#own = commands;
    this.nPending.value = commands.length;
  }

  #answered(input) {
    const command = input ? this.#own.find((other) => other.input === input) : null;
    if (command) this.#keep(this.#own.filter((other) => other !== command));
    return command;
  }

  /** The message item. */
  changed({ id, item, by, input }, me) {
    const rows = new Map(this.rows.peek());
    const isNew = !rows.has(id);
    if (item) rows.set(id, item);
    else rows.delete(id);
    this.rows.value = rows;
    this.#answered(input)?.done(item);
    if (item && isNew && by !== me) this.#told(item);
  }

  /** The server refused an own command. Returns whether the message was one of these. */
  refused(input, problem) {
    const command = this.#answered(input);
    command?.failed(problem);
    return Boolean(command);
  }

  /** The room has ended: what waits for an answer is refused. Returns whether anything did. */
  end() {
    const left = this.#own;
    this.#keep([]);
    for (const { failed } of left) failed({ detail: say.notSaved });
    return left.length > 0;
  }

  /** The connection was lost: what was sent may have arrived or not. */
  recall() {
    for (const command of this.#own) command.input = 0;
  }

  /** All rows, after entering or coming back. What the rows show to be done is not sent again by resend(). */
  replace(items, me) {
    this.rows.value = new Map(items.map((item) => [item.id, item]));
    for (const command of [...this.#own]) {
      const { message, before } = command;
      const same = (item) =>
        item.kind === message.kind &&
        Object.entries(message.body).every(([name, value]) => JSON.stringify(value) === JSON.stringify(item.body[name]));
      const found =
        message.type === 'item.delete'
          ? null
          : message.item
            ? this.rows.value.get(message.item)
            : items.find((item) => !before.has(item.id) && item.author === me && same(item));
      const isDone =
        message.type === 'item.delete' ? !this.rows.value.has(message.item) : found && found.version > message.version && same(found);
      if (!isDone) continue;
      this.#keep(this.#own.filter((other) => other !== command));
      command.done(found);
    }
  }

  /** Sends what waits for a connection. */
  resend() {
    for (const command of this.#own) command.input ||= this.#send(command.message);
  }
}
