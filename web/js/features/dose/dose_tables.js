// Tables of isodose levels to begin with, of proto/dose_presets.json. Pure.
import { dosePresets } from '../../../gen/dose_presets.js';
import { levelsOf } from './level_list.js';

/** {name, unit: 'percent' or 'dose', source, levels: [{value, color}]} */
export const levelTables = dosePresets.levelTables;

/** All levels replaced by those of a table; a level keeps its switches where the old list had the same value. */
export function tablePatch(scene, table) {
  const { levels } = scene.dose;
  const added = table.levels.map(({ value, color }, index) => {
    const before = Object.values(levels).find((level) => level.value === value && level.unit === table.unit);
    const { visible, line, wash, surface, opacity } = before ?? { visible: true, line: true, wash: true, surface: false, opacity: 0.4 };
    return [`level-${index + 1}`, { value, unit: table.unit, color, visible, line, wash, surface, opacity }];
  });
  const gone = Object.keys(levels)
    .filter((id) => !added.some(([other]) => other === id))
    .map((id) => [id, null]);
  return { dose: { levels: Object.fromEntries([...added, ...gone]) } };
}

/** The table that the levels are those of, by value and colour; null: none. */
export function tableOf(scene) {
  const all = levelsOf(scene);
  return (
    levelTables.find(
      ({ unit, levels }) =>
        levels.length === all.length &&
        levels.every(({ value, color }) => all.some((level) => level.value === value && level.unit === unit && level.color === color)),
    ) ?? null
  );
}
