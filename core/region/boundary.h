#pragma once
/* The border of a mask: inside voxels with at least one of their 6 neighbours outside, computed 64 voxels at a time.
 * Knows nothing of regions.
 *
 * The mask decides about the hierarchy: the border of mask_from_region (a region with all its descendants) is the outer
 * one alone; that of mask_from_region_own also follows the regions inside. */
#include "core/region/mask.h"

/* Border voxels on the mask's own grid.
 *
 *   is_open_at_edge  voxels beyond the grid count as inside, so there is no border where the scan cuts a region, as in
 *                    Sera3d
 *   errors           ERROR_MEMORY
 *   thread           any */
NODISCARD struct mask *mask_boundary(const struct mask *mask, bool is_open_at_edge, int n_threads, struct error *err);
/* Voxels of the region alone, without its descendants. Errors: as mask_from_labels, ERROR_RANGE no such region. */
NODISCARD struct mask *mask_from_region_own(const struct region_set *set, size_t region, int n_threads,
                                            struct error *err);
