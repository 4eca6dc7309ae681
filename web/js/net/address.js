// The addresses of the page: which path shows a room, and what an address asks for.
import { isId } from '../wire/check.js';

/** @param {string} room its id @param {string} link token of a link: behind "#", so that no server, log or referrer gets it */
export const roomPath = (room, link = '') => `/rooms/${room}${link ? `#link=${link}` : ''}`;

/**
 * The place that an address names: a room, a meeting, a permalink ("p"), the kept records, where people sign in ("signin"), or any other, for which there is the start page. Rooms were fragments once, "#/rooms/ID/PLAN?link=TOKEN":
 * such addresses still lead there.
 * @param {{pathname: string, hash: string}} address @returns {{place: string, id: string, plan: string, link: string}}
 */
export function placeOf({ pathname, hash }) {
  const [fragment, query] = hash.slice(1).split('?');
  const isInFragment = fragment.startsWith('/');
  const [, place = '', id = '', plan = ''] = (isInFragment ? fragment : pathname).split('/');
  const link = new URLSearchParams(isInFragment ? query : fragment).get('link') ?? '';
  if (['signin', 'records'].includes(place) && !isInFragment) return { place, id: isId(id) ? id : '', plan: '', link: '' };
  const hasId = ['rooms', 'p', 'meetings'].includes(place) && isId(id);
  return hasId ? { place, id, plan: isId(plan) ? plan : '', link: link.slice(0, 64) } : { place: '', id: '', plan: '', link: '' };
}

/** The room that a person typed or pasted: an id, or an address of a room. */
export function roomOf(text) {
  const at = text.trim();
  const [, path = `/rooms/${at}`] = /^https?:\/\/[^/]+(\/.*)$/i.exec(at) ?? [];
  const { pathname, hash } = new URL(path, 'http://host');
  return placeOf({ pathname, hash });
}
