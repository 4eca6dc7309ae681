#pragma once
/* Measures how far a shape is from the region it shows. Knows nothing of how the shape was made. */
#include "core/region/mask.h"

struct shape_distance {
    double mean_mm, max_mm; /* over all positions; 0 and 0 without positions */
    size_t n_positions;
    uint64_t n_measured; /* faces whose distance was computed: a measure of cost */
};

/* Distance of each position to the exact border of the mask: the faces between inside and outside voxels, with
 * everything beyond the grid outside. Exact, on sheared grids too; 0 on the border, positive on either side.
 *
 *   positions_lps_mm  [n_positions][3]
 *   n_threads         0: all cores; the result is the same for any number
 *   errors            ERROR_RANGE no voxel is inside, or a position is not finite; ERROR_MEMORY
 *   thread            any
 *   cost              a position near the border looks at some 30 voxels, any other at some hundred blocks and faces,
 *                     regardless of its distance and of the aspect ratio of the voxels */
NODISCARD bool shape_distance(const struct mask *mask, const float *positions_lps_mm, size_t n_positions, int n_threads,
                              struct shape_distance *distance, struct error *err);
