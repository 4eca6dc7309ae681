#pragma once
/* The border of a mask: its voxels with one of their 6 neighbours outside. Word-parallel. Knows nothing of regions.
 *
 * Hierarchy comes in with the mask: of mask_from_region (a region with all that lies inside it) the border is the outer
 * one alone; of mask_from_region_own it runs also along the regions inside. */
#include "core/region/mask.h"

/* The border voxels on the mask's own grid.
 *   is_open_at_edge  what lies beyond the grid counts as inside, so that where the scan cuts a region is no border, as
 * in the original errors           ERROR_MEMORY */
NODISCARD struct mask *mask_boundary(const struct mask *mask, bool is_open_at_edge, int n_threads, struct error *err);
/* Voxels of the region alone, without its descendants. errors as mask_from_labels, ERROR_RANGE no such region */
NODISCARD struct mask *mask_from_region_own(const struct region_set *set, size_t region, int n_threads,
                                            struct error *err);
