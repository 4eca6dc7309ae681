#pragma once
/* Lines of equal value through samples on a lattice: isodose lines. From plain numbers; knows no grid and no dose. Any
 * thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum { ISOLINES_MAX_SIDE = 8192 };

/* The values at the points of a lattice. */
struct isoline_samples {
    const float *values; /* [size[1]][size[0]]; NaN: there is none */
    uint32_t size[2];    /* each 1..ISOLINES_MAX_SIDE */
    /* Values may jump between samples of different kinds: tissues. NULL: they do not. */
    const uint8_t *kinds; /* [size[1]][size[0]] */
    /* Where the level is crossed between the neighbouring samples a and b of different kinds, whose values lie on
     * different sides of it, as the share 0..1 of the way from a to b. a, b: indices of samples, a < b. */
    double (*jump)(const void *context, size_t a, size_t b, double level);
    const void *context;
};

/* Polylines in lattice coordinates: sample (u, v) is at (u, v). A closed one ends with the point that it begins with.
 */
struct isolines {
    double (*points)[2];
    size_t n_points, points_capacity;
    size_t *ends; /* [n_lines] the index behind the last point of each line; lines follow each other */
    size_t n_lines, lines_capacity;
};
void isolines_finish(struct isolines *lines);

/* Replaces `lines` by those of a level: marching squares with linear interpolation along the edges of the lattice. A
 * value equal to the level is above it. Where a cell's corners are above and below crosswise, the value of the bilinear
 * interpolation at its saddle decides which are joined. A cell with a corner without value has no line.
 *   errors  ERROR_MEMORY
 *   source  G. M. Nielson, B. Hamann, The Asymptotic Decider, IEEE Visualization 1991 */
NODISCARD bool isolines_trace(const struct isoline_samples *samples, double level, struct isolines *lines,
                              struct error *err);
