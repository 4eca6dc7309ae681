#pragma once
/* Where an image used as a volume can be skipped, as results of the store: the range of values in each brick of an
 * image, built once; and for the values that a picture shows, how far the next brick is that has any. */
#include "core/derive/derive.h"

/* A brick has VOLUME_BRICK indices along each axis: brick b holds the positions from VOLUME_BRICK b up to, not
 * including, VOLUME_BRICK (b + 1), and so, interpolated, the voxels from VOLUME_BRICK b to VOLUME_BRICK (b + 1). */
enum { VOLUME_BRICK_BITS = 2, VOLUME_BRICK = 1 << VOLUME_BRICK_BITS };

struct volume_bricks {
    struct derive_result base;
    uint32_t n[3];     /* along i, j, k */
    float *low, *high; /* [k][j][i] finite values of the voxels, in the image's unit; low > high: there is none */
};

/* The bricks of an image of the plan. One reference, the caller's, dropped by derive_result_unref(&result->base).
 * errors ERROR_MEMORY */
NODISCARD struct volume_bricks *volume_bricks_get(struct derive *derive, size_t image, struct error *err);

/* The values that are seen: a list of ranges, in the image's unit. */
enum { VOLUME_MAX_RANGES = 16 };
struct volume_range {
    double low, high; /* both included */
};

struct volume_leaps {
    struct derive_result base;
    uint32_t n[3];
    /* [k][j][i] 0: the brick may hold a value that is seen. d > 0: no brick less than d bricks away, along whichever
     * axis that is most, does. */
    uint8_t *leap;
};

/* Distances to bricks with values that are seen; n <= VOLUME_MAX_RANGES. errors ERROR_MEMORY */
NODISCARD struct volume_leaps *volume_leaps_get(struct derive *derive, size_t image, const struct volume_range *ranges,
                                                size_t n, struct error *err);
