#pragma once
/* Inside of choosing grids: the image's lattice of voxels, continued to where contours leave the image. */
#include "core/region/contour_planes.h"

/* Whether the contours, without the thickness of their slabs, stay between the outer faces of the grid. */
bool contour_is_within(const struct contour_planes *planes, const struct grid *grid);

/* A grid around every set that is marked. In the plane it continues the image's voxels; along the contours' normal it
 * does so where their planes lie on the image's slices, else each plane of the set with most planes gets a slice of its
 * own. Coarser by doubling where a side or the part around one set would be over its limit. is_marked  sets to cover;
 * those that reach further than CONTOUR_MAX_REACH_MM beyond the image are unmarked has_grid   false: nothing is left to
 * cover, or the grid would leave the reach of coordinates (GRID_FARTHEST_MM); all are unmarked errors     as
 * contour_planes_init */
NODISCARD bool contour_reach_grid(const struct contour_set *sets, bool *is_marked, size_t n_sets,
                                  const struct grid *image, const struct contour_options *options, struct grid *reach,
                                  bool *has_grid, struct error *err);
