#pragma once
/* Inside core/derive: surfaces of regions from their masks, full and coarse; built, not kept. */
#include "core/derive/shape_facts.h"
#include "core/region/mask.h"

enum { REGION_SURFACE_MAX_REDUCTION = MASK_MAX_FACTOR };

/* Builds the surface from the region's mask (mask_from_region), with vertex normals and all facts but the distances.
 * errors as surface_make */
NODISCARD struct shape *region_surface_build(const struct mask *mask, enum surface_algorithm algorithm, int n_threads,
                                             struct shape_facts *facts, struct error *err);
/* Builds the surface from the reduced mask (mask_reduce): along its shortest voxel edge `reduction` voxels become one
 * (2 or more), along longer edges as many as make it no longer than that. Runs on the calling thread alone. */
NODISCARD struct shape *region_surface_build_coarse(const struct mask *full, enum surface_algorithm algorithm,
                                                    uint32_t reduction, struct shape_facts *facts, struct error *err);
