#pragma once
/* The univels of regions in a cylinder around a line, such as the aperture of a beam. Any thread. */
#include "core/region/region.h"

struct region_in_cylinder {
    uint64_t n_voxels;     /* with their centres inside; the region's own, without those of regions inside it */
    double first_along_mm; /* the least distance along the line of such a centre; INFINITY without one */
};

/* Counts the univels of each region whose centres are within radius_mm of the line, on it included, however far along
 * it both ways.
 *
 *   from_lps_mm, direction  the line; direction of unit length, distances along it count from from_lps_mm
 *   found    [n_regions]
 *   errors   ERROR_MEMORY
 *   threads  all cores, where that is faster; measured regions (region_set_measure) */
NODISCARD bool regions_in_cylinder(const struct region_set *set, struct vec3 from_lps_mm, struct vec3 direction,
                                   double radius_mm, struct region_in_cylinder *found, struct error *err);
