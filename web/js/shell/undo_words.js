// The words for what undo and redo would change.
import { undoWords } from '../../gen/undo_words.js';
import { shownImage } from '../room/plan.js';
import { number, significant, windowText } from '../parts/format.js';
import { say as fieldNames } from './field_words.js';
import { say } from './words.js';

const units = { _mm: 'mm', _px: 'px', _deg: '°' };

const unitOf = (name) => Object.keys(units).find((ending) => name.endsWith(ending));
const unique = (list) => [...new Set(list)];

/** The words of proto/scene.json for the innermost field of a path that has some; undefined: none has. @param {'scene'|'view'} document */
function wordsOf(document, path) {
  let [tree, words] = [undoWords[document]];
  for (const name of path) {
    tree = Object.hasOwn(tree, name) ? tree[name] : tree['*'];
    if (typeof tree !== 'object') return fieldNames[tree ?? words];
    words = tree[''] ?? words;
  }
  return fieldNames[words];
}

/** "window", "window and wash"; of more than two the short form. @param {string[]} names @param {(names: string[]) => string} short */
const joined = (names, short) =>
  names.length < 2 ? (names[0] ?? '') : names.length === 2 ? say.and({ one: names[0], two: names[1] }) : short(names);

/** "opacity of brain", "window", "camera of 3-D", "crosshair", "visibility of 4 regions". @param {import('../room/undo.js').Change[]} changes */
export function stepName(changes, room) {
  if (changes[0]?.of === 'act') return changes[0].path[0];
  if (changes.some(({ path }) => path.join('.') === 'image.id')) return say.imageShown; // its window and colours went with it
  const views = changes.filter(({ of }) => of !== 'scene');
  const [regions, rest] = [true, false].map((isRegion) =>
    changes.filter(({ of, path }) => of === 'scene' && (path[0] === 'regions') === isRegion),
  );
  const names = [];
  if (regions.length) {
    const ids = unique(regions.map(({ path }) => path[1]));
    const fields = unique(regions.map(({ path }) => wordsOf('scene', path) ?? path[2]?.replaceAll('_', ' ')));
    const what =
      ids.length > 1 ? say.nRegions({ n: ids.length }) : (room.plan.value?.regions.find(({ id }) => id === ids[0])?.name ?? ids[0]);
    names.push(say.stepOf({ fields: joined(fields, () => say.style), what }));
  }
  names.push(...unique(rest.map(fieldName)));
  const panes = unique(views.map(({ of }) => room.view(of).nameWithin));
  const isOne = views.every(({ path }) => path[0] === views[0].path[0]);
  const field = (isOne && wordsOf('view', views[0]?.path ?? [])) || say.camera;
  if (panes.length) names.push(say.stepOf({ fields: field, what: panes.join(', ') }));
  return joined(names, () => say.andMore({ one: names[0], n: names.length - 1 }));
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

const ways = {
  undo: { wanted: 'before', none: say.undoNone, step: say.undo, stepTo: say.undoTo },
  redo: { wanted: 'after', none: say.redoNone, step: say.redo, stepTo: say.redoTo },
};

/** "Undo: opacity of brain, to 100 %" @param {'undo'|'redo'} way */
export function stepTitle(way, changes, room) {
  const { wanted, none, step, stepTo } = ways[way];
  if (!changes) return none;
  const value = changes.length === 1 ? valueText(changes[0], wanted, room) : '';
  const name = stepName(changes, room);
  return value ? stepTo({ step: name, value }) : step({ step: name });
}
