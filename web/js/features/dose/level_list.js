// Isodose levels of a scene: their order, their value in the other unit, adding, removing. Pure.
import { dosePresets } from '../../../gen/dose_presets.js';

export const maxLevels = 32;

/** The level's value in the quantity's unit; NaN where 100 % is not known. */
export const doseOf = ({ value, unit }, reference) => (unit === 'dose' ? value : (value / 100) * (reference ?? NaN));
/** The level in per cent of the reference. */
export const percentOf = ({ value, unit }, reference) => (unit === 'percent' ? value : (value / (reference ?? NaN)) * 100);

/** The levels {id, ...}, highest first; with levels in both units by the reference. */
export function levelsOf(scene, reference) {
  const rank = (level) => (Number.isFinite(reference) ? doseOf(level, reference) : level.value);
  return Object.entries(scene.dose.levels)
    .map(([id, level]) => ({ id, ...level }))
    .sort((a, b) => rank(b) - rank(a));
}

/** The colours that are told apart with any colour vision. */
const safe = dosePresets.levelTables.find(({ id }) => id === 'safe').levels.map(({ color }) => color);
const colours = ['#ff5a36', '#ffb52e', '#ffd60a', '#6fd33a', '#22b4d6', '#3aa0ff', '#8b7cf6', '#e05bff'];

function freeId(levels) {
  let n = 1;
  while (`level-${n}` in levels) n += 1;
  return `level-${n}`;
}

/** A level below the lowest one, in its unit. @returns {{id: string, patch: object}|null} null: there are as many as there may be */
export function addedLevel(scene, reference) {
  const all = levelsOf(scene, reference);
  if (all.length >= maxLevels) return null;
  const last = all.at(-1);
  const id = freeId(scene.dose.levels);
  const value = last ? Number((last.value > 10 && last.unit === 'percent' ? last.value - 10 : last.value / 2).toPrecision(3)) : 50;
  const choice = all.length && all.every(({ color }) => safe.includes(color)) ? [...safe, ...colours] : colours;
  const color = choice.find((other) => !all.some((level) => level.color === other)) ?? colours[0];
  return {
    id,
    patch: {
      dose: {
        levels: {
          [id]: {
            value,
            unit: last?.unit ?? 'percent',
            color,
            visible: true,
            line: true,
            wash: true,
            surface: false,
            opacity: last?.opacity ?? 0.4,
          },
        },
      },
    },
  };
}

export const levelPatch = (id, change) => ({ dose: { levels: { [id]: change } } });

/** A level in the other unit, at the same dose. */
export function convertedLevel(level, unit, reference) {
  const value = unit === 'dose' ? doseOf(level, reference) : percentOf(level, reference);
  return Number.isFinite(value) ? { unit, value: Number(value.toPrecision(6)) } : null;
}

const surfacesAt = [90, 70, 50]; // per cent

/** The patch that switches the isodose surfaces. Switched on with none chosen, those of 90, 70 and 50 % come with them, else of the nearest visible levels:
 *  never none. */
export function surfacesPatch(scene, reference, isOn) {
  const all = levelsOf(scene, reference);
  if (!isOn || all.some(({ visible, surface }) => visible && surface)) return { dose: { surfaces: { visible: isOn } } };
  const away = (level, percent) => Math.abs((percentOf(level, reference) || 0) - percent);
  const left = all.filter(({ visible }) => visible);
  const chosen = surfacesAt.flatMap((percent) => {
    const nearest = left.reduce((best, level) => (best && away(best, percent) <= away(level, percent) ? best : level), null);
    return nearest ? left.splice(left.indexOf(nearest), 1) : [];
  });
  return { dose: { surfaces: { visible: true }, levels: Object.fromEntries(chosen.map(({ id }) => [id, { surface: true }])) } };
}
