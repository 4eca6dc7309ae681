// Merges a saved view or a picture into the room: things that people made since may be hidden, and are never removed.
import { objects } from '../../gen/wire.js';
import { say } from './later_words.js';

/** Maps of the scene whose entries people make. isMark: an entry stays as it is now, also where the saved view has an older one. */
const made = [
  { at: ['measures'], isMark: true, words: say.measures },
  { at: ['probes'], isMark: true, words: say.probes },
  { at: ['constraints'], isMark: true, words: say.limits },
  { at: ['beam', 'kept'], isMark: true, words: say.drafts },
  { at: ['image', 'obliques'], words: say.planes },
  { at: ['dose', 'levels'], words: say.levels },
];
/** The description of a field of the scene. */
const fieldAt = (path) => path.reduce((field, name) => objects[field.object].find((other) => other.name === name), { object: 'scene' });
for (const kind of made) kind.most = fieldAt(kind.at).max_items;

const inside = (document, path) => path.reduce((value, name) => value?.[name], document);
const replaced = (document, [name, ...rest], value) => ({
  ...document,
  [name]: rest.length ? replaced(document[name], rest, value) : value,
});
const own = (map, id) => (Object.hasOwn(map, id) ? map[id] : undefined);
const withoutVisible = ({ visible, ...rest }) => JSON.stringify(rest);

function mergedEntry(before, after, isMark) {
  if (after === undefined) return isMark || !('visible' in before) ? before : { ...before, visible: false };
  if (!isMark) return after;
  return 'visible' in after ? { ...before, visible: after.visible } : before;
}

function mergedMap(now, wanted, { isMark, most }) {
  const found = { map: {}, hidden: 0, changed: 0, left: 0 };
  const set = (id, value) => Object.defineProperty(found.map, id, { value, enumerable: true, configurable: true, writable: true });
  for (const [id, before] of Object.entries(now)) {
    const after = own(wanted, id);
    const entry = mergedEntry(before, after, isMark);
    set(id, entry);
    if (before.visible && !entry.visible) found.hidden += 1;
    if (isMark && after !== undefined && withoutVisible(after) !== withoutVisible(before)) found.changed += 1;
  }
  for (const [id, after] of Object.entries(wanted)) {
    if (own(now, id) !== undefined) continue;
    if (Object.keys(found.map).length < most) set(id, after);
    else found.left += 1;
  }
  return found;
}

/**
 * The scene to show instead of wanted, the saved one, while the room has now.
 * @returns {{scene: object, hidden: string[], changed: string[], left: string[]}} in words: what was visible and is not any more; what stays as it
 *   was changed since; what of the saved scene has no place beside that of the room
 */
export function mergedScene(now, wanted) {
  const told = { hidden: [], changed: [], left: [] };
  let scene = wanted;
  for (const kind of made) {
    const [before, after] = [inside(now, kind.at), inside(wanted, kind.at)];
    if (!before || !after) continue;
    const found = mergedMap(before, after, kind);
    scene = replaced(scene, kind.at, found.map);
    for (const what of Object.keys(told)) if (found[what]) told[what].push(kind.words({ n: found[what] }));
  }
  const [draft, saved] = [now.beam?.draft, wanted.beam?.draft];
  if (draft && saved && !saved.enabled) {
    scene = replaced(scene, ['beam', 'draft'], { ...draft, enabled: false });
    if (draft.enabled) told.hidden.push(say.draftBeam);
  }
  return { scene, ...told };
}

/** The merge in sentences; '' when there is nothing to say. */
export function toldOfMerge({ hidden, changed, left }) {
  const sentences = [];
  if (hidden.length) sentences.push(say.hidden({ what: hidden.join(', ') }));
  if (changed.length) sentences.push(say.changed({ what: changed.join(', ') }));
  if (left.length) sentences.push(say.left({ what: left.join(', ') }));
  return sentences.join(' ');
}
