// The meeting of many cases that a room belongs to, as far as every page has it: the rest is loaded when the server tells of one.
import { signal } from '../../../lib/signals-core.js';
import { later } from '../../parts/lazy.js';

const code = later(() => import('./later.js'), 'js/features/meeting/meeting.css', 'js/features/meeting/invite.css');

/** @param {object} world {room, ui, api, clock, connection, enter} @returns {() => void} stops */
function start(world) {
  const early = []; // told while the code is loaded
  let isLeft = false;
  const take = async ({ detail }) => {
    if (!detail.type.startsWith('meeting')) return;
    early.push(detail);
    if (!code.loaded.peek()) await code.load();
    if (isLeft || !code.loaded.peek()) return;
    world.meeting.value ??= code.loaded.peek().join(world);
    for (const message of early.splice(0)) world.meeting.peek().take(message);
  };
  world.connection.addEventListener('message', take);
  return () => {
    isLeft = true;
    world.meeting.peek()?.leave();
  };
}

/** @type {import('../index.js').Feature} */
export const meeting = {
  make: (world) => {
    world.meeting = signal(null);
  },
  start,
  keys: { nextCase: (world) => world.meeting.peek()?.next() },
  chip: (world) => code.loaded.value?.chip(world),
  chipCard: (world) => code.loaded.value?.chipCard(world),
};
