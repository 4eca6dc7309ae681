// The seat of a display that came by a link of the role wall: a member of the room, without input. Loaded where the address has a link.
import { ofMember } from './net/api.js';
import { Connection } from './net/connection.js';

const clock = {
  now: () => performance.now(),
  setTimeout: (callback, ms) => setTimeout(callback, ms),
  clearTimeout: (timer) => clearTimeout(timer),
};

export class WallSeat {
  #member = null;

  /** @param {string} room its id @param {string} link token @param {(reason: string) => void} ended @param {() => void} refused a sign-in is needed */
  constructor(room, link, ended, refused) {
    const url = new URL(`/api/v1/rooms/${room}/ws`, location.href);
    url.protocol = url.protocol.replace('http', 'ws');
    url.hash = '';
    const connection = new Connection(url.href, { makeSocket: (address) => new WebSocket(address), clock }, { link });
    connection.addEventListener('message', ({ detail }) => {
      if (detail.type === 'welcome') this.#member = detail;
    });
    const out = (tell) => {
      this.#member = null;
      tell();
    };
    connection.addEventListener('ended', ({ detail }) => out(() => ended(detail.reason)));
    connection.addEventListener('paused', () => out(refused));
    connection.open();
  }

  /** False until the room has let the display in, and after it has put it out. */
  get isIn() {
    return this.#member !== null;
  }

  get headers() {
    return this.#member ? ofMember(this.#member) : {};
  }
}
