// volume_presets.h, volume_presets.c and volume_presets.js of volume_presets.json: transfer functions to begin with, as
// scene_transfer_point for core/scene and as data for the page.
import { notice } from './names.mjs';

const need = (is, name, what) => {
  if (!is) throw new Error(`volume_presets.json: ${name}: ${what}`);
};

/** The presets, checked against the field of the scene that they fill. */
export function checkedPresets({ presets }, scene) {
  const { max_items: most } = scene.objects.volume_style.fields.find((field) => field.name === 'points');
  for (const { name, unit, points } of presets) {
    need(['HU', 'window'].includes(unit), name, 'unit is HU or window');
    need(points.length > 1 && points.length <= most, name, `needs 2 to ${most} points`);
    points.forEach(({ value, color, opacity }, index) => {
      need(index === 0 || value > points[index - 1].value, name, 'points are in ascending order');
      need(/^#[0-9a-f]{6}$/.test(color) && opacity >= 0 && opacity <= 1, name, 'a colour is #rrggbb, an opacity 0 to 1');
    });
  }
  return presets;
}

export const presetsHeader = () =>
  `#pragma once\n${notice}#include "scene.h"\n\n` +
  '/* A transfer function to begin with. is_hu: values are Hounsfield units; else parts of the window, 0 its lower end. */\n' +
  'struct volume_preset {\n    const char *name, *modality;\n    bool is_hu;\n    const struct scene_transfer_point *points;\n    size_t n_points;\n};\n' +
  'extern const struct volume_preset volume_presets[];\nextern const size_t n_volume_presets;\n';

const pointRow = ({ value, color, opacity }) => `    { .value = ${value}, .color_rgb = 0x${color.slice(1)}, .opacity = ${opacity} },\n`;

export function presetsSource(presets) {
  const lists = presets
    .map(({ points }, i) => `static const struct scene_transfer_point points_${i}[] = {\n${points.map(pointRow).join('')}};\n`)
    .join('');
  const rows = presets
    .map(({ name, modality, unit, points }, i) => `    { "${name}", "${modality}", ${unit === 'HU'}, points_${i}, ${points.length} },\n`)
    .join('');
  return `${notice}#include "volume_presets.h"\n\n${lists}\nconst struct volume_preset volume_presets[] = {\n${rows}};\nconst size_t n_volume_presets = ${presets.length};\n`;
}

export const presetsScript = (presets) =>
  `// Generated from proto/volume_presets.json; change it there.\nexport const volumePresets = ${JSON.stringify(presets, null, 1)};\n`;
