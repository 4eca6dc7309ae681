// Whether a room has ended or does not exist: the notice of it, and the search for ways on.
import { nothing } from '../../lib/lit-html.js';
import { effect } from '../../lib/signals-core.js';
import { later } from '../parts/lazy.js';

export const card = later(() => import('./ended_card.js'));

export const ended = (world) => (world.room.link.value.state === 'ended' ? card.draw((loaded) => loaded.endedCard(world)) : nothing);

/** Looks for ways on as soon as the room has ended. @param {string} plan as far as the address knows it @returns {() => void} stops */
export function watchEnd(host, room, after, plan) {
  const stop = effect(() => {
    if (room.link.value.state !== 'ended') return;
    host.querySelector('.room').classList.toggle('unknown', room.member.peek() === '');
    queueMicrotask(() => void after.look(room.planId.peek() || plan)); // outside of the effect: what it reads must not start it again
  });
  return () => {
    stop();
    after.stop();
  };
}
