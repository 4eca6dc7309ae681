/* The tables of the colour maps: some the compiler makes of their formulas, the others are published ones. */
#include "core/render/visible/color_map.h"

#include <stddef.h>

#include "color_maps.h" /* generated from proto/color_maps.json */

#define BYTE(x) ((x) < 0 ? 0 : (x) > 255 ? 255 : (x))
#define RGB(r, g, b) ((uint32_t)BYTE(r) | (uint32_t)BYTE(g) << 8 | (uint32_t)BYTE(b) << 16 | 0xff000000u)
/* The standard's tables end in white, not in 255, 254, 252. */
#define HOT_IRON(i) RGB((i) < 128 ? 2 * (i) : 255, (i) == 255 ? 255 : 2 * ((i)-128), (i) == 255 ? 255 : 4 * ((i)-192))
#define RAINBOW(i) RGB(4 * (i)-510, (i) < 128 ? 4 * (i) : 1020 - 4 * (i), 510 - 4 * (i))

#define FOUR(color, i) color(i), color((i) + 1), color((i) + 2), color((i) + 3)
#define SIXTEEN(color, i) FOUR(color, i), FOUR(color, (i) + 4), FOUR(color, (i) + 8), FOUR(color, (i) + 12)
#define SIXTY_FOUR(color, i) \
    SIXTEEN(color, i), SIXTEEN(color, (i) + 16), SIXTEEN(color, (i) + 32), SIXTEEN(color, (i) + 48)
#define ALL(color) \
    { \
        SIXTY_FOUR(color, 0), SIXTY_FOUR(color, 64), SIXTY_FOUR(color, 128), SIXTY_FOUR(color, 192) \
    }

const uint32_t *color_map_table(enum scene_color_map map)
{
    static const uint32_t hot_iron[COLOR_MAP_LEVELS] = ALL(HOT_IRON), rainbow[COLOR_MAP_LEVELS] = ALL(RAINBOW);
    switch (map) {
    case SCENE_COLOR_MAP_HOT_IRON: return hot_iron;
    case SCENE_COLOR_MAP_RAINBOW: return rainbow;
    default: return color_map_colors(map);
    }
}
