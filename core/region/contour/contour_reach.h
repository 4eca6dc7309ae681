#pragma once
/* Inside of choosing grids: continues the image's lattice of voxels to where contours leave the image. Any thread. */
#include "core/region/contour/contour_planes.h"

/* Returns true if the contours, without the thickness of their slabs, stay between the outer faces of the grid. */
bool contour_is_within(const struct contour_planes *planes, const struct grid *grid);

/* Makes a grid around all marked sets. In the plane it continues the image's voxels. Along the contours' normal it does
 * so if their planes are on the image's slices; else each plane of the set with most planes gets a slice. Steps are
 * doubled while a side, or the part around one set, exceeds its limit.
 *
 *   is_marked  sets to cover; those that reach further than CONTOUR_MAX_REACH_MM beyond the image are unmarked
 *   has_grid   false: nothing is left to cover, or the grid would exceed GRID_FARTHEST_MM; then all are unmarked
 *   errors     as contour_planes_init */
NODISCARD bool contour_reach_grid(const struct contour_set *sets, bool *is_marked, size_t n_sets,
                                  const struct grid *image, const struct contour_options *options, struct grid *reach,
                                  bool *has_grid, struct error *err);
