// dose_presets.h, dose_presets.c and dose_presets.js of dose_presets.json: weights by kind of tissue, parameters of the
// photon-isoeffective dose, tables of isodose levels; for core and as data for the page.
import { notice } from './names.mjs';

const need = (is, name, what) => {
  if (!is) throw new Error(`dose_presets.json: ${name}: ${what}`);
};
const weightNames = ['boron_ratio', 'cbe', 'nitrogen', 'fast', 'gamma', 'other'];
const responses = ['photon', 'boron', 'nitrogen', 'fast'];
const repairNames = ['repair_fast_min', 'repair_slow_min', 'low_let_fast_part', 'high_let_fast_part', 'photon_min'];

function checkWeights({ weights, isoeffective }, scene) {
  const fields = Object.fromEntries(scene.objects.tissue_weights.fields.map((field) => [field.name, field]));
  const longest = scene.objects.dose_style.fields.find(({ name }) => name === 'weights_name').max;
  for (const { name, source, tissues } of weights) {
    need(name.length <= longest && source, name, `has a name of up to ${longest} characters and a source`);
    tissues.forEach((tissue, index) => {
      need(tissue.words.length > 0 || index === tissues.length - 1, name, 'only the last kind of tissue has no words');
      need(
        tissue.words.every((word) => /^[a-z]+$/.test(word)),
        name,
        'words are a-z',
      );
      for (const field of weightNames)
        need(
          tissue[field] >= fields[field].min && tissue[field] <= fields[field].max,
          name,
          `${tissue.tissue}: ${field} is out of the scene's range`,
        );
      need(!tissue.isoeffective || isoeffective.some((set) => set.name === tissue.isoeffective), name, `no set ${tissue.isoeffective}`);
    });
  }
  for (const set of isoeffective) {
    need(
      set.name.length <= fields.isoeffective.max && set.source,
      set.name,
      `has a name of up to ${fields.isoeffective.max} characters and a source`,
    );
    need(
      responses.every((of) => set[of].alpha > 0 && set[of].beta >= 0),
      set.name,
      'needs alpha > 0 and beta >= 0 of each component',
    );
    need(
      repairNames.every((of) => set[of] >= 0) && set.repair_fast_min > 0 && set.repair_slow_min > 0,
      set.name,
      'needs repair times and parts',
    );
  }
}

