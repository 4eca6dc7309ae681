// A room over a connection and a clock that are fakes.
import { load } from './page.mjs';

const { RoomState } = await load('room/room.js');

export class FakeConnection extends EventTarget {
  sent = [];
  isOpen = true;
  names = [];
  pausedAs = null;

  rename(name) {
    this.names.push(name);
    this.isOpen = false;
    this.tell('renewing');
  }

  pause(seat) {
    this.pausedAs = seat;
    this.isOpen = false;
    this.tell('paused');
  }

  send(message) {
    if (this.isOpen) this.sent.push(message);
    return this.isOpen;
  }

  tell(type, detail) {
    this.dispatchEvent(Object.assign(new Event(type), { detail }));
  }

  receive(message) {
    this.tell('message', message);
  }
}

export const scene = {
  regions: { brain: { visible: true, opacity: 1, color: '#ffffff' } },
  image: {
    id: '',
    window: { center: 40, width: 400 },
    slices: { axial: { position_mm: 0 }, coronal: { position_mm: 0 }, sagittal: { position_mm: 0 } },
  },
};

export const welcome = (more = {}) => ({
  type: 'welcome',
  room: 'r',
  member: 'm1',
  secret: 's',
  name: 'Reviewer 1',
  plan_id: 'p',
  plan: { id: 'p' },
  revision: 1,
  scene,
  gl: '',
  ...more,
});

/** The list of members: the presenter, "Dr A", and others. presenter null: nobody presents. */
export function members(presenter, others = [], more = {}) {
  const names = { m1: 'Reviewer 1', m2: 'Dr A', m3: 'Dr B' };
  const ids = [...new Set([...(presenter ? [presenter] : []), ...others])];
  return {
    type: 'members',
    members: ids.map((id) => ({
      id,
      name: names[id],
      connected: true,
      following: id !== presenter,
      presenting: id === presenter,
      ...more[id],
    })),
  };
}

/** @param {object} list the members message after the welcome; by default the page's member presents alone */
export function roomWorld(list = members('m1')) {
  const connection = new FakeConnection();
  const frames = [];
  const told = [];
  let now = 1000;
  const room = new RoomState('r', {
    connection,
    clock: { now: () => now },
    schedule: (callback) => frames.push(callback),
    notify: (...words) => told.push(words),
  });
  const flush = () => frames.splice(0).forEach((callback) => callback());
  connection.receive(welcome());
  connection.receive(list);
  flush();
  const lose = () => {
    connection.isOpen = false;
    connection.tell('lost', { retryMs: 500 });
  };
  const back = (again = list, more = {}) => {
    connection.isOpen = true;
    connection.sent.length = 0;
    connection.receive(welcome(more));
    connection.receive(again);
    flush();
  };
  return {
    room,
    connection,
    flush,
    told,
    lose,
    back,
    advance: (ms) => {
      now += ms;
    },
  };
}
