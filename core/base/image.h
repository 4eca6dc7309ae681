#pragma once
/* A picture in memory: 8 bits a channel, RGBA, row 0 at the top, no padding between rows. */
#include <stdint.h>

#include "core/base/error.h"

enum { IMAGE_MAX_SIDE_PX = 8192 };

struct image {
    int width_px, height_px;
    uint8_t *rgba; /* [height][width][4] */
};

/* Zeroed pixels.
 *   errors  ERROR_RANGE   a side outside 1..IMAGE_MAX_SIDE_PX
 *           ERROR_MEMORY */
NODISCARD struct image *image_create(int width_px, int height_px, struct error *err);
void image_destroy(struct image *image);
