// Marks: the measures, pinned probes and limits of the scene. Everybody who may present adds some to the room, also while they follow: under ids that end with
// "-" and their member id, which nobody but they and the presenter changes. On one's own they are one's own, in the override.
import { isObject } from '../wire/merge.js';

const kinds = ['measures', 'probes', 'constraints'];

/** "3" of "m3-m12", "pin-3", "limit-3-m2": the id without its kind's prefix and its member. */
export const shortId = (id, prefix) => id.replace(/-m\d+$/, '').replace(prefix, '');

/** The first number that no id with this prefix has, whoever's it is. */
export function freeNumber(ids, prefix) {
  const used = new Set([...ids].filter((id) => id.startsWith(prefix)).map((id) => Number.parseInt(id.slice(prefix.length), 10)));
  let n = 1;
  while (used.has(n)) n += 1;
  return n;
}

const prefixes = { measures: 'm', probes: 'pin-', constraints: 'limit-' };

/** An id for a new mark of this member, beside all of these. */
const ownId = (kind, ids, member) => `${prefixes[kind]}${freeNumber(ids, prefixes[kind])}-${member}`;

const isOf = (id, member) => id.endsWith(`-${member}`) && id.length > member.length + 1;

/** The part of a patch that this member may change in the room without presenting; null: none. */
export function ownPart(patch, member) {
  const part = {};
  for (const kind of kinds) {
    const own = isObject(patch?.[kind]) ? Object.entries(patch[kind]).filter(([id]) => isOf(id, member)) : [];
    if (own.length) part[kind] = Object.fromEntries(own);
  }
  return Object.keys(part).length ? part : null;
}

/** Whether a patch changes marks, and nothing else. */
export const isOfMarks = (patch) =>
  Object.keys(patch).length > 0 && Object.keys(patch).every((kind) => kinds.includes(kind) && isObject(patch[kind]));

/** Whether a patch changes nothing but marks of this member. */
export const isOwn = (patch, member) =>
  isOfMarks(patch) &&
  Object.values(patch).every((marks) => Object.keys(marks).length > 0 && Object.keys(marks).every((id) => isOf(id, member)));

/** The patch with the author in marks that are new, as the room writes it down. */
export function authored(patch, scene, name) {
  const signed = { ...patch };
  for (const kind of kinds)
    if (isObject(patch[kind]))
      signed[kind] = Object.fromEntries(
        Object.entries(patch[kind]).map(([id, mark]) => [
          id,
          isObject(mark) && mark.author === undefined && !scene?.[kind]?.[id] ? { ...mark, author: name } : mark,
        ]),
      );
  return signed;
}

/** The marks that only this member sees: of their override, and not in the room's scene. Under ids with which they can be added to it. @returns {{patch: object, n: number}} */
export function leftBehind(override, scene, member) {
  const patch = {};
  let n = 0;
  for (const kind of kinds)
    for (const [id, mark] of Object.entries(override?.[kind] ?? {})) {
      if (!isObject(mark) || scene[kind]?.[id]) continue;
      patch[kind] ??= {};
      patch[kind][ownId(kind, [...Object.keys(scene[kind] ?? {}), ...Object.keys(patch[kind])], member)] = mark;
      n += 1;
    }
  return { patch, n };
}

/** The patch with marks that the room does not have, and that others made, under ids of this member: in a picture from another room the numbers are other people's.
 *  Those that the room has under another id are left out. */
export function adopted(patch, scene, member) {
  for (const kind of kinds)
    for (const [id, mark] of Object.entries(patch[kind] ?? {})) {
      if (!/-m\d+$/.test(id) || isOf(id, member) || scene[kind]?.[id]) continue;
      delete patch[kind][id];
      const text = JSON.stringify(mark);
      if (!Object.values(scene[kind] ?? {}).some((other) => JSON.stringify(other) === text))
        patch[kind][ownId(kind, [...Object.keys(scene[kind] ?? {}), ...Object.keys(patch[kind])], member)] = mark;
      if (!Object.keys(patch[kind]).length) delete patch[kind];
    }
  return patch;
}