/** The presets, checked against the fields of the scene that they fill. */
export function checkedDosePresets(presets, scene) {
  checkWeights(presets, scene);
  const most = scene.objects.dose_style.fields.find(({ name }) => name === 'levels').max_items;
  for (const { name, unit, source, levels } of presets.level_tables) {
    need(['percent', 'dose'].includes(unit) && source, name, 'unit is percent or dose, and there is a source');
    need(levels.length > 0 && levels.length <= most, name, `needs 1 to ${most} levels`);
    levels.forEach(({ value, color }, index) => {
      need(index === 0 || value < levels[index - 1].value, name, 'levels are in descending order');
      need(/^#[0-9a-f]{6}$/.test(color), name, 'a colour is #rrggbb');
    });
  }
  for (const { name, stops } of presets.scales) {
    need(
      stops.length > 1 && stops.every(({ at }, index) => index === 0 || at >= stops[index - 1].at),
      name,
      'has stops in ascending order',
    );
    need(
      stops.every(({ color, opacity }) => /^#[0-9a-f]{6}$/.test(color) && opacity >= 0 && opacity <= 1),
      name,
      'a colour is #rrggbb, an opacity 0 to 1',
    );
  }
  return presets;
}

export const dosePresetsHeader = () =>
  `#pragma once\n${notice}#include <stdbool.h>\n#include <stddef.h>\n#include <stdint.h>\n\n#include "core/dose/isoeffective.h"\n\n` +
  '/* Weights of a kind of tissue. A region is of the kind if one of the words begins a word of its name; no words: any\n * other region. */\n' +
  'struct tissue_preset {\n    const char *tissue;\n    const char *const *words;\n    size_t n_words;\n    double boron_ratio, cbe, nitrogen, fast, gamma, other;\n' +
  '    const char *isoeffective; /* name of the set; "": none */\n    const char *assumed;      /* what the source does not give; "": nothing */\n};\n' +
  'struct weights_preset {\n    const char *name, *source, *note;\n    const struct tissue_preset *tissues;\n    size_t n_tissues;\n};\n' +
  'extern const struct weights_preset weights_presets[];\nextern const size_t n_weights_presets;\n\n' +
  'extern const struct isoeffective_set isoeffective_sets[];\nextern const size_t n_isoeffective_sets;\n\n' +
  '/* Isodose levels and their colours, highest first; is_percent: of the reference, else in the unit of the dose. */\n' +
  'struct level_preset {\n    double value;\n    uint32_t color_rgb; /* 0xrrggbb */\n};\n' +
  'struct level_table {\n    const char *name, *source;\n    bool is_percent;\n    const struct level_preset *levels;\n    size_t n_levels;\n};\n' +
  'extern const struct level_table level_tables[];\nextern const size_t n_level_tables;\n\n' +
  "/* Colours of a wash of a difference (in parts of its span), a gamma index, a statistical error (%); a jump where two\n * stops are at one value. opacity: a part of the wash's. */\n" +
  'struct color_stop {\n    double at;\n    uint32_t color_rgb; /* 0xrrggbb */\n    double opacity;\n};\n' +
  'struct color_scale {\n    const struct color_stop *stops;\n    size_t n_stops;\n};\n' +
  'extern const struct color_scale difference_scale, gamma_scale, error_scale;\n';

const text = (value) => JSON.stringify(value ?? '');
const numbers = (object, names) => names.map((name) => `.${name} = ${object[name]}`).join(', ');

function tissueSource({ tissues }, preset) {
  const words = tissues
    .map(({ words }, i) => (words.length ? `static const char *const words_${preset}_${i}[] = { ${words.map(text).join(', ')} };\n` : ''))
    .join('');
  const rows = tissues
    .map(
      (tissue, i) =>
        `    { .tissue = ${text(tissue.tissue)}, ${tissue.words.length ? `.words = words_${preset}_${i}, .n_words = ${tissue.words.length}, ` : ''}` +
        `${numbers(tissue, weightNames)}, .isoeffective = ${text(tissue.isoeffective)}, .assumed = ${text(tissue.assumed)} },\n`,
    )
    .join('');
  return `${words}static const struct tissue_preset tissues_${preset}[] = {\n${rows}};\n`;
}

const setRow = (set) =>
  `    { .name = ${text(set.name)}, .tissue = ${text(set.tissue)}, .source = ${text(set.source)}, .repair_source = ${text(set.repair_source)},\n      ` +
  `${responses.map((of) => `.${of} = { ${set[of].alpha}, ${set[of].beta} }`).join(', ')}, ${numbers(set, repairNames)} },\n`;

const scaleSource = ({ name, stops }) =>
  `static const struct color_stop ${name}_stops[] = { ${stops.map(({ at, color, opacity }) => `{ ${at}, 0x${color.slice(1)}, ${opacity} }`).join(', ')} };\nconst struct color_scale ${name}_scale = { ${name}_stops, ${stops.length} };\n`;

export function dosePresetsSource({ weights, isoeffective, level_tables: tables, scales }) {
  const list = (type, name, count, rows) =>
    `const struct ${type} ${name}[] = {\n${rows.join('')}};\nconst size_t n_${name} = ${count};\n\n`;
  const levels = tables
    .map(
      (table, i) =>
        `static const struct level_preset levels_${i}[] = { ${table.levels.map(({ value, color }) => `{ ${value}, 0x${color.slice(1)} }`).join(', ')} };\n`,
    )
    .join('');
  return (
    `${notice}#include "dose_presets.h"\n\n${weights.map(tissueSource).join('')}\n` +
    list(
      'weights_preset',
      'weights_presets',
      weights.length,
      weights.map(
        ({ name, source, note, tissues }, i) => `    { ${text(name)}, ${text(source)}, ${text(note)}, tissues_${i}, ${tissues.length} },\n`,
      ),
    ) +
    list('isoeffective_set', 'isoeffective_sets', isoeffective.length, isoeffective.map(setRow)) +
    levels +
    list(
      'level_table',
      'level_tables',
      tables.length,
      tables.map(
        ({ name, source, unit, levels: of }, i) =>
          `    { ${text(name)}, ${text(source)}, ${unit === 'percent'}, levels_${i}, ${of.length} },\n`,
      ),
    ) +
    scales.map(scaleSource).join('')
  );
}

export const dosePresetsScript = ({ weights, isoeffective, level_tables: levelTables, scales }) =>
  `// Generated from proto/dose_presets.json; change it there.\nexport const dosePresets = ${JSON.stringify({ weights, isoeffective, levelTables, scales: Object.fromEntries(scales.map(({ name, stops }) => [name, stops])) }, null, 1)};\n`;
