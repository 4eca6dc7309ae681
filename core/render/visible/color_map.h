#pragma once
/* Colour maps of images: the colour of each grey level. Knows no image.
 *   hot-iron  DICOM PS3.6 B.1.1: red 2 i up to 254, green 2 (i - 128), blue 4 (i - 192), each kept within 0..255; level
 *             255 is white.
 *   rainbow   blue, cyan, green, yellow, red at 0, 1/4, 1/2, 3/4 and 1, linear between: red 4 i - 510, green the least
 * of 4 i and 1020 - 4 i, blue 510 - 4 i, each kept within 0..255.
 *   all others  the tables of proto/color_maps.json, where their sources and licences stand. */
#include <stdint.h>

#include "scene.h" /* generated from proto/scene.json */

enum { COLOR_MAP_LEVELS = 256 };
/* [COLOR_MAP_LEVELS] colours by level: red in the lowest byte, then green and blue, 255 in the highest. NULL for grey,
 * whose level is the colour. The table is constant and of the program. */
const uint32_t *color_map_table(enum scene_color_map map);
