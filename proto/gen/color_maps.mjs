// color_maps.h, color_maps.c and color_maps.js of color_maps.json: tables of colours for core, stops of gradients for the page.
import { notice } from './names.mjs';

const levels = 256;
/** Every 8th colour and the last one: a gradient between them is within 6 of 255 of the table. */
const stopEvery = 8;

const need = (is, name, what) => {
  if (!is) throw new Error(`color_maps.json: ${name}: ${what}`);
};

/** {name, source, licence, colors: ["rrggbb", ...]} of each map. */
export function checkedColorMaps({ maps }, scene) {
  const known = scene.enums.color_map.values.map(([name]) => name);
  return maps.map(({ name, source, licence, colors }) => {
    need(known.includes(name), name, 'is no color_map of scene.json');
    need(source && licence, name, 'has a source and a licence');
    const all = colors.join('').match(/.{6}/g);
    need(all.length === levels && all.every((color) => /^[0-9a-f]{6}$/.test(color)), name, `has ${levels} colours rrggbb`);
    return { name, source, licence, colors: all };
  });
}

export const colorMapsHeader = () =>
  `#pragma once\n${notice}#include <stdint.h>\n\n#include "scene.h"\n\n` +
  '/* 256 colours from low to high: red in the lowest byte, then green and blue, 255 in the highest. NULL: the map has no table. */\n' +
  'const uint32_t *color_map_colors(enum scene_color_map map);\n';

const word = (color) => `0xff${color.slice(4)}${color.slice(2, 4)}${color.slice(0, 2)}u`;
const rows = (colors) => colors.map((color, i) => (i % 8 === 7 ? `${word(color)},\n` : `${word(color)}, `)).join('');

export const colorMapsSource = (maps) =>
  `${notice}#include "color_maps.h"\n\n#include <stddef.h>\n\n` +
  maps
    .map(({ name, source, licence, colors }) => `/* ${source}; ${licence} */\nstatic const uint32_t ${name}[] = {\n${rows(colors)}};\n`)
    .join('\n') +
  `\nconst uint32_t *color_map_colors(enum scene_color_map map)\n{\n    switch (map) {\n${maps
    .map(({ name }) => `    case SCENE_COLOR_MAP_${name.toUpperCase()}: return ${name};\n`)
    .join('')}    default: return NULL;\n    }\n}\n`;

export const colorMapsScript = (maps) =>
  `// Generated from proto/color_maps.json; change it there.\nexport const colorMapStops = ${JSON.stringify(
    Object.fromEntries(
      maps.map(({ name, colors }) => [name, colors.filter((_, i) => i % stopEvery === 0 || i === levels - 1).map((color) => `#${color}`)]),
    ),
    null,
    1,
  )};\n`;
