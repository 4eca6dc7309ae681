// The seat of this tab in a room, told to other tabs of this browser: a duplicated tab remembers the seat of the first, and would throw it out.
const waitMs = 80; // a tab answers within a few ms

export class Seats {
  #channel;
  #own = '';

  /** @param {(() => BroadcastChannel)} makeChannel may throw */
  constructor(makeChannel) {
    try {
      this.#channel = makeChannel();
    } catch {
      return; // a browser without it: as it was before
    }
    this.#channel.addEventListener(
      'message',
      ({ data }) => data?.ask && data.ask === this.#own && this.#channel.postMessage({ taken: data.ask }),
    );
  }

  /** This tab sits there from now on. @param {string} member '' none */
  take(room, member) {
    this.#own = member && `${room} ${member}`;
  }

  /** @returns {Promise<boolean>} whether another tab sits there */
  isTaken(room, member) {
    if (!this.#channel) return Promise.resolve(false);
    const seat = `${room} ${member}`;
    const abort = new AbortController();
    return new Promise((done) => {
      const timer = setTimeout(() => done(false), waitMs);
      const answer = ({ data }) => {
        if (data?.taken !== seat) return;
        clearTimeout(timer);
        done(true);
      };
      this.#channel.addEventListener('message', answer, { signal: abort.signal });
      this.#channel.postMessage({ ask: seat });
    }).finally(() => abort.abort());
  }
}
