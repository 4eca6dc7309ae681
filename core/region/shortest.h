#pragma once
/* The direction in which the least tissue lies between a point in the patient and the outside. */
#include "core/region/region.h"

struct shortest_way {
    struct vec3 outwards; /* unit vector, from the point to the outside */
    double depth_mm; /* from the point to the skin: where no univel of a region lies any farther; 0: the way is free */
};

/* The least depth over all directions. Every region counts, and where the scan cuts the patient counts as outside.
 *
 *   point_lps_mm  from which the ways lead
 *   returns       of the directions SHORTEST_STEP_DEG or less apart, and around the best one a sixteenth of that, the
 * one with the least depth; of equal ones (within 1e-6 mm) the first in a fixed order, so that equal input gives an
 * equal answer whatever the number of cores errors        ERROR_MEMORY, ERROR_NOT_FOUND no region has a univel threads
 * all cores; measured regions (region_set_measure) */
#define SHORTEST_STEP_DEG 0.1
NODISCARD bool regions_shortest_way(const struct region_set *set, struct vec3 point_lps_mm, struct shortest_way *way,
                                    struct error *err);
