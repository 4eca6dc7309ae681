#pragma once
/* How far a shape lies from the region it shows. Knows nothing of how it was made. */
#include "core/region/mask.h"

struct shape_distance {
    double mean_mm, max_mm; /* over all positions; 0 and 0 when there is none */
    size_t n_positions;
    uint64_t n_asked; /* faces whose distance was worked out: what it cost */
};

/* Distance of each position to the mask's true border: the faces between inside and outside voxels, what lies beyond
 * the grid being outside. Exact, on sheared grids too; on the border it is 0, on either side of it positive.
 *
 *   positions_lps_mm  [n_positions][3]
 *   n_threads         0: all cores; the answer is the same for any number
 *   errors            ERROR_RANGE   no voxel is inside, or a position is not finite
 *                     ERROR_MEMORY
 *   cost              a position near the border looks at some 30 voxels, any other at some hundred blocks and faces,
 * however far it is and however much higher than wide the voxels are */
NODISCARD bool shape_distance(const struct mask *mask, const float *positions_lps_mm, size_t n_positions, int n_threads,
                              struct shape_distance *distance, struct error *err);
