// Colours of isodose levels, whatever their values: Sera3d's, those safe for any colour vision, colour maps. Pure.
import { dosePresets } from '../../../gen/dose_presets.js';
import { colorAt, colorMaps } from '../image/color_maps.js';
import { levelsOf } from './level_list.js';
import { say } from './later_words.js';

const coloursOf = (table) => dosePresets.levelTables.find(({ id }) => id === table).levels.map(({ color }) => color);
const sera = coloursOf('sera');
const safe = coloursOf('safe');
/** The lowest part of a map is left out: it is black in some, and no line is seen on air. */
const lowestPart = 0.25;
const ofMap = (id) => (n) => Array.from({ length: n }, (_, i) => colorAt(id, n > 1 ? 1 - ((1 - lowestPart) * i) / (n - 1) : 1));
/** Colours of a list, n of them, spread over it. Any two of the safe colours are told apart, so any choice of them is. */
const spread = (all) => (n) => Array.from({ length: n }, (_, i) => all[n > 1 ? Math.round((i * (all.length - 1)) / (n - 1)) : 0]);

/** Word, name, what it is, how many levels it has colours for, the colours of n levels, highest first. */
export const levelColours = [
  ['sera', say.colourSera, say.colourSeraIs({ n: sera.length }), sera.length, (n) => sera.slice(0, n)],
  ['safe', say.colourSafe, say.colourSafeIs({ n: safe.length }), safe.length, spread(safe)],
  ...colorMaps.filter(([id]) => id !== 'grey').map(([id, name, about]) => [id, name, about, Infinity, ofMap(id)]),
];

/** The colours that the scene's levels have; null: others. */
export function coloursNow(scene, reference) {
  const all = levelsOf(scene, reference);
  const [id] = levelColours.find(
    ([, , , most, of]) => all.length && all.length <= most && of(all.length).every((color, i) => color === all[i].color),
  ) ?? [null];
  return id;
}

/** The patch that gives the levels other colours, highest first; their values, switches and opacities stay. Null: there are too many levels, or none. */
export function coloursPatch(scene, reference, chosen) {
  const all = levelsOf(scene, reference);
  const [, , , most, of] = levelColours.find(([id]) => id === chosen);
  if (!all.length || all.length > most) return null;
  const colours = of(all.length);
  return { dose: { levels: Object.fromEntries(all.map(({ id }, i) => [id, { color: colours[i] }])) } };
}
