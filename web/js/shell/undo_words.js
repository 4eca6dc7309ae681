// The words for what undo and redo would change.
import { undoWords } from '../../gen/undo_words.js';
import { shownImage } from '../room/plan.js';
import { number, significant, windowText } from '../parts/format.js';

const units = { _mm: 'mm', _px: 'px', _deg: '°' };

const unitOf = (name) => Object.keys(units).find((ending) => name.endsWith(ending));
const unique = (list) => [...new Set(list)];

/** The words of proto/scene.json for the innermost field of a path that has some; undefined: none has. @param {'scene'|'view'} document */
function wordsOf(document, path) {
  let [tree, words] = [undoWords[document]];
  for (const name of path) {
    tree = Object.hasOwn(tree, name) ? tree[name] : tree['*'];
    if (typeof tree !== 'object') return tree ?? words;
    words = tree[''] ?? words;
  }
  return words;
}

/** "opacity of brain", "window", "camera of 3-D", "crosshair", "visibility of 4 regions". @param {import('../room/undo.js').Change[]} changes */
export function stepName(changes, room) {
  if (changes[0]?.of === 'act') return changes[0].path[0];
  if (changes.some(({ path }) => path.join('.') === 'image.id')) return 'image shown'; // its window and colours went with it
  const views = changes.filter(({ of }) => of !== 'scene');
  const [regions, rest] = [true, false].map((isRegion) =>
    changes.filter(({ of, path }) => of === 'scene' && (path[0] === 'regions') === isRegion),
  );
  const names = [];
  if (regions.length) {
    const ids = unique(regions.map(({ path }) => path[1]));
    const fields = unique(regions.map(({ path }) => wordsOf('scene', path) ?? path[2]?.replaceAll('_', ' ')));
    const who = ids.length > 1 ? `${ids.length} regions` : (room.plan.value?.regions.find(({ id }) => id === ids[0])?.name ?? ids[0]);
    names.push(`${fields.length > 2 ? 'style' : fields.join(' and ')} of ${who}`);
  }
  names.push(...unique(rest.map(fieldName)));
  const panes = unique(views.map(({ of }) => room.view(of).name)).map((name) => (name.startsWith('3-D') ? name : name.toLowerCase()));
  if (panes.length)
    names.push(
      `${views.every(({ path }) => path[0] === views[0].path[0]) ? (wordsOf('view', views[0].path) ?? 'camera') : 'camera'} of ${panes.join(', ')}`,
    );
  return names.length > 2 ? `${names[0]} and ${names.length - 1} more` : names.join(' and ');
}

function fieldName({ path }) {
  const known = wordsOf('scene', path);
  if (known) return known;
  const [group, name] = path;
  const ending = unitOf(name ?? '');
  return [group, ...(name ? [ending ? name.slice(0, -ending.length) : name] : [])].join(' ').replaceAll('_', ' ');
}

/** "100 %", "2 px", "C 40 W 400": the value that a step of one field goes to; '' where a value would say little. */
function valueText(change, wanted, room) {
  const value = change[wanted];
  const name = change.path.at(-1);
  if (name === 'window' && value) return windowText(value, shownImage(room.plan.value, room.scene.value)?.unit);
  if (typeof value !== 'number' || name === 'position_mm') return '';
  if (name === 'opacity') return `${number(value * 100)} %`;
  const unit = units[unitOf(name)];
  return unit ? `${significant(value)} ${unit}` : significant(value);
}

/** "Undo: opacity of brain, to 100 % (Ctrl+Z)" */
export function stepTitle(verb, keys, changes, wanted, room) {
  if (!changes) return `${verb} (${keys})`;
  const value = changes.length === 1 ? valueText(changes[0], wanted, room) : '';
  return `${verb}: ${stepName(changes, room)}${value ? `, to ${value}` : ''} (${keys})`;
}
