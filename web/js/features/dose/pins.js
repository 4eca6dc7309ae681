// Pinned probes: points of the scene whose values are kept in view. Pure.
import { freeNumber, shortId } from '../../room/marks.js';

export const maxPins = 32;

/** The pins with their numbers, in the order in which they were set. */
export const pinsOf = (scene) =>
  Object.entries(scene?.probes ?? {}).map(([id, pin]) => ({ id, ...pin, label: pin.name || shortId(id, /^pin-/) }));

const same = (a, b) => a.every((value, axis) => Math.abs(value - b[axis]) < 0.05);

/** suffix: of the ids of who does not present. @returns {{id: string, patch: object}|null} null: there is one already, or there are as many as there may be */
export function pinnedAt(scene, point, suffix = '') {
  const all = pinsOf(scene);
  if (all.length >= maxPins || all.some((pin) => same(pin.at_mm, point))) return null;
  const id = `pin-${freeNumber(Object.keys(scene.probes), 'pin-')}${suffix}`;
  const at = point.map((value) => Math.round(value * 1e4) / 1e4 || 0);
  return { id, patch: { probes: { [id]: { at_mm: at, name: '' } } } };
}
