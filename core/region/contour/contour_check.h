#pragma once
/* Inside of contour filling: an estimate of the area of a plane by another way than filling it. Any thread. */
#include "core/region/contour/contour_planes.h"

/* Adds up the areas of contours by the shoelace formula; a contour inside an odd number of others counts negative. Most
 * of 16 points of it decide whether it is inside, by their winding number. Partial overlaps count twice, and loops that
 * turn against each other cancel: there, and where a rule of filling went wrong, the estimate differs from the voxels.
 *
 *   n_steps  grows by the work done; beyond CONTOUR_MAX_CHECKED the result is NaN */
double contour_outlines_mm2(const struct contour *const *contours, size_t n, struct vec3 normal_lps, uint64_t *n_steps);
#define CONTOUR_MAX_CHECKED ((uint64_t)1 << 28)
